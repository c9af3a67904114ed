//! Keeping the parts of a body apart through a motion.
//!
//! A pose by itself is [corrected](SelfContact::separated) until its parts touch lightly at most,
//! but which joint gives way, and by how much, may change from one frame to the next: hands would
//! jump. Here all frames are pushed apart by a little, the turns of each joint are smoothed over
//! time, and the contacts are measured anew, some rounds.
//!
//! Turns are found at moments of the motion that lie [`STRIDE`] apart, no farther than [`REACH`]
//! from the frames that are asked for, and interpolated between them: which frames those are
//! matters by millimetres, where ways out are clear.

use std::{collections::BTreeSet, ops::RangeInclusive};

use garnet_skin::{Pose, SkinError};
use nalgebra::{UnitQuaternion, Vector3};
use rayon::prelude::*;

use super::{SelfContact, SeparationOptions};

/// How often frames are pushed apart and smoothed.
const ROUNDS: u32 = 8;

/// Standard deviation of the smoothing, in seconds.
const SMOOTHING: f64 = 0.07;

/// How far apart the moments are for which turns are found, in seconds; frames of slower motions
/// are all taken.
const STRIDE: f64 = 1.0 / 30.0;

/// How far before and after a frame the motion is looked at, in seconds: some three standard
/// deviations of all rounds together.
const REACH: f64 = 0.6;

/// Seconds from frame to frame that are believed; motions that tell others are taken for ones of 30
/// frames a second.
const FRAME_TIMES: RangeInclusive<f64> = 1e-4..=10.0;

/// Turns of the joints in a pose, as axes times angles in radians, each about its joint in the
/// joint's own frame `[joint]`.
pub type Turns = Vec<Vector3<f32>>;

/// How long a motion is, and how fast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// How many frames it has.
    pub num_frames: usize,
    /// Seconds from one frame to the next, if they are known.
    pub frame_time: Option<f64>,
}

/// Turns the joints of a pose.
pub fn turn(pose: &mut Pose, turns: &[Vector3<f32>]) {
    for (rotation, turn) in pose.rotations.iter_mut().zip(turns) {
        *rotation *= UnitQuaternion::from_scaled_axis(*turn);
    }
}

impl SelfContact {
    /// The turns that keep the parts of the body apart in poses that follow each other by so many
    /// seconds `[pose][joint]`, as far as that goes smoothly: where parts come together fast they
    /// may run into each other by more than the options allow.
    ///
    /// # Errors
    ///
    /// Those of [`garnet_skin::Skeleton::transforms`].
    pub fn easing(
        &self,
        poses: &[Pose],
        seconds: f64,
        options: &SeparationOptions,
    ) -> Result<Vec<Turns>, SkinError> {
        let num_joints = self.body().skeleton().num_joints();
        let options = &options.scaled(self.scale());
        let mut turns = vec![vec![Vector3::zeros(); num_joints]; poses.len()];
        let bell = bell(SMOOTHING / seconds, poses.len());
        let is_still = |turns: &Turns| turns.iter().all(|turn| *turn == Vector3::zeros());
        for round in 0..ROUNDS {
            let pushed = poses.par_iter().zip(&turns).map(|(given, turns)| {
                // What is still after a round was apart in it, or has nothing that could give way.
                if round > 0 && is_still(turns) {
                    return Ok(None);
                }
                let mut pose = given.clone();
                turn(&mut pose, turns);
                let report = self.report_with_room(&pose, options.room)?;
                if options.is_sound(&report) {
                    return Ok(None);
                }
                self.push(&mut pose, &report, options)?;
                Ok(Some(turns_between(given, &pose)))
            });
            let pushed: Vec<Option<Turns>> = pushed.collect::<Result<_, SkinError>>()?;
            // Once something gives way all rounds are taken, as smoothing goes on where nothing is
            // left to push.
            if pushed.iter().all(Option::is_none) && turns.iter().all(is_still) {
                break;
            }
            for (turns, pushed) in turns.iter_mut().zip(pushed) {
                *turns = pushed.unwrap_or_else(|| std::mem::take(turns));
            }
            turns = smoothed(&turns, &bell);
        }
        Ok(turns)
    }

    /// The turns that keep the parts of the body apart in frames of a motion `[frame][joint]`,
    /// whose poses of this body `poses_of` gives by their numbers.
    ///
    /// Whichever other frames are asked for, a frame's turns are the same but for millimetres,
    /// except where a limb may leave another part by several ways.
    ///
    /// # Errors
    ///
    /// Those of `poses_of` and [`SelfContact::easing`].
    pub fn easing_of_frames<E: From<SkinError>>(
        &self,
        timing: Timing,
        frames: &[usize],
        options: &SeparationOptions,
        poses_of: impl Fn(&[usize]) -> Result<Vec<Pose>, E>,
    ) -> Result<Vec<Turns>, E> {
        let frame_time = timing
            .frame_time
            .filter(|time| FRAME_TIMES.contains(time))
            .unwrap_or(STRIDE);
        let stride = (STRIDE / frame_time).round().max(1.0) as usize;
        let seconds = stride as f64 * frame_time;
        let reach = (REACH / seconds).ceil() as usize;
        let last = timing.num_frames.saturating_sub(1) / stride;
        let near = |&frame: &usize| {
            let moment = frame / stride;
            moment.saturating_sub(reach)..=(moment + 1 + reach).min(last)
        };
        let moments: BTreeSet<usize> = frames.iter().flat_map(near).collect();
        let mut found: Vec<Option<Turns>> = vec![None; last + 1];
        for run in runs(&moments) {
            let of_run: Vec<usize> = run.clone().map(|moment| moment * stride).collect();
            let turns = self.easing(&poses_of(&of_run)?, seconds, options)?;
            for (moment, turns) in run.zip(turns) {
                found[moment] = Some(turns);
            }
        }
        let between = |&frame: &usize| {
            let (moment, share) = (frame / stride, (frame % stride) as f32 / stride as f32);
            let before = found[moment.min(last)].clone().unwrap_or_default();
            match found.get(moment + 1).and_then(Option::as_ref) {
                Some(after) => mixed(&before, after, share),
                None => before,
            }
        };
        Ok(frames.iter().map(between).collect())
    }
}

fn turns_between(from: &Pose, to: &Pose) -> Turns {
    let rotations = from.rotations.iter().zip(&to.rotations);
    rotations
        .map(|(from, to)| (from.inverse() * to).scaled_axis())
        .collect()
}

fn mixed(before: &[Vector3<f32>], after: &[Vector3<f32>], share: f32) -> Turns {
    let both = before.iter().zip(after);
    both.map(|(before, after)| before.lerp(after, share))
        .collect()
}

/// Half of a bell, from its middle, with a standard deviation of so many frames; no longer than
/// `num_frames`.
fn bell(deviation: f64, num_frames: usize) -> Vec<f32> {
    let deviation = deviation.max(f64::MIN_POSITIVE);
    let reach = ((3.0 * deviation).floor() as usize).min(num_frames);
    let weight = |frame: usize| (-0.5 * (frame as f64 / deviation).powi(2)).exp() as f32;
    (0..=reach).map(weight).collect()
}

fn smoothed(turns: &[Turns], bell: &[f32]) -> Vec<Turns> {
    let mean = |frame: usize| -> Turns {
        let near = frame.saturating_sub(bell.len() - 1)..turns.len().min(frame + bell.len());
        let weights = near.clone().map(|other| bell[other.abs_diff(frame)]);
        let sum: f32 = weights.clone().sum();
        let mut mean = vec![Vector3::zeros(); turns[frame].len()];
        for (other, weight) in near.zip(weights) {
            for (mean, turn) in mean.iter_mut().zip(&turns[other]) {
                *mean += turn * (weight / sum);
            }
        }
        mean
    };
    (0..turns.len()).into_par_iter().map(mean).collect()
}

/// Numbers that follow each other, run by run.
fn runs(numbers: &BTreeSet<usize>) -> Vec<RangeInclusive<usize>> {
    let mut runs: Vec<RangeInclusive<usize>> = Vec::new();
    for &number in numbers {
        match runs.last_mut() {
            Some(run) if run.end() + 1 == number => *run = *run.start()..=number,
            _ => runs.push(number..=number),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_cut_where_one_is_missing() {
        let numbers = [3, 4, 5, 9, 11, 12].into_iter().collect();
        assert_eq!(runs(&numbers), [3..=5, 9..=9, 11..=12]);
        assert!(runs(&BTreeSet::new()).is_empty());
    }

    #[test]
    fn smoothing_keeps_what_is_the_same_in_all_frames_and_spreads_what_is_in_one() {
        let same = vec![vec![Vector3::new(0.1, -0.2, 0.3)]; 9];
        for turns in smoothed(&same, &bell(2.0, 9)) {
            approx::assert_relative_eq!(turns[0], same[0][0], epsilon = 1e-6);
        }
        let mut one = vec![vec![Vector3::zeros()]; 9];
        one[4][0].x = 1.0;
        let spread: Vec<f32> = smoothed(&one, &bell(1.0, 9))
            .iter()
            .map(|turns| turns[0].x)
            .collect();
        assert!(
            spread.windows(2).take(4).all(|pair| pair[0] <= pair[1]),
            "{spread:?}"
        );
        approx::assert_relative_eq!(spread[4], 0.399, epsilon = 0.01);
        assert!(spread[0] == 0.0, "{spread:?}");
    }
}
