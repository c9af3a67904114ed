//! Why a motion cannot be carried over.

use garnet_skin::SkinError;

/// Why a motion or a pose cannot be carried over to a skeleton.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RetargetError {
    /// A skeleton lacks joints that a human figure must have.
    #[error(
        "{whose} has no joint that is named like {}; its joints are {}",
        list(missing),
        list(found)
    )]
    MissingJoints {
        /// `the motion` or `the body`.
        whose: &'static str,
        /// The joints that are missing.
        missing: Vec<&'static str>,
        /// The joints that were found: what they are, and their names.
        mapped: Vec<(&'static str, String)>,
        /// Names that are there, the first of them if there are many.
        found: Vec<String>,
    },
    /// Two joints that should hang on one tree do not.
    #[error("{whose} has no joint that both `{a}` and `{b}` hang on")]
    Apart {
        /// `the motion` or `the body`.
        whose: &'static str,
        /// One joint.
        a: String,
        /// The other.
        b: String,
    },
    /// The bones of the legs have no length.
    #[error("the legs of {whose} have no length")]
    NoLegs {
        /// `the motion` or `the body`.
        whose: &'static str,
    },
    /// With all angles zero, legs and trunk point the same way: how joints are turned at rest is
    /// not told.
    #[error(
        "the zero pose of the motion is no standing figure: its legs and its trunk point the same way"
    )]
    Folded,
    /// A frame is not there.
    #[error("frame {frame} was asked for, but there are {num_frames} (counted from 0)")]
    FrameOutOfRange {
        /// The frame, from 0.
        frame: usize,
        /// How many frames there are.
        num_frames: usize,
    },
    /// The range holds no frame.
    #[error("the range of frames `{range}` holds none of the {num_frames} frames")]
    NoFrames {
        /// The range.
        range: String,
        /// How many frames there are.
        num_frames: usize,
    },
    /// Seconds were asked for, and the motion does not tell how long its frames take.
    #[error("`{range}` needs the time from frame to frame, which the motion does not tell")]
    NoFrameTime {
        /// The range.
        range: String,
    },
    /// A step was asked for where the motion is played anew at another rate.
    #[error(
        "the range of frames `{range}` has a step, and another number of frames a second is asked for"
    )]
    StepOfSamples {
        /// The range.
        range: String,
    },
    /// A pose is impossible.
    #[error(transparent)]
    Skin(#[from] SkinError),
}

impl RetargetError {
    /// What was found of a skeleton that lacks joints, as the text of a map for `--joints`, with
    /// `?` where a joint is missing.
    pub fn joint_map(&self) -> Option<String> {
        let Self::MissingJoints {
            missing, mapped, ..
        } = self
        else {
            return None;
        };
        let missing = missing.iter().map(|role| (*role, "?"));
        let mapped = mapped.iter().map(|(role, name)| (*role, name.as_str()));
        let entries = missing.chain(mapped);
        let entries: Vec<String> = entries
            .map(|(role, name)| format!("{role:?}: {name:?}"))
            .collect();
        Some(format!("{{{}}}", entries.join(", ")))
    }

    /// Whether the skeleton of a body is at fault, and not that of a motion.
    pub fn is_of_body(&self) -> bool {
        match self {
            Self::MissingJoints { whose, .. }
            | Self::Apart { whose, .. }
            | Self::NoLegs { whose } => *whose != THE_MOTION,
            Self::FrameOutOfRange { .. }
            | Self::NoFrames { .. }
            | Self::NoFrameTime { .. }
            | Self::StepOfSamples { .. }
            | Self::Folded
            | Self::Skin(_) => false,
        }
    }
}

/// Whose skeleton is that of a motion.
pub(super) const THE_MOTION: &str = "the motion";

/// A text that is no range of frames.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{text}` is no range of frames; expected `FRAME` or `FIRST:END[:STEP]`, counted from 0, \
     without the frame END, STEP at least 1; or seconds, as in `1.5s:3s`"
)]
pub struct FrameRangeError {
    /// The text.
    pub text: String,
}

fn list<T: AsRef<str>>(names: &[T]) -> String {
    let quoted: Vec<String> = names
        .iter()
        .map(|name| format!("`{}`", name.as_ref()))
        .collect();
    quoted.join(", ")
}
