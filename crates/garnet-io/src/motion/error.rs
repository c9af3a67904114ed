//! Why a motion cannot be read.

use std::{io, path::PathBuf};

use garnet_skin::SkinError;

use crate::FileProblem;

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
    #[error("the file is no motion (BVH, npz with `poses`, GLB with an animation, or pose JSON)")]
    UnknownFormat,
    /// A clip is named of a file that has none.
    #[error("the file has no clips, and `{clip}` is named")]
    NoClips {
        /// The name.
        clip: String,
    },
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
    /// A body is beyond all coordinates.
    #[error("frame {frame}: `{key}` has {value:e}, which is farther than 900 km from the origin")]
    TooFar {
        /// The frame, from 0.
        frame: usize,
        /// The key.
        key: &'static str,
        /// What it has, in metres.
        value: f32,
    },
    /// A matrix is no rotation.
    #[error(
        "frame {frame}, joint {joint}: what `{key}` has is no rotation: columns that are not unit \
         vectors at right angles, or a mirror image"
    )]
    NotARotation {
        /// The key.
        key: &'static str,
        /// The frame, from 0.
        frame: usize,
        /// The joint: its number, from 0, and its name.
        joint: String,
    },
    /// An axis-angle vector turns further than any joint does.
    #[error(
        "frame {frame}, joint {joint}: `{key}` turns by {radians:.1} radians, more than two whole turns"
    )]
    TurnsOverAndOver {
        /// The key.
        key: &'static str,
        /// The frame, from 0.
        frame: usize,
        /// The joint: its number, from 0, and its name.
        joint: String,
        /// The angle.
        radians: f64,
    },
    /// An angle is none: joints turn by a hundred turns at most.
    #[error("frame {frame}, joint {joint} turns by {degrees} degrees, more than a hundred turns")]
    NotAnAngle {
        /// The frame, from 0.
        frame: usize,
        /// The joint: its number, from 0, and its name.
        joint: String,
        /// The angle.
        degrees: f64,
    },
    /// Six numbers a joint may mean either of two rotations.
    #[error("`{key}` has six numbers a joint: two rows, or two columns, of a matrix")]
    RowsOrColumns {
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
