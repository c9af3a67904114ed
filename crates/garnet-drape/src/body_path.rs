//! The way of a body from its rest shape and pose to a target.

use garnet_mesh::Point3;
use garnet_skin::{
    Body, BoundGarment, Joint, Pose, PosedBody, Skeleton, SkinError, SkinWeights, Vector3,
    skin_dual_quaternion,
};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};

/// A body that moves from its rest shape and pose, at time 0, to a target, at time 1.
///
/// Joints turn the short way at even speed against their parents (slerp); the shape, the lengths of
/// the bones and what skinning leaves of the target change linearly. The end is the target to
/// rounding.
///
/// The time runs evenly: whoever moves the body decides how it starts and stops.
#[derive(Debug, Clone)]
pub struct BodyPath {
    rest: Vec<Point3>,
    /// Change of each vertex at rest.
    shape: Vec<Vector3>,
    weights: SkinWeights,
    /// Each joint after its parent.
    order: Vec<usize>,
    parents: Vec<Option<usize>>,
    /// Position of each joint at rest, at both ends.
    pivots: [Vec<Point3>; 2],
    /// Position of each joint against its parent, in the parent's frame, at both ends.
    bones: [Vec<Vector3>; 2],
    /// Rotation of each joint against its parent at the end.
    rotations: Vec<UnitQuaternion<f32>>,
    /// What skinning leaves of the target.
    residual: Vec<Vector3>,
}

impl BodyPath {
    /// The path from `body` at rest to a target of the same body: another pose, perhaps with
    /// another shape that is known by its offsets alone.
    pub fn to_posed(body: &Body, target: &PosedBody) -> Self {
        let zero = || vec![Vector3::zeros(); body.rest().num_vertices()];
        let shape = target
            .shape_offsets()
            .map_or_else(zero, <[Vector3]>::to_vec);
        let path = Self::new(body, body.skeleton(), shape, target.posed_from_rest());
        path.ending_at(target.skin().positions())
    }

    /// The path from `body` at rest to `target`, a body of the same topology and the same joints
    /// that has its own rest shape, in a pose.
    ///
    /// # Errors
    ///
    /// [`SkinError::TargetCount`], [`SkinError::TransformCount`], or those of
    /// [`Skeleton::transforms`].
    pub fn to_shape(body: &Body, target: &Body, pose: &Pose) -> Result<Self, SkinError> {
        let (from, to) = (body.rest().positions(), target.rest().positions());
        if from.len() != to.len() {
            return Err(SkinError::TargetCount {
                found: to.len(),
                expected: from.len(),
            });
        }
        let (joints, expected) = (target.skeleton().num_joints(), body.skeleton().num_joints());
        if joints != expected {
            return Err(SkinError::TransformCount {
                found: joints,
                expected,
            });
        }
        let transforms = target.skeleton().transforms(pose)?;
        let shape = from.iter().zip(to).map(|(from, to)| to - from).collect();
        Ok(Self::new(body, target.skeleton(), shape, &transforms))
    }

    fn new(
        body: &Body,
        target: &Skeleton,
        shape: Vec<Vector3>,
        posed_from_rest: &[Isometry3<f32>],
    ) -> Self {
        let skeleton = body.skeleton();
        let parents: Vec<Option<usize>> =
            skeleton.joints().iter().map(|joint| joint.parent).collect();
        let positions = |joints: &[Joint]| -> Vec<Point3> {
            joints.iter().map(|joint| joint.rest_position).collect()
        };
        let pivots = [positions(skeleton.joints()), positions(target.joints())];
        let num_joints = parents.len();
        let mut rotations = vec![UnitQuaternion::identity(); num_joints];
        let mut bones = [
            vec![Vector3::zeros(); num_joints],
            vec![Vector3::zeros(); num_joints],
        ];
        for joint in 0..num_joints {
            let rotation = posed_from_rest[joint].rotation;
            let place = posed_from_rest[joint] * pivots[1][joint];
            if let Some(parent) = parents[joint] {
                let of_parent = posed_from_rest[parent].rotation.inverse();
                rotations[joint] = of_parent * rotation;
                bones[0][joint] = pivots[0][joint] - pivots[0][parent];
                bones[1][joint] = of_parent * (place - posed_from_rest[parent] * pivots[1][parent]);
            } else {
                rotations[joint] = rotation;
                bones[0][joint] = pivots[0][joint].coords;
                bones[1][joint] = place.coords;
            }
        }
        Self {
            rest: body.rest().positions().to_vec(),
            residual: Vec::new(),
            shape,
            weights: body.weights().clone(),
            order: skeleton.parents_first().to_vec(),
            parents,
            pivots,
            bones,
            rotations,
        }
    }

    /// With the end exactly at `target`.
    fn ending_at(mut self, target: &[Point3]) -> Self {
        let end = self.positions(1.0);
        self.residual = target
            .iter()
            .zip(&end)
            .map(|(target, end)| target - end)
            .collect();
        self
    }

    /// The positions of the skin `[vertex]` at a time from 0 to 1, in metres.
    pub fn positions(&self, time: f32) -> Vec<Point3> {
        let transforms = self.transforms(time);
        let rest: Vec<Point3> = self
            .rest
            .iter()
            .zip(&self.shape)
            .map(|(rest, shape)| rest + time * shape)
            .collect();
        let mut posed = skin_dual_quaternion(&rest, &self.weights, &transforms);
        for (point, residual) in posed.iter_mut().zip(&self.residual) {
            *point += time * residual;
        }
        posed
    }

    /// The body on its way: `body` is that at rest, from which the path starts.
    ///
    /// # Errors
    ///
    /// Those of [`Body::fitted_by`].
    pub fn posed(&self, body: &Body, time: f32) -> Result<PosedBody, SkinError> {
        body.fitted_by(&self.positions(time), self.transforms(time))
    }

    /// Where a garment's nodes `[node]` would be at a time from 0 to 1 if they went along with the
    /// body, in metres: the shape-aware warp on the way. `offsets_nodes` are those of
    /// [`BoundGarment::shape_offsets_nodes`] for [`BodyPath::shape`].
    ///
    /// # Panics
    ///
    /// Panics if the garment is bound to a body with other joints.
    pub fn carried_nodes(
        &self,
        garment: &BoundGarment,
        offsets_nodes: &[Vector3],
        time: f32,
    ) -> Vec<Point3> {
        let nodes = garment.rest_nodes().iter().zip(offsets_nodes);
        let shaped: Vec<Point3> = nodes.map(|(rest, offset)| rest + time * offset).collect();
        skin_dual_quaternion(&shaped, garment.weights(), &self.transforms(time))
    }

    /// How far each vertex of the body at rest moves by the change of its shape `[vertex]`, in
    /// metres.
    pub fn shape(&self) -> &[Vector3] {
        &self.shape
    }

    fn transforms(&self, time: f32) -> Vec<Isometry3<f32>> {
        let identity = UnitQuaternion::identity();
        let mut frames = vec![Isometry3::identity(); self.parents.len()];
        for &joint in &self.order {
            // Half a turn has no short way: any axis that the end gives will do.
            let rotation = identity
                .try_slerp(&self.rotations[joint], time, 1e-6)
                .unwrap_or(self.rotations[joint].powf(time));
            let bone = self.bones[0][joint].lerp(&self.bones[1][joint], time);
            let local = Isometry3::from_parts(Translation3::from(bone), rotation);
            frames[joint] = match self.parents[joint] {
                Some(parent) => frames[parent] * local,
                None => local,
            };
        }
        for (joint, frame) in frames.iter_mut().enumerate() {
            let pivot = self.pivots[0][joint]
                .coords
                .lerp(&self.pivots[1][joint].coords, time);
            *frame *= Translation3::from(-pivot);
        }
        frames
    }
}
