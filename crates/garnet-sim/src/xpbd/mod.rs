//! Extended position-based dynamics in small steps with one iteration each.
//!
//! Macklin, Storey, Lu, Terdiman, Chentanez, Jeschke and Müller 2019, "Small steps in physics
//! simulation": many short substeps with one projection of each constraint converge faster than few
//! with many.

pub(crate) mod bending;
pub(crate) mod coloring;
#[cfg(target_arch = "x86_64")]
mod eights;
pub(crate) mod pairs;
pub(crate) mod particles;
pub(crate) mod patch;
pub(crate) mod patchwork;
pub(crate) mod quad;
mod rounds;
mod seam;
#[cfg(test)]
mod sheet;
pub(crate) mod springs;
