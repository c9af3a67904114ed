//! What can go wrong between files and a drape.

use garnet_body::motion::RetargetError;
use garnet_io::{FileError, Misplaced, ObjError};
use garnet_knn::KnnError;
use garnet_mesh::MeshError;
#[cfg(feature = "package")]
use garnet_net::{CheckpointError, NetError};
use garnet_skin::SkinError;
use garnet_untangle::UntangleError;

#[cfg(feature = "package")]
use crate::PackageError;

/// What can go wrong between files and a drape.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An OBJ file cannot be read or written.
    #[error(transparent)]
    Obj(#[from] ObjError),
    /// A rig, pose or scene file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A mesh is not usable.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A body, a pose or weights do not fit together.
    #[error(transparent)]
    Skin(#[from] SkinError),
    /// A body is no human figure, so a garment cannot be carried over to it.
    #[error(transparent)]
    Figure(#[from] RetargetError),
    /// A garment or a body cannot be searched.
    #[error(transparent)]
    Knn(#[from] KnnError),
    /// Untangling cannot start.
    #[error(transparent)]
    Untangle(#[from] UntangleError),
    /// Weights of a network cannot be used.
    #[cfg(feature = "package")]
    #[error(transparent)]
    Weights(Box<CheckpointError>),
    /// A network cannot be run.
    #[cfg(feature = "package")]
    #[error(transparent)]
    Net(#[from] NetError),
    /// A garment package cannot be read, or its garment not simulated.
    #[cfg(feature = "package")]
    #[error(transparent)]
    Package(Box<PackageError>),
    /// A simulation was asked for, and the draper has no simulator.
    #[cfg(feature = "package")]
    #[error("the garment has no simulator")]
    NoSimulator,
    /// The garment does not lie on the body.
    #[error("the garment does not lie on the rest body")]
    Misplaced(#[from] Misplaced),
}

impl Error {
    /// Whether the work was stopped from outside.
    pub fn is_stopped(&self) -> bool {
        #[cfg(feature = "package")]
        if let Self::Package(error) = self {
            return matches!(**error, PackageError::Stopped);
        }
        false
    }
}

#[cfg(feature = "package")]
impl From<CheckpointError> for Error {
    fn from(source: CheckpointError) -> Self {
        Self::Weights(Box::new(source))
    }
}

#[cfg(feature = "package")]
impl From<PackageError> for Error {
    fn from(source: PackageError) -> Self {
        Self::Package(Box::new(source))
    }
}
