//! Files: rigs, weights, scenes and poses.

mod error;
mod gltf;
mod json;
mod npy;
mod npz;
mod pose_json;
mod read_rig;
mod rig_json;
mod rig_npz;
mod scene;
mod weights_json;

pub use error::{FileError, FileProblem};
pub use gltf::{GltfProblem, read_rig_gltf};
pub use npy::{ArrayProblem, NpyArray, NpyValues};
pub use npz::NpzFile;
pub use pose_json::read_pose;
pub use read_rig::read_rig;
pub use rig_npz::{WriteRigError, read_rig_npz, stage_rig_npz, write_rig_npz};
pub use scene::Scene;
pub use weights_json::read_weights;
