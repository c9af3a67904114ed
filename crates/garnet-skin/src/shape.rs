//! Carrying a change of the body's shape over to the garment.
//!
//! Dual-quaternion skinning knows the pose only. Where a target body has another shape, its skin is
//! taken back to the rest pose; how far it then lies from the rest skin is the shape offset, which
//! the garment receives from the nearest skin, smoothed over the cloth.

use garnet_knn::ClosestPoint;
use garnet_mesh::{Point3, Vector3};
use nalgebra::{Isometry3, Matrix3};
use rayon::prelude::*;

use crate::{Method, SkinWeights, blended_transforms};

/// Below this determinant a blend of rotations has collapsed and is not inverted.
const MIN_DETERMINANT: f32 = 0.2;

/// Rest-space offsets `[vertex]` of a posed body's skin from the rest skin, in metres.
///
/// `method` is how the target was posed from its own unposed shape by `posed_from_rest`.
pub(crate) fn shape_offsets(
    rest: &[Point3],
    target: &[Point3],
    weights: &SkinWeights,
    posed_from_rest: &[Isometry3<f32>],
    method: Method,
) -> Vec<Vector3> {
    let rigid = blended_transforms(weights, posed_from_rest);
    let offset = |vertex: usize| {
        let unposed = match method {
            Method::DualQuaternion => None,
            Method::Linear => unposed_linear(&target[vertex], weights, posed_from_rest, vertex),
        };
        unposed.unwrap_or_else(|| rigid[vertex].inverse_transform_point(&target[vertex]))
            - rest[vertex]
    };
    (0..rest.len()).into_par_iter().map(offset).collect()
}

/// Where linear blend skinning has `target` from, unless the blend has collapsed.
fn unposed_linear(
    target: &Point3,
    weights: &SkinWeights,
    posed_from_rest: &[Isometry3<f32>],
    vertex: usize,
) -> Option<Point3> {
    let mut linear = Matrix3::zeros();
    let mut translation = Vector3::zeros();
    for (joint, weight) in weights.vertex(vertex) {
        let transform = &posed_from_rest[joint];
        linear += weight * transform.rotation.to_rotation_matrix().into_inner();
        translation += weight * transform.translation.vector;
    }
    if linear.determinant() < MIN_DETERMINANT {
        return None;
    }
    Some((linear.try_inverse()? * (target - translation).coords).into())
}

/// The offsets of the closest skin `[node]`, of offsets `[body_vertex]`.
pub(crate) fn offsets_at_skin(
    offsets: &[Vector3],
    body_faces: &[[u32; 3]],
    skin: &[ClosestPoint],
) -> Vec<Vector3> {
    let offset_at = |closest: &ClosestPoint| {
        let corners = body_faces[closest.face as usize];
        let shares = corners.into_iter().zip(closest.barycentric);
        shares
            .map(|(corner, share)| share * offsets[corner as usize])
            .sum()
    };
    skin.iter().map(offset_at).collect()
}
