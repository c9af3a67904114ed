//! The built-in parametric human body, its tape measures, poses and motion files.

pub mod motion;
pub mod poses;
mod registration;
pub mod shape;

pub use registration::Registration;
