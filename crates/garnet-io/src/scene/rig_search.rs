//! Where the rig of a body is of which only the mesh is named.

use std::path::{Path, PathBuf};

use garnet_body::shape::{Recognized, recognized};
use garnet_mesh::TriMesh;
use garnet_skin::Rig;

use super::{SceneError, SceneProblem, is_rig};

/// `folder/body.rig.npz` of `folder/body.obj`: where a body's rig is looked for.
pub fn rig_beside(body: &Path) -> PathBuf {
    body.with_extension("rig.npz")
}

/// Where the rig of a body is without one being named: the file itself, if it is a rig.
pub(super) fn rig_of(body: &Path) -> PathBuf {
    if is_rig(body) {
        return body.to_path_buf();
    }
    rig_beside(body)
}

/// The rig of the built-in body, if the mesh of the file is one at rest; in the unit of the file.
pub(super) fn built_in(mesh: &TriMesh, path: &Path) -> Result<Rig, SceneError> {
    let problem = match recognized(mesh) {
        Recognized::Rest(body) => return Ok(Rig::from(*body)),
        Recognized::Posed => SceneProblem::Posed,
        Recognized::Stranger => SceneProblem::Stranger {
            looked: vec![rig_beside(path)],
        },
    };
    Err(SceneError::NoRig {
        body: Some(path.to_path_buf()),
        problem,
    })
}
