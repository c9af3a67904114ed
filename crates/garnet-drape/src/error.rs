//! What can go wrong between files and a drape.

use garnet_body::motion::RetargetError;
use garnet_io::{FileError, ObjError};
use garnet_mesh::{Bounds, MeshError};
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
    #[error(
        "the garment is {distance:.3} m from the rest body at its nearest vertex and does not lie \
         on it"
    )]
    NotOnBody {
        /// Distance of the nearest vertex to the skin, in metres.
        distance: f32,
        /// The box of the garment, in metres.
        garment: Bounds,
        /// The box of the rest body, in metres.
        body: Bounds,
    },
    /// The garment is much larger or smaller than the body.
    #[error(
        "the garment is {garment_size:.3} m in size and the rest body {body_size:.3} m: they seem \
         to be in different units"
    )]
    DifferentUnits {
        /// Diagonal of the garment's box, in metres.
        garment_size: f32,
        /// Diagonal of the rest body's box, in metres.
        body_size: f32,
    },
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
