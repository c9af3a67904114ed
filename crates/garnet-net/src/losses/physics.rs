//! Terms that need no teacher: strain, gravity, bending energy.

use garnet_mesh::Hinge;

use super::gradient::{Gradient, Place, by_corners, unit_normal};

/// The mean squared relative change of edge lengths.
///
/// ```text
/// L_strain = 1/|E| Σ_e (l_e / l_e^0 − 1)²
/// ```
///
/// Source: the mass-spring energy of *Bertiche et al. 2021 (PBNS)*, relative to rest lengths.
pub(crate) fn strain_loss(
    predicted: &[Place],
    edges: &[[u32; 2]],
    rest_lengths: &[f64],
    gradient: &mut Gradient<'_>,
) -> f64 {
    let share = 1.0 / edges.len().max(1) as f64;
    let mut sum = 0.0;
    for (&[i, k], &rest) in edges.iter().zip(rest_lengths) {
        let between = predicted[i as usize] - predicted[k as usize];
        let length = between.norm();
        if rest <= f64::MIN_POSITIVE || length <= f64::MIN_POSITIVE {
            continue;
        }
        let strain = length / rest - 1.0;
        sum += strain * strain;
        let derivative = 2.0 * share * strain / (rest * length) * between;
        gradient.add(i, derivative);
        gradient.add(k, -derivative);
    }
    share * sum
}

/// The mean height of vertices, by the share of cloth that each carries.
///
/// ```text
/// L_gravity = Σ_i A_i y_i / Σ_i A_i
/// ```
pub(crate) fn gravity_loss(
    predicted: &[Place],
    shares: &[f64],
    gradient: &mut Gradient<'_>,
) -> f64 {
    let mut height = 0.0;
    for (vertex, (place, share)) in (0..).zip(predicted.iter().zip(shares)) {
        height += share * place.y;
        gradient.add(vertex, Place::new(0.0, *share, 0.0));
    }
    height
}

/// The mean lack of the cosine between faces that share an edge.
///
/// ```text
/// L_fold = 1/|H| Σ_h (1 − n_a · n_b)
/// ```
///
/// Source: the bending term of *Bertiche et al. 2021 (PBNS)*.
pub(crate) fn fold_loss(predicted: &[Place], hinges: &[Hinge], gradient: &mut Gradient<'_>) -> f64 {
    let share = 1.0 / hinges.len().max(1) as f64;
    let mut sum = 0.0;
    for hinge in hinges {
        let [a, b] = hinge.edge;
        let faces = [[a, b, hinge.opposite[0]], [b, a, hinge.opposite[1]]];
        let [Some(left), Some(right)] = faces.map(|face| unit_normal(predicted, face)) else {
            continue;
        };
        sum += 1.0 - left.0.dot(&right.0);
        for (face, own, other) in [(faces[0], left, right), (faces[1], right, left)] {
            let derivatives = by_corners(predicted, face, own, -share * other.0);
            for (vertex, derivative) in face.into_iter().zip(derivatives) {
                gradient.add(vertex, derivative);
            }
        }
    }
    share * sum
}
