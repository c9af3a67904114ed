//! Why a motion cannot be read or carried over.

use std::{io, path::PathBuf};

use garnet_skin::{FileProblem, SkinError};

/// A motion file that cannot be read.
///
/// The text says which file; [`std::error::Error::source`] says why, with the line where there is
/// one.
#[derive(Debug, thiserror::Error)]
#[error("cannot read `{}`", path.display())]
pub struct MotionError {
    /// The file.
    pub path: PathBuf,
    /// Why it cannot be read.
    #[source]
    pub problem: MotionProblem,
}

/// What is wrong with a motion file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MotionProblem {
    /// The system refuses.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The content is none of the known formats.
    #[error("the file is no motion (BVH, npz with `poses`, or pose JSON)")]
    UnknownFormat,
    /// A word stands where another is expected.
    #[error("line {line}: found `{found}`, expected {expected}")]
    Unexpected {
        /// Line, from 1.
        line: usize,
        /// The word.
        found: String,
        /// What may stand there.
        expected: &'static str,
    },
    /// The file ends too early.
    #[error("line {line}: the file ends here, expected {expected}")]
    Ends {
        /// The last line, from 1.
        line: usize,
        /// What should follow.
        expected: &'static str,
    },
    /// A row of numbers has another length.
    #[error("line {line}: {found} numbers, expected {expected}, one for each channel")]
    RowLength {
        /// Line, from 1.
        line: usize,
        /// How many there are.
        found: usize,
        /// How many channels the skeleton has.
        expected: usize,
    },
    /// The file has another number of frames than it says.
    #[error("line {line}: {found} frames, expected {expected} as `Frames:` says")]
    FrameCount {
        /// The last line, from 1.
        line: usize,
        /// How many there are.
        found: usize,
        /// How many were announced.
        expected: usize,
    },
    /// The skeleton goes on and on.
    #[error("line {line}: more than {limit} joints or levels of joints")]
    TooDeep {
        /// Line, from 1.
        line: usize,
        /// The largest number.
        limit: usize,
    },
    /// An axis-angle vector or a shift is no number.
    #[error("frame {frame}: a value of `{key}` is not finite")]
    NonFinite {
        /// The frame, from 0.
        frame: usize,
        /// The key.
        key: &'static str,
    },
    /// There is no frame.
    #[error("there is no frame")]
    NoFrames,
    /// The skeleton or a pose is impossible.
    #[error(transparent)]
    Skin(#[from] SkinError),
    /// The JSON does not parse.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// The npz archive is damaged, or one of its arrays wrong.
    #[error(transparent)]
    File(Box<FileProblem>),
}

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
    /// A pose is impossible.
    #[error(transparent)]
    Skin(#[from] SkinError),
}

impl RetargetError {
    /// Whether the skeleton of a body is at fault, and not that of a motion.
    pub fn is_of_body(&self) -> bool {
        match self {
            Self::MissingJoints { whose, .. }
            | Self::Apart { whose, .. }
            | Self::NoLegs { whose } => *whose != THE_MOTION,
            Self::FrameOutOfRange { .. } | Self::NoFrames { .. } | Self::Skin(_) => false,
        }
    }
}

/// Whose skeleton is that of a motion.
pub(super) const THE_MOTION: &str = "the motion";

/// A text that is no range of frames.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{text}` is no range of frames; expected `FRAME` or `FIRST:END[:STEP]`, counted from 0, \
     without the frame END, STEP at least 1"
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
