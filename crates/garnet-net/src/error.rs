//! What can be wrong with a configuration, a garment, a scene or a weight file.

use std::path::PathBuf;

#[cfg(feature = "burn")]
use garnet_kernel::KernelError;
use garnet_knn::KnnError;
use garnet_mesh::{Fingerprint, MeshError, WriteError};

/// Why a network cannot be made, bound or run.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NetError {
    /// A number of the configuration is not usable.
    #[error("`{field}` of the network is `{}`, but has to be from {min} to {max}", short(*value))]
    Config {
        /// Which number.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The smallest value allowed.
        min: f64,
        /// The largest value allowed.
        max: f64,
    },
    /// A weight or constant of the loss is not usable.
    #[error("`{field}` of the loss is `{}`, but has to be from {min} to {max}", short(*value))]
    Loss {
        /// Which number.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The smallest value allowed.
        min: f64,
        /// The largest value allowed.
        max: f64,
    },
    /// No preset has this name.
    #[error("there is no network preset `{name}`; there are {known}")]
    UnknownPreset {
        /// The name.
        name: String,
        /// Those there are.
        known: String,
    },
    /// The model was trained for another garment.
    #[error(
        "the model was trained for the garment `{expected}`, but this one is `{found}`: other faces or another vertex count"
    )]
    OtherGarment {
        /// The garment of the model.
        expected: Fingerprint,
        /// The garment at hand.
        found: Fingerprint,
    },
    /// An array has the wrong length.
    #[error("{what}: {found} given, {expected} expected")]
    Count {
        /// What was counted.
        what: &'static str,
        /// How many were given.
        found: usize,
        /// How many were expected.
        expected: usize,
    },
    /// Something needed is missing.
    #[error("{what} missing, which {needed_by}")]
    Missing {
        /// What.
        what: &'static str,
        /// Why it is needed.
        needed_by: &'static str,
    },
    /// A body point that is used does not exist.
    #[error("body point {index} is used, but the body has {num_points} points")]
    BodyPoint {
        /// The number used.
        index: u32,
        /// Points of the body.
        num_points: usize,
    },
    /// A coordinate, normal or parameter is not a number, or far beyond any garment.
    #[error("{what} {index} is not finite or out of range")]
    NotFinite {
        /// What it belongs to.
        what: &'static str,
        /// Which one.
        index: usize,
    },
    /// The network gave a vertex no finite place.
    #[error("the network moves vertex {vertex} to no finite place; its weights are unusable")]
    Diverged {
        /// The first such vertex.
        vertex: usize,
    },
    /// A mesh is unusable.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A graph or table of neighbors is unusable.
    #[cfg(feature = "burn")]
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// Neighbors cannot be searched.
    #[error(transparent)]
    Knn(#[from] KnnError),
}

/// A number as messages have it: hundreds of digits say less than its power of ten.
fn short(value: f64) -> String {
    if value.is_finite() && value.abs() >= 1e15 {
        return format!("{value:e}");
    }
    value.to_string()
}

/// Why a weight file cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The system refuses.
    #[error("cannot read weights `{}`", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The file is no safetensors file, or ends too early.
    #[error("weights `{}` are truncated, corrupted or no safetensors file", path.display())]
    NotSafetensors {
        /// The file.
        path: PathBuf,
        /// What the reader says.
        source: safetensors::SafeTensorError,
    },
    /// It was not written by garnet.
    #[error("weights `{}` are not of garnet: no `{key}` in the metadata", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// The key that is missing.
        key: &'static str,
    },
    /// The metadata cannot be understood.
    #[error("weights `{}` have unreadable metadata", path.display())]
    Metadata {
        /// The file.
        path: PathBuf,
        /// What the reader says.
        source: serde_json::Error,
    },
    /// It was written by another version.
    #[error("weights `{}` have the schema `{found}`, but this version reads `{expected}`", path.display())]
    Schema {
        /// The file.
        path: PathBuf,
        /// Its schema.
        found: String,
        /// The schema of this version.
        expected: &'static str,
    },
    /// The numbers are not those that were written.
    #[error("weights `{}` were altered: checksum {found}, expected {expected}", path.display())]
    Altered {
        /// The file.
        path: PathBuf,
        /// Checksum of the numbers.
        found: Fingerprint,
        /// Checksum in the metadata.
        expected: Fingerprint,
    },
    /// The weights do not fit what they are to be used for.
    #[error("weights `{}` do not fit", path.display())]
    Unfit {
        /// The file.
        path: PathBuf,
        /// What differs.
        source: NetError,
    },
    /// A network was trained on another pose-space deformation than the one beside it.
    #[error("weights `{}` start from the pose-space deformation {expected}, but `{}` is {found}", path.display(), start.display())]
    OtherStart {
        /// The file of the network.
        path: PathBuf,
        /// The file of the pose-space deformation.
        start: PathBuf,
        /// Checksum of the one that it was trained on.
        expected: String,
        /// Checksum of the one that there is.
        found: String,
    },
    /// The weights are of a GarNet, and this build runs none: it lacks the feature `burn`.
    #[error(
        "`{variant}` is a GarNet, which takes the feature `network` of garnet (`burn` of garnet-net)"
    )]
    NoNetworks {
        /// The variant, as its file is named.
        variant: String,
        /// The file.
        path: PathBuf,
    },
    /// The configuration in the file is not usable.
    #[error("weights `{}` hold an unusable configuration", path.display())]
    Config {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: NetError,
    },
    /// A tensor is missing, unknown or of another shape than the configuration says.
    #[error("weights `{}`: tensor `{name}` is {found}, but the configuration asks for {expected}", path.display())]
    Tensor {
        /// The file.
        path: PathBuf,
        /// The tensor.
        name: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// The tensors cannot be brought into the network for another reason.
    #[error("weights `{}` cannot be loaded", path.display())]
    Unloadable {
        /// The file.
        path: PathBuf,
        /// What the store of Burn says.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A weight is not a number: such a model is neither written nor read.
    #[error("weight `{name}` holds a value that is not finite")]
    NotFinite {
        /// The tensor.
        name: String,
    },
}

impl NetError {
    /// Refuses another count than the one expected.
    pub(crate) fn check_count(
        what: &'static str,
        found: usize,
        expected: usize,
    ) -> Result<(), Self> {
        if found == expected {
            return Ok(());
        }
        Err(Self::Count {
            what,
            found,
            expected,
        })
    }
}
