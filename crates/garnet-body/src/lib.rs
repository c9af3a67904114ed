//! The built-in parametric human body, its tape measures, poses and motion files.

pub mod motion;
pub mod poses;
pub mod shape;
