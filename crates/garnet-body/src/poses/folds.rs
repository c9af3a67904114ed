//! Skin that posing turns over.

use garnet_skin::{Body, Method, Point3, Pose, SkinError, blended_transforms};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::SelfContact;
use crate::motion::{Role, Side};

/// What posing does to the faces of a skin.
///
/// A face is *turned over* if its normal is more than 90° off from where the mean of the rotations
/// that carry its corners would turn it: the skin lies folded on itself there. Weights that change
/// faster than a bone turns do that.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SkinFolds {
    /// Faces that are turned over, rising.
    pub turned: Vec<u32>,
    /// Area of those faces at rest, in m².
    pub turned_area: f64,
    /// The smallest area of a face over its area at rest.
    pub least_area_ratio: f64,
}

/// Least weight of collarbone and upper arm in the mean of a face at the shoulder.
const SHOULDER_SHARE: f32 = 0.1;

impl SelfContact {
    /// Area at rest of the skin at both shoulders that a pose turns over, in m².
    ///
    /// # Errors
    ///
    /// Those of [`garnet_skin::Skeleton::transforms`].
    pub(crate) fn turned_shoulder_area(&self, pose: &Pose) -> Result<f64, SkinError> {
        let body = self.body();
        let roles = Side::BOTH.map(|side| [Role::Collar(side), Role::Shoulder(side)]);
        let joints = roles.as_flattened().iter();
        let joints: Vec<usize> = joints
            .filter_map(|role| self.figure().joint(*role))
            .collect();
        let share = |vertex: u32| -> f32 {
            let weights = body.weights().vertex(vertex as usize);
            let of_shoulder = weights.filter(|(joint, _)| joints.contains(joint));
            of_shoulder.map(|(_, weight)| weight).sum()
        };
        let is_of_shoulder =
            |corners: [u32; 3]| corners.into_iter().map(share).sum::<f32>() > 3.0 * SHOULDER_SHARE;
        let turned = skin_folds(body, pose)?.turned.into_iter();
        let corners = turned.map(|face| body.rest().faces()[face as usize]);
        let at_shoulder = corners.filter(|corners| is_of_shoulder(*corners));
        let areas = at_shoulder.map(|corners| doubled_area(body.rest().positions(), corners));
        Ok(areas.map(|area| 0.5 * area.norm()).sum())
    }
}

/// Finds the faces that a pose turns over.
///
/// # Errors
///
/// Those of [`garnet_skin::Skeleton::transforms`].
pub fn skin_folds(body: &Body, pose: &Pose) -> Result<SkinFolds, SkinError> {
    let transforms = body.skeleton().transforms(pose)?;
    let posed = body.transformed_positions(&transforms, Method::DualQuaternion);
    let carried = blended_transforms(body.weights(), &transforms);
    let rest = body.rest();
    let mut folds = SkinFolds {
        least_area_ratio: 1.0,
        ..SkinFolds::default()
    };
    for (face, corners) in rest.faces().iter().enumerate() {
        let before = doubled_area(rest.positions(), *corners);
        let after = doubled_area(&posed, *corners);
        let turned = mean_rotation(corners.map(|corner| carried[corner as usize].rotation));
        if (turned * before).dot(&after) < 0.0 {
            folds.turned.push(face as u32);
            folds.turned_area += 0.5 * before.norm();
        }
        let ratio = after.norm() / before.norm().max(f64::MIN_POSITIVE);
        folds.least_area_ratio = folds.least_area_ratio.min(ratio);
    }
    Ok(folds)
}

/// The normal of a face, as long as twice its area.
fn doubled_area(positions: &[Point3], corners: [u32; 3]) -> Vector3<f64> {
    let [a, b, c] = corners.map(|corner| positions[corner as usize].coords.cast::<f64>());
    (b - a).cross(&(c - a))
}

/// The rotation half-way between three, all on the side of the first.
fn mean_rotation(rotations: [UnitQuaternion<f32>; 3]) -> UnitQuaternion<f64> {
    let first = rotations[0].into_inner().cast::<f64>();
    let mut sum = Quaternion::new(0.0, 0.0, 0.0, 0.0);
    for rotation in rotations {
        let rotation = rotation.into_inner().cast::<f64>();
        sum += if first.dot(&rotation) < 0.0 {
            -rotation
        } else {
            rotation
        };
    }
    UnitQuaternion::new_normalize(sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::poses::{Poser, key_pose};
    use crate::shape::{BodyParameters, ParametricBody};

    /// Of an upper arm and its shoulder of 800 cm² each side, in m².
    const MAX_TURNED_AREA: f64 = 15e-4;

    #[test]
    fn raised_arms_leave_the_skin_of_the_shoulders_outside() {
        for sex in [0.0, 1.0] {
            let built = ParametricBody::build(&BodyParameters::new(sex).with_bmi(23.0)).unwrap();
            let body = built.into_body();
            let poser = Poser::new(body.skeleton()).unwrap();
            let contact = SelfContact::new(&body).unwrap();
            for name in [
                "reach_high",
                "upward_salute",
                "warrior_one",
                "t_pose",
                "stand",
            ] {
                let pose = poser.pose(&key_pose(name).unwrap().angles);
                let area = contact.turned_shoulder_area(&pose).unwrap();
                assert!(area < MAX_TURNED_AREA, "{name}: {:.1} cm²", 1e4 * area);
            }
        }
    }

    #[test]
    fn a_body_that_turns_as_a_whole_folds_nowhere() {
        let built = ParametricBody::build(&BodyParameters::new(1.0)).unwrap();
        let body = built.into_body();
        let mut pose = Pose::rest(body.skeleton().num_joints());
        pose.rotations[0] = UnitQuaternion::from_euler_angles(1.0, 2.0, -0.5);
        let folds = skin_folds(&body, &pose).unwrap();
        assert_eq!(folds.turned, Vec::<u32>::new());
        approx::assert_relative_eq!(folds.least_area_ratio, 1.0, epsilon = 0.02);
    }
}
