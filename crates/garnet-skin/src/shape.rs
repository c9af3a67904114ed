//! Carrying a change of the body's shape over to the garment.
//!
//! Dual-quaternion skinning knows the pose only. Where a target body has another shape, its skin is
//! taken back to the rest pose; how far it then lies from the rest skin is the shape offset, which
//! the garment receives from the nearest skin, smoothed over the cloth.

use garnet_knn::ClosestPoint;
use garnet_mesh::{Point3, Vector3};
use nalgebra::{Isometry3, Matrix3, UnitQuaternion};
use rayon::prelude::*;

use crate::{Method, Skeleton, SkinWeights, blended_transforms};

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

/// Where the joints `[joint]` of a skeleton are in a body of another shape, whose vertices were at
/// `rest` and are at `shaped` `[vertex]`.
///
/// A joint goes along with the skin that bends there: that which moves with both sides of it. What
/// no skin bends at goes along with its parent, a root with the skin of its own or the whole.
///
/// With `turns` of the joints from rest `[joint]`, the skin that bends at a joint is turned half as
/// far as the joint from its parent.
pub(crate) fn reshaped_joints(
    skeleton: &Skeleton,
    weights: &SkinWeights,
    rest: &[Point3],
    shaped: &[Point3],
    turns: Option<&[UnitQuaternion<f32>]>,
) -> Vec<Point3> {
    let joints = skeleton.joints();
    let mut at_joint = vec![Spread::default(); joints.len()];
    let mut of_joint = vec![Spread::default(); joints.len()];
    let mut of_all = Spread::default();
    let mut below = vec![0.0_f64; joints.len()];
    for (vertex, (from, to)) in rest.iter().zip(shaped).enumerate() {
        below.fill(0.0);
        for (joint, weight) in weights.vertex(vertex) {
            of_joint[joint].add(from, to, f64::from(weight));
            let mut next = Some(joint);
            while let Some(joint) = next {
                below[joint] += f64::from(weight);
                next = joints[joint].parent;
            }
        }
        for (spread, &mass) in at_joint.iter_mut().zip(&below) {
            spread.add(from, to, mass * (1.0 - mass).max(0.0));
        }
        of_all.add(from, to, 1.0);
    }
    let turn = |joint: usize| turns.map(|turns| turns[joint].cast::<f64>());
    let mut used = vec![(Spread::default(), None); joints.len()];
    for &joint in skeleton.parents_first() {
        let parent = joints[joint].parent;
        let half = parent.map_or(turn(joint), |parent| {
            let [from, to] = [turn(parent)?, turn(joint)?];
            Some(from.try_slerp(&to, 0.5, f64::EPSILON).unwrap_or(to))
        });
        let above = parent.map_or((of_joint[joint], turn(joint)), |parent| used[parent]);
        let known = [(at_joint[joint], half), above];
        let is_known = |(spread, _): &(Spread, _)| spread.weight > MIN_BENDING;
        used[joint] = known
            .into_iter()
            .find(is_known)
            .unwrap_or((of_all, turn(joint)));
    }
    let places = joints.iter().zip(&used);
    places
        .map(|(joint, (spread, turn))| spread.carried(&joint.rest_position, turn.as_ref()))
        .collect()
}

/// Less skin than this, in vertices, does not tell where a joint is.
const MIN_BENDING: f64 = 0.5;

/// Weighted sums over vertices before and after a change of shape.
#[derive(Debug, Clone, Copy, Default)]
struct Spread {
    weight: f64,
    sums: [nalgebra::Vector3<f64>; 2],
    squares: [f64; 2],
}

impl Spread {
    fn add(&mut self, from: &Point3, to: &Point3, weight: f64) {
        self.weight += weight;
        for (side, place) in [from, to].into_iter().enumerate() {
            let place = place.coords.cast::<f64>();
            self.sums[side] += weight * place;
            self.squares[side] += weight * place.norm_squared();
        }
    }

    /// A point moved like the middle of the vertices, and grown with their distance from it, and
    /// turned.
    fn carried(&self, point: &Point3, turn: Option<&UnitQuaternion<f64>>) -> Point3 {
        if self.weight <= 0.0 {
            return *point;
        }
        let [from, to] = self.sums.map(|sum| sum / self.weight);
        let [before, after] = [(from, 0), (to, 1)].map(|(middle, side)| {
            let mean = self.squares[side] / self.weight - middle.norm_squared();
            mean.max(0.0).sqrt()
        });
        let grown = if before > 0.0 { after / before } else { 1.0 };
        let offset = point.coords.cast::<f64>() - from;
        let moved = to + grown * turn.map_or(offset, |turn| turn * offset);
        Point3::from(moved.cast::<f32>())
    }
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
