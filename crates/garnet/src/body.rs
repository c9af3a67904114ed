//! The built-in body, its poses, and motions that are carried over to it.

pub use garnet_body::{Registration, motion, poses, shape};
