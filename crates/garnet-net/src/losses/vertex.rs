//! `L_vert`: how far vertices are from where the teacher puts them.

use super::gradient::{Gradient, Place};

/// The root of the smallest square that has a slope, in units.
const LEAST: f64 = 1e-3;

/// The mean distance of vertices: what is far off counts no more than what is near.
///
/// ```text
/// L_dist = 1/N Σ_i √(‖G_i^G − G_i^P‖² + ε²) − ε,   ε = 0.1 mm
/// ```
pub(crate) fn distance_loss(
    predicted: &[Place],
    target: &[Place],
    gradient: &mut Gradient<'_>,
) -> f64 {
    mean(predicted, target, gradient, |square, share| {
        let distance = (square + LEAST * LEAST).sqrt();
        (distance - LEAST, share / distance)
    })
}

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
    mean(predicted, target, gradient, |square, share| {
        (square, 2.0 * share)
    })
}

/// The mean of a function of squared distances. `of` takes a square and the share of a vertex in
/// the mean; it returns the value, and the factor of the difference in the gradient.
fn mean(
    predicted: &[Place],
    target: &[Place],
    gradient: &mut Gradient<'_>,
    of: impl Fn(f64, f64) -> (f64, f64),
) -> f64 {
    let share = 1.0 / predicted.len() as f64;
    let mut sum = 0.0;
    for (vertex, (predicted, target)) in (0..).zip(predicted.iter().zip(target)) {
        let difference = predicted - target;
        let (value, factor) = of(difference.norm_squared(), share);
        sum += value;
        gradient.add(vertex, factor * difference);
    }
    share * sum
}
