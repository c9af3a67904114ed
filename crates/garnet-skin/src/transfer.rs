//! Skin weights of a garment, taken from the body that it lies on.
//!
//! Near the skin a garment follows the skin below it; loose cloth follows its own neighbours. So
//! the weights of the closest skin are smoothed over the garment by a screened Poisson equation,
//! over a length that grows with the distance to the skin: a skirt between the legs moves as one
//! cloth, and no edge is torn where the closest skin jumps from one limb to another. The idea of
//! trusting only near skin is that of Abdrashitov et al. 2023, *Robust skin weights transfer via
//! weight inpainting*.

use garnet_knn::ClosestPoint;

use crate::free_cloth::free_length;
use crate::holes::Holes;
use crate::{ClothGraph, MAX_INFLUENCES, ScreenedPoisson, SkinError, SkinWeights};

/// Over which length weights are smoothed, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransferOptions {
    /// Smoothing length where the cloth lies on the skin.
    pub near_length: f32,
    /// Smoothing length where the cloth is `loose_distance` or farther from the skin.
    pub loose_length: f32,
    /// Distance from the skin at which cloth counts as loose.
    pub loose_distance: f32,
}

impl Default for TransferOptions {
    fn default() -> Self {
        Self {
            near_length: 0.03,
            loose_length: 0.20,
            loose_distance: 0.05,
        }
    }
}

impl TransferOptions {
    /// The same for bodies that are `scale` times as large.
    #[must_use]
    pub fn scaled(self, scale: f32) -> Self {
        Self {
            near_length: scale * self.near_length,
            loose_length: scale * self.loose_length,
            loose_distance: scale * self.loose_distance,
        }
    }
}

/// Pieces that sit on other cloth have no skin of their own: their smoothing length, in metres.
pub(crate) const PIECE_LENGTH: f64 = 10.0;

/// The screening `[node]` that smooths over the lengths of `options`.
pub(crate) fn transfer_screening(
    graph: &ClothGraph,
    skin: &[ClosestPoint],
    (is_piece, holes): (&[bool], Option<&Holes>),
    freedom: &[f32],
    options: TransferOptions,
) -> Vec<f64> {
    let screening = |node: usize| {
        let length = if is_piece[node] {
            PIECE_LENGTH
        } else {
            let real = || skin[node].distance_squared.sqrt();
            let distance = holes.map_or_else(real, |holes| holes.distance[node]);
            let t = (distance / options.loose_distance).clamp(0.0, 1.0);
            let step = t * t * (3.0 - 2.0 * t);
            let range = options.loose_length - options.near_length;
            let length = f64::from(options.near_length + range * step);
            match freedom.get(node) {
                Some(&freedom) if freedom > 0.0 => free_length(length, freedom),
                _ => length,
            }
        };
        f64::from(graph.node_areas()[node]) / (length * length)
    };
    (0..graph.num_nodes()).map(screening).collect()
}

/// Weights `[node]` of the cloth: those of the closest skin, or of the bones below holes of it,
/// smoothed by `system`.
///
/// # Errors
///
/// Those of [`SkinWeights::from_influences`].
pub(crate) fn transferred_weights(
    body_weights: &SkinWeights,
    body_faces: &[[u32; 3]],
    (skin, holes): (&[ClosestPoint], Option<&Holes>),
    system: &ScreenedPoisson,
) -> Result<SkinWeights, SkinError> {
    let num_joints = body_weights.num_joints();
    let mut columns = vec![Vec::new(); num_joints];
    for (node, closest) in skin.iter().enumerate() {
        let corners = body_faces[closest.face as usize];
        let corners = corners.into_iter().zip(closest.barycentric);
        let part = holes.map_or(1.0, |holes| 1.0 - holes.share[node]);
        let real = corners.flat_map(|(corner, share)| {
            let weights = body_weights.vertex(corner as usize);
            weights.map(move |(joint, weight)| (joint, f64::from(part * share) * f64::from(weight)))
        });
        let missing = holes.map(|holes| holes.weights[node].iter());
        let missing = missing.into_iter().flatten();
        let missing =
            missing.map(|&(joint, weight)| (joint, f64::from(1.0 - part) * f64::from(weight)));
        for (joint, weight) in real.chain(missing) {
            let column: &mut Vec<f64> = &mut columns[joint];
            column.resize(skin.len(), 0.0);
            column[node] += weight;
        }
    }
    let joints: Vec<usize> = (0..num_joints)
        .filter(|&joint| !columns[joint].is_empty())
        .collect();
    columns.retain(|column| !column.is_empty());
    let smoothed = system.smoothed(&columns);
    let influences = (0..skin.len()).map(|node| {
        let mut row: Vec<(usize, f32)> = joints
            .iter()
            .zip(&smoothed)
            .map(|(&joint, column)| (joint, column[node].max(0.0) as f32))
            .filter(|&(_, weight)| weight > 1e-5)
            .collect();
        row.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        row.truncate(MAX_INFLUENCES);
        row
    });
    let weights = SkinWeights::from_influences(num_joints, influences)?;
    Ok(weights.on_that_of(body_weights))
}
