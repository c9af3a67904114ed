//! A warped garment with the frames and numbers that a learned displacement is told.

use garnet_mesh::{Point3, Vector3};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};

use crate::{Body, BoundGarment, PosedBody, SkinError, Warp, blended_transforms};

/// Names of the joint that the root frame belongs to; the first joint of other skeletons.
const PELVIS: [&str; 3] = ["pelvis", "hips", "hip"];

/// A garment warped to a posed body, as a network sees it.
///
/// Everything is in the world; whoever computes with it takes it to the root frame.
#[derive(Debug, Clone)]
pub struct WarpedGarment {
    /// Positions `[vertex]` of the garment's mesh, in metres.
    pub positions: Vec<Point3>,
    /// The blended rotation of each vertex from rest `[vertex]`.
    pub rotations: Vec<UnitQuaternion<f32>>,
    /// Where the pelvis is.
    pub world_from_root: Isometry3<f32>,
}

impl WarpedGarment {
    /// Warps a garment that was bound to `body` to that body in a pose.
    ///
    /// # Errors
    ///
    /// Those of [`BoundGarment::warped_nodes`].
    pub fn new(
        garment: &BoundGarment,
        body: &Body,
        posed: &PosedBody,
        warp: Warp,
    ) -> Result<Self, SkinError> {
        let weld = garment.weld();
        let nodes = garment.warped_nodes(posed, warp)?;
        let transforms = blended_transforms(garment.weights(), posed.posed_from_rest());
        let turns: Vec<UnitQuaternion<f32>> = transforms
            .iter()
            .map(|transform| transform.rotation)
            .collect();
        Ok(Self {
            positions: weld.scatter(&nodes),
            rotations: weld.scatter(&turns),
            world_from_root: body.world_from_root(posed),
        })
    }
}

impl Body {
    /// The frame of the pelvis of this body in a pose; of the root joint, if none has that name.
    pub fn world_from_root(&self, posed: &PosedBody) -> Isometry3<f32> {
        let skeleton = self.skeleton();
        let pelvis = PELVIS.iter().find_map(|name| skeleton.find(name));
        let root = pelvis.unwrap_or(skeleton.parents_first()[0]);
        let pivot = skeleton.joints()[root].rest_position;
        posed.posed_from_rest()[root] * Translation3::from(pivot)
    }

    /// Numbers that describe pose and shape, [`Body::NUMBERS_A_JOINT`] a joint.
    ///
    /// Of each joint: the first two columns of its rotation against its parent (of the root: where
    /// up is, seen from it, and three zeros, for a body may look in any direction); the mean offset
    /// of its skin from the skin at rest, in metres; and the mean of that offset along the normal
    /// at rest, which tells the girth.
    pub fn pose_and_shape(&self, posed: &PosedBody) -> Vec<f32> {
        let joints = self.skeleton().joints();
        let turned = |joint: usize| posed.posed_from_rest()[joint].rotation;
        let shapes = self.mean_offsets(posed);
        let mut numbers = Vec::with_capacity(Self::NUMBERS_A_JOINT * joints.len());
        for (number, joint) in joints.iter().enumerate() {
            if let Some(parent) = joint.parent {
                let local = (turned(parent).inverse() * turned(number)).to_rotation_matrix();
                numbers.extend_from_slice(&local.matrix().as_slice()[..6]);
            } else {
                let up = turned(number).inverse() * Vector3::y();
                numbers.extend([up.x, up.y, up.z, 0.0, 0.0, 0.0]);
            }
            numbers.extend_from_slice(&shapes[number]);
        }
        numbers
    }

    /// Numbers of a joint in [`Body::pose_and_shape`].
    pub const NUMBERS_A_JOINT: usize = 10;

    /// Of each joint the mean offset of its skin, and the mean of that along the normal.
    fn mean_offsets(&self, posed: &PosedBody) -> Vec<[f32; 4]> {
        let mut sums = vec![[0.0_f64; 5]; self.skeleton().num_joints()];
        let Some(offsets) = posed.shape_offsets() else {
            return vec![[0.0; 4]; sums.len()];
        };
        for (vertex, (offset, normal)) in offsets.iter().zip(self.rest_normals()).enumerate() {
            let outward = offset.dot(normal);
            for (joint, weight) in self.weights().vertex(vertex) {
                let parts = [offset.x, offset.y, offset.z, outward, 1.0];
                for (sum, part) in sums[joint].iter_mut().zip(parts) {
                    *sum += f64::from(weight * part);
                }
            }
        }
        let mean = |[x, y, z, outward, total]: [f64; 5]| {
            let total = total.max(f64::MIN_POSITIVE);
            [x, y, z, outward].map(|sum| (sum / total) as f32)
        };
        sums.into_iter().map(mean).collect()
    }
}

#[cfg(test)]
mod tests {
    use garnet_mesh::primitives::{capsule, tube};

    use super::*;
    use crate::{Garment, Joint, Pose, Skeleton, SkinWeights};

    fn arm() -> Body {
        let arm = capsule(0.05, 0.6, 16, 24);
        let joint = |name: &str, parent, y| Joint {
            name: name.to_owned(),
            parent,
            rest_position: Point3::new(0.0, y, 0.0),
        };
        let joints = vec![joint("shoulder", None, -0.3), joint("elbow", Some(0), 0.0)];
        let forearm = |point: &Point3| (0.5 + point.y / 0.1).clamp(0.0, 1.0);
        let rows = (arm.positions().iter()).map(|p| [(0, 1.0 - forearm(p)), (1, forearm(p))]);
        let weights = SkinWeights::from_influences(2, rows).unwrap();
        Body::new(arm, Skeleton::new(joints).unwrap(), weights).unwrap()
    }

    fn bent() -> Pose {
        let mut pose = Pose::rest(2);
        pose.root_translation = Vector3::new(0.3, 0.1, 0.0);
        pose.rotations[1] = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 1.0);
        pose
    }

    #[test]
    fn rotations_are_those_of_the_skinning() {
        let body = arm();
        let sleeve = Garment::new(tube(0.06, 0.4, 16, 20)).bind(&body).unwrap();
        let posed = body.posed(&bent()).unwrap();
        let warped = WarpedGarment::new(&sleeve, &body, &posed, Warp::DualQuaternion).unwrap();
        assert_eq!(warped.positions.len(), warped.rotations.len());
        let angles = warped.rotations.iter().map(UnitQuaternion::angle);
        let largest = angles.fold(0.0, f32::max);
        // Weights that are smoothed along the cloth keep a little of the shoulder to the end.
        assert!((0.95..1.001).contains(&largest), "{largest}");
        let root = warped.world_from_root.translation.vector;
        assert!(
            (root - Vector3::new(0.3, -0.2, 0.0)).norm() < 1e-6,
            "{root}"
        );
    }

    #[test]
    fn pose_and_shape_are_numbers_of_joints() {
        let body = arm();
        let posed = body.posed(&bent()).unwrap();
        let numbers = body.pose_and_shape(&posed);
        assert_eq!(numbers.len(), 2 * Body::NUMBERS_A_JOINT);
        assert_eq!(
            numbers[..10],
            [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
        );
        assert!((numbers[14] - 1.0_f32.cos()).abs() < 1e-6);

        let thick: Vec<Point3> = (body.rest().positions().iter())
            .map(|p| Point3::new(1.2 * p.x, p.y, 1.2 * p.z))
            .collect();
        let rest = vec![Isometry3::identity(); 2];
        let numbers = body.pose_and_shape(&body.fitted_by(&thick, rest).unwrap());
        // The ends of the capsule grow less than its side, by 0.2 of 5 cm.
        assert!((0.006..0.0101).contains(&numbers[9]), "{numbers:?}");
        assert!(numbers[6].abs() < 1e-4);
    }
}
