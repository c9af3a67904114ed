//! Reading all that a scene needs, in parallel.

use std::{
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
};

use garnet_body::shape::{Recognized, recognized};
use garnet_mesh::{Point3, Unit, UpAxis};
use garnet_skin::Rig;
use rayon::prelude::*;

use super::{
    MotionOptions, PoseSource, SceneError, SceneProblem, is_rig,
    read_mesh::{ShownMesh, read_shown_mesh},
    rig_search::{built_in, rig_beside, rig_of},
};
use crate::{ObjFile, PartsNote, RigOptions, SceneJson, read_rig, read_rig_with};

/// The files of a scene, and what is known of them without reading them.
///
/// The rig of the bodies is the first that there is: [`SceneFiles::rig`]; [`SceneFiles::own_rig`],
/// unless a rest body is named or the rig beside the first body is of another topology;
/// `<rest body>.rig.npz` beside the rest body; the first body itself, if it is a rig, or
/// `<body>.rig.npz` beside it; that of the built-in body, if the rest body or else the one body is
/// one at rest.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct SceneFiles {
    /// The garment, as OBJ, lying on the rest body.
    pub garment: PathBuf,
    /// Skeleton and weights of the body that the garment was made on, if they came with it: those
    /// of a package. The garment is then in metres with y up.
    pub own_rig: Option<PathBuf>,
    /// The bodies that the garment goes to, as OBJ, npz, GLB or glTF; with a pose, the rest body.
    pub bodies: Vec<PathBuf>,
    /// Skeleton and weights of the bodies: npz, GLB, glTF, VRM or JSON.
    pub rig: Option<PathBuf>,
    /// The body on which the garment lies, as OBJ, npz, GLB or glTF; else the rest mesh of the rig.
    pub rest_body: Option<PathBuf>,
    /// Whether the garment is brought to its body where it does not lie on it.
    pub place: bool,
    /// How the rig is read.
    pub rig_options: RigOptions,
    /// The poses that the rest body takes, in place of those of the bodies.
    pub pose: Option<PoseSource>,
    /// Where a motion of those poses goes, and how fast.
    pub motion: MotionOptions,
    /// Units of the OBJ files, where they are not to be detected.
    pub units: SceneUnits,
    /// The axis of the OBJ files that points up; the longer of y and z of the rest body without it.
    pub up: Option<UpAxis>,
}

/// Units of length that are known beforehand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SceneUnits {
    /// That of the garment; that of the bodies without it.
    pub garment: Option<Unit>,
    /// That of the bodies; the one in which the rest body has the height of a body without it.
    pub body: Option<Unit>,
}

impl SceneFiles {
    /// A garment alone; all other fields are public.
    pub fn new(garment: impl Into<PathBuf>) -> Self {
        Self {
            garment: garment.into(),
            ..Self::default()
        }
    }
}

/// The files of a scene, as read.
#[derive(Debug)]
pub(super) struct ReadFiles {
    pub(super) garment: ObjFile,
    pub(super) bodies: Vec<BodyFile>,
    pub(super) rest_body: Option<ObjFile>,
    pub(super) rig: Rig,
    pub(super) rig_path: PathBuf,
    /// The body that the garment lies on, where that is not the one of the rig.
    pub(super) own: Option<Rig>,
    /// Which meshes of rig files are bodies.
    pub(super) parts: Vec<PartsNote>,
}

/// A body of which positions are kept, and the text if there is but one.
#[derive(Debug)]
pub(super) struct BodyFile {
    pub(super) path: PathBuf,
    /// In the unit of the file.
    pub(super) positions: Vec<Point3>,
    /// Of its polygons: bodies of one topology share them.
    pub(super) edges: Arc<Vec<[u32; 2]>>,
    /// Its polygons as triangles, shared likewise.
    pub(super) triangles: Arc<Vec<[u32; 3]>>,
    pub(super) file: Option<ObjFile>,
    /// Of a rig: positions in the rest pose of the rig, where it shows another one.
    pub(super) at_rest: Option<Vec<Point3>>,
    /// What was left out.
    pub(super) note: Option<PartsNote>,
}

impl ReadFiles {
    pub(super) fn read(files: &SceneFiles) -> Result<Self, SceneError> {
        let rig_path = rig_path(files);
        let meshes = || {
            rayon::join(
                || ObjFile::read(&files.garment),
                || {
                    rayon::join(
                        || read_bodies(files),
                        || read_rest(files, rig_path.as_deref()),
                    )
                },
            )
        };
        let read = |path: &Path| Ok((read_rig_with(path, &files.rig_options)?, path.to_path_buf()));
        let rig = || -> Result<_, SceneError> { rig_path.as_deref().map(read).transpose() };
        let ((garment, (bodies, rest_body)), rig) = rayon::join(meshes, rig);
        let (garment, mut bodies, rest) = (garment?, bodies?, rest_body?);
        let (rest_body, note) = rest.map_or((None, None), |rest| (Some(rest.file), rest.note));
        let mut parts = Vec::new();
        let (mut rig, mut rig_path) = match rig? {
            Some((read, rig_path)) => {
                parts.extend(read.note(&rig_path));
                (read.rig, rig_path)
            }
            None => built_in_rig(rest_body.as_ref(), &bodies, files)?,
        };
        parts.extend(note);
        parts.extend(bodies.iter_mut().filter_map(|body| body.note.take()));
        let mut own = None;
        if let Some(own_rig) = &files.own_rig {
            if *own_rig != rig_path {
                own = Some(read_rig(own_rig)?);
            } else if let Some((other, path)) = rig_of_stranger(&rig, &bodies)? {
                own = Some(std::mem::replace(&mut rig, other));
                rig_path = path;
            }
        }
        Ok(Self {
            garment,
            bodies,
            rest_body,
            rig,
            rig_path,
            own,
            parts,
        })
    }
}

/// The rig beside a body, if that is of another topology than the body of the garment.
fn rig_of_stranger(own: &Rig, bodies: &[BodyFile]) -> Result<Option<(Rig, PathBuf)>, SceneError> {
    let (Some(rest), Some(body)) = (&own.rest, bodies.first()) else {
        return Ok(None);
    };
    let path = rig_of(&body.path);
    if !path.is_file() {
        return Ok(None);
    }
    let other = read_rig(&path)?;
    let is_stranger = match &other.rest {
        Some(mesh) => mesh.faces() != rest.faces(),
        None => body.positions.len() != rest.num_vertices(),
    };
    Ok(is_stranger.then_some((other, path)))
}

/// The rig of a built-in body without a rig file: of the rest body, or else of the one body.
fn built_in_rig(
    rest_body: Option<&ObjFile>,
    bodies: &[BodyFile],
    files: &SceneFiles,
) -> Result<(Rig, PathBuf), SceneError> {
    let first = bodies.first().and_then(|body| body.file.as_ref());
    let Some(file) = rest_body.or(first) else {
        return Err(no_rig(files));
    };
    let Ok(mesh) = file.mesh() else {
        return Err(no_rig(files));
    };
    match recognized(&mesh) {
        Recognized::Stranger => Err(no_rig(files)),
        _ => Ok((built_in(&mesh, file.path())?, file.path().to_path_buf())),
    }
}

/// The rest body, unless it is the rest mesh of the rig itself.
fn read_rest(files: &SceneFiles, rig: Option<&Path>) -> Result<Option<ShownMesh>, SceneError> {
    let path = files.rest_body.as_deref();
    let Some(path) = path.filter(|path| !is_rig(path) || rig != Some(*path)) else {
        return Ok(None);
    };
    read_shown_mesh(path, &files.rig_options).map(Some)
}

/// A list, or the first one if that is the same.
fn shared<T: PartialEq + Clone>(first: &OnceLock<Arc<Vec<T>>>, list: Vec<T>) -> Arc<Vec<T>> {
    let first = first.get_or_init(|| Arc::new(list.clone()));
    if **first == list {
        return Arc::clone(first);
    }
    Arc::new(list)
}

fn read_bodies(files: &SceneFiles) -> Result<Vec<BodyFile>, SceneError> {
    let paths = &files.bodies;
    let is_single = paths.len() == 1;
    let (first_edges, first_triangles) = (OnceLock::new(), OnceLock::new());
    let read = |path: &PathBuf| -> Result<BodyFile, SceneError> {
        let ShownMesh {
            file,
            at_rest,
            note,
            ..
        } = read_shown_mesh(path, &files.rig_options)?;
        let edges = file.polygon_edges();
        let edges = shared(&first_edges, edges);
        let triangles = shared(&first_triangles, file.triangles());
        Ok(BodyFile {
            at_rest,
            note,
            path: path.clone(),
            positions: file.positions().to_vec(),
            edges,
            triangles,
            file: (is_single && !is_rig(path)).then_some(file),
        })
    };
    // In their order, so that of several bad files the first is told.
    let all: Vec<Result<BodyFile, SceneError>> = paths.par_iter().map(read).collect();
    all.into_iter().collect()
}

/// Where the rig is: as named, or that of the garment, or beside the rest body, or beside the first
/// body.
fn rig_path(files: &SceneFiles) -> Option<PathBuf> {
    let own = || (files.own_rig.as_ref()).filter(|_| files.rest_body.is_none());
    if let Some(path) = files.rig.as_ref().or_else(own) {
        return Some(path.clone());
    }
    let beside = files.rest_body.iter().chain(files.bodies.first());
    beside.map(|path| rig_of(path)).find(|path| path.is_file())
}

fn no_rig(files: &SceneFiles) -> SceneError {
    let of_garment = rig_beside(&files.garment);
    if let (Some(body), true) = (files.bodies.first(), of_garment.is_file()) {
        return SceneError::BodyAsGarment {
            garment: files.garment.clone(),
            problem: SceneProblem::RigOfGarment {
                rig: of_garment,
                body: body.clone(),
            },
        };
    }
    let bodies = files.rest_body.iter().chain(files.bodies.first());
    SceneError::NoRig {
        body: files.bodies.first().or(files.rest_body.as_ref()).cloned(),
        problem: SceneProblem::NoneBeside {
            looked: bodies.map(|path| rig_beside(path)).collect(),
        },
    }
}

/// The files that a `drape-scene/1` file names, as read.
#[derive(Debug)]
pub(super) struct NamedFiles {
    pub(super) scene: SceneJson,
    pub(super) garment: ObjFile,
    pub(super) rig: Rig,
    pub(super) target: ObjFile,
}

impl NamedFiles {
    pub(super) fn read(path: &Path) -> Result<Self, SceneError> {
        let scene = SceneJson::read(path)?;
        let meshes = || {
            rayon::join(
                || ObjFile::read_regular(&scene.garment),
                || ObjFile::read_regular(&scene.target_body),
            )
        };
        let ((garment, target), rig) = rayon::join(meshes, || scene.rig());
        Ok(Self {
            garment: garment?,
            target: target?,
            rig: rig?,
            scene,
        })
    }
}
