//! The weight file of a network.

use std::collections::BTreeMap;
use std::path::Path;

use burn::tensor::Device;
use garnet_mesh::{Fingerprint, write_atomically};

use super::{CheckpointHeader, Precision, SCHEMA, tensors};
use crate::{CheckpointError, GarNet, GarmentGraph, NetError, TrainedRange, UNIT, weight_file};

/// A model with all that its file says.
#[derive(Debug)]
pub struct Checkpoint {
    /// The network of the file.
    pub model: GarNet,
    /// The garment it was trained for.
    pub garment: Fingerprint,
    /// The poses and shapes that it was trained on, if that is known.
    pub range: Option<TrainedRange>,
    /// The checksum of the pose-space deformation that it starts from, if it starts from one.
    pub pose_space: Option<String>,
    /// How it was trained.
    pub record: serde_json::Value,
    /// Scores by name.
    pub scores: BTreeMap<String, f64>,
}

impl Checkpoint {
    /// Whether a garment is the one that the model was trained for.
    ///
    /// # Errors
    ///
    /// [`NetError::OtherGarment`] with both fingerprints.
    pub fn accepts(&self, garment: &GarmentGraph) -> Result<(), NetError> {
        let (expected, found) = (self.garment, garment.fingerprint());
        if expected == found {
            return Ok(());
        }
        Err(NetError::OtherGarment { expected, found })
    }

    /// Writes the file in one piece: an error leaves an old one as it was.
    ///
    /// # Errors
    ///
    /// [`CheckpointError::NotFinite`] for weights that are no numbers (none are written), or what
    /// the system says.
    pub fn save(
        &self,
        path: impl AsRef<Path>,
        precision: Precision,
    ) -> Result<(), CheckpointError> {
        let path = path.as_ref();
        let bytes = self.to_bytes(path, precision)?;
        Ok(write_atomically(path, |writer| writer.write_all(&bytes))?)
    }

    /// Stores the weights of a file anew, in other bits.
    ///
    /// # Errors
    ///
    /// As [`Checkpoint::load`] and [`Checkpoint::save`].
    pub fn repack(path: impl AsRef<Path>, precision: Precision) -> Result<(), CheckpointError> {
        let path = path.as_ref();
        Self::load(path, &Device::flex())?.save(path, precision)
    }

    /// The bytes of the file `path`.
    ///
    /// # Errors
    ///
    /// [`CheckpointError::NotFinite`] for weights that are no numbers.
    pub fn to_bytes(&self, path: &Path, precision: Precision) -> Result<Vec<u8>, CheckpointError> {
        let tensors = tensors::collected(&self.model, precision);
        let mut views = Vec::new();
        for tensor in &tensors {
            views.push((tensor.name.as_str(), tensor.view(path)?));
        }
        let mut header = CheckpointHeader {
            schema: SCHEMA.to_owned(),
            config: self.model.config().clone(),
            garment: self.garment.to_string(),
            unit: UNIT,
            checksum: String::new(),
            range: self.range.clone(),
            pose_space: self.pose_space.clone(),
            record: self.record.clone(),
            scores: self.scores.clone(),
        };
        weight_file::to_bytes(path, &mut header, views)
    }

    /// Reads a file and makes its network on a device.
    ///
    /// # Errors
    ///
    /// [`CheckpointError`] by name for a file that is truncated, altered, foreign, or of another
    /// version.
    pub fn load(path: impl AsRef<Path>, device: &Device) -> Result<Self, CheckpointError> {
        let path = path.as_ref();
        Self::from_bytes(path, weight_file::read(path)?, device)
    }

    /// Reads the bytes of the file `path`.
    ///
    /// # Errors
    ///
    /// As [`Checkpoint::load`].
    pub fn from_bytes(
        path: &Path,
        bytes: Vec<u8>,
        device: &Device,
    ) -> Result<Self, CheckpointError> {
        let (header, _) = weight_file::checked::<CheckpointHeader>(path, &bytes)?;
        let garment = weight_file::fingerprint(path, &header.garment)?;
        let unusable = |source| CheckpointError::Config {
            path: path.to_path_buf(),
            source,
        };
        let mut model = header.config.blank(device).map_err(unusable)?;
        tensors::fill(&mut model, path, bytes)?;
        Ok(Self {
            model,
            garment,
            range: header.range,
            pose_space: header.pose_space,
            record: header.record,
            scores: header.scores,
        })
    }

    /// Reads what a file says about itself, and checks no weights.
    ///
    /// # Errors
    ///
    /// As [`Checkpoint::load`].
    pub fn header(path: impl AsRef<Path>) -> Result<CheckpointHeader, CheckpointError> {
        let path = path.as_ref();
        let bytes = weight_file::read(path)?;
        Ok(weight_file::parse::<CheckpointHeader>(path, &bytes)?.header)
    }
}
