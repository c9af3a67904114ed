//! Files: what is read from them and written to them.

use std::path::Path;

pub use garnet_mesh::{
    ObjError, ObjFile, ObjLineProblem, ObjParseError, WriteError, remove_stale_temporaries,
    write_atomically, write_obj,
};
pub use garnet_skin::{
    ArrayProblem, FileError, FileProblem, Scene, WriteRigError, read_pose, read_rig, write_rig_npz,
};

use crate::{Body, Error};

/// Reads a body from a rig file that has its rest mesh: `*.rig.npz`, GLB or glTF.
///
/// # Errors
///
/// [`Error::File`] if the file cannot be read, [`Error::Skin`] if it holds no rest mesh.
pub fn read_body(path: impl AsRef<Path>) -> Result<Body, Error> {
    Ok(read_rig(path)?.into_body()?)
}
