//! Why a rig, pose or scene file cannot be read.

use std::{io, path::PathBuf};

use garnet_mesh::MeshError;
use garnet_skin::SkinError;

use crate::{gltf::GltfProblem, npy::ArrayProblem, obj::ObjError};

/// A rig, pose or scene file that cannot be read.
///
/// The text says which file; [`std::error::Error::source`] says why, with key, line and column
/// where there are any.
#[derive(Debug, thiserror::Error)]
#[error("cannot read `{}`", path.display())]
pub struct FileError {
    /// The file.
    pub path: PathBuf,
    /// Why it cannot be read.
    #[source]
    pub problem: FileProblem,
}

/// What is wrong with a rig, pose or scene file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileProblem {
    /// The system refuses.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// There is nothing in the file.
    #[error("the file is empty")]
    Empty,
    /// The file is a pickle, an archive of objects of Python.
    #[error("the file is a pickle of Python, which is not read")]
    Pickle,
    /// The content is none of the known formats.
    #[error("the file is no rig (npz, GLB, glTF, rig JSON or `drape-scene/1` JSON)")]
    UnknownFormat,
    /// The JSON does not parse, or a field is missing or of the wrong type.
    #[error("line {line}, column {column}: {reason}")]
    Json {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What the parser expected and found.
        reason: String,
    },
    /// A field has a value that has no meaning here.
    #[error("`{field}` is `{found}`, expected {expected}")]
    Field {
        /// The field.
        field: String,
        /// Its value.
        found: String,
        /// What it may be.
        expected: &'static str,
    },
    /// Two lists that belong together differ in length.
    #[error("`{field}` has {found} entries, expected {expected}")]
    ListLength {
        /// The list.
        field: String,
        /// Its length.
        found: usize,
        /// The length that fits the rest of the file.
        expected: usize,
    },
    /// A pose names a joint that the skeleton does not have.
    #[error("the skeleton has no joint `{name}`{}", near_names(near))]
    UnknownJointName {
        /// The name.
        name: String,
        /// Names of the skeleton that resemble it, the nearest first.
        near: Vec<String>,
    },
    /// A mesh is chosen in a file that has one alone.
    #[error("the file has one mesh without a name, and `{name}` is chosen")]
    NoMeshes {
        /// The name.
        name: String,
    },
    /// A map of joints calls a joint what it cannot be.
    #[error("`{role}` cannot be `{name}`, which {reason}")]
    JointRole {
        /// What it is called.
        role: String,
        /// The joint.
        name: String,
        /// Why not.
        reason: String,
    },
    /// A map of joints calls one joint by two names.
    #[error("it calls `{name}` both `{first}` and `{second}`, and a joint is one of them")]
    JointNamedTwice {
        /// The joint.
        name: String,
        /// What it is called.
        first: String,
        /// What it is called, too.
        second: String,
    },
    /// A rotation is no unit quaternion.
    #[error("the rotation of joint `{joint}` has the norm {norm}, expected 1")]
    NotAUnitQuaternion {
        /// The joint.
        joint: String,
        /// Norm of the quaternion.
        norm: f64,
    },
    /// The file has fewer frames than were asked for.
    #[error("frame {frame} was asked for, but there are {num_frames} (counted from 0)")]
    FrameOutOfRange {
        /// The frame, from 0.
        frame: usize,
        /// How many frames the file has.
        num_frames: usize,
    },
    /// A pose file holds no pose.
    #[error("the file holds no pose: neither `joints` nor `local_rotation_xyzw` nor `frames`")]
    NoPose,
    /// A pose is told in several ways.
    #[error("the pose is told in several ways: {}", fields.join(", "))]
    SeveralPoses {
        /// The fields that tell it.
        fields: Vec<&'static str>,
    },
    /// Transforms of joints are no pose: they pull joints apart.
    #[error("the transforms pull joints apart, by up to {residual} m")]
    NotRotated {
        /// How far a joint is from where the rotations have it, in metres.
        residual: f64,
    },
    /// A file that this file names is not there.
    #[error("{role} `{}` is not there", path.display())]
    MissingFile {
        /// What it is for.
        role: &'static str,
        /// Where it was looked for.
        path: PathBuf,
    },
    /// Keys of an npz archive are missing.
    #[error("missing {}; found {}", key_list(missing), key_list(found))]
    MissingKeys {
        /// The keys that are missing.
        missing: Vec<String>,
        /// The keys that are there.
        found: Vec<String>,
    },
    /// The file is no zip archive, or a damaged one.
    #[error("the file is no sound npz (zip) archive")]
    Archive(#[source] zip::result::ZipError),
    /// An array of an npz archive is wrong.
    #[error("key `{key}`: {problem}")]
    Array {
        /// The key.
        key: String,
        /// What is wrong with it.
        problem: ArrayProblem,
    },
    /// A shape is asked for of a rig that has none.
    #[error("the rig has {found} shape directions, {asked} betas are given")]
    NoBetas {
        /// Shape directions of the rig.
        found: usize,
        /// Betas that are given.
        asked: usize,
    },
    /// An array is stored as an object of Python: a sparse matrix, a list of arrays.
    #[error("key `{key}` is an object of Python, which is not read")]
    Pickled {
        /// The key.
        key: String,
    },
    /// A glTF file is wrong.
    #[error(transparent)]
    Gltf(#[from] GltfProblem),
    /// Skeleton, weights or pose are impossible.
    #[error(transparent)]
    Skin(#[from] SkinError),
    /// The mesh is impossible.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The OBJ that the file names cannot be read.
    #[error(transparent)]
    Obj(#[from] ObjError),
    /// Another file that the file names cannot be read.
    #[error(transparent)]
    Other(Box<FileError>),
}

impl From<FileError> for FileProblem {
    fn from(error: FileError) -> Self {
        Self::Other(Box::new(error))
    }
}

fn near_names(near: &[String]) -> String {
    if near.is_empty() {
        return String::new();
    }
    format!("; near it are {}", key_list(near))
}

fn key_list(keys: &[String]) -> String {
    if keys.is_empty() {
        return "nothing".to_owned();
    }
    let quoted: Vec<String> = keys.iter().map(|key| format!("`{key}`")).collect();
    quoted.join(", ")
}
