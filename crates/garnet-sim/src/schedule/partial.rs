//! Schedules that end at a moment, or begin at one.

use super::{PATCHES, Quality, Schedule, Stage, rate};
use crate::moment::{Moment, frames_left};

/// For how many sixtieths of a second all stages but the last last at most, and for which share of
/// the frames.
///
/// They find the folds, with little friction: too short, cloth keeps the strain of the way there;
/// too long, it slides on. Tried: 10 to 24 sixtieths, and two thirds of all without a limit
/// (docs/experiments/002-settling-frames.md).
const FOLDING_FRAMES: f32 = 20.0;

/// The other half of [`FOLDING_FRAMES`].
const FOLDING_SHARE: f32 = 2.0 / 3.0;

/// For how long cloth settles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SettleFrames {
    /// For about how many frames of a sixtieth of a second.
    pub count: u32,
    /// How many of them are simulated as one, at most.
    pub at_once: u32,
}

impl Schedule {
    /// The same up to a moment. Cloth that is [falling](Moment::Falling) is no state of a
    /// simulation: it is found between its arrival and rest, so the schedule is the whole one.
    #[must_use]
    pub fn until(self, moment: Moment) -> Self {
        let motion_frames = match moment {
            Moment::Falling | Moment::Rest => return self,
            Moment::Arrival => self.motion_frames,
            Moment::Start => 0,
            Moment::Midway => self.midway_frame(),
        };
        let to = match moment {
            Moment::Midway => moment.motion_share(),
            _ => self.motion_part[1],
        };
        Self {
            motion_frames,
            motion_part: [self.motion_part[0], to],
            stages: Vec::new(),
            balance_steps: 0,
            ..self
        }
    }

    /// The rest of the motion, and settling, for cloth that something else has put where it is at a
    /// moment: a few times faster than the teacher.
    ///
    /// # Examples
    ///
    /// ```
    /// use garnet_sim::{Moment, Schedule, SettleFrames};
    ///
    /// let moment = Moment::Midway;
    /// let frames = SettleFrames {
    ///     count: moment.settle_frames(),
    ///     at_once: moment.frames_at_once(),
    /// };
    /// let schedule = Schedule::after(moment, 0.016, frames);
    /// assert_eq!(schedule.motion_part, [0.5, 1.0]);
    /// ```
    pub fn after(moment: Moment, edge_length: f32, frames: SettleFrames) -> Self {
        let row = moment.continuation();
        let whole = Self::for_quality(Quality::Teacher, edge_length);
        let at_once = frames.at_once.max(1);
        let mut left = frames.count.div_ceil(at_once);
        // The last frames are as long as those of the motion, if there is any; else all are as much
        // shorter as fits.
        let length = if moment.is_on_way() {
            at_once as f32
        } else {
            frames.count.max(1) as f32 / left.max(1) as f32
        };
        let last = row.stages.len() - 1;
        let mut stages = Vec::with_capacity(row.stages.len());
        for (number, &[speed, extra_drag, friction]) in row.stages.iter().enumerate() {
            let frames = if number < last {
                let share = (FOLDING_SHARE * left as f32).round() as u32;
                share.min((FOLDING_FRAMES / length) as u32)
            } else {
                left
            };
            left -= frames;
            stages.push(Stage {
                frames,
                rate: rate(speed, edge_length),
                extra_drag,
                friction,
            });
        }
        let motion_frames = frames_left(whole.motion_frames / at_once, row.motion_share);
        Self {
            frame_seconds: length * whole.frame_seconds,
            motion_frames,
            motion_part: match motion_frames {
                0 => whole.motion_part,
                _ => [row.motion_share, 1.0],
            },
            stages,
            refreshes_per_frame: row.refreshes,
            // As often in a second, if frames are longer.
            pair_interval: (row.pair_interval * row.at_once / at_once).max(1),
            bending_interval: row.bending_interval,
            patches: PATCHES,
            length_share: row.length_share,
            over_relaxation: row.over_relaxation,
            ..whole
        }
    }

    /// At the end of which frame the body is midway; 0 if it is so from the start, or never.
    pub(crate) fn midway_frame(&self) -> u32 {
        let [from, to] = self.motion_part;
        let share = (Moment::Midway.motion_share() - from) / (to - from);
        (share * self.motion_frames as f32).round() as u32
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use super::*;
    use crate::SimError;

    fn after(moment: Moment, edge_length: f32, count: u32) -> Schedule {
        let at_once = moment.frames_at_once();
        Schedule::after(moment, edge_length, SettleFrames { count, at_once })
    }

    #[test]
    fn schedules_after_each_moment_are_those_that_networks_were_measured_with() {
        let mut found = String::new();
        for moment in Moment::ALL {
            for frames in [0, moment.settle_frames(), 25] {
                let schedule = after(moment, 0.0151, frames);
                writeln!(found, "{} {frames} {schedule:?}", moment.name()).unwrap();
            }
        }
        assert_eq!(found, include_str!("../../tests/data/schedules.txt"));
    }

    #[test]
    fn cloth_settles_for_as_long_as_is_asked_for() {
        for moment in Moment::ALL {
            for frames in [0, 1, 2, 3, 7, 8, 12, 24, 30, 46] {
                let schedule = after(moment, 0.016, frames);
                assert_eq!(schedule.check(), Ok(()));
                let asked = (frames + moment.motion_frames()) as f32;
                let found = 60.0 * schedule.seconds();
                let more = if moment.is_on_way() { 1.0 } else { 0.0 };
                assert!(
                    (-1e-3..more + 1e-3).contains(&(found - asked)),
                    "{moment:?} {found} {asked}"
                );
            }
        }
    }

    #[test]
    fn what_falls_settles_in_few_frames() {
        for frames in [0, 1, 2, 3, 7, 8, 46] {
            let schedule = after(Moment::Falling, 0.016, frames);
            assert_eq!(schedule.num_frames(), u64::from(frames.div_ceil(3)));
        }
    }

    #[test]
    fn long_frames_are_fewer_and_cloth_near_cloth_is_looked_for_as_often() {
        let [short, long] = [1, 3].map(|at_once| {
            Schedule::after(Moment::Rest, 0.016, SettleFrames { count: 6, at_once })
        });
        assert_eq!([short.num_frames(), long.num_frames()], [6, 2]);
        assert!((short.seconds() - long.seconds()).abs() < 1e-6);
        assert_eq!([short.pair_interval, long.pair_interval], [2, 1]);
        assert_eq!(short.stages.len(), 1);
        assert!((short.stages[0].rate - long.stages[0].rate).abs() < 1e-3);
    }

    #[test]
    fn the_motion_has_two_halves() {
        let whole = Schedule::for_quality(Quality::Teacher, 0.016);
        let until = whole.clone().until(Moment::Midway);
        assert_eq!(2 * until.num_frames(), u64::from(whole.motion_frames));
        assert_eq!(until.midway_frame(), until.motion_frames);
        assert_eq!(until.check(), Ok(()));
        let after = after(Moment::Midway, 0.016, 24);
        assert_eq!(after.midway_frame(), 0);
        let nothing = Schedule {
            motion_part: [0.5, 0.5],
            ..whole
        };
        assert!(matches!(nothing.check(), Err(SimError::Schedule { .. })));
    }

    #[test]
    fn a_schedule_ends_where_it_is_to() {
        let whole = Schedule::for_quality(Quality::Reference, 0.016);
        let until = whole.clone().until(Moment::Arrival);
        assert_eq!(until.num_frames(), u64::from(whole.motion_frames));
        assert_eq!(until.motion_rate.to_bits(), whole.motion_rate.to_bits());
        assert_eq!(until.balance_steps, 0);
        assert_eq!(whole.clone().until(Moment::Rest), whole);
        assert_eq!(whole.clone().until(Moment::Falling), whole);
        let nothing = whole.until(Moment::Start);
        assert_eq!((nothing.num_frames(), nothing.check()), (0, Ok(())));
    }
}
