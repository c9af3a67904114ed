//! Networks that predict where cloth is at a moment of its drape.
//!
//! *Pose-space deformations* ([`pose_space`]) move a skinned garment by principal shapes whose
//! shares a kernel regression, or a small network for each region, predicts of pose and shape. They
//! are plain code.
//!
//! With the feature `burn` there is also *GarNet*: a network predicts, for each vertex of a skinned
//! garment M over a body B, the translation that brings it to where a simulation would put it:
//! `G_P = M + f(M, B)` (*Gundogdu et al. 2020, Eq. 1*). [`GarNetConfig`] says what it is made of
//! and makes a `GarNet`; a [`GarmentGraph`] and a `BodySampling` hold what is known before any
//! scene, a `Scene` one garment over one body. Two paths run the same modules: tensors with
//! derivatives for training (`GarNet::forward`, `surrogate`, `losses`), and a `Predictor` without
//! either for draping, which takes and gives points. Both call the kernels of `garnet-kernel`, so
//! their results are equal.
//!
//! A [`Model`] is either of the two, or one after the other, bound to a garment.
#![cfg_attr(feature = "burn", doc = "\n```")]
#![cfg_attr(not(feature = "burn"), doc = "\n```ignore")]
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

#[cfg(feature = "burn")]
mod body_sampling;
pub mod checkpoint;
mod config;
mod cost;
mod error;
mod garment_graph;
#[cfg(feature = "burn")]
pub mod losses;
mod model;
#[cfg(feature = "burn")]
mod network;
#[cfg(feature = "burn")]
mod ops;
pub mod pose_space;
#[cfg(feature = "burn")]
mod predictor;
mod presets;
mod reference_case;
#[cfg(feature = "burn")]
mod reference_stage;
#[cfg(feature = "burn")]
mod scene;
mod scene_input;
#[cfg(feature = "burn")]
mod scene_scaling;
mod trained_range;
mod weight_file;

#[cfg(feature = "burn")]
pub use body_sampling::BodySampling;
#[cfg(feature = "burn")]
pub use checkpoint::Checkpoint;
pub use checkpoint::{CheckpointHeader, Precision};
pub use config::{
    BodyStreamConfig, Frame, GarNetConfig, GarmentStreamConfig, InputScaling, PoolingConfig, Start,
    StnConfig, UNIT, Variant, VertexInput,
};
pub use cost::Cost;
pub use error::{CheckpointError, NetError};
pub use garment_graph::GarmentGraph;
pub use garnet_sim::Moment;
pub use model::{Model, ModelFile, ModelHeader};
#[cfg(feature = "burn")]
pub use network::{GarNet, surrogate};
pub use pose_space::PoseSpace;
#[cfg(feature = "burn")]
pub use predictor::Predictor;
pub use presets::PRESET_NAMES;
pub use reference_case::ReferenceCase;
#[cfg(feature = "burn")]
pub use reference_stage::ReferenceStage;
#[cfg(feature = "burn")]
pub use scene::{Scene, SceneNeighbors};
pub use scene_input::SceneInput;
#[cfg(feature = "burn")]
pub use scene_scaling::ScalingSums;
pub use trained_range::TrainedRange;
