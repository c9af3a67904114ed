//! The built-in parametric human body, its tape measures, poses, motions and retargeting.

mod draws;
pub mod motion;
pub mod poses;
mod registration;
pub mod shape;

pub use draws::uniform;
pub use registration::Registration;
