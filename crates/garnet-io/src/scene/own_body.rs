//! A body at rest of which a file is named.

use std::path::{Path, PathBuf};

use garnet_skin::{Body, Rig};

use super::{
    Frame, SceneError, SceneProblem,
    read_mesh::is_rig,
    rest_body::rest_body_of,
    rest_mesh::{Frames, RestMesh},
    rig_search::{built_in, rig_beside},
};
use crate::{ObjFile, read_rig};

/// A body at rest, in metres with y up, and the OBJ that it came from.
#[derive(Debug)]
#[non_exhaustive]
pub struct OwnBody {
    /// The body, in the pose zero of its rig.
    pub body: Body,
    /// The text of its OBJ with unit and up axis, if it came as one.
    pub file: Option<(ObjFile, Frame)>,
}

impl OwnBody {
    /// Reads a body from an OBJ, or from a rig that holds its mesh (npz, GLB, glTF).
    ///
    /// The rig of an OBJ is `rig`, or `<body>.rig.npz` beside it, or that of the built-in body.
    /// Unit and up axis are detected.
    ///
    /// # Errors
    ///
    /// [`SceneError`]: files that cannot be read, a body without rig, or a rig that does not fit.
    pub fn read(path: impl AsRef<Path>, rig: Option<&Path>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        if rig.is_none() && is_rig(path) {
            let rig = read_rig(path)?;
            let mesh = rig.rest.clone().ok_or_else(|| SceneError::NoBody {
                path: path.to_path_buf(),
                problem: SceneProblem::SkeletonAlone {
                    rig: path.to_path_buf(),
                },
            })?;
            let taken = RestMesh {
                mesh,
                path: path.to_path_buf(),
                is_obj: false,
            };
            let (body, _) = in_metres(rig, &taken, path)?;
            return Ok(Self { body, file: None });
        }
        let file = ObjFile::read(path)?;
        let mesh = file.mesh().map_err(|source| SceneError::NoBody {
            path: path.to_path_buf(),
            problem: source.into(),
        })?;
        let beside = rig_beside(path);
        let (rig, rig_path): (Rig, PathBuf) = match rig {
            Some(rig) => (read_rig(rig)?, rig.to_path_buf()),
            None if beside.is_file() => (read_rig(&beside)?, beside),
            None => (built_in(&mesh, path)?, path.to_path_buf()),
        };
        let taken = RestMesh {
            mesh,
            path: path.to_path_buf(),
            is_obj: true,
        };
        let (body, frame) = in_metres(rig, &taken, &rig_path)?;
        Ok(Self {
            body,
            file: Some((file, frame)),
        })
    }
}

/// The body of a rig in metres with y up, and how its mesh was given.
fn in_metres(rig: Rig, taken: &RestMesh, rig_path: &Path) -> Result<(Body, Frame), SceneError> {
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
