//! Why data cannot be made, read or written.

use std::{
    io,
    path::{Path, PathBuf},
};

use garnet_body::{motion::RetargetError, shape::ShapeError};
use garnet_drape::PackageError;
use garnet_io::{FileError, ObjError};
use garnet_mesh::{Fingerprint, MOST_BYTES, MeshDifference, MeshError, WriteError, read_text};
use garnet_pattern::PatternError;
use garnet_sim::SimError;
use garnet_skin::SkinError;

use crate::dataset::ImportProblem;

/// Why data cannot be made, read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DataError {
    /// A file cannot be read.
    #[error("cannot read `{}`", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A folder or file is there, but no data set in it.
    #[error("`{}` is no data set: it has no `dataset.json`", folder.display())]
    NoDataset {
        /// The folder or file.
        folder: PathBuf,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A folder cannot be made, or a file in it not removed.
    #[error("cannot change `{}`", path.display())]
    Folder {
        /// The folder or file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A file with tensors is cut off or damaged.
    #[error("`{}` is no sound safetensors file", path.display())]
    Tensors {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: safetensors::SafeTensorError,
    },
    /// A file with JSON in it does not parse.
    #[error("`{}`: {reason}", path.display())]
    Text {
        /// The file.
        path: PathBuf,
        /// What was expected and found, with line and column.
        reason: String,
    },
    /// A file is not the one that was written.
    #[error("`{}` was altered or damaged: its checksum is {found}, and was {expected} when it was written", path.display())]
    Altered {
        /// The file.
        path: PathBuf,
        /// The checksum of what it holds.
        found: Fingerprint,
        /// The one that was written down.
        expected: String,
    },
    /// A file belongs to something else or to another version.
    #[error("`{}` does not belong here: {what}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What tells so.
        what: String,
    },
    /// The folder holds a data set that was asked for in another way.
    #[error("`{}` holds a data set with {field} {found}, asked for is {asked}", path.display())]
    OtherDataset {
        /// The manifest.
        path: PathBuf,
        /// What differs.
        field: &'static str,
        /// The value there.
        found: String,
        /// The value that was asked for.
        asked: String,
    },
    /// A shard has the name of another one.
    #[error("`{}` is the shard `{name}`", path.display())]
    MisnamedShard {
        /// The file.
        path: PathBuf,
        /// The name that its split and bodies give it.
        name: String,
    },
    /// Another run writes the same shards.
    #[error("`{}` is being written by another run{}", folder.display(), of_process(*process))]
    InUse {
        /// The folder of the data set.
        folder: PathBuf,
        /// The number of its process, if it is known.
        process: Option<u32>,
    },
    /// A list of scenes made elsewhere is none.
    #[error("`{}`: {problem}", path.display())]
    Import {
        /// The list.
        path: PathBuf,
        /// What is wrong.
        problem: Box<ImportProblem>,
    },
    /// A scene made elsewhere cannot be taken.
    #[error("cannot take scene {scene}, of body `{body}`, of `{}`", path.display())]
    ImportScene {
        /// The list of scenes.
        path: PathBuf,
        /// Its place in the list, from 1.
        scene: usize,
        /// Its body.
        body: String,
        /// Why, with the file.
        source: Box<Self>,
    },
    /// A mesh is too small or too large to be what it should be.
    #[error("`{}` extends over {found:.4} m, the {of} of the package over {expected:.4} m", path.display())]
    Extent {
        /// The file.
        path: PathBuf,
        /// Its largest extent, in metres.
        found: f32,
        /// What it is compared with.
        of: &'static str,
        /// The largest extent of that, in metres.
        expected: f32,
    },
    /// A mesh made elsewhere is not that of the package in another pose and shape.
    #[error("`{}` does not belong here: {}", path.display(), of_package(*difference, of))]
    OtherMesh {
        /// The file.
        path: PathBuf,
        /// What it is compared with.
        of: &'static str,
        /// What tells so.
        difference: MeshDifference,
    },
    /// A garment made elsewhere does not lie on its body.
    #[error("`{}` is {gap:.2} m away from its body `{}`", garment.display(), body.display())]
    Apart {
        /// The file of the garment.
        garment: PathBuf,
        /// The file of the body.
        body: PathBuf,
        /// Distance between the boxes of both, in metres.
        gap: f32,
    },
    /// The meshes of a scene were others when they were read again.
    #[error("`{}` or `{}` has changed meanwhile", garment.display(), body.display())]
    Changed {
        /// The file of the garment.
        garment: PathBuf,
        /// The file of the body.
        body: PathBuf,
    },
    /// The garment lies on a body that no body of the population is like.
    #[error(
        "the garment lies on a body of {vertices} vertices that is not the built-in one: the bodies of a data set are"
    )]
    ForeignBody {
        /// Vertices of its body.
        vertices: usize,
    },
    /// The size fits too few bodies of the population.
    #[error("the garment fits only {found} of {tried} bodies, {needed} are needed")]
    FewFit {
        /// Bodies that it fits.
        found: usize,
        /// Bodies that were tried.
        tried: usize,
        /// Bodies that are needed.
        needed: usize,
    },
    /// A garment that was not made from a pattern is to be cut to measure.
    #[error("the garment has no sewing pattern: it cannot be cut to the measures of bodies")]
    NoPattern,
    /// All bodies wear the template, and parameters are to be drawn for each.
    #[error("all bodies wear the template: no sewing parameters can be drawn for each")]
    VariedTemplate,
    /// The work was stopped from outside.
    #[error("stopped")]
    Stopped,
    /// A mesh is none.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// An OBJ file cannot be read.
    #[error(transparent)]
    Obj(#[from] ObjError),
    /// A rig cannot be read.
    #[error(transparent)]
    Rig(#[from] FileError),
    /// Body and garment, or body and pose, do not fit together.
    #[error(transparent)]
    Skin(#[from] SkinError),
    /// A body cannot be built.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A body cannot be posed.
    #[error(transparent)]
    Pose(#[from] RetargetError),
    /// A pattern cannot be cut.
    #[error(transparent)]
    Pattern(#[from] PatternError),
    /// A scene cannot be simulated.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// A garment package cannot be used, or its garment not simulated.
    #[error(transparent)]
    Package(PackageError),
}

/// What both kinds of errors have is an error of data.
impl From<PackageError> for DataError {
    fn from(error: PackageError) -> Self {
        match error {
            PackageError::Stopped => Self::Stopped,
            PackageError::InUse { folder, process } => Self::InUse { folder, process },
            PackageError::Mesh(error) => Self::Mesh(error),
            PackageError::Obj(error) => Self::Obj(error),
            PackageError::Rig(error) => Self::Rig(error),
            PackageError::Skin(error) => Self::Skin(error),
            PackageError::Sim(error) => Self::Sim(error),
            PackageError::Write(error) => Self::Write(error),
            error => Self::Package(error),
        }
    }
}

fn of_process(number: Option<u32>) -> String {
    number.map_or_else(String::new, |number| format!(" (process {number})"))
}

fn of_package(difference: MeshDifference, of: &str) -> String {
    difference.described(&format!("the {of} of the package"))
}

/// The text of a file, which a manifest or a folder names: no pipe, and of no more bytes than fit.
///
/// # Errors
///
/// [`DataError::Read`].
pub(crate) fn text_of(path: &Path) -> Result<String, DataError> {
    let text = read_text(path, MOST_BYTES);
    text.map_err(|source| DataError::read(path, source))
}

impl DataError {
    pub(crate) fn read(path: &Path, source: io::Error) -> Self {
        Self::Read {
            path: path.to_path_buf(),
            source,
        }
    }

    pub(crate) fn folder(path: &Path, source: io::Error) -> Self {
        Self::Folder {
            path: path.to_path_buf(),
            source,
        }
    }

    pub(crate) fn tensors(path: &Path, source: safetensors::SafeTensorError) -> Self {
        Self::Tensors {
            path: path.to_path_buf(),
            source,
        }
    }

    pub(crate) fn json(path: &Path, source: &serde_json::Error) -> Self {
        Self::Text {
            path: path.to_path_buf(),
            reason: source.to_string(),
        }
    }

    /// Refuses the file `path` if its checksum is not the expected one.
    pub(crate) fn check(path: &Path, found: Fingerprint, expected: &str) -> Result<(), Self> {
        if found.to_string() == expected {
            return Ok(());
        }
        Err(Self::Altered {
            path: path.to_path_buf(),
            found,
            expected: expected.to_owned(),
        })
    }

    pub(crate) fn foreign(path: &Path, what: impl Into<String>) -> Self {
        Self::Foreign {
            path: path.to_path_buf(),
            what: what.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(unix)]
    fn what_never_ends_is_not_read() {
        let error = text_of(Path::new("/dev/zero")).unwrap_err();
        let DataError::Read { source, .. } = error else {
            panic!("{error}");
        };
        assert!(
            source.to_string().contains("a pipe or a device"),
            "{source}"
        );
    }
}
