//! Rigs as GLB or glTF 2.0: the first mesh with a skin.
//!
//! The `gltf` crate gives the JSON schema. Containers, buffers and accessors are read here, because
//! every number in such a file may lead out of bounds.

mod accessor;
mod base64;
mod container;
mod nodes;
mod problem;
mod rig;

pub(super) use container::MAGIC;
pub use problem::GltfProblem;
pub use rig::read_rig_gltf;
