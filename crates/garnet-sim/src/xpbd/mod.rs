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

/// How springs and hinges are projected.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Projection {
    /// Length of a substep, in seconds.
    pub(crate) step: f32,
    /// What corrections of springs are multiplied by.
    pub(crate) over_relaxation: f32,
    /// Hinges are projected once in so many substeps.
    pub(crate) bending_interval: u32,
}

#[cfg(test)]
impl Projection {
    /// Substeps of so many seconds.
    fn of(step: f32, bending_interval: u32) -> Self {
        Self {
            step,
            over_relaxation: 1.0,
            bending_interval,
        }
    }
}
