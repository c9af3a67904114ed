//! Errors of the suite; a drape that fails is none, it is a result.

use garnet_body::motion::RetargetError;
use garnet_body::shape::ShapeError;
use garnet_drape::PackageError;
use garnet_knn::KnnError;
use garnet_mesh::MeshError;
use garnet_skin::SkinError;

/// Why a scene cannot be made or draped.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StressError {
    /// The garment cannot be bound or draped.
    #[error(transparent)]
    Drape(#[from] garnet_drape::Error),
    /// The package cannot be simulated.
    #[error(transparent)]
    Package(#[from] PackageError),
    /// The garment cannot be cut anew.
    #[error(transparent)]
    Data(#[from] garnet_data::DataError),
    /// The body cannot be posed.
    #[error(transparent)]
    Skin(#[from] SkinError),
    /// The skeleton is no human figure.
    #[error(transparent)]
    Retarget(#[from] RetargetError),
    /// There is no such body.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A mesh that was made worse is none.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The skin cannot be searched.
    #[error(transparent)]
    Knn(#[from] KnnError),
    /// Threads cannot be started.
    #[error("cannot start the threads")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A variant was asked for that has no weights.
    #[error("the variant has no weights")]
    NoVariant,
}
