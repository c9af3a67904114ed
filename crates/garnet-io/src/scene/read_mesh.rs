//! Meshes in any of the files that hold one.

use std::path::Path;

use super::{SceneError, SceneProblem};
use crate::{ObjFile, read_rig};

/// Reads a mesh: an OBJ, or the rest mesh of a rig (npz, GLB, glTF, VRM) as if it were written as
/// OBJ.
///
/// Meshes of rigs are in metres with y up.
///
/// # Errors
///
/// [`SceneError`] if the file cannot be read, or if it is a rig without a mesh.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<ObjFile, SceneError> {
    let path = path.as_ref();
    if !is_rig(path) {
        return Ok(ObjFile::read(path)?);
    }
    let mesh = read_rig(path)?.rest.ok_or_else(|| SceneError::NoBody {
        path: path.to_path_buf(),
        problem: SceneProblem::SkeletonAlone {
            rig: path.to_path_buf(),
        },
    })?;
    Ok(ObjFile::of_mesh(&mesh, path)?)
}

/// Whether the name is that of a rig that may hold a mesh: npz, GLB, glTF or VRM.
pub fn is_rig(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    let extension = extension.unwrap_or_default().to_ascii_lowercase();
    matches!(extension.as_str(), "npz" | "glb" | "gltf" | "vrm")
}
