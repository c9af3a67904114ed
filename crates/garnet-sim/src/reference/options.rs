//! What the reference solver is asked for.

use nalgebra::Vector3;

/// How the reference solver runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceOptions {
    /// Acceleration of free fall, m/s².
    pub gravity: Vector3<f64>,
    /// Stiffness of contact and of sticking friction, N/m a vertex.
    pub contact_stiffness: f64,
    /// Vertices that are not near along the cloth keep this distance, in metres; `None` lets cloth
    /// pass through itself.
    pub self_contact: Option<f64>,
    /// Largest force left over on a vertex, over the mean weight of a vertex under 9.81 m/s².
    pub tolerance: f64,
    /// Newton iterations of a step.
    pub max_iterations: usize,
    /// Steps of a settling.
    pub max_steps: usize,
    /// Vertices that a settling may hold where they are because they lie in creases of the
    /// obstacle: two contacts bear them there, and the nearest one alone cannot, so that no step
    /// goes down.
    pub max_creased: usize,
    /// Length of the first step of a settling, in seconds; the later ones are longer.
    pub first_step: f64,
}

impl Default for ReferenceOptions {
    fn default() -> Self {
        Self {
            gravity: Vector3::new(0.0, -9.81, 0.0),
            contact_stiffness: 500.0,
            self_contact: None,
            tolerance: 1e-3,
            max_iterations: 40,
            max_steps: 300,
            max_creased: 0,
            first_step: 1.0 / 60.0,
        }
    }
}
