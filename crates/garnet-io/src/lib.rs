//! Files of meshes and scenes: OBJ in and lossless out, rigs, poses, motions; and
//! [`Scene::load`], which brings the files of a drape together.
//!
//! Readers tell formats by their content, check every number where it enters, and give metres with
//! Y up wherever the format says what it is in.
//!
//! ```
//! use garnet_io::ObjFile;
//!
//! let file = ObjFile::parse(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec(), "triangle.obj")?;
//! assert_eq!(file.mesh()?.num_faces(), 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod align;
mod cache;
mod error;
mod gltf;
mod json;
mod motion;
mod npy;
mod npz;
mod obj;
mod placement;
mod pose_json;
mod read_rig;
mod rig_json;
mod rig_npz;
mod rig_smpl;
mod scene;
mod scene_json;
mod sleeves;
mod smpl_regressor;
mod units;
mod weights_json;

pub use self::cache::{CacheError, CacheKind, CachePart, CacheWriter};
pub use self::gltf::{GltfProblem, LeftOut, MeshFrames, RigPart, read_rig_gltf};
pub use align::{Alignment, aligned, threaded_openings};
pub use error::{FileError, FileProblem};
pub use motion::{MotionError, MotionProblem, Take, TakeError};
pub use npy::{ArrayProblem, NpyArray, NpyValues};
pub use npz::NpzFile;
pub use obj::{
    ObjElement, ObjError, ObjFile, ObjLineProblem, ObjLook, ObjMaterial, ObjMaterials,
    ObjParseError, ObjPicture, write_obj,
};
pub use placement::{Misplaced, check_offsets, check_pieces, check_sizes};
pub use pose_json::read_pose;
pub use read_rig::{PartsNote, ReadRig, RigOptions, read_rig, read_rig_with};
pub use rig_npz::{WriteRigError, read_rig_npz, rig_npz, write_rig_npz};
pub use scene::{
    Frame, MotionOptions, NamedPose, OwnBody, PoseError, PoseNote, PoseProblem, PoseSource, Posing,
    RestSource, RigRest, Scene, SceneError, SceneFiles, SceneGarment, SceneProblem, SceneUnits,
    ShownMesh, Target, TargetSource, is_rig, largest_distance, read_mesh, read_mesh_frames,
    read_mesh_of, read_shown_mesh, rig_beside,
};
pub use scene_json::SceneJson;
pub use sleeves::{EmptySleeve, empty_sleeves};
pub use units::{guess_body_unit, guess_garment_units, guess_up_axis};
pub use weights_json::read_weights;
