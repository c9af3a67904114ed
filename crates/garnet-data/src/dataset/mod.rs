//! Data sets: many simulated scenes of one garment.

mod dress;
mod generate;
mod import;
mod lock;
mod manifest;
mod plan;
mod record;
mod shard;
mod variations;

use std::path::{Path, PathBuf};

use garnet_mesh::Fingerprint;

pub use generate::{DatasetEvent, DatasetOptions, Tally, generate};
pub use import::{ImportManifest, ImportProblem, ImportScene, import};
pub use manifest::{DATASET_SCHEMA, DatasetManifest, GENERATOR, Sizing};
pub use plan::{Counts, Plan, Protocol, sampler, sequences};
pub use record::{BodyRecord, Posed, Rejection, SceneRecord, Split};
pub use shard::Shard;
pub use variations::Variations;

use crate::DataError;
use shard::Layout;

/// A data set in a folder: `dataset.json` and `shards/*.safetensors`.
///
/// Shards that were made by several machines are one data set as soon as they are in one folder.
#[derive(Debug, Clone)]
pub struct Dataset {
    /// What the data set is made of.
    pub manifest: DatasetManifest,
    fingerprint: Fingerprint,
    paths: Vec<PathBuf>,
}

impl Dataset {
    /// Opens a data set; the shards are read when they are asked for.
    ///
    /// # Errors
    ///
    /// [`DataError::NoDataset`] for a folder of other files, or another [`DataError`] that names
    /// the file.
    pub fn open(folder: &Path) -> Result<Self, DataError> {
        let layout = Layout {
            folder: folder.to_path_buf(),
        };
        let path = layout.manifest();
        if folder.exists() && !path.exists() {
            return Err(DataError::NoDataset {
                folder: folder.to_path_buf(),
            });
        }
        let manifest = DatasetManifest::read(&path)?;
        Ok(Self {
            fingerprint: manifest.fingerprint(),
            manifest,
            paths: layout.found()?,
        })
    }

    /// Reads the shards, one after the other.
    pub fn shards(&self) -> impl Iterator<Item = Result<Shard, DataError>> + '_ {
        let bodies = self.manifest.bodies_per_shard;
        let paths = self.paths.iter();
        paths.map(move |path| Shard::read_named(path, self.fingerprint, bodies))
    }

    /// Reads the shards of a split, one after the other.
    pub fn split(&self, split: Split) -> impl Iterator<Item = Result<Shard, DataError>> + '_ {
        let shards = self.shards();
        shards.filter(move |shard| shard.as_ref().map_or(true, |shard| shard.split == split))
    }

    /// Size of the shards, in bytes.
    ///
    /// # Errors
    ///
    /// [`DataError::Read`].
    pub fn num_bytes(&self) -> Result<u64, DataError> {
        let size = |path: &PathBuf| {
            let metadata = std::fs::metadata(path);
            Ok(metadata
                .map_err(|source| DataError::read(path, source))?
                .len())
        };
        self.paths.iter().map(size).sum()
    }

    /// How many shards there are.
    pub fn num_shards(&self) -> usize {
        self.paths.len()
    }
}
