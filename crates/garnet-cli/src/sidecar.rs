//! The rig of a body of which only the mesh is named.

use std::path::{Path, PathBuf};

use garnet::{
    Rig, TriMesh,
    shape::{Recognized, recognized},
};

use crate::failure::refused;

/// `folder/body.rig.npz` of `folder/body.obj`.
pub(crate) fn rig_beside(body: &Path) -> PathBuf {
    body.with_extension("rig.npz")
}

/// The rig of the built-in body, if the mesh of the file is one at rest; in the unit of the file.
pub(crate) fn built_in(mesh: &TriMesh, path: &Path) -> anyhow::Result<Rig> {
    let refuse = |cause: String| {
        refused(
            format!("there is no rig for `{}`", path.display()),
            cause,
            "give the skeleton and weights of the body with `--rig FILE` (npz, GLB, glTF or JSON), \
             and the body on which the garment lies with `--rest-body OBJ` if the rig does not hold \
             it",
        )
    };
    match recognized(mesh) {
        Recognized::Rest(body) => Ok(Rig::from(*body)),
        Recognized::Posed => Err(refuse(
            "it is the built-in body in a pose, and its skeleton at rest cannot be told from that"
                .to_owned(),
        )),
        Recognized::Stranger => Err(refuse(format!(
            "no `--rig` is given, there is no `{}`, and it is not the built-in body",
            rig_beside(path).display()
        ))),
    }
}
