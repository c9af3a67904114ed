//! The skeleton: a forest of joints with rest positions.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use crate::{Point3, Pose, SkinError};

/// One joint of a skeleton.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name, as in the file.
    pub name: String,
    /// Number of the parent, from 0; none for a root.
    pub parent: Option<usize>,
    /// Position at rest, in metres.
    pub rest_position: Point3,
}

/// Joints that form one or more trees.
///
/// Joints keep the order of their file, in which a child may come before its parent. Bones of zero
/// length and equal names are allowed: real rigs have them.
#[derive(Debug, Clone, PartialEq)]
pub struct Skeleton {
    joints: Vec<Joint>,
    parents_first: Vec<usize>,
    labels: BTreeMap<String, usize>,
}

impl Skeleton {
    /// The largest number of joints.
    pub const MAX_JOINTS: usize = u16::MAX as usize;

    /// Checks `joints` and makes a skeleton of them.
    ///
    /// # Errors
    ///
    /// [`SkinError::NoJoints`], [`SkinError::TooManyJoints`], [`SkinError::ParentOutOfRange`],
    /// [`SkinError::CyclicParents`] or [`SkinError::NonFiniteJoint`].
    pub fn new(joints: Vec<Joint>) -> Result<Self, SkinError> {
        let num_joints = joints.len();
        if num_joints == 0 {
            return Err(SkinError::NoJoints);
        }
        if num_joints > Self::MAX_JOINTS {
            return Err(SkinError::TooManyJoints {
                found: num_joints,
                limit: Self::MAX_JOINTS,
            });
        }
        for (index, joint) in joints.iter().enumerate() {
            if let Some(parent) = joint.parent.filter(|&parent| parent >= num_joints) {
                return Err(SkinError::ParentOutOfRange {
                    joint: index,
                    name: joint.name.clone(),
                    parent,
                    num_joints,
                });
            }
            let coordinates = joint.rest_position.iter();
            if let Some(&value) = coordinates.into_iter().find(|value| !value.is_finite()) {
                return Err(SkinError::NonFiniteJoint {
                    joint: index,
                    name: joint.name.clone(),
                    value,
                });
            }
        }
        let parents_first = parents_first(&joints)?;
        Ok(Self {
            joints,
            parents_first,
            labels: BTreeMap::new(),
        })
    }

    /// The same skeleton, whose joints are known by further names: what they are, such as
    /// `left_knee`. Numbers of joints that are not there are left out.
    #[must_use]
    pub fn with_labels(mut self, labels: impl IntoIterator<Item = (String, usize)>) -> Self {
        let num_joints = self.num_joints();
        let labels = labels.into_iter();
        self.labels
            .extend(labels.filter(|&(_, joint)| joint < num_joints));
        self
    }

    /// Joints by what they are, where a file or the user says it: `left_knee`, `head` …
    pub fn labels(&self) -> &BTreeMap<String, usize> {
        &self.labels
    }

    /// The same skeleton with its joints elsewhere: at `place(number, joint)`.
    ///
    /// # Errors
    ///
    /// [`SkinError::NonFiniteJoint`].
    pub fn placed(&self, place: impl Fn(usize, &Joint) -> Point3) -> Result<Self, SkinError> {
        let joint = |(number, joint): (usize, &Joint)| Joint {
            rest_position: place(number, joint),
            ..joint.clone()
        };
        let placed = Self::new(self.joints.iter().enumerate().map(joint).collect())?;
        Ok(placed.with_labels(self.labels.clone()))
    }

    /// The joints `[joint]`, in the order of their file.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// How many joints there are.
    pub fn num_joints(&self) -> usize {
        self.joints.len()
    }

    /// The length of all bones together at rest, in metres.
    pub fn length_of_bones(&self) -> f32 {
        let bones = self.joints.iter().filter_map(|joint| {
            let parent = &self.joints[joint.parent?];
            Some((joint.rest_position - parent.rest_position).norm())
        });
        bones.sum()
    }

    /// Joint numbers in an order in which every parent comes before its children.
    pub fn parents_first(&self) -> &[usize] {
        &self.parents_first
    }

    /// The number of the first joint of this name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// The rigid transform of each joint, `posed_from_rest[joint]`.
    ///
    /// ```text
    /// T_j = T_parent(j) · Translate(h_j) · R_j · Translate(-h_j)      h_j: rest position of joint j
    /// ```
    ///
    /// A root has `Translate(root_translation)` in place of `T_parent`. Products are taken in
    /// `f64`.
    ///
    /// # Errors
    ///
    /// [`SkinError::RotationCount`] or [`SkinError::NonFiniteTransform`].
    pub fn transforms(&self, pose: &Pose) -> Result<Vec<Isometry3<f32>>, SkinError> {
        let num_joints = self.num_joints();
        if pose.rotations.len() != num_joints {
            return Err(SkinError::RotationCount {
                found: pose.rotations.len(),
                expected: num_joints,
            });
        }
        let root = Isometry3::from(Translation3::from(pose.root_translation.cast::<f64>()));
        let mut posed_from_rest = vec![Isometry3::<f64>::identity(); num_joints];
        for &index in &self.parents_first {
            let joint = &self.joints[index];
            let posed_from_parent_rest =
                joint.parent.map_or(root, |parent| posed_from_rest[parent]);
            let rotation =
                UnitQuaternion::new_normalize(pose.rotations[index].into_inner().cast::<f64>());
            let position = joint.rest_position.coords.cast::<f64>();
            let transform = posed_from_parent_rest * rotation_about(&position, rotation);
            if !is_finite(&transform) {
                return Err(SkinError::NonFiniteTransform {
                    joint: index,
                    name: joint.name.clone(),
                });
            }
            posed_from_rest[index] = transform;
        }
        Ok(posed_from_rest.into_iter().map(Isometry3::cast).collect())
    }
}

/// `Translate(position) · rotation · Translate(-position)`.
fn rotation_about(position: &Vector3<f64>, rotation: UnitQuaternion<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(position - rotation * position), rotation)
}

/// Whether rotation and translation are numbers that `f32` holds.
pub(crate) fn is_finite(transform: &Isometry3<f64>) -> bool {
    let translation = transform.translation.vector.iter();
    let rotation = transform.rotation.coords.iter();
    translation
        .chain(rotation)
        .all(|&value| (value as f32).is_finite())
}

/// Orders joints level by level; a joint that is never reached hangs below a cycle.
fn parents_first(joints: &[Joint]) -> Result<Vec<usize>, SkinError> {
    let mut children = vec![Vec::new(); joints.len()];
    let mut order = Vec::with_capacity(joints.len());
    for (index, joint) in joints.iter().enumerate() {
        match joint.parent {
            Some(parent) => children[parent].push(index),
            None => order.push(index),
        }
    }
    let mut next = 0;
    while let Some(&index) = order.get(next) {
        order.append(&mut children[index]);
        next += 1;
    }
    if order.len() == joints.len() {
        return Ok(order);
    }
    let mut reached = vec![false; joints.len()];
    for &index in &order {
        reached[index] = true;
    }
    let mut joint = reached
        .iter()
        .position(|&is_reached| !is_reached)
        .unwrap_or(0);
    // As many steps upwards as there are joints end on the cycle itself.
    for _ in 0..joints.len() {
        joint = joints[joint].parent.unwrap_or(joint);
    }
    Err(SkinError::CyclicParents {
        joint,
        name: joints[joint].name.clone(),
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn joint(name: &str, parent: Option<usize>, y: f32) -> Joint {
        Joint {
            name: name.to_owned(),
            parent,
            rest_position: Point3::new(0.0, y, 0.0),
        }
    }

    #[test]
    fn children_may_come_before_their_parents() {
        let joints = vec![
            joint("tip", Some(1), 2.0),
            joint("mid", Some(2), 1.0),
            joint("root", None, 0.0),
        ];
        let skeleton = Skeleton::new(joints).unwrap();
        assert_eq!(skeleton.parents_first(), [2, 1, 0]);
        let mut pose = Pose::rest(3);
        pose.rotations[1] =
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f32::consts::FRAC_PI_2);
        let transforms = skeleton.transforms(&pose).unwrap();
        let tip = transforms[0] * Point3::new(0.0, 2.0, 0.0);
        approx::assert_relative_eq!(tip, Point3::new(-1.0, 1.0, 0.0), epsilon = 1e-6);
    }

    #[test]
    fn a_cycle_of_parents_is_refused_by_name() {
        let joints = vec![
            joint("root", None, 0.0),
            joint("a", Some(2), 1.0),
            joint("b", Some(1), 1.0),
            joint("below", Some(1), 1.0),
        ];
        let error = Skeleton::new(joints).unwrap_err();
        assert!(
            matches!(&error, SkinError::CyclicParents { name, .. } if name == "a" || name == "b")
        );
    }

    #[test]
    fn a_joint_that_is_its_own_parent_a_missing_parent_and_no_joints_are_refused() {
        assert_eq!(Skeleton::new(Vec::new()).unwrap_err(), SkinError::NoJoints);
        let error = Skeleton::new(vec![joint("a", Some(0), 0.0)]).unwrap_err();
        assert!(matches!(error, SkinError::CyclicParents { joint: 0, .. }));
        let error = Skeleton::new(vec![joint("a", Some(7), 0.0)]).unwrap_err();
        assert!(matches!(
            error,
            SkinError::ParentOutOfRange { parent: 7, .. }
        ));
        let error = Skeleton::new(vec![joint("a", None, f32::NAN)]).unwrap_err();
        assert!(matches!(error, SkinError::NonFiniteJoint { joint: 0, .. }));
    }

    #[test]
    fn the_first_of_two_equal_names_is_found() {
        let skeleton = Skeleton::new(vec![joint("a", None, 0.0), joint("a", None, 1.0)]).unwrap();
        assert_eq!(skeleton.find("a"), Some(0));
        assert_eq!(skeleton.find("b"), None);
    }

    #[test]
    fn a_pose_that_does_not_fit_is_refused() {
        let skeleton = Skeleton::new(vec![joint("a", None, 0.0)]).unwrap();
        let error = skeleton.transforms(&Pose::rest(2)).unwrap_err();
        assert_eq!(
            error,
            SkinError::RotationCount {
                found: 2,
                expected: 1
            }
        );
        let mut pose = Pose::rest(1);
        pose.root_translation.x = f32::INFINITY;
        let error = skeleton.transforms(&pose).unwrap_err();
        assert!(matches!(
            error,
            SkinError::NonFiniteTransform { joint: 0, .. }
        ));
    }
}
