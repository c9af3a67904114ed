//! Left and right.

use nalgebra::Vector3;

use crate::{Body, Joint, Point3, Skeleton};

/// A joint may be this far from where the mirror puts its partner, in metres.
const TOLERANCE: f32 = 0.01;

/// The plane x = `x` that exchanges left and right, and which joint takes the place of each.
#[derive(Debug, Clone, PartialEq)]
pub struct Symmetry {
    /// Where the plane is, in metres.
    pub x: f32,
    /// The partner of each joint `[joint]`; joints on the plane are their own.
    pub joints: Vec<usize>,
}

impl Symmetry {
    /// Where the mirror puts a point.
    pub fn point(&self, point: &Point3) -> Point3 {
        Point3::new(2.0 * self.x - point.x, point.y, point.z)
    }

    /// What the mirror makes of a vector.
    pub fn vector(vector: Vector3<f32>) -> Vector3<f32> {
        Vector3::new(-vector.x, vector.y, vector.z)
    }
}

impl Skeleton {
    /// The symmetry of the joints at rest; none if a joint has no partner.
    ///
    /// The plane goes through the first root. Partners have partners for parents.
    pub fn symmetry(&self) -> Option<Symmetry> {
        let joints = self.joints();
        let root = &joints[self.parents_first()[0]];
        let mut symmetry = Symmetry {
            x: root.rest_position.x,
            joints: vec![usize::MAX; joints.len()],
        };
        for &joint in self.parents_first() {
            let place = symmetry.point(&joints[joint].rest_position);
            let parent = joints[joint].parent.map(|parent| symmetry.joints[parent]);
            let distance = |other: &Joint| (other.rest_position - place).norm();
            let others = joints.iter().enumerate();
            let near = others
                .filter(|&(number, other)| {
                    other.parent == parent && !symmetry.joints.contains(&number)
                })
                .min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))?;
            if distance(near.1) > TOLERANCE {
                return None;
            }
            symmetry.joints[joint] = near.0;
        }
        let partner = &symmetry.joints;
        let is_mutual = (0..partner.len()).all(|joint| partner[partner[joint]] == joint);
        is_mutual.then_some(symmetry)
    }
}

/// What a mirror makes of the numbers of a joint in [`Body::pose_and_shape`]: of the first two
/// columns of M R M, of M o, and of the growth, with M = diag(−1, 1, 1).
const SIGNS: [f32; Body::NUMBERS_A_JOINT] = [1.0, -1.0, -1.0, -1.0, 1.0, 1.0, -1.0, 1.0, 1.0, 1.0];

/// And of those of the root, which are the direction up.
const SIGNS_OF_ROOT: [f32; Body::NUMBERS_A_JOINT] =
    [-1.0, 1.0, 1.0, 1.0, 1.0, 1.0, -1.0, 1.0, 1.0, 1.0];

impl Body {
    /// What becomes of the numbers of [`Body::pose_and_shape`] if left and right are exchanged: for
    /// each number the one that takes its place, and its sign.
    pub fn mirrored_numbers(&self, symmetry: &Symmetry) -> Vec<(usize, f32)> {
        let joints = self.skeleton().joints().iter().zip(&symmetry.joints);
        let of_joint = |(joint, &partner): (&Joint, &usize)| {
            let signs = match joint.parent {
                Some(_) => SIGNS,
                None => SIGNS_OF_ROOT,
            };
            let first = partner * Self::NUMBERS_A_JOINT;
            let numbers = signs.into_iter().enumerate();
            numbers.map(move |(number, sign)| (first + number, sign))
        };
        joints.flat_map(of_joint).collect()
    }
}

#[cfg(test)]
mod tests {
    use garnet_mesh::primitives::capsule;
    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::{Pose, SkinWeights};

    fn joint(name: &str, parent: Option<usize>, x: f32, y: f32) -> Joint {
        Joint {
            name: name.to_owned(),
            parent,
            rest_position: Point3::new(x, y, 0.0),
        }
    }

    /// A trunk with two arms, the right one first, in front of the plane x = 0.1.
    fn joints() -> Vec<Joint> {
        vec![
            joint("pelvis", None, 0.1, 0.0),
            joint("right", Some(0), -0.1, 0.4),
            joint("left", Some(0), 0.301, 0.4),
            joint("left hand", Some(2), 0.7, 0.4),
            joint("right hand", Some(1), -0.5, 0.4),
        ]
    }

    #[test]
    fn partners_are_found_by_place_and_parent() {
        let found = Skeleton::new(joints()).unwrap().symmetry().unwrap();
        assert_eq!(found.joints, [0, 2, 1, 4, 3]);
        let point = found.point(&Point3::new(0.3, 1.0, 2.0));
        assert!((point - Point3::new(-0.1, 1.0, 2.0)).norm() < 1e-6);
        let mut one_sided = joints();
        one_sided[3].rest_position.x += 0.02;
        assert_eq!(Skeleton::new(one_sided).unwrap().symmetry(), None);
        let mut one_armed = joints();
        one_armed.pop();
        assert_eq!(Skeleton::new(one_armed).unwrap().symmetry(), None);
    }

    #[test]
    fn the_numbers_of_a_mirrored_pose_are_the_mirrored_numbers() {
        let skeleton = Skeleton::new(joints()).unwrap();
        let symmetry = skeleton.symmetry().unwrap();
        let mesh = capsule(0.2, 0.6, 12, 12);
        let rows = mesh
            .positions()
            .iter()
            .map(|p| [(usize::from(p.x > 0.0), 1.0)]);
        let weights = SkinWeights::from_influences(5, rows).unwrap();
        let body = Body::new(mesh, skeleton, weights).unwrap();
        let mut pose = Pose::rest(5);
        for (number, rotation) in pose.rotations.iter_mut().enumerate() {
            let axis = Vector3::new(1.0, 0.3 * number as f32, -0.7);
            *rotation = UnitQuaternion::from_scaled_axis(axis * 0.4);
        }
        let mut mirrored = pose.clone();
        for (joint, &partner) in symmetry.joints.iter().enumerate() {
            // M R M turns about M a the other way round.
            let axis = -Symmetry::vector(pose.rotations[partner].scaled_axis());
            mirrored.rotations[joint] = UnitQuaternion::from_scaled_axis(axis);
        }
        let numbers = |pose: &Pose| body.pose_and_shape(&body.posed(pose).unwrap());
        let (of_pose, expected) = (numbers(&pose), numbers(&mirrored));
        for (&(number, sign), expected) in body.mirrored_numbers(&symmetry).iter().zip(&expected) {
            assert!((sign * of_pose[number] - expected).abs() < 1e-5);
        }
    }
}
