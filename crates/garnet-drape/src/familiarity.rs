//! How far a pose is from those that networks have learned from, and how far off that lets a drape
//! be.

use garnet_skin::{Body, PosedBody};
use serde::{Deserialize, Serialize};

use crate::BoundGarment;
use crate::unfamiliar::{TURN, moving_joints, turned_by};

/// Fewer scenes than this say nothing of how the distance grows.
const MIN_SCENES: usize = 20;

/// The share of scenes of the fit that keep within [`Expectation::bound`], so that nine of ten
/// others do: more by the standard error of some 40 scenes that know nothing of each other, as
/// there are in 150 of 20 bodies. A lower one promises too much in other sequences.
const SHARE: f64 = 0.95;

/// What the poses of scenes are like that networks have learned from, or were chosen by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredPoses {
    /// The mean of the numbers that tell a joint's turn, those of [`Body::pose_and_shape`]
    /// `[joint][6]`.
    pub mean: Vec<f32>,
    /// How far each joint is from there, the root of the mean square, about radians `[joint]`.
    /// Empty in older packages: a radian each, then.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub spread: Vec<f32>,
}

/// How far from the simulation drapes of a variant probably are, by how far the pose is from the
/// middle of the poses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Expectation {
    /// Mean distance of the vertices in the middle of the poses, in metres.
    pub distance: f64,
    /// By how much its logarithm grows, per unit of the distance of poses.
    pub growth: f64,
    /// The ratio of true to expected distance that nine tenths of other scenes keep within.
    pub within: f64,
}

impl StoredPoses {
    /// The middle of poses `[pose]`, each as [`Body::pose_and_shape`] tells it; none of none.
    pub fn of<'a>(poses: impl IntoIterator<Item = &'a [f32]>) -> Option<Self> {
        let poses: Vec<&[f32]> = poses.into_iter().collect();
        let mut sums: Vec<f64> = Vec::new();
        let mut count = 0_u32;
        for pose in &poses {
            let turns = turns(pose).flatten();
            count += 1;
            if sums.is_empty() {
                sums = turns.map(|&number| f64::from(number)).collect();
            } else {
                (sums.iter_mut().zip(turns)).for_each(|(sum, &number)| *sum += f64::from(number));
            }
        }
        // Four digits are a hundredth of a degree.
        let mean = |sum: f64| ((1e4 * sum / f64::from(count)).round() / 1e4) as f32;
        if count == 0 {
            return None;
        }
        let mean: Vec<f32> = sums.into_iter().map(mean).collect();
        let num_joints = mean.len() / TURN;
        let mut squares = vec![0.0_f64; num_joints];
        for pose in &poses {
            let apart = apart(pose, &mean).zip(&mut squares);
            apart.for_each(|(apart, sum)| *sum += apart * apart);
        }
        let spread = |sum: f64| {
            let spread = (sum / f64::from(count)).sqrt().max(LEAST_SPREAD);
            ((1e4 * spread).round() / 1e4) as f32
        };
        Some(Self {
            spread: squares.into_iter().map(spread).collect(),
            mean,
        })
    }

    /// How far a pose is from the middle, 1 for a usual pose: the root of the mean square over the
    /// joints that [move](BoundGarment::moving_joints) the garment, each in units of its spread;
    /// none of another skeleton.
    pub fn distance(&self, pose: &[f32], moves: &[bool]) -> Option<f64> {
        if self.mean.len() != TURN * moves.len() {
            return None;
        }
        let apart: Vec<f64> = (apart(pose, &self.mean).zip(moves).enumerate())
            .filter(|(_, (_, moves))| **moves)
            .map(|(joint, (apart, _))| apart / f64::from(*self.spread.get(joint).unwrap_or(&1.0)))
            .collect();
        let sum: f64 = apart.iter().map(|apart| apart * apart).sum();
        let count = if self.spread.is_empty() {
            1
        } else {
            apart.len().max(1)
        };
        Some((sum / count as f64).sqrt())
    }

    /// The same of a posed body; none if its skeleton is not that of the poses.
    pub fn distance_of(&self, posed: &PosedBody, garment: &BoundGarment) -> Option<f64> {
        let pose = garment.body().pose_and_shape(posed);
        self.distance(&pose, &garment.moving_joints())
    }
}

/// Joints that hardly turn in any pose count as if they turned by this, in radians.
const LEAST_SPREAD: f64 = 0.05;

/// How far the turns of a pose are from others, about radians `[joint]`.
fn apart(pose: &[f32], mean: &[f32]) -> impl Iterator<Item = f64> {
    turns(pose).zip(mean.chunks(TURN)).map(|(turn, mean)| {
        let apart: Vec<f32> = turn.iter().zip(mean).map(|(a, b)| a - b).collect();
        f64::from(turned_by(&apart))
    })
}

/// The turns of the joints of a pose `[joint]`.
fn turns(pose: &[f32]) -> impl Iterator<Item = &[f32]> {
    let joints = pose.chunks_exact(Body::NUMBERS_A_JOINT);
    joints.map(|numbers| &numbers[..TURN])
}

impl BoundGarment {
    /// Whether each joint of the body moves the garment `[joint]`.
    pub fn moving_joints(&self) -> Vec<bool> {
        moving_joints(self.cloth(), self.body().skeleton().num_joints())
    }
}

/// How familiar a pose is that is so far from the middle: 1 in the middle, towards 0
/// far from it.
pub fn familiarity(distance: f64) -> f64 {
    1.0 / (1.0 + distance)
}

impl Expectation {
    /// Fits distances from the simulation, in metres, of scenes that are so far from the middle of
    /// the poses: a line through their logarithms, by least squares. None of too few.
    pub fn fit(scenes: &[(f64, f64)]) -> Option<Self> {
        if scenes.len() < MIN_SCENES {
            return None;
        }
        let logs: Vec<(f64, f64)> = scenes
            .iter()
            .map(|&(far, distance)| (far, distance.max(f64::MIN_POSITIVE).ln()))
            .collect();
        let count = logs.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(&|scene| scene.0), mean(&|scene| scene.1));
        let spread = mean(&|scene| (scene.0 - x).powi(2));
        let both = mean(&|scene| (scene.0 - x) * (scene.1 - y));
        // Nearer to the middle nothing is worse.
        let growth = if spread > 0.0 {
            (both / spread).max(0.0)
        } else {
            0.0
        };
        let mut expected = Self {
            distance: (y - growth * x).exp(),
            growth,
            within: 1.0,
        };
        let mut ratios: Vec<f64> = scenes
            .iter()
            .map(|&(far, distance)| distance / expected.at(far))
            .collect();
        ratios.sort_by(f64::total_cmp);
        let last = (SHARE * count).ceil() as usize;
        expected.within = ratios[last.clamp(1, ratios.len()) - 1];
        Some(expected)
    }

    /// The distance that is expected so far from the middle, in metres.
    pub fn at(&self, far: f64) -> f64 {
        self.distance * (self.growth * far).exp()
    }

    /// What nine scenes of ten keep within so far from the middle, in metres.
    pub fn bound(&self, far: f64) -> f64 {
        self.within * self.at(far)
    }
}

/// The rank correlation of pairs (*Spearman 1904*), from -1 to 1; 0 of fewer than two, or if all of
/// one side are equal.
pub fn rank_correlation(pairs: &[(f64, f64)]) -> f64 {
    let ranks = |of: &dyn Fn(&(f64, f64)) -> f64| {
        let mut order: Vec<usize> = (0..pairs.len()).collect();
        order.sort_by(|&a, &b| of(&pairs[a]).total_cmp(&of(&pairs[b])));
        let mut ranks = vec![0.0; pairs.len()];
        let mut first = 0;
        while first < order.len() {
            let value = of(&pairs[order[first]]);
            let same = order[first..]
                .iter()
                .take_while(|&&place| of(&pairs[place]).total_cmp(&value).is_eq());
            let last = first + same.count();
            for &place in &order[first..last] {
                ranks[place] = 0.5 * (first + last - 1) as f64;
            }
            first = last;
        }
        ranks
    };
    let (a, b) = (ranks(&|pair| pair.0), ranks(&|pair| pair.1));
    let middle = 0.5 * (pairs.len() as f64 - 1.0);
    let product = |a: &[f64], b: &[f64]| -> f64 {
        let pairs = a.iter().zip(b);
        pairs.map(|(a, b)| (a - middle) * (b - middle)).sum()
    };
    let spread = (product(&a, &a) * product(&b, &b)).sqrt();
    if spread > 0.0 {
        product(&a, &b) / spread
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_expectation_finds_the_line_that_scenes_lie_on() {
        let line = |far: f64| 0.002 * (0.5 * far).exp();
        let scenes: Vec<(f64, f64)> = (0..40)
            .map(|number| 0.1 * f64::from(number))
            .map(|far| (far, line(far)))
            .collect();
        let found = Expectation::fit(&scenes).unwrap();
        assert!((found.distance - 0.002).abs() < 1e-12, "{found:?}");
        assert!((found.growth - 0.5).abs() < 1e-12, "{found:?}");
        assert!((found.within - 1.0).abs() < 1e-9, "{found:?}");
        assert_eq!(Expectation::fit(&scenes[..MIN_SCENES - 1]), None);
    }

    #[test]
    fn nine_scenes_of_ten_keep_within_the_bound() {
        let scenes: Vec<(f64, f64)> = (0..200)
            .map(|number| (f64::from(number % 7), 1e-3 * f64::from(1 + number % 10)))
            .collect();
        let found = Expectation::fit(&scenes).unwrap();
        let within = scenes
            .iter()
            .filter(|(far, distance)| *distance <= found.bound(*far) * (1.0 + 1e-9))
            .count();
        assert!((190..=200).contains(&within), "{within}");
        // Growth is never below nothing.
        let falling: Vec<(f64, f64)> = (0..30)
            .map(|number| (f64::from(number), 1.0 / f64::from(1 + number)))
            .collect();
        assert!(Expectation::fit(&falling).unwrap().growth.abs() < 1e-12);
    }

    #[test]
    fn poses_are_as_far_as_their_joints_usually_turn() {
        // Two joints, of which one turns ten times as much as the other.
        let pose = |turn: f32| {
            let mut numbers = vec![0.0; 2 * Body::NUMBERS_A_JOINT];
            (numbers[0], numbers[Body::NUMBERS_A_JOINT]) = (turn, 10.0 * turn);
            numbers
        };
        let poses: Vec<Vec<f32>> = [-1.0, 1.0].map(pose).to_vec();
        let found = StoredPoses::of(poses.iter().map(Vec::as_slice)).unwrap();
        assert!((found.spread[1] / found.spread[0] - 10.0).abs() < 0.01);
        for (turn, expected) in [(0.0, 0.0), (1.0, 1.0), (3.0, 3.0)] {
            let far = found.distance(&pose(turn), &[true, true]).unwrap();
            assert!((far - expected).abs() < 1e-3, "{far}");
        }
        // Of a joint alone that moves the garment it is the same.
        let far = found.distance(&pose(2.0), &[true, false]).unwrap();
        assert!((far - 2.0).abs() < 1e-3, "{far}");
        assert_eq!(found.distance(&pose(1.0), &[true]), None);
    }

    #[test]
    fn ranks_correlate_by_order_alone() {
        let rising: Vec<(f64, f64)> = (1..9)
            .map(|number| (f64::from(number), f64::from(number).powi(5)))
            .collect();
        assert!((rank_correlation(&rising) - 1.0).abs() < 1e-12);
        let falling: Vec<(f64, f64)> = rising.iter().map(|&(a, b)| (a, -b)).collect();
        assert!((rank_correlation(&falling) + 1.0).abs() < 1e-12);
        assert!(rank_correlation(&[(1.0, 2.0), (1.0, 3.0)]).abs() < 1e-12);
        // Spearman by hand: ranks 0 1 2 3 and 1 0 3 2 give 1 - 6 * 4 / 60.
        let mixed = [(1.0, 2.0), (2.0, 1.0), (3.0, 4.0), (4.0, 3.0)];
        assert!((rank_correlation(&mixed) - 0.6).abs() < 1e-12);
    }
}
