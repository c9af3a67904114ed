//! A body that the user brings along.

use std::path::Path;

use anyhow::Context;
use garnet::{
    Body, Rig,
    io::{ObjFile, read_rig},
};

use crate::{
    drape::{Frame, Frames, RestMesh, rest_body_of},
    failure::refused,
    sidecar::{built_in, rig_beside},
};

/// The text of an OBJ, and its unit and up axis.
pub(crate) type FramedFile = (ObjFile, Frame);

/// The body at rest in metres, and its OBJ if it came as one; unit and up axis are detected.
pub(crate) fn read(path: &Path, rig: Option<&Path>) -> anyhow::Result<(Body, Option<FramedFile>)> {
    let extension = path.extension().and_then(|extension| extension.to_str());
    let extension = extension.unwrap_or_default().to_ascii_lowercase();
    if rig.is_none() && matches!(extension.as_str(), "npz" | "glb" | "gltf") {
        let rig = read_rig(path)?;
        let mesh = rig.rest.clone().ok_or_else(|| {
            refused(
                format!("cannot make a body of `{}`", path.display()),
                "it holds a skeleton and weights alone",
                "give the OBJ of the body, and this file with `--rig`",
            )
        })?;
        let taken = RestMesh {
            mesh,
            path: path.to_path_buf(),
            is_obj: false,
        };
        return Ok((in_metres(rig, &taken, path)?.0, None));
    }
    let file = ObjFile::read(path)?;
    let mesh = file.mesh();
    let mesh = mesh.with_context(|| format!("cannot make a body of `{}`", path.display()))?;
    let beside = rig_beside(path);
    let (rig, rig_path) = match rig {
        Some(rig) => (read_rig(rig)?, rig),
        None if beside.is_file() => (read_rig(&beside)?, beside.as_path()),
        None => (built_in(&mesh, path)?, path),
    };
    let taken = RestMesh {
        mesh,
        path: path.to_path_buf(),
        is_obj: true,
    };
    let (body, frame) = in_metres(rig, &taken, rig_path)?;
    Ok((body, Some((file, frame))))
}

/// The body of a rig in metres with y up, and how its mesh was given.
fn in_metres(rig: Rig, taken: &RestMesh, rig_path: &Path) -> anyhow::Result<(Body, Frame)> {
    let frame = Frame::detected(&taken.mesh);
    let frames = Frames {
        obj: frame,
        rest: frame,
        rig: frame,
        bodies: Vec::new(),
    };
    let bodies = rest_body_of(rig, taken, &frames, rig_path)?;
    // Poses are those of the pose zero of the rig.
    let body = bodies.zero.map_or(bodies.rest, |zero| zero.body);
    Ok((body, frame))
}
