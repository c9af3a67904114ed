//! Files: what is read from them and written to them.

use std::path::Path;

pub use garnet_io::{
    Alignment, ArrayProblem, CacheError, CacheKind, CachePart, CacheWriter, EmptySleeve, FileError,
    FileProblem, Frame, GltfProblem, LeftOut, MeshFrames, Misplaced, MotionError, MotionOptions,
    MotionProblem, NamedPose, NpyArray, NpzFile, ObjError, ObjFile, ObjLineProblem, ObjLook,
    ObjMaterial, ObjMaterials, ObjParseError, ObjPicture, OwnBody, PartsNote, PoseError, PoseNote,
    PoseProblem, PoseSource, Posing, ReadRig, RestSource, RigOptions, RigPart, RigRest, Scene,
    SceneError, SceneFiles, SceneGarment, SceneJson, SceneProblem, SceneUnits, ShownMesh, Take,
    TakeError, Target, TargetSource, WriteRigError, aligned, empty_sleeves, guess_body_unit,
    guess_garment_units, guess_up_axis, is_rig, largest_distance, read_mesh, read_mesh_frames,
    read_mesh_of, read_pose, read_rig, read_rig_with, read_shown_mesh, rig_beside,
    threaded_openings, write_obj, write_rig_npz,
};
pub use garnet_mesh::{WriteError, remove_stale_temporaries, write_atomically};

use crate::{Body, Error};

/// Reads a body from a rig file that has its rest mesh: `*.rig.npz`, GLB or glTF.
///
/// # Errors
///
/// [`Error::File`] if the file cannot be read, or holds no rest mesh.
pub fn read_body(path: impl AsRef<Path>) -> Result<Body, Error> {
    let path = path.as_ref();
    let body = read_rig(path)?.into_body();
    Ok(body.map_err(|error| FileError {
        path: path.to_path_buf(),
        problem: error.into(),
    })?)
}
