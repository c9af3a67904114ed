//! The moments of a drape, and how cloth is simulated on from each.

use serde::{Deserialize, Serialize};

use crate::schedule::{LAST_RATE, RARELY, SHAKEN, TEACHER_FRAMES};

/// Where cloth is on its way from the body at rest to its drape.
///
/// Networks predict where it is at one of these moments, data sets are simulated until one of them,
/// and the simulator [goes on](crate::Schedule::after) from any. Later moments are greater.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Moment {
    /// It lies on the body at rest: the whole motion is still to be simulated.
    Start,
    /// The body is halfway, in time and, as it starts as gently as it stops, on its path
    /// ([`Drape::midway`](crate::Drape::midway)): the second half of the motion is still to be
    /// simulated.
    Midway,
    /// The body has come to its last place ([`Drape::arrived`](crate::Drape::arrived)): until then
    /// the cloth follows the body, and its folds are still to be found.
    Arrival,
    /// It falls into its folds: [most of the way](FALLEN) on a line from where it is at the arrival
    /// to where it rests.
    Falling,
    /// It rests.
    #[default]
    Rest,
}

/// The share of the way from the arrival to rest that cloth has behind it when it is
/// [`Moment::Falling`].
///
/// More of it leaves less to simulate, and more of the predicted folds, which are blurred. Tried: 0
/// to 1, best from 0.5 to 0.8, less the more frames follow (docs/experiments/005-fallen-share.md).
pub const FALLEN: f32 = 0.8;

/// How cloth is simulated on from a moment: a row of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Continuation {
    /// The share of the motion that the body has behind it.
    pub(crate) motion_share: f32,
    /// For how many frames of a sixtieth of a second the cloth settles by default, after the motion
    /// if there is any left. More take longer and end nearer to the teacher.
    pub(crate) frames: u32,
    /// How many frames are simulated as one, at most. Contacts are looked for
    /// [`refreshes`](Self::refreshes) times in each: more cost less and miss more.
    pub(crate) at_once: u32,
    /// The same of cloth that a network predicts: at rest it lies where it rests but for
    /// millimetres. More take less time, and more of the cloth crosses itself
    /// (docs/experiments/087-long-frames-at-rest.md).
    pub(crate) predicted_at_once: u32,
    /// `[rate, drag, friction]` of each stage: substeps a second for each metre of 1/Δx, more for
    /// stiffer cloth; velocity lost beyond that to the air in 1/s, more for cloth that swings less
    /// and falls slower; and the share of the friction on skin, less for cloth that slides to where
    /// it hangs.
    pub(crate) stages: &'static [[f32; 3]],
    /// [`Schedule::over_relaxation`](crate::Schedule::over_relaxation): above 1 for stiffer cloth
    /// at the same rate.
    pub(crate) over_relaxation: f32,
    /// [`Schedule::length_share`](crate::Schedule::length_share): below 1 for cloth that sags less
    /// at the same rate.
    pub(crate) length_share: f32,
    /// Cloth near cloth is looked for at one of so many refreshes: more cost less, and cloth
    /// crosses itself more.
    pub(crate) pair_interval: u32,
    /// Hinges are projected once in so many substeps: more cost less and leave cloth softer.
    pub(crate) bending_interval: u32,
    /// Contacts are looked for so often in a frame.
    pub(crate) refreshes: u32,
    /// Whether the cloth lies about as it will in the end: on the skin that it lies on at rest.
    pub(crate) lies_near_rest: bool,
    /// Whether the cloth finds folds of its own; else it keeps most of those that it has.
    pub(crate) finds_folds: bool,
}

/// Stages of cloth whose folds are still to be found, as the teacher's but shorter.
///
/// Tried: a drag of 5 to 12 in the first and of 0 to 10 in the second, a rate of 45 to 54 in the
/// second (docs/experiments/002-settling-frames.md).
const FOLDING: &[[f32; 3]] = &[[34.0, 8.0, SHAKEN], [LAST_RATE, 0.0, 1.0]];

/// The rows, in the order of [`Moment`].
const TABLE: [Continuation; 5] = [
    // Start.
    Continuation {
        motion_share: 0.0,
        frames: 46,
        at_once: 2,
        predicted_at_once: 2,
        stages: FOLDING,
        over_relaxation: 1.0,
        length_share: 1.0,
        pair_interval: 1,
        bending_interval: RARELY,
        refreshes: 1,
        lies_near_rest: false,
        finds_folds: true,
    },
    // Midway. Tried: 24 to 60 frames, 1 or 2 refreshes (002-settling-frames).
    Continuation {
        motion_share: 0.5,
        frames: 46,
        at_once: 2,
        predicted_at_once: 2,
        stages: FOLDING,
        over_relaxation: 1.0,
        length_share: 1.0,
        pair_interval: 2,
        bending_interval: RARELY,
        refreshes: 2,
        lies_near_rest: false,
        finds_folds: true,
    },
    // Arrival. Tried: up to 60 frames.
    Continuation {
        motion_share: 1.0,
        frames: 30,
        at_once: 1,
        predicted_at_once: 1,
        stages: FOLDING,
        over_relaxation: 1.0,
        length_share: 1.0,
        pair_interval: 2,
        bending_interval: RARELY,
        refreshes: 1,
        lies_near_rest: false,
        finds_folds: true,
    },
    // Falling. Tried: frames of 2 to 3.5 sixtieths, rates of 18 to 45, drags of 5 to 30, an
    // over-relaxation of 1 to 1.2, pairs at each, every second and every fourth refresh
    // (001-falling-schedule).
    Continuation {
        motion_share: 1.0,
        frames: 6,
        at_once: 3,
        predicted_at_once: 3,
        stages: &[[20.0, 10.0, 1.0], [28.0, 25.0, 1.0]],
        over_relaxation: 1.2,
        length_share: 0.995,
        pair_interval: 2,
        bending_interval: RARELY,
        refreshes: 1,
        lies_near_rest: true,
        finds_folds: true,
    },
    // Rest. Tried: rates of 17 to 40, drags of 30 and 60, up to 12 frames (002-settling-frames).
    Continuation {
        motion_share: 1.0,
        frames: 6,
        at_once: 1,
        predicted_at_once: 3,
        stages: &[[40.0, 60.0, SHAKEN]],
        over_relaxation: 1.0,
        length_share: 1.0,
        pair_interval: 2,
        bending_interval: 2,
        refreshes: 1,
        lies_near_rest: true,
        finds_folds: false,
    },
];

impl Moment {
    /// All moments, the earliest first.
    pub const ALL: [Self; 5] = [
        Self::Start,
        Self::Midway,
        Self::Arrival,
        Self::Falling,
        Self::Rest,
    ];

    /// The name in files and messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Midway => "midway",
            Self::Arrival => "arrival",
            Self::Falling => "falling",
            Self::Rest => "rest",
        }
    }

    /// How cloth is simulated on from here.
    pub(crate) const fn continuation(self) -> &'static Continuation {
        &TABLE[self as usize]
    }

    /// Whether it is the last one, when there is nothing left to simulate.
    pub fn is_rest(&self) -> bool {
        *self == Self::Rest
    }

    /// Whether the body is still on its way.
    pub fn is_on_way(self) -> bool {
        self < Self::Arrival
    }

    /// The share of the motion that the body has behind it, from 0 to 1.
    pub const fn motion_share(self) -> f32 {
        self.continuation().motion_share
    }

    /// How many frames of a sixtieth of a second of the motion are still to be simulated.
    pub fn motion_frames(self) -> u32 {
        frames_left(TEACHER_FRAMES[0], self.motion_share())
    }

    /// For how many frames of a sixtieth of a second cloth settles by default, after the motion if
    /// there is any left.
    pub const fn settle_frames(self) -> u32 {
        self.continuation().frames
    }

    /// How many of these frames are simulated as one by default, at most.
    pub const fn frames_at_once(self) -> u32 {
        self.continuation().at_once
    }

    /// The same of cloth that a network predicts.
    pub const fn predicted_frames_at_once(self) -> u32 {
        self.continuation().predicted_at_once
    }

    /// Whether the cloth lies about as it will in the end: on the skin that it lies on at rest.
    pub const fn lies_near_rest(self) -> bool {
        self.continuation().lies_near_rest
    }

    /// Whether cloth that is simulated on from here finds folds of its own; else it keeps most of
    /// those that it has, and some of their strain.
    pub const fn finds_folds(self) -> bool {
        self.continuation().finds_folds
    }
}

/// How many of so many frames of the motion come after a share of it.
pub(crate) fn frames_left(frames: u32, share: f32) -> u32 {
    frames - (share * frames as f32).round() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn later_moments_have_less_of_the_motion_before_them() {
        let frames = Moment::ALL.map(Moment::motion_frames);
        assert_eq!(frames, [60, 30, 0, 0, 0]);
        assert!(Moment::ALL.is_sorted());
        assert_eq!(
            Moment::ALL.map(Moment::is_on_way),
            frames.map(|frames| frames > 0)
        );
    }

    #[test]
    fn moments_have_the_names_that_files_have() {
        for (moment, row) in Moment::ALL.into_iter().zip(&TABLE) {
            let text = serde_json::to_string(&moment).unwrap();
            assert_eq!(text, format!("\"{}\"", moment.name()));
            assert_eq!(serde_json::from_str::<Moment>(&text).unwrap(), moment);
            assert_eq!(moment.continuation(), row);
        }
    }
}
