//! `L_pen`: vertices behind the body point nearest to them.

use super::gradient::{Gradient, Place};

/// A body point moved out along its normal, and the normal.
pub(crate) type Front = (Place, Place);

/// How far vertices are behind the planes of their nearest body points.
///
/// ```text
/// L_pen = 1/N Σ_{i,j} 1[‖G_j^P − G_j^G‖ < d_tol] ReLU(−N_Bi · (G_j^P − B_i))
/// ```
///
/// with B_i moved out along its normal by 20 % of the body's mean edge length. The pairs are
/// searched anew for each prediction, and neither they nor the indicator are differentiated. This
/// is a test for the loss alone: it is wrong for many points near the skin.
///
/// Source: *Gundogdu et al. 2020, Eq. 5 and section 3.5*.
pub(crate) fn penetration_loss(
    predicted: &[Place],
    target: &[Place],
    fronts: &[Front],
    tolerance: f64,
    gradient: &mut Gradient<'_>,
) -> f64 {
    let share = 1.0 / predicted.len() as f64;
    let mut sum = 0.0;
    for (vertex, (place, (point, normal))) in (0..).zip(predicted.iter().zip(fronts)) {
        let depth = -normal.dot(&(place - point));
        if depth > 0.0 && (place - target[vertex as usize]).norm() < tolerance {
            sum += depth;
            gradient.add(vertex, -share * normal);
        }
    }
    share * sum
}
