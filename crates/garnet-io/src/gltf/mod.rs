//! Rigs as GLB or glTF 2.0: all meshes with a skin on one skeleton, as the file shows them.
//!
//! The `gltf` crate gives the JSON schema. Containers, buffers and accessors are read here, because
//! every number in such a file may lead out of bounds.

mod accessor;
mod animation;
mod bare;
mod base64;
mod container;
mod extensions;
mod modes;
mod nodes;
mod parts;
mod problem;
mod rest;
mod rig;
mod shapes;
mod skeletons;
mod vertices;
mod vrm;

pub(super) use animation::read_clip;
pub(crate) use bare::{read_bare, read_frames};
pub(super) use container::MAGIC;
pub use parts::{LeftOut, RigPart};
pub use problem::GltfProblem;
pub(crate) use rig::read_gltf;
pub use rig::read_rig_gltf;
pub use shapes::MeshFrames;
