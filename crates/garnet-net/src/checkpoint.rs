//! Weight files.
//!
//! One safetensors file holds the weights and, under the metadata key `garnet`, one JSON text: the
//! schema version, the configuration, the fingerprint of the garment, the length unit, a checksum
//! of this text and the weights, the record of the training and its scores. One key alone, because
//! several would be written in random order, and the same model must give the same bytes.
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
//! A matrix of type `I8` has a tensor `<name>.scale` beside it, a number for each of its rows: it
//! is `weights[name] * weights[name + ".scale"].view(-1, 1)`.
//!
//! The last three rows of each `u` belong to the places of the vertices and are multiplied by
//! `0.1 / config.mean_edge_length` before use. `benches/python/garnet_torch.py` is the whole
//! network in PyTorch and checks that both agree.

#[cfg(feature = "burn")]
mod network_file;
#[cfg(feature = "burn")]
mod tensors;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

#[cfg(feature = "burn")]
pub use self::network_file::Checkpoint;
use crate::weight_file::Header;
use crate::{GarNetConfig, TrainedRange};

/// The schema of files whose numbers are stored as they are.
pub const SCHEMA: &str = "garnet-weights/1";

/// The schema of files with matrices of 8 bits, which earlier versions do not read.
pub const PACKED_SCHEMA: &str = "garnet-weights/2";

/// How weights are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// 32 bits: exact.
    #[default]
    F32,
    /// 16 bits: half the file.
    F16,
    /// 8 bits for matrices, with a scale for each row, which is all numbers of the first index: a
    /// number is off by 0.4 % of the largest of its row at most. A quarter of the file.
    I8,
}

/// What a weight file says about itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CheckpointHeader {
    /// [`SCHEMA`], or [`PACKED_SCHEMA`].
    pub schema: String,
    /// What the network is made of.
    pub config: GarNetConfig,
    /// The garment, as [`Fingerprint`](garnet_mesh::Fingerprint) writes it.
    pub garment: String,
    /// The length unit in metres.
    pub unit: f32,
    /// Checksum of this text without it, and of names and numbers, as
    /// [`Fingerprint`](garnet_mesh::Fingerprint) writes it.
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

impl Header for CheckpointHeader {
    const SCHEMA: &'static str = SCHEMA;
    const PACKED: &'static str = PACKED_SCHEMA;

    fn schema(&mut self) -> &mut String {
        &mut self.schema
    }

    fn checksum(&mut self) -> &mut String {
        &mut self.checksum
    }

    fn unit(&self) -> f32 {
        self.unit
    }
}
