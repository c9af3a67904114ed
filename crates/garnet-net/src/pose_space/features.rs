//! What of a pose and shape tells how cloth lies.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use crate::NetError;

/// Numbers of a joint in what describes pose and shape: six of its rotation, four of its skin.
const NUMBERS_A_JOINT: usize = 10;

/// Numbers of a rotation: its first two columns.
const TURN: usize = 6;

/// How a garment is cut, in metres: the mean girth, which is area over height, and height and width
/// at rest.
pub type Cut = [f32; 3];

/// Cuts are known that are outside of those of the training by no more than this share of each
/// number. More trusts networks farther out, less simulates what they could tell.
const NEAR_CUTS: f32 = 0.03;

/// What a feature tells of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Aspect {
    /// Its rotation against its parent: two columns. Of the root: where up is, and three zeros.
    Turn,
    /// Its rotation against the [hub](Features::hub): two columns.
    AgainstHub,
    /// The mean offset of its skin from the skin at rest, in metres, and how far that is outward.
    Shape,
    /// Where up is, seen from it.
    Up,
    /// How the garment is [cut](Cut), whatever the joint.
    Cut,
}

impl Aspect {
    /// How many numbers it has.
    pub const fn len(self) -> usize {
        match self {
            Self::Turn | Self::AgainstHub => TURN,
            Self::Shape => NUMBERS_A_JOINT - TURN,
            Self::Up => 3,
            Self::Cut => size_of::<Cut>() / size_of::<f32>(),
        }
    }

    /// Whether there are no features, which is never so.
    pub const fn is_empty(self) -> bool {
        false
    }
}

/// An aspect of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Feature {
    /// The joint.
    pub joint: usize,
    /// What of it.
    pub aspect: Aspect,
}

/// Features of a body, by the numbers of its pose and shape.
///
/// An arm is told against its collarbone in those numbers, but a sleeve lies on the trunk as the
/// arm lies on the trunk: rotations against one joint of the trunk tell drapes with fewer scenes.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Features {
    /// The parent of each joint `[joint]`.
    pub parents: Vec<Option<usize>>,
    /// The joint that others are told against: the one from which those limbs go that move most of
    /// the garment.
    pub hub: usize,
    /// What is told.
    pub all: Vec<Feature>,
    /// The least and the greatest numbers of the cuts of the training, if they are told.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cuts: Option<[Cut; 2]>,
}

impl Features {
    /// Refuses joints that there are not, and parents that are their own ancestors.
    ///
    /// # Errors
    ///
    /// [`NetError::Count`].
    pub fn check(&self) -> Result<(), NetError> {
        let num_joints = self.parents.len();
        let parents = self.parents.iter().flatten().copied();
        let named = parents.chain(self.all.iter().map(|feature| feature.joint));
        let most = named.chain([self.hub]).max().unwrap_or(0);
        let is_endless = |joint| self.above(joint).count() > num_joints;
        if most >= num_joints || (0..num_joints).any(is_endless) {
            return Err(NetError::Count {
                what: "joints of features",
                found: most + 1,
                expected: num_joints,
            });
        }
        Ok(())
    }

    /// A joint and those above it, up to the root; one more than there are joints if there is no
    /// root.
    fn above(&self, joint: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(joint), |&joint| self.parents[joint])
            .take(self.parents.len() + 1)
    }

    /// How many numbers of pose and shape there are.
    pub(super) fn num_parameters(&self) -> usize {
        NUMBERS_A_JOINT * self.parents.len()
    }

    /// How many numbers all features have.
    pub fn len(&self) -> usize {
        self.all.iter().map(|feature| feature.aspect.len()).sum()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// The number of the feature that each number belongs to `[number]`.
    pub fn owners(&self) -> Vec<usize> {
        let all = self.all.iter().enumerate();
        all.flat_map(|(number, feature)| std::iter::repeat_n(number, feature.aspect.len()))
            .collect()
    }

    /// Whether the training had garments that are cut like this: never, if it was not told of cuts.
    pub fn knows(&self, cut: &Cut) -> bool {
        self.cuts.is_some_and(|[low, high]| {
            let mut ends = low.iter().zip(&high).zip(cut);
            ends.all(|((low, high), number)| {
                (low * (1.0 - NEAR_CUTS)..=high * (1.0 + NEAR_CUTS)).contains(number)
            })
        })
    }

    /// The numbers of all features of a body of this pose and shape, and of a garment of this cut.
    ///
    /// # Errors
    ///
    /// [`NetError::Count`] for another count of numbers than ten a joint.
    pub fn of(&self, parameters: &[f32], cut: &Cut) -> Result<Vec<f32>, NetError> {
        let expected = self.num_parameters();
        NetError::check_count("parameters", parameters.len(), expected)?;
        let turns = self.turns(parameters);
        let from_hub = turns[self.hub].transpose();
        let mut numbers = Vec::with_capacity(self.len());
        for &Feature { joint, aspect } in &self.all {
            let first = NUMBERS_A_JOINT * joint;
            let own = &parameters[first..first + NUMBERS_A_JOINT];
            match aspect {
                Aspect::Turn => numbers.extend_from_slice(&own[..TURN]),
                Aspect::Shape => numbers.extend_from_slice(&own[TURN..]),
                Aspect::AgainstHub => {
                    numbers.extend_from_slice(&(from_hub * turns[joint]).as_slice()[..TURN]);
                }
                Aspect::Cut => numbers.extend_from_slice(cut),
                Aspect::Up => {
                    numbers.extend_from_slice((turns[joint].transpose() * Vector3::y()).as_slice());
                }
            }
        }
        Ok(numbers)
    }

    /// The rotation of each joint in a world in which the root is turned by no more than its lean.
    fn turns(&self, parameters: &[f32]) -> Vec<Matrix3<f32>> {
        let (numbers, _) = parameters.as_chunks::<NUMBERS_A_JOINT>();
        let of_parent = |joint: usize| -> Matrix3<f32> {
            let [a, b, c, d, e, f, ..] = numbers[joint];
            let first = Vector3::new(a, b, c);
            if self.parents[joint].is_none() {
                let lean = UnitQuaternion::rotation_between(&first, &Vector3::y());
                let over =
                    || UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f32::consts::PI);
                return Rotation3::from(lean.unwrap_or_else(over)).into_inner();
            }
            let second = Vector3::new(d, e, f);
            Matrix3::from_columns(&[first, second, first.cross(&second)])
        };
        let in_world = |joint: usize| {
            self.above(joint)
                .fold(Matrix3::identity(), |turn, joint| of_parent(joint) * turn)
        };
        (0..self.parents.len()).map(in_world).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A root, a joint on it and one on that.
    fn chain(aspects: &[(usize, Aspect)]) -> Features {
        let all = aspects.iter();
        Features {
            parents: vec![None, Some(0), Some(1)],
            hub: 1,
            all: all
                .map(|&(joint, aspect)| Feature { joint, aspect })
                .collect(),
            cuts: None,
        }
    }

    fn numbers(turns: [UnitQuaternion<f32>; 3]) -> Vec<f32> {
        let mut numbers = Vec::new();
        for (joint, turn) in turns.into_iter().enumerate() {
            if joint == 0 {
                let up = turn.inverse() * Vector3::y();
                numbers.extend([up.x, up.y, up.z, 0.0, 0.0, 0.0]);
            } else {
                numbers.extend_from_slice(&turn.to_rotation_matrix().matrix().as_slice()[..TURN]);
            }
            numbers.extend([0.1 * joint as f32, 0.2, 0.3, 0.4]);
        }
        numbers
    }

    #[test]
    fn features_are_rotations_against_the_hub_and_up() {
        let about = |axis, angle| UnitQuaternion::from_axis_angle(&axis, angle);
        let turns = [
            about(Vector3::x_axis(), 0.4),
            about(Vector3::z_axis(), 0.7),
            about(Vector3::y_axis(), -0.3),
        ];
        let features = chain(&[
            (2, Aspect::AgainstHub),
            (0, Aspect::AgainstHub),
            (2, Aspect::Up),
            (1, Aspect::Shape),
            (0, Aspect::Cut),
        ]);
        let found = features.of(&numbers(turns), &[1.1, 0.7, 0.8]).unwrap();
        assert_eq!(found.len(), features.len());
        assert_eq!(features.owners()[6..13], [1, 1, 1, 1, 1, 1, 2]);
        let mut expected = Vec::new();
        for turn in [turns[2], turns[1].inverse()] {
            expected.extend_from_slice(&turn.to_rotation_matrix().matrix().as_slice()[..TURN]);
        }
        let up = (turns[0] * turns[1] * turns[2]).inverse() * Vector3::y();
        expected.extend_from_slice(up.as_slice());
        expected.extend([0.1, 0.2, 0.3, 0.4, 1.1, 0.7, 0.8]);
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-5, "{found} {expected}");
        }
    }

    #[test]
    fn a_body_may_look_in_any_direction() {
        let lean = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.4);
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 1.1);
        let still = UnitQuaternion::identity();
        let features = chain(&[(2, Aspect::Up), (0, Aspect::AgainstHub)]);
        let of = |numbers: &[f32]| features.of(numbers, &[0.0; 3]).unwrap();
        let [one, other] = [lean, yaw * lean].map(|root| of(&numbers([root, still, still])));
        for (one, other) in one.iter().zip(&other) {
            assert!((one - other).abs() < 1e-5);
        }
    }

    #[test]
    fn cuts_are_known_between_those_of_the_training() {
        let mut features = chain(&[(0, Aspect::Cut)]);
        assert!(!features.knows(&[1.0, 0.7, 0.8]));
        features.cuts = Some([[0.9, 0.6, 0.7], [1.2, 0.7, 0.9]]);
        assert!(features.knows(&[1.0, 0.7, 0.8]));
        assert!(features.knows(&[1.22, 0.6, 0.69]));
        assert!(!features.knows(&[1.3, 0.7, 0.8]) && !features.knows(&[1.0, 0.7, 0.5]));
    }

    #[test]
    fn what_there_is_not_is_refused() {
        assert!(chain(&[(2, Aspect::Up)]).check().is_ok());
        assert!(chain(&[(3, Aspect::Up)]).check().is_err());
        let mut circle = chain(&[(2, Aspect::Up)]);
        circle.parents[0] = Some(2);
        assert!(circle.check().is_err());
        let short = chain(&[(2, Aspect::Up)]).of(&[0.0; 29], &[0.0; 3]);
        assert!(matches!(short, Err(NetError::Count { expected: 30, .. })));
    }
}
