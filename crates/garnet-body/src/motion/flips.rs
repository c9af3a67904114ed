//! Flips: joints that a recording turns over from one frame to the next.
//!
//! Solvers that fit a skeleton to markers lose the turn of a limb about itself where it is nearly
//! straight: the knee of a standing foot is on one side of the leg in a frame and on the other in
//! the next. No body does that, and skin that follows it steps by half a metre. Such a step is told
//! from fast motion by its neighbors, which are slow. Around it the rotation of the joint is a mean
//! over time, weighed by a bell, of one frame's quaternion and its neighbors': the joint turns over
//! within a fifth of a second, about the one axis that the flip itself has, so that what the joint
//! carries stays near where the recording has it on both sides.

use garnet_skin::Pose;
use nalgebra::Quaternion;

use super::{
    Motion,
    rotation::{Rotation, to_f32, to_f64},
};

/// The least step of a flip, in radians.
const LEAST_STEP: f64 = 1.2;

/// The least speed of a flip, in radians a second: the fastest joints of kicks and throws are
/// slower over a frame, but for the turn of a pitcher's shoulder, which takes several.
const LEAST_SPEED: f64 = 30.0;

/// A flip is so many times as large as the steps around it.
const AMONG_STEPS: f64 = 4.0;

/// How many steps before and after a flip it is compared with.
const COMPARED: usize = 4;

/// Standard deviation of the mean, in seconds.
const SMOOTHING: f64 = 0.05;

/// Up to how many standard deviations from a flip the mean is taken whole; at twice of them it
/// ends.
const WHOLE: f64 = 2.0;

/// Steps farther than this may be turned either way; the way nearer to rest is taken. In radians.
const EITHER_WAY: f64 = 1.8;

/// Frame times of recordings whose flips can be told from motion, in seconds.
const LONGEST_FRAME_TIME: f64 = 0.05;

/// The flips of a recording.
#[derive(Debug, Clone, Default)]
pub(super) struct Flips {
    /// Joint, and the frames that begin with a flip, ascending.
    of_joints: Vec<(usize, Vec<usize>)>,
    /// Standard deviation of the mean, in frames.
    deviation: f64,
    /// The largest flip in radians, its joint, and the frame that begins with it.
    largest: Option<(f64, usize, usize)>,
}

impl Flips {
    /// Finds the flips of a recording.
    pub(super) fn find(motion: &Motion) -> Self {
        let frame_time = motion.frame_time.unwrap_or(1.0 / 30.0);
        let can_tell = frame_time > 1e-4 && frame_time <= LONGEST_FRAME_TIME;
        if !can_tell || motion.frames.len() < 2 * COMPARED {
            return Self::default();
        }
        let least = LEAST_STEP.max(LEAST_SPEED * frame_time);
        let mut flips = Self {
            deviation: SMOOTHING / frame_time,
            ..Self::default()
        };
        for joint in 0..motion.skeleton.num_joints() {
            let pairs = motion.frames.windows(2);
            let steps: Vec<f64> = pairs
                .map(|pair| {
                    let [from, to] = [0, 1].map(|end| pair[end].rotations.get(joint));
                    from.zip(to)
                        .map_or(0.0, |(from, to)| angle_between(&to_f64(from), &to_f64(to)))
                })
                .collect();
            let is_flip = |step: usize| {
                steps[step] >= least && steps[step] >= AMONG_STEPS * around(&steps, step)
            };
            let found: Vec<usize> = (0..steps.len()).filter(|&step| is_flip(step)).collect();
            for &step in &found {
                if flips.largest.is_none_or(|(angle, ..)| steps[step] > angle) {
                    flips.largest = Some((steps[step], joint, step + 1));
                }
            }
            if !found.is_empty() {
                let frames = found.into_iter().map(|step| step + 1).collect();
                flips.of_joints.push((joint, frames));
            }
        }
        flips
    }

    /// What is told of them; nothing if there are none.
    pub(super) fn note(&self, motion: &Motion) -> Option<String> {
        let (angle, joint, frame) = self.largest?;
        let count: usize = self.of_joints.iter().map(|(_, frames)| frames.len()).sum();
        let name = &motion.skeleton.joints()[joint].name;
        Some(format!(
            "the recording turns joints over between two frames ({count} times; `{name}` by {:.0} \
             degrees from frame {} to {frame}): they are turned within a fifth of a second",
            angle.to_degrees(),
            frame - 1
        ))
    }

    /// The pose in a frame; none if there is no flip near it.
    pub(super) fn mended(&self, motion: &Motion, frame: usize) -> Option<Pose> {
        let reach = 2.0 * WHOLE * self.deviation;
        let mut mended = None;
        for (joint, frames) in &self.of_joints {
            // A flip is between two frames.
            let distances = frames
                .iter()
                .map(|&flip| (frame as f64 - flip as f64 + 0.5).abs());
            let distance = distances.fold(f64::INFINITY, f64::min);
            if distance >= reach {
                continue;
            }
            let pose: &mut Pose = mended.get_or_insert_with(|| motion.frames[frame].clone());
            let whole = WHOLE * self.deviation;
            let share = ((reach - distance) / (reach - whole)).clamp(0.0, 1.0);
            let share = share * share * (3.0 - 2.0 * share);
            let given = to_f64(&motion.frames[frame].rotations[*joint]);
            let mean = self.mean(motion, *joint, frame);
            let mixed = given.try_slerp(&mean, share, 1e-9).unwrap_or(mean);
            pose.rotations[*joint] = to_f32(&mixed);
        }
        mended
    }

    /// The mean of a joint's rotations around a frame.
    fn mean(&self, motion: &Motion, joint: usize, frame: usize) -> Rotation {
        let reach = (3.0 * self.deviation).floor() as usize;
        let last = motion.frames.len() - 1;
        let rotation = |frame: usize| to_f64(&motion.frames[frame].rotations[joint]).into_inner();
        let weight = |other: usize| {
            let distance = other.abs_diff(frame) as f64 / self.deviation;
            (-0.5 * distance * distance).exp()
        };
        let middle = rotation(frame);
        let mut sum = middle;
        let mut add_along = |frames: &mut dyn Iterator<Item = usize>| {
            let mut before = middle;
            for other in frames {
                let next = same_way(&before, rotation(other));
                sum += next * weight(other);
                before = next;
            }
        };
        add_along(&mut (frame.saturating_sub(reach)..frame).rev());
        add_along(&mut (frame + 1..=(frame + reach).min(last)));
        if sum.norm() > 1e-6 {
            Rotation::new_normalize(sum)
        } else {
            Rotation::new_normalize(middle)
        }
    }
}

/// The one of the two quaternions of a rotation to which `from` turns: by the shorter way, or of
/// two ways that are about as long by the one that passes nearer to rest.
fn same_way(from: &Quaternion<f64>, to: Quaternion<f64>) -> Quaternion<f64> {
    let along = from.dot(&to);
    let angle = 2.0 * along.abs().min(1.0).acos();
    let is_same = if angle > EITHER_WAY {
        // The rotation halfway is the sum or the difference; its real part is the nearness to rest.
        (from.w + to.w).abs() * (from - to).norm() >= (from.w - to.w).abs() * (from + to).norm()
    } else {
        along >= 0.0
    };
    if is_same { to } else { -to }
}

/// The median of the steps around one.
fn around(steps: &[f64], step: usize) -> f64 {
    let near = step.saturating_sub(COMPARED)..(step + COMPARED + 1).min(steps.len());
    let mut others: Vec<f64> = near
        .filter(|&other| other != step)
        .map(|other| steps[other])
        .collect();
    others.sort_by(f64::total_cmp);
    others.get(others.len() / 2).copied().unwrap_or(0.0)
}

/// The angle between two rotations, in radians, exact for small ones.
fn angle_between(from: &Rotation, to: &Rotation) -> f64 {
    let turn = from.inverse() * to;
    2.0 * turn.vector().norm().atan2(turn.w.abs())
}

#[cfg(test)]
mod tests {
    use garnet_skin::{Joint, Point3, Skeleton};
    use nalgebra::{UnitQuaternion, Vector3};

    use super::*;

    fn motion(angles: impl Iterator<Item = f32>) -> Motion {
        let joint = Joint {
            name: "hip".to_owned(),
            parent: None,
            rest_position: Point3::origin(),
        };
        let frames = angles.map(|angle| Pose {
            root_translation: Vector3::zeros(),
            rotations: vec![UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angle)],
        });
        Motion {
            skeleton: Skeleton::new(vec![joint]).unwrap(),
            frames: frames.collect(),
            frame_time: Some(1.0 / 60.0),
            notes: Vec::new(),
        }
    }

    fn largest_step(motion: &Motion, flips: &Flips) -> f64 {
        let frames = 0..motion.frames.len();
        let poses: Vec<Pose> = frames
            .map(|frame| {
                let given = || motion.frames[frame].clone();
                flips.mended(motion, frame).unwrap_or_else(given)
            })
            .collect();
        let steps = poses.windows(2).map(|pair| {
            let [from, to] = [0, 1].map(|end| to_f64(&pair[end].rotations[0]));
            angle_between(&from, &to)
        });
        steps.fold(0.0, f64::max)
    }

    #[test]
    fn what_turns_over_in_a_frame_turns_within_a_fifth_of_a_second() {
        let turned = |frame: usize| {
            if (20..24).contains(&frame) || frame > 30 {
                3.1
            } else {
                0.0
            }
        };
        let motion = motion((0..60).map(|frame| 0.02 * frame as f32 + turned(frame)));
        let flips = Flips::find(&motion);
        assert_eq!(flips.of_joints, [(0, vec![20, 24, 31])]);
        assert!(flips.note(&motion).unwrap().contains("3 times"));
        let step = largest_step(&motion, &flips);
        assert!(step < 0.65, "{step}");
        // Far from them nothing changes.
        assert!(flips.mended(&motion, 2).is_none());
        assert!(flips.mended(&motion, 50).is_none());
    }

    #[test]
    fn a_spike_of_one_frame_goes() {
        let motion = motion((0..40).map(|frame| if frame == 20 { 2.0 } else { 0.1 }));
        let flips = Flips::find(&motion);
        assert_eq!(flips.of_joints, [(0, vec![20, 21])]);
        assert!(largest_step(&motion, &flips) < 0.2);
    }

    #[test]
    fn fast_motion_is_none() {
        // A whirl of 24 radians a second, and a throw: 1.1 radians a frame, for four frames.
        let whirl = motion((0..60).map(|frame| 0.4 * frame as f32));
        let throw = motion((0..60).map(|frame: i32| 1.1 * (frame - 30).clamp(0, 4) as f32));
        for motion in [whirl, throw] {
            let flips = Flips::find(&motion);
            assert!(flips.of_joints.is_empty(), "{:?}", flips.of_joints);
            assert!(flips.note(&motion).is_none() && flips.mended(&motion, 32).is_none());
        }
    }
}
