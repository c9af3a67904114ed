//! What can go wrong between files and a drape.

use garnet_body::motion::RetargetError;
use garnet_io::{FileError, Misplaced, ObjError};
use garnet_mesh::MeshError;
use garnet_net::{CheckpointError, NetError};
use garnet_skin::SkinError;
use garnet_untangle::UntangleError;

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
    /// Untangling cannot start.
    #[error(transparent)]
    Untangle(#[from] UntangleError),
    /// Weights of a network cannot be used.
    #[error(transparent)]
    Weights(Box<CheckpointError>),
    /// A network cannot be run.
    #[error(transparent)]
    Net(#[from] NetError),
    /// A garment package cannot be read, or its garment not simulated.
    #[error(transparent)]
    Package(Box<PackageError>),
    /// The garment does not lie on the body.
    #[error("the garment does not lie on the rest body")]
    Misplaced(#[from] Misplaced),
}

impl From<CheckpointError> for Error {
    fn from(source: CheckpointError) -> Self {
        Self::Weights(Box::new(source))
    }
}

impl From<PackageError> for Error {
    fn from(source: PackageError) -> Self {
        Self::Package(Box::new(source))
    }
}
