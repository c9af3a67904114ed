//! A body at rest of which a file is named.

use std::path::{Path, PathBuf};

use garnet_mesh::Point3;
use garnet_skin::{Body, Pose, Rig};

use super::{
    Frame, PoseNote, SceneError, SceneProblem,
    places::matched_rig,
    read_mesh::{ShownMesh, is_rig, read_shown_mesh},
    rest_body::rest_body_of,
    rest_mesh::{Frames, RestMesh},
    rig_search::{built_in, rig_beside},
};
use crate::{ObjFile, RigOptions, read_rig_with};

/// A body at rest, in metres with y up, and the OBJ that it came from.
#[derive(Debug)]
#[non_exhaustive]
pub struct OwnBody {
    /// The body, in the pose zero of its rig.
    pub body: Body,
    /// The text of its OBJ with unit and up axis, if it came as one.
    pub file: Option<(ObjFile, Frame)>,
    /// Unit and up axis that were taken for its mesh.
    pub frame: Frame,
    /// The positions that its file shows, where they are not those of the body, and the pose.
    pub shown: Option<(Vec<Point3>, Pose)>,
    /// What was taken for granted.
    pub notes: Vec<PoseNote>,
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
        Self::read_with(path, rig, &RigOptions::default())
    }

    /// The same with a choice of what is read of the rig.
    ///
    /// # Errors
    ///
    /// Those of [`OwnBody::read`].
    pub fn read_with(
        path: impl AsRef<Path>,
        rig: Option<&Path>,
        options: &RigOptions,
    ) -> Result<Self, SceneError> {
        let path = path.as_ref();
        if rig.is_none() && is_rig(path) {
            let read = read_rig_with(path, options)?;
            let note = read.note(path);
            let rig = read.rig;
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
            let (mut own, _) = in_metres(rig, &taken, path)?;
            own.notes.extend(note.map(PoseNote::Parts));
            return Ok(own);
        }
        let ShownMesh {
            file,
            note: of_mesh,
            ..
        } = read_shown_mesh(path, options)?;
        let mesh = file.mesh().map_err(|source| SceneError::NoBody {
            path: path.to_path_buf(),
            problem: source.into(),
        })?;
        let beside = rig_beside(path);
        let named = rig.map(Path::to_path_buf);
        let beside = beside.is_file().then_some(beside);
        let mut note = None;
        let (rig, rig_path): (Rig, PathBuf) = match named.or(beside) {
            Some(rig) => {
                let read = read_rig_with(&rig, options)?;
                note = read.note(&rig);
                (read.rig, rig)
            }
            None => (built_in(&mesh, path)?, path.to_path_buf()),
        };
        let (rig, _) = matched_rig(rig, &mesh, || file.polygon_edges());
        let taken = RestMesh {
            mesh,
            path: path.to_path_buf(),
            is_obj: true,
        };
        let (mut own, frame) = in_metres(rig, &taken, &rig_path)?;
        own.notes
            .extend(note.into_iter().chain(of_mesh).map(PoseNote::Parts));
        // What is posed from a rig file has no text to keep.
        own.file = (!is_rig(path)).then_some((file, frame));
        Ok(own)
    }
}

/// The body of a rig in metres with y up, and how its mesh was given.
fn in_metres(rig: Rig, taken: &RestMesh, rig_path: &Path) -> Result<(OwnBody, Frame), SceneError> {
    let frame = Frame::detected(&taken.mesh);
    let frames = Frames {
        obj: frame,
        rest: frame,
        rig: frame,
        bodies: Vec::new(),
    };
    let bodies = rest_body_of(rig, taken, &frames, rig_path)?;
    let notes = bodies.notes(&taken.path, rig_path);
    // Poses are those of the pose zero of the rig.
    let (body, shown) = match bodies.zero {
        None => (bodies.rest, None),
        Some(zero) => {
            let pose = Pose::from_transforms(zero.body.skeleton(), &zero.rest_from_zero)?.pose;
            let positions = bodies.rest.rest().positions().to_vec();
            (zero.body, Some((positions, pose)))
        }
    };
    let own = OwnBody {
        body,
        file: None,
        frame,
        shown,
        notes,
    };
    Ok((own, frame))
}
