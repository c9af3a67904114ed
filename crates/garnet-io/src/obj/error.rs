//! What can be wrong with an OBJ file.

use std::{io, path::PathBuf};

use garnet_mesh::{MAX_COORDINATE, MeshError, WriteError};

/// Why an OBJ file could not be read or written.
///
/// The text says which file; [`std::error::Error::source`] says why, with the line where there is
/// one.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ObjError {
    /// The file cannot be read from disk.
    #[error("cannot read `{}`", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The file is not an OBJ mesh.
    #[error("cannot read `{}`", path.display())]
    Parse {
        /// The file, or the name given with the bytes.
        path: PathBuf,
        /// What is wrong in it.
        source: ObjParseError,
    },
    /// New positions do not fit the vertices of the file.
    #[error("cannot place the vertices of `{}`", path.display())]
    Positions {
        /// The file that was read.
        path: PathBuf,
        /// How they do not fit.
        source: MeshError,
    },
    /// The output cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// What is wrong with the bytes of an OBJ file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ObjParseError {
    /// There is nothing in it.
    #[error("the file is empty")]
    Empty,
    /// Offsets in it do not fit 32 bits.
    #[error("the file has {num_bytes} bytes, more than the {most} that an OBJ may have here")]
    TooLarge {
        /// Its size, in bytes.
        num_bytes: u64,
        /// The most that is read, in bytes: less of a pipe than of a file.
        most: u64,
    },
    /// It is another kind of file.
    #[error("the file is not an OBJ mesh, it looks like {looks_like}")]
    NotObj {
        /// The kind, with its article: `a GLB model`.
        looks_like: &'static str,
    },
    /// It has no `v` line.
    #[error("the file has no vertices (no line that starts with `v`)")]
    NoVertices,
    /// It has no `f` line.
    #[error("the file has no faces (no line that starts with `f`)")]
    NoFaces,
    /// A line is wrong.
    #[error("line {line}: {problem}")]
    Line {
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong with it.
        problem: ObjLineProblem,
    },
    /// tobj refuses the file although every line looks right.
    #[error("the OBJ parser refuses the file")]
    Refused {
        /// What tobj says.
        source: tobj::LoadError,
    },
    /// tobj and the scan of the lines read different meshes.
    #[error("the OBJ parser read {found} face corners where the file has {expected}")]
    CornersDiffer {
        /// Face corners by tobj that agree with the file.
        found: usize,
        /// Face corners of the file.
        expected: usize,
    },
}

/// What is wrong with a line of an OBJ file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ObjLineProblem {
    /// A `v` line has fewer than three numbers.
    #[error("a vertex needs 3 coordinates, found {found}")]
    TooFewCoordinates {
        /// How many there are.
        found: usize,
    },
    /// A coordinate is no number.
    #[error("vertex coordinate `{text}` is not a number")]
    CoordinateNotANumber {
        /// The coordinate as written.
        text: String,
    },
    /// A coordinate is NaN, or beyond [`MAX_COORDINATE`].
    #[error("vertex coordinate `{text}` is not finite or beyond {MAX_COORDINATE}")]
    CoordinateOutOfRange {
        /// The coordinate as written.
        text: String,
    },
    /// The fourth number of a `v` line, which divides the coordinates, is of no use.
    #[error("vertex weight `{text}` is not a number other than zero")]
    BadWeight {
        /// The weight as written.
        text: String,
    },
    /// An `f` line has fewer than three corners.
    #[error("a face needs at least 3 corners, found {found}")]
    TooFewCorners {
        /// How many there are.
        found: usize,
    },
    /// A corner is not of the form `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    #[error("face corner `{text}` is not `v`, `v/vt`, `v//vn` or `v/vt/vn`")]
    BadCorner {
        /// The corner as written.
        text: String,
    },
    /// A corner names number 0; OBJ counts from 1.
    #[error("face corner `{text}` names {element} 0, but they are numbered from 1")]
    IndexZero {
        /// The corner as written.
        text: String,
        /// What it names.
        element: ObjElement,
    },
    /// A corner names something that does not exist.
    #[error("face corner `{text}` names {element} {index}, but there are {available}")]
    IndexOutOfRange {
        /// The corner as written.
        text: String,
        /// What it names.
        element: ObjElement,
        /// The number as written: from 1, or negative and counted back from the line.
        index: i64,
        /// How many exist in the file, or before the line for a negative number.
        available: usize,
    },
}

/// What a number of a face corner names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ObjElement {
    /// A `v` line.
    Vertex,
    /// A `vt` line.
    TextureVertex,
    /// A `vn` line.
    Normal,
}

impl std::fmt::Display for ObjElement {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(match self {
            Self::Vertex => "vertex",
            Self::TextureVertex => "texture vertex",
            Self::Normal => "normal",
        })
    }
}
