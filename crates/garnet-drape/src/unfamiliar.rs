//! Bodies unlike those that a network was trained on.

use std::fmt;

use garnet_knn::TORN_STRETCH;
use garnet_mesh::Point3;
use garnet_skin::{Body, BoundGarment, Joint};

/// A joint counts if it moves a vertex of the garment with at least this weight.
const MIN_WEIGHT: f32 = 0.05;

/// A joint may leave the range by this: numbers of its rotation, about radians; ...
pub(crate) const MAX_TURN: f32 = 0.3;

/// ... and the mean offset of its skin, along its normal too, in metres.
pub(crate) const MAX_GROWTH: f32 = 0.03;

/// Numbers of a joint that tell its turn, the first of them.
pub(crate) const TURN: usize = 6;

/// Edges of a prediction that are longer than this over their length at rest count against it: a
/// quarter more than torn, because relaxing and untangling mend what is just torn. Lower, drapes
/// fall back that would have been mended.
const TORN_BEYOND_MENDING: f32 = 1.25 * TORN_STRETCH;

/// More torn edges than this, as a share of all, and the drape is of no use.
const MAX_TORN: f64 = 0.01;

/// What of a body, or of a prediction, is unlike the training of a network.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Unfamiliar {
    /// A joint is bent, or the body leans, as in no scene of the training.
    Pose {
        /// The joint.
        joint: String,
        /// How far outside, about radians.
        excess: f32,
    },
    /// A part of the body is larger or smaller than in any scene of the training.
    Shape {
        /// The joint of that part.
        joint: String,
        /// How far outside, in metres.
        excess: f32,
    },
    /// The network would tear the garment.
    Torn {
        /// The share of its edges that would be longer than 2.5 times their length at rest.
        share: f64,
    },
}

impl fmt::Display for Unfamiliar {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pose { joint, excess } => write!(
                formatter,
                "the pose of `{joint}` is {:.0} degrees outside of what it was trained on",
                excess.to_degrees()
            ),
            Self::Shape { joint, excess } => write!(
                formatter,
                "the body at `{joint}` is {:.0} mm outside of what it was trained on",
                1e3 * excess
            ),
            Self::Torn { share } => write!(
                formatter,
                "it would tear {:.1} % of the garment's edges",
                1e2 * share
            ),
        }
    }
}

/// The joint that is farthest outside of what a network was trained on, if that is far; only joints
/// that move the garment count. `excess` is that of [`Body::pose_and_shape`].
pub(crate) fn unfamiliar(excess: &[f32], joints: &[Joint], moves: &[bool]) -> Option<Unfamiliar> {
    let mut worst: Option<(f32, Unfamiliar)> = None;
    let numbers = excess.chunks(Body::NUMBERS_A_JOINT);
    for ((joint, numbers), _) in joints
        .iter()
        .zip(numbers)
        .zip(moves)
        .filter(|(_, moves)| **moves)
    {
        let (turn, growth) = numbers.split_at(numbers.len().min(TURN));
        let joint = || joint.name.clone();
        let turn = turned_by(turn);
        let growth = norm(growth);
        let found = [
            (
                turn / MAX_TURN,
                Unfamiliar::Pose {
                    joint: joint(),
                    excess: turn,
                },
            ),
            (
                growth / MAX_GROWTH,
                Unfamiliar::Shape {
                    joint: joint(),
                    excess: growth,
                },
            ),
        ];
        for (share, found) in found {
            if share > worst.as_ref().map_or(1.0, |(share, _)| *share) {
                worst = Some((share, found));
            }
        }
    }
    worst.map(|(_, found)| found)
}

/// About by how many radians two columns of a rotation have changed: by the square root of two
/// times the angle.
pub(crate) fn turned_by(numbers: &[f32]) -> f32 {
    norm(numbers) / std::f32::consts::SQRT_2
}

pub(crate) fn norm(numbers: &[f32]) -> f32 {
    let squares = numbers.iter().map(|number| number * number);
    squares.sum::<f32>().sqrt()
}

/// Whether each joint moves the garment.
pub(crate) fn moving_joints(garment: &BoundGarment, num_joints: usize) -> Vec<bool> {
    let mut moves = vec![false; num_joints];
    for node in 0..garment.rest_nodes().len() {
        for (joint, weight) in garment.weights().vertex(node) {
            moves[joint] |= weight >= MIN_WEIGHT;
        }
    }
    moves
}

/// Whether a drape `[node]` is torn, more than the warp that it started from.
pub(crate) fn torn(
    garment: &BoundGarment,
    warp: &[Point3],
    drape: &[Point3],
) -> Option<Unfamiliar> {
    let edges = garment.topology().edges();
    let rest = garment.rest_nodes();
    let share = |places: &[Point3]| {
        let is_torn = |&&[a, b]: &&[u32; 2]| {
            let length = |places: &[Point3]| (places[a as usize] - places[b as usize]).norm();
            length(places) > TORN_BEYOND_MENDING * length(rest)
        };
        edges.iter().filter(is_torn).count() as f64 / edges.len().max(1) as f64
    };
    let found = share(drape);
    (found > MAX_TORN && found > 2.0 * share(warp)).then_some(Unfamiliar::Torn { share: found })
}
