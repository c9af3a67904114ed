//! `L_UMC`: curvature with uniform weights.

use garnet_mesh::Topology;

use super::gradient::{Gradient, Place};

/// Vectors from each vertex to the middle of its one-ring.
///
/// ```text
/// κ_UMC^i = 1/|N_i| Σ_j (G_j − G_i)
/// ```
///
/// Source: *Gundogdu et al. 2020, Eq. 19*.
pub(crate) fn uniform_curvatures(places: &[Place], topology: &Topology) -> Vec<Place> {
    let curvature = |(vertex, place): (usize, &Place)| {
        let ring = topology.neighbors(vertex);
        let sum: Place = ring
            .iter()
            .map(|&other| places[other as usize] - place)
            .sum();
        sum / ring.len().max(1) as f64
    };
    places.iter().enumerate().map(curvature).collect()
}

/// The mean squared difference of these vectors: Eq. 14 with Eq. 19 in place of Eq. 9.
pub(crate) fn uniform_curvature_loss(
    predicted: &[Place],
    topology: &Topology,
    target: &[Place],
    gradient: &mut Gradient<'_>,
) -> f64 {
    let share = 1.0 / predicted.len() as f64;
    let mut sum = 0.0;
    let curvatures = uniform_curvatures(predicted, topology);
    for (vertex, (curvature, target)) in curvatures.iter().zip(target).enumerate() {
        let ring = topology.neighbors(vertex);
        if ring.is_empty() {
            continue;
        }
        let difference = curvature - target;
        sum += difference.norm_squared();
        let derivative = 2.0 * share * difference;
        gradient.add(vertex as u32, -derivative);
        for &other in ring {
            gradient.add(other, derivative / ring.len() as f64);
        }
    }
    share * sum
}
