//! What can be wrong with a garment package, or with the simulation of its garment.

use std::io;
use std::path::{Path, PathBuf};

use garnet_io::{FileError, ObjError, WriteRigError};
use garnet_mesh::{Fingerprint, MeshError, WriteError};
use garnet_sim::SimError;
use garnet_skin::SkinError;

/// What can be wrong with a garment package, or with the simulation of its garment.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PackageError {
    /// A file cannot be read.
    #[error("cannot read `{}`", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A file cannot be removed.
    #[error("cannot change `{}`", path.display())]
    Folder {
        /// The file.
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
    /// The manifest does not parse.
    #[error("`{}`: {reason}", path.display())]
    Text {
        /// The file.
        path: PathBuf,
        /// What was expected and found, with line and column.
        reason: String,
    },
    /// A number of a manifest is none that it may be.
    #[error("`{}`: `{field}` is {value}, expected a number from {min} to {max}", path.display())]
    Number {
        /// The manifest.
        path: PathBuf,
        /// The number.
        field: String,
        /// As it is.
        value: f64,
        /// The least that it may be.
        min: f64,
        /// The greatest that it may be.
        max: f64,
    },
    /// The fabric of a package is none.
    #[error("`{}` is not usable", path.display())]
    Fabric {
        /// The manifest.
        path: PathBuf,
        /// The constant, its value and its range.
        source: SimError,
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
    /// A file belongs to another package or to another version.
    #[error("`{}` does not belong here: {what}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What tells so.
        what: String,
    },
    /// Another run writes the same.
    #[error("`{}` is being written by another run{}", folder.display(), of_process(*process))]
    InUse {
        /// The folder of the package, or of a training in it.
        folder: PathBuf,
        /// The number of its process, if it is known.
        process: Option<u32>,
    },
    /// The package does not have the variant that is asked for.
    #[error("the package has no variant `{name}`; it has {known}")]
    NoVariant {
        /// The name.
        name: String,
        /// Those there are.
        known: String,
    },
    /// The package does not have the size that is asked for.
    #[error("the package has no size `{name}`; it has {}", if known.is_empty() { "none" } else { known })]
    NoSize {
        /// The name.
        name: String,
        /// Those there are.
        known: String,
    },
    /// A garment lies too deep in its body to be simulated.
    #[error("{inside} of {vertices} vertices of the garment are inside the body at rest, the deepest by {:.1} mm", 1e3 * deepest)]
    InsideAtStart {
        /// Vertices inside.
        inside: usize,
        /// All vertices.
        vertices: usize,
        /// The deepest, in metres.
        deepest: f32,
    },
    /// Nothing holds a garment that is to be simulated.
    #[error("{:.0} % of the garment lies over holes of the body, where nothing holds it", 1e2 * share)]
    OverHoles {
        /// The share of its vertices.
        share: f64,
    },
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
    /// A rig cannot be written.
    #[error(transparent)]
    WriteRig(#[from] WriteRigError),
    /// Body and garment, or body and pose, do not fit together.
    #[error(transparent)]
    Skin(#[from] SkinError),
    /// A scene cannot be simulated.
    #[error(transparent)]
    Sim(#[from] SimError),
}

fn of_process(number: Option<u32>) -> String {
    number.map_or_else(String::new, |number| format!(" (process {number})"))
}

/// What is wrong with a TOML `text`, in one line: line and column, both from 1, and what.
///
/// The parser draws the line with a mark below it, which no message of one line can hold.
pub fn toml_problem(text: &str, error: &toml::de::Error) -> String {
    let what = error.message().lines().map(str::trim);
    let what: Vec<&str> = what.filter(|line| !line.is_empty()).collect();
    let what = what.join(", ");
    let before = error.span().and_then(|span| text.get(..span.start));
    let Some(before) = before else {
        return what;
    };
    let line = before.matches('\n').count() + 1;
    let start = before.rfind('\n').map_or(0, |end| end + 1);
    let column = before[start..].chars().count() + 1;
    format!("line {line}, column {column}: {what}")
}

impl PackageError {
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

    pub(crate) fn toml(path: &Path, text: &str, source: &toml::de::Error) -> Self {
        Self::Text {
            path: path.to_path_buf(),
            reason: toml_problem(text, source),
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
    fn what_is_wrong_with_a_toml_text_is_told_in_a_line() {
        let told = |text: &str| {
            let error = toml::from_str::<crate::StoredFabric>(text).unwrap_err();
            toml_problem(text, &error)
        };
        let unknown = told("name = \"silk\"\n  color = 3\n");
        assert!(
            unknown.starts_with("line 2, column 3: unknown field `color`"),
            "{unknown}"
        );
        let broken = told("name = \"silk\"\ndensity = \n");
        assert!(broken.starts_with("line 2, column "), "{broken}");
        assert!(!broken.contains('\n') && !broken.contains('|'), "{broken}");
    }
}
