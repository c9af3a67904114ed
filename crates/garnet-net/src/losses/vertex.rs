//! `L_vert`: how far vertices are from where the teacher puts them.

use super::gradient::{Gradient, Place};

/// The mean squared distance of vertices.
///
/// ```text
/// L_vert = 1/N Σ_i ‖G_i^G − G_i^P‖²
/// ```
///
/// Source: *Gundogdu et al. 2020, Eq. 4* (their text says distance, their formula squares it).
pub(crate) fn vertex_loss(
    predicted: &[Place],
    target: &[Place],
    gradient: &mut Gradient<'_>,
) -> f64 {
    let share = 1.0 / predicted.len() as f64;
    let mut sum = 0.0;
    for (vertex, (predicted, target)) in (0..).zip(predicted.iter().zip(target)) {
        let difference = predicted - target;
        sum += difference.norm_squared();
        gradient.add(vertex, 2.0 * share * difference);
    }
    share * sum
}
