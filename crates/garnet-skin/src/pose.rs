//! Poses: a local rotation for each joint.

use nalgebra::{Isometry3, UnitQuaternion};

use crate::{Skeleton, SkinError, Vector3};

/// Local joint rotations and the shift of the roots.
///
/// The axes of all rotations are the world's axes at rest: a joint carries no frame of its own. See
/// [`Skeleton::transforms`] for the equation.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// Shift of every root joint, applied last, in metres.
    pub root_translation: Vector3,
    /// Rotation of each joint against its parent, `[joint]`.
    pub rotations: Vec<UnitQuaternion<f32>>,
}

/// A pose made from transforms, and what it leaves out of them.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PoseFit {
    /// The pose.
    pub pose: Pose,
    /// Largest distance between a joint as the given transforms place it and as the pose does, in
    /// metres. Zero, up to rounding, if the transforms keep every joint on its parent.
    pub max_residual_m: f32,
}

impl Pose {
    /// The rest pose of a skeleton with `num_joints` joints.
    pub fn rest(num_joints: usize) -> Self {
        Self {
            root_translation: Vector3::zeros(),
            rotations: vec![UnitQuaternion::identity(); num_joints],
        }
    }

    /// The pose whose transforms have the rotations of `posed_from_rest` `[joint]`.
    ///
    /// A pose bends a skeleton and cannot pull it apart: transforms that do are met in their
    /// rotations and in the position of the first root; [`PoseFit::max_residual_m`] tells the rest.
    ///
    /// # Errors
    ///
    /// [`SkinError::TransformCount`] or [`SkinError::NonFiniteTransform`].
    pub fn from_transforms(
        skeleton: &Skeleton,
        posed_from_rest: &[Isometry3<f32>],
    ) -> Result<PoseFit, SkinError> {
        let num_joints = skeleton.num_joints();
        if posed_from_rest.len() != num_joints {
            return Err(SkinError::TransformCount {
                found: posed_from_rest.len(),
                expected: num_joints,
            });
        }
        let mut pose = Self::rest(num_joints);
        for (index, joint) in skeleton.joints().iter().enumerate() {
            let world = posed_from_rest[index].rotation.cast::<f64>();
            let local = match joint.parent {
                Some(parent) => posed_from_rest[parent].rotation.cast::<f64>().inverse() * world,
                None => world,
            };
            pose.rotations[index] = UnitQuaternion::new_normalize(local.into_inner()).cast();
        }
        let root = skeleton.parents_first()[0];
        let root_position = skeleton.joints()[root].rest_position;
        pose.root_translation = posed_from_rest[root] * root_position - root_position;

        let rebuilt = skeleton.transforms(&pose)?;
        let mut max_residual_m = 0.0_f32;
        for (index, joint) in skeleton.joints().iter().enumerate() {
            let given = posed_from_rest[index] * joint.rest_position;
            let distance = (given - rebuilt[index] * joint.rest_position).norm();
            if !distance.is_finite() {
                return Err(SkinError::NonFiniteTransform {
                    joint: index,
                    name: joint.name.clone(),
                });
            }
            max_residual_m = max_residual_m.max(distance);
        }
        Ok(PoseFit {
            pose,
            max_residual_m,
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{Joint, Point3};

    /// A chain of four joints and a second root.
    fn skeleton() -> Skeleton {
        let parents = [None, Some(0), Some(1), Some(1), None];
        let joint = |(index, &parent): (usize, &Option<usize>)| Joint {
            name: format!("joint_{index}"),
            parent,
            rest_position: Point3::new(0.1 * index as f32, 0.3 * index as f32, -0.05),
        };
        Skeleton::new(parents.iter().enumerate().map(joint).collect()).unwrap()
    }

    proptest! {
        #[test]
        fn transforms_give_their_pose_back(
            angles in prop::collection::vec(prop::array::uniform3(-3.0_f32..3.0), 5),
            shift in prop::array::uniform3(-2.0_f32..2.0),
        ) {
            let pose = Pose {
                root_translation: Vector3::from(shift),
                rotations: angles.iter().map(|&angle| UnitQuaternion::from_scaled_axis(Vector3::from(angle))).collect(),
            };
            let skeleton = skeleton();
            let transforms = skeleton.transforms(&pose).unwrap();
            let fit = Pose::from_transforms(&skeleton, &transforms).unwrap();
            prop_assert!(fit.max_residual_m < 1e-5);
            for (found, expected) in fit.pose.rotations.iter().zip(&pose.rotations) {
                prop_assert!(found.angle_to(expected) < 2e-3, "acos of f32 resolves 1e-3 near 0");
            }
        }
    }

    #[test]
    fn a_skeleton_pulled_apart_leaves_a_residual() {
        let skeleton = skeleton();
        let mut transforms = vec![Isometry3::identity(); 5];
        transforms[2].translation.vector.x = 0.25;
        let fit = Pose::from_transforms(&skeleton, &transforms).unwrap();
        approx::assert_relative_eq!(fit.max_residual_m, 0.25, epsilon = 1e-6);
        assert_eq!(fit.pose, Pose::rest(5));
    }

    #[test]
    fn transforms_that_are_not_finite_are_refused() {
        let mut transforms = vec![Isometry3::identity(); 5];
        transforms[3].translation.vector.y = f32::NAN;
        let error = Pose::from_transforms(&skeleton(), &transforms).unwrap_err();
        assert!(matches!(
            error,
            SkinError::NonFiniteTransform { joint: 3, .. }
        ));
    }
}
