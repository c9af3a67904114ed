//! Schedules of cloth that something else has brought a part of the way.

use super::{
    FAST_FRAMES, LAST_RATE, MIDWAY, MIN_EDGE, PATCHES, Quality, RARELY, SHAKEN, Schedule, Stage,
    TEACHER_FRAMES,
};

/// Stages of [`Schedule::after_arrival`]: rate for each meter of 1/Δx, drag in 1/s, and friction.
///
/// 156 validation drapes of a T-shirt that networks put where the cloth is midway ([`Schedule::after_midway`]) end 1.98 mm and 3.59° from the teacher
/// after 46 frames, with a drag of 5 and 12 in the first stage at 2.08 and 2.05 mm (3.7°), of 5 in both at 2.15 mm, of 5 and 10 at 2.21 mm; after 30, 36 and 60
/// frames at 2.45, 2.18 and 1.86 mm, 4.4, 4.0 and 3.4°. At a rate of 45 in the last stage they ended 0.15 mm farther off (36 frames, a drag of 5 in the first).
const AFTER_ARRIVAL: [[f32; 3]; 2] = [[34.0, 8.0, SHAKEN], [LAST_RATE, 0.0, 1.0]];

/// For how many frames of a sixtieth of a second the first of two stages lasts at most.
///
/// With two thirds of all the drapes above end 2.62 mm from the teacher after 45 frames, 3.00 after 60, 2.43 after 30 (drags of 5 and 10): cloth
/// with a third of its friction slides on. With 10 of 46 frames they end at 2.91 mm (with 20 at 2.21; drags of 5 and 10), with 24 at 2.30 (with 20 at 2.15; of 5).
const SHAKEN_FRAMES: f32 = 20.0;

/// The share of all frames that it lasts at most.
const SHAKEN_SHARE: f32 = 2.0 / 3.0;

/// The stages of [`Schedule::while_falling`].
///
/// 155 test drapes of a T-shirt that networks put where it falls (those of 1,700 bodies) end 4.94 mm and 8.42° from the teacher's after 2 frames so; in
/// 2 frames of 3.5 sixtieths, at rates of 18 and 28 with drags of 16 and 30, at 4.93 mm and 8.29°, there at 23 in both stages at 4.99 mm, at 21 in both at 8.8°. After
/// 3 frames of 8/3 sixtieths, at rates of 22 and 36 (springs of 0.997 of their lengths, corrections times 1.15, drags of 16 and 25) they end at 4.57 mm and 8.04°; after 4
/// frames of 2, at rates of 28 and 45 with plain corrections and drags of 10 and 5, at 4.46 mm and 8.13°, in 1.8 times as many substeps.
const WHILE_FALLING: [[f32; 3]; 2] = [[20.0, 10.0, 1.0], [28.0, 25.0, 1.0]];

/// Frames of a sixtieth of a second in one of theirs, at most.
const FALLING_FRAME: f32 = 3.0;

/// Their [`Schedule::length_share`].
const FALLING_LENGTHS: f32 = 0.995;

/// Their [`Schedule::over_relaxation`].
const FALLING_OVER_RELAXATION: f32 = 1.2;

/// Their [`Schedule::pair_interval`]: at every second refresh they end 5.76 mm from the teacher's, at every fourth 5.77 mm (40 test drapes), and cross
/// themselves in 42 in place of 51 pairs of triangles (620); without looking for cloth on cloth they ended a fifth farther.
const FALLING_PAIR_INTERVAL: u32 = 2;

/// Cloth that settles is looked for near cloth at one of so many refreshes, if these are a sixtieth of a second apart: 4.56 and 4.55 mm after 8 frames.
const PAIRS_RARELY: u32 = 2;

/// Rate of [`Schedule::settling`] for each meter of 1/Δx, and what cloth loses of its velocity, 1/s.
///
/// On 155 drapes of a T-shirt by a pose-space deformation, 9.3 mm from the teacher (whose cloth still resisted compression), six frames at 30, 34, 40
/// bring them to 8.2, 7.8, 7.7 mm with a drag of 30; with one of 60 they are at 7.8 and 7.6 mm. 17 is too soft:
/// cloth sags, 14.5 mm after twelve frames.
const SETTLING: [f32; 2] = [40.0, 60.0];

impl Schedule {
    /// A short settling of cloth that something else has put where it belongs, but for its strain and finer
    /// folds, on a body that stands still.
    pub fn settling(edge_length: f32, frames: u32) -> Self {
        let [speed, extra_drag] = SETTLING;
        Self {
            motion_frames: 0,
            patches: PATCHES,
            pair_interval: PAIRS_RARELY,
            stages: vec![Stage {
                frames,
                rate: speed / edge_length.max(MIN_EDGE),
                extra_drag,
                friction: SHAKEN,
            }],
            ..Self::for_quality(Quality::Teacher, edge_length)
        }
    }

    /// The settling of cloth that something else has put where it is when the body comes to its last place
    /// ([`Drape::arrived`](crate::Drape::arrived)): as the teacher's, but so short that folds still move a little.
    pub fn after_arrival(edge_length: f32, frames: u32) -> Self {
        Self::by_table(&AFTER_ARRIVAL, edge_length, frames, 1.0)
    }

    /// The settling of cloth that something else has put most of the way from there to where it rests: `frames` of a
    /// sixtieth of a second, in a few longer ones: contacts are looked for at each.
    pub fn while_falling(edge_length: f32, frames: u32) -> Self {
        let number = (frames as f32 / FALLING_FRAME).ceil() as u32;
        let length = frames.max(1) as f32 / number.max(1) as f32;
        let schedule = Self::by_table(&WHILE_FALLING, edge_length, number, length);
        Self {
            length_share: FALLING_LENGTHS,
            over_relaxation: FALLING_OVER_RELAXATION,
            pair_interval: FALLING_PAIR_INTERVAL,
            ..schedule
        }
    }

    /// Two stages of so many frames in all, each `length` sixtieths of a second long.
    fn by_table(table: &[[f32; 3]; 2], edge_length: f32, frames: u32, length: f32) -> Self {
        let first = (SHAKEN_SHARE * frames as f32).round() as u32;
        let first = first.min((SHAKEN_FRAMES / length) as u32);
        let stage = |[speed, extra_drag, friction]: [f32; 3], frames: u32| Stage {
            frames,
            rate: speed / edge_length.max(MIN_EDGE),
            extra_drag,
            friction,
        };
        let whole = Self::for_quality(Quality::Teacher, edge_length);
        Self {
            motion_frames: 0,
            patches: PATCHES,
            frame_seconds: length * whole.frame_seconds,
            stages: vec![stage(table[0], first), stage(table[1], frames - first)],
            pair_interval: PAIRS_RARELY,
            bending_interval: RARELY,
            ..whole
        }
    }

    /// The second half of the motion, for cloth that something else has put where it is when the body is
    /// [midway](MIDWAY), and settling as [after the arrival](Schedule::after_arrival) for about so many frames of a
    /// sixtieth of a second. Contacts are looked for as often as by the teacher, cloth on cloth half as often.
    ///
    /// With cloth on cloth looked for as often as by the teacher 156 validation drapes of a T-shirt ended as near to it, with contacts looked for half as
    /// often, as in the [fast quality](Quality::Fast), a tenth farther off.
    pub fn after_midway(edge_length: f32, frames: u32) -> Self {
        let whole = Self::from_rest(edge_length, frames);
        Self {
            motion_frames: whole.motion_frames - whole.midway_frame(),
            motion_part: [MIDWAY, 1.0],
            refreshes_per_frame: 2,
            pair_interval: 2,
            ..whole
        }
    }

    /// The same for the whole motion of cloth on the body at rest.
    pub fn from_rest(edge_length: f32, frames: u32) -> Self {
        let length = TEACHER_FRAMES[0] / FAST_FRAMES[0];
        let frames = frames.div_ceil(length);
        Self {
            stages: Self::by_table(&AFTER_ARRIVAL, edge_length, frames, length as f32).stages,
            ..Self::for_quality(Quality::Fast, edge_length)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SimError;

    #[test]
    fn what_has_arrived_settles_for_as_many_frames_as_are_asked_for() {
        for frames in [0, 1, 2, 12, 30] {
            let schedule = Schedule::after_arrival(0.016, frames);
            assert_eq!(schedule.check(), Ok(()));
            assert_eq!(schedule.num_frames(), u64::from(frames));
        }
        let whole = Schedule::for_quality(Quality::Reference, 0.016);
        let until = whole.clone().until_arrival();
        assert_eq!(until.num_frames(), u64::from(whole.motion_frames));
        assert_eq!(until.motion_rate.to_bits(), whole.motion_rate.to_bits());
        assert_eq!(until.balance_steps, 0);
    }

    #[test]
    fn what_falls_settles_for_as_long_as_is_asked_for_in_few_frames() {
        for frames in [0, 1, 2, 3, 7, 8, 46] {
            let schedule = Schedule::while_falling(0.016, frames);
            assert_eq!(schedule.check(), Ok(()));
            assert!((60.0 * schedule.seconds() - frames as f32).abs() < 1e-3);
            let least = frames as f32 / FALLING_FRAME;
            let number = schedule.num_frames() as f32;
            assert!((least..least + 1.0).contains(&number), "{number}");
        }
    }

    #[test]
    fn the_motion_has_two_halves() {
        let [whole, fast] =
            [Quality::Teacher, Quality::Fast].map(|quality| Schedule::for_quality(quality, 0.016));
        let until = whole.clone().until_midway();
        assert_eq!(2 * until.num_frames(), u64::from(whole.motion_frames));
        assert_eq!(until.midway_frame(), until.motion_frames);
        assert_eq!(until.check(), Ok(()));
        for frames in [0, 1, 24, 25] {
            let after = Schedule::after_midway(0.016, frames);
            assert_eq!(after.check(), Ok(()));
            assert_eq!(2 * after.motion_frames, fast.motion_frames);
            let settling = after.num_frames() - u64::from(after.motion_frames);
            assert_eq!(settling, u64::from(frames.div_ceil(2)));
            assert_eq!(after.midway_frame(), 0);
        }
        let nothing = Schedule {
            motion_part: [MIDWAY, MIDWAY],
            ..fast
        };
        assert!(matches!(nothing.check(), Err(SimError::Schedule { .. })));
    }
}
