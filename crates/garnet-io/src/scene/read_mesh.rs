//! Meshes in any of the files that hold one.

use std::path::Path;

use garnet_mesh::Point3;
use garnet_skin::skin_linear;

use super::{SceneError, SceneProblem};
use crate::{
    FileError, FileProblem, GltfProblem, MeshFrames, ObjFile, PartsNote, RigOptions,
    gltf::{read_bare, read_frames},
    read_rig_with,
};

/// Reads a mesh: an OBJ, or the rest mesh of a rig (npz, GLB, glTF, VRM) as if it were written as
/// OBJ.
///
/// Meshes of rigs are in metres with y up, those of glTF as the file shows them. Of a glTF without
/// any skin all meshes are read.
///
/// # Errors
///
/// [`SceneError`] if the file cannot be read, or if it is a rig without a mesh.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<ObjFile, SceneError> {
    read_mesh_of(path, &RigOptions::default())
}

/// Reads a mesh as [`read_mesh`] does, with a choice of the meshes of a rig.
///
/// # Errors
///
/// Those of [`read_mesh`], and a mesh of a name that is not there.
pub fn read_mesh_of(path: impl AsRef<Path>, options: &RigOptions) -> Result<ObjFile, SceneError> {
    Ok(read_shown_mesh(path, options)?.file)
}

/// A mesh of a file.
#[derive(Debug)]
#[non_exhaustive]
pub struct ShownMesh {
    /// The mesh as an OBJ.
    pub file: ObjFile,
    /// Positions `[vertex]` in the rest pose of its rig, if the file shows another pose.
    pub at_rest: Option<Vec<Point3>>,
    /// What was left out of a glTF without a skin.
    pub note: Option<PartsNote>,
    /// What was joined and left out of one with a skin.
    pub rig_note: Option<PartsNote>,
    /// Whether it is a drape that was written as GLB: a garment, and the body after it if it has
    /// one.
    pub is_drape: bool,
}

/// Reads a mesh as [`read_mesh_of`] does, and tells what was left out.
///
/// # Errors
///
/// Those of [`read_mesh_of`].
pub fn read_shown_mesh(
    path: impl AsRef<Path>,
    options: &RigOptions,
) -> Result<ShownMesh, SceneError> {
    let path = path.as_ref();
    if !is_rig(path) {
        let file = ObjFile::read(path)?;
        return Ok(ShownMesh {
            file,
            at_rest: None,
            note: None,
            rig_note: None,
            is_drape: false,
        });
    }
    // Which joint is which does not matter for a mesh.
    let options = RigOptions {
        joints: None,
        betas: Vec::new(),
        ..options.clone()
    };
    let read = match read_rig_with(path, &options) {
        Err(FileError {
            problem: FileProblem::Gltf(GltfProblem::NoSkin),
            ..
        }) if options.meshes.is_empty() => {
            let bare = read_bare(path)?;
            return Ok(ShownMesh {
                file: ObjFile::of_mesh(&bare.mesh, path)?,
                at_rest: None,
                note: PartsNote::of_bare(path, bare.parts),
                rig_note: None,
                is_drape: bare.is_drape,
            });
        }
        read => read?,
    };
    let rig_note = read.note(path);
    let rig = read.rig;
    let mesh = rig.rest.as_ref().ok_or_else(|| SceneError::NoBody {
        path: path.to_path_buf(),
        problem: SceneProblem::SkeletonAlone {
            rig: path.to_path_buf(),
        },
    })?;
    let is_npz = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("npz"));
    let Some(pose) = rig.rest_pose.as_ref().filter(|_| !is_npz) else {
        let file = ObjFile::of_mesh(mesh, path)?;
        return Ok(ShownMesh {
            file,
            at_rest: None,
            note: None,
            rig_note,
            is_drape: false,
        });
    };
    let transforms = rig.skeleton.transforms(pose)?;
    let shown = skin_linear(mesh.positions(), &rig.weights, &transforms);
    let shown = mesh
        .with_positions(shown)
        .map_err(|source| SceneError::Mesh {
            path: path.to_path_buf(),
            source,
        })?;
    Ok(ShownMesh {
        file: ObjFile::of_mesh(&shown, path)?,
        at_rest: Some(mesh.positions().to_vec()),
        note: None,
        rig_note,
        is_drape: false,
    })
}

/// Reads the frames of a glTF without a skin whose animation changes the shapes of its meshes, as
/// motions are written into a GLB: positions of the vertices of [`read_mesh`]. None of any other
/// file.
///
/// # Errors
///
/// [`SceneError`] if the file cannot be read, or if its frames make no sense or are too many.
pub fn read_mesh_frames(path: impl AsRef<Path>) -> Result<Option<MeshFrames>, SceneError> {
    let path = path.as_ref();
    let extension = path.extension().unwrap_or_default();
    if !is_rig(path) || extension.eq_ignore_ascii_case("npz") {
        return Ok(None);
    }
    Ok(read_frames(path)?)
}

/// Whether the name is that of a rig that may hold a mesh: npz, GLB, glTF or VRM.
pub fn is_rig(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    let extension = extension.unwrap_or_default().to_ascii_lowercase();
    matches!(extension.as_str(), "npz" | "glb" | "gltf" | "vrm")
}
