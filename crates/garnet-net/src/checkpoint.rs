//! Weight files.
//!
//! One safetensors file holds the weights and, under the metadata key `garnet`, one JSON text: the
//! schema version, the configuration, the fingerprint of the garment, the length unit, a checksum
//! of this text and the weights, the record of the training and its scores. One key alone, because several would
//! be written in random order, and the same model must give the same bytes.
//!
//! Tensors are named by their place in the network (`garment.blocks.0.convolutions.1.w`) and lie
//! as the equations read: a linear layer is `x W + b` with `W` of `[in, out]`.
//!
//! # Loading in PyTorch
//!
//! ```python
//! import json
//! from safetensors import safe_open
//!
//! with safe_open("local.safetensors", "pt") as file:
//!     header = json.loads(file.metadata()["garnet"])
//!     weights = {name: file.get_tensor(name).float() for name in file.keys()}
//! # torch.nn.Linear keeps its matrix as [out, in]:
//! linear.weight.data = weights["fusion.translation.weight"].T
//! linear.bias.data = weights["fusion.translation.bias"]
//! # torch_geometric.nn.FeaStConv(in, out, heads), with u scaled as below:
//! conv.u.weight.data = u.T
//! conv.c.data, conv.bias.data = weights[at + ".c"], weights[at + ".b"]
//! conv.lin.weight.data = w.view(heads, channels, out).permute(0, 2, 1).reshape(heads * out, channels)
//! ```
//!
//! The last three rows of each `u` belong to the places of the vertices and are multiplied by
//! `0.1 / config.mean_edge_length` before use. `benches/python/garnet_torch.py` is the whole
//! network in PyTorch and checks that both agree.

mod tensors;

use std::collections::BTreeMap;
use std::path::Path;

use burn::tensor::Device;
use garnet_mesh::{Fingerprint, write_atomically};
use serde::{Deserialize, Serialize};

use crate::weight_file::{self, Header};
use crate::{CheckpointError, GarNet, GarNetConfig, GarmentGraph, NetError, TrainedRange, UNIT};

/// The schema that this version reads and writes.
pub const SCHEMA: &str = "garnet-weights/1";

/// How weights are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// 32 bits: exact.
    #[default]
    F32,
    /// 16 bits: half the file.
    F16,
}

/// What a weight file says about itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CheckpointHeader {
    /// [`SCHEMA`].
    pub schema: String,
    /// What the network is made of.
    pub config: GarNetConfig,
    /// The garment, as [`Fingerprint`] writes it.
    pub garment: String,
    /// The length unit in metres.
    pub unit: f32,
    /// Checksum of this text without it, and of names and numbers, as [`Fingerprint`] writes it.
    pub checksum: String,
    /// The poses and shapes that it was trained on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<TrainedRange>,
    /// The checksum of the pose-space deformation that it starts from, if it starts from one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pose_space: Option<String>,
    /// How the model was trained; whatever the trainer finds worth keeping.
    pub record: serde_json::Value,
    /// Scores by name.
    pub scores: BTreeMap<String, f64>,
}

/// A model with all that its file says.
#[derive(Debug)]
pub struct Checkpoint {
    /// The network.
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

    /// The bytes of the file `path`.
    ///
    /// # Errors
    ///
    /// [`CheckpointError::NotFinite`] for weights that are no numbers.
    pub fn to_bytes(&self, path: &Path, precision: Precision) -> Result<Vec<u8>, CheckpointError> {
        let tensors = tensors::collected(&self.model, precision);
        let mut views = Vec::new();
        for (name, tensor) in &tensors {
            views.push((name.as_str(), tensor.view(path, precision)?));
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

impl Header for CheckpointHeader {
    const SCHEMA: &'static str = SCHEMA;

    fn checksum(&mut self) -> &mut String {
        &mut self.checksum
    }

    fn unit(&self) -> f32 {
        self.unit
    }
}
