//! The network GarNet++ in Burn: variants, losses, checkpoints and inference.
//!
//! A network predicts, for each vertex of a skinned garment M over a body B, the translation that
//! brings it to where a simulation would put it: `G_P = M + f(M, B)` (*Gundogdu et al. 2020, Eq.
//! 1*). [`GarNetConfig`] says what it is made of and makes a [`GarNet`]; a [`GarmentGraph`] and a
//! [`BodySampling`] hold what is known before any scene, a [`Scene`] one garment over one body.
//!
//! Two paths run the same modules: tensors with derivatives for training ([`GarNet::forward`],
//! [`surrogate`], [`losses`]), and a [`Predictor`] without either for draping, which takes and
//! gives points. Both call the kernels of `garnet-kernel`, so their results are equal.
//!
//! ```
//! use garnet_mesh::primitives::{icosphere, tube};
//! use garnet_net::{BodySampling, GarNetConfig, GarmentGraph, Predictor, SceneInput};
//! use nalgebra::{Isometry3, UnitQuaternion};
//!
//! let (template, body) = (tube(0.2, 0.3, 16, 8), icosphere(3, 0.18));
//! let garment = GarmentGraph::new(&template, &[])?;
//! let config = garment.configured(GarNetConfig::preset("tiny")?);
//! let sampling = BodySampling::for_garment(body.positions(), template.positions(), &config)?;
//!
//! let mut predictor = Predictor::untrained(&config, 7, garment, sampling)?;
//! let normals = garnet_mesh::vertex_normals(body.positions(), body.faces());
//! let draped = predictor.predict(&SceneInput {
//!     warped: template.positions(),
//!     body: body.positions(),
//!     body_normals: &normals,
//!     world_from_root: Isometry3::identity(),
//!     rotations: &vec![UnitQuaternion::identity(); template.num_vertices()],
//!     parameters: &[],
//! })?;
//! assert_eq!(draped, template.positions()); // An untrained network leaves the warp as it is.
//! # Ok::<(), garnet_net::NetError>(())
//! ```

#![allow(clippy::doc_markdown, reason = "FeaStNet and PyTorch are names")]

mod body_sampling;
pub mod checkpoint;
mod config;
mod cost;
mod error;
mod garment_graph;
pub mod losses;
mod model;
mod network;
mod ops;
pub mod pose_space;
mod predictor;
mod presets;
mod reference_case;
mod reference_stage;
mod scene;
mod trained_range;
mod weight_file;

pub use body_sampling::BodySampling;
pub use checkpoint::{Checkpoint, CheckpointHeader, Precision};
pub use config::{
    BodyStreamConfig, Frame, GarNetConfig, GarmentStreamConfig, PoolingConfig, Start, StnConfig,
    UNIT, Variant, VertexInput,
};
pub use cost::Cost;
pub use error::{CheckpointError, NetError};
pub use garment_graph::GarmentGraph;
pub use garnet_sim::Moment;
pub use model::{Model, ModelFile, ModelHeader};
pub use network::{GarNet, surrogate};
pub use pose_space::PoseSpace;
pub use predictor::Predictor;
pub use presets::PRESET_NAMES;
pub use reference_case::write_reference_case;
pub use reference_stage::ReferenceStage;
pub use scene::{Scene, SceneInput, SceneNeighbors};
pub use trained_range::TrainedRange;
