//! A body that the user brings along.

use std::path::Path;

use anyhow::Context;
use garnet::{
    Body,
    io::{ObjFile, read_rig},
};

use crate::{failure::refused, sidecar::rig_beside};

/// The body at rest, in metres, and the text of its OBJ if it came as one.
pub(crate) fn read(path: &Path, rig: Option<&Path>) -> anyhow::Result<(Body, Option<ObjFile>)> {
    let cannot = || format!("cannot make a body of `{}`", path.display());
    let extension = path.extension().and_then(|extension| extension.to_str());
    let extension = extension.unwrap_or_default().to_ascii_lowercase();
    if rig.is_none() && matches!(extension.as_str(), "npz" | "glb" | "gltf") {
        let body = read_rig(path)?.into_body().with_context(cannot)?;
        return Ok((body, None));
    }
    let file = ObjFile::read(path)?;
    let beside = rig_beside(path);
    let rig_path = match rig {
        Some(rig) => rig,
        None if beside.is_file() => &beside,
        None => {
            return Err(refused(
                format!("there is no rig for `{}`", path.display()),
                format!(
                    "no `--rig` is given, and there is no `{}`",
                    beside.display()
                ),
                "give skeleton and weights with `--rig FILE` (npz, GLB, glTF or JSON)",
            ));
        }
    };
    let mesh = file.mesh().with_context(cannot)?;
    let body = read_rig(rig_path)?
        .into_body_with(mesh)
        .with_context(cannot)?;
    Ok((body, Some(file)))
}
