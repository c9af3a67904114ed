//! `L_norm`: how faces are turned.

use super::gradient::{Gradient, Place, by_corners, unit_normal};

/// The mean squared lack of the cosine between unit normals.
///
/// ```text
/// L_norm = 1/N_F Σ_i (1 − F_i^G · F_i^P)²
/// ```
///
/// Faces without area have no normal: in the target they are left out, in the prediction they
/// count as square to the target and have no derivative.
///
/// Source: *Gundogdu et al. 2020, Eq. 6*.
pub(crate) fn normal_loss(
    predicted: &[Place],
    faces: &[[u32; 3]],
    target_normals: &[Option<Place>],
    gradient: &mut Gradient<'_>,
) -> f64 {
    let share = 1.0 / faces.len().max(1) as f64;
    let mut sum = 0.0;
    for (&face, target) in faces.iter().zip(target_normals) {
        let Some(target) = target else { continue };
        let Some(normal) = unit_normal(predicted, face) else {
            sum += 1.0;
            continue;
        };
        let lack = 1.0 - target.dot(&normal.0);
        sum += lack * lack;
        let by_normal = -2.0 * share * lack * target;
        let by_corners = by_corners(predicted, face, normal, by_normal);
        for (vertex, derivative) in face.into_iter().zip(by_corners) {
            gradient.add(vertex, derivative);
        }
    }
    share * sum
}
