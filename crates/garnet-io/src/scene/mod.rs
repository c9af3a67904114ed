//! A scene read from files: a garment on a body at rest, and the bodies that it goes to.
//!
//! [`Scene::load`] reads the files that are named, finds the rig, detects units and axes, and
//! brings all to metres with y up. What was detected is part of the scene.

mod error;
mod files;
mod frame;
mod own_body;
mod places;
mod pose;
mod read_mesh;
mod rest_body;
mod rest_mesh;
mod rig_search;
mod same_faces;

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use garnet_knn::Surface;
use garnet_mesh::{Bounds, KnownMesh, Point3, TriMesh, Unit, UpAxis};
use garnet_skin::{Body, Method, Pose, PosedBody, Rig, SkinError, skin_linear};
use nalgebra::Isometry3;

pub use error::{SceneError, SceneProblem};
pub use files::{SceneFiles, SceneUnits};
pub use frame::Frame;
pub use own_body::OwnBody;
pub use pose::{MotionOptions, NamedPose, PoseError, PoseNote, PoseProblem, PoseSource, Posing};
pub use read_mesh::{
    ShownMesh, is_rig, read_mesh, read_mesh_frames, read_mesh_of, read_shown_mesh,
};
pub use rest_body::largest_distance;
pub use rig_search::rig_beside;

use crate::{Alignment, ObjFile, aligned, check_pieces};
use files::{BodyFile, NamedFiles, ReadFiles};
use places::{match_body, matched_rig};
use rest_body::{RestBodies, Zero, in_metres, rest_body_of, unfit};
use rest_mesh::{Frames, RestMesh, check_target, mesh_of};

/// A garment on a body at rest and the bodies that it goes to, in metres with y up.
#[derive(Debug)]
#[non_exhaustive]
pub struct Scene {
    /// The garment.
    pub garment: SceneGarment,
    /// The body that the garment lies on, if that is another than [`Scene::body`]: the garment is
    /// then to be brought to that first.
    pub own: Option<Body>,
    /// The rest body.
    pub body: Body,
    /// Where the rest body came from.
    pub rest: RestSource,
    /// What the garment goes to.
    pub targets: Vec<Target>,
    /// What was taken for granted while poses were read.
    pub notes: Vec<PoseNote>,
    /// Seconds from each target to the next, if they are frames of a motion that says.
    pub frame_time: Option<f64>,
}

/// A garment as read.
#[derive(Debug)]
#[non_exhaustive]
pub struct SceneGarment {
    /// The text of its file.
    pub file: ObjFile,
    /// Unit and up axis of the file: as named, or as detected of the rest body.
    pub frame: Frame,
    /// The mesh, in metres with y up.
    pub mesh: TriMesh,
}

/// Where a rest body came from.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct RestSource {
    /// The file with its mesh.
    pub path: PathBuf,
    /// The file with its skeleton and weights.
    pub rig_path: PathBuf,
    /// Unit and up axis of that file.
    pub frame: Frame,
    /// The OBJ whose text posed bodies are written with; none if the mesh came from the rig alone.
    pub file: Option<ObjFile>,
    /// Unit and up axis in which posed bodies are written: those of the garment.
    pub file_frame: Frame,
}

/// A body that a garment goes to.
#[derive(Debug)]
#[non_exhaustive]
pub struct Target {
    /// The file that tells its pose.
    pub path: PathBuf,
    /// What outputs are called, if it is one frame of several.
    pub stem: Option<String>,
    /// Where its pose and shape come from.
    pub source: TargetSource,
}

/// Where the pose and shape of a target come from.
#[derive(Debug)]
#[non_exhaustive]
pub enum TargetSource {
    /// Where its vertices are.
    Vertices(Vec<Point3>),
    /// Where its vertices are, and how each joint moved.
    Transforms(Vec<Point3>, Vec<Isometry3<f32>>),
    /// The pose of the rest body.
    Pose(Pose),
    /// The pose of the body as its rig has it, which garments do not lie on.
    PoseOfRig(Pose, RigRest),
}

/// The body in the pose zero of its rig, and the way from there to the rest body.
#[derive(Debug, Clone)]
pub struct RigRest(Arc<Zero>);

impl Target {
    /// The rest body in the pose and shape of the target.
    ///
    /// # Errors
    ///
    /// [`SceneError::Unfitted`] if the body cannot take the pose.
    pub fn posed(&self, body: &Body) -> Result<PosedBody, SceneError> {
        let posed = match &self.source {
            TargetSource::Vertices(positions) => body.fitted(positions),
            TargetSource::Transforms(positions, transforms) => {
                body.fitted_by(positions, transforms.clone())
            }
            TargetSource::Pose(pose) => body.posed(pose),
            TargetSource::PoseOfRig(pose, rig) => rig.posed(pose, body),
        };
        posed.map_err(|source| SceneError::Unfitted {
            path: self.path.clone(),
            source,
        })
    }
}

/// A target whose vertices are as near as this to those of the rest body is the rest body, in
/// metres.
const SAME: f32 = 2e-3;

/// Cloth that was made of the mesh of a body is no farther from it than this, in metres.
const MAX_SUIT: f32 = 0.05;

/// Relative rounding of the length of a unit.
const UNIT_ROUNDING: f32 = 1e-3;

impl Scene {
    /// Reads the files of a scene and brings them together.
    ///
    /// # Errors
    ///
    /// [`SceneError`]: a file that cannot be read, a body without rig, files that are not of one
    /// body, or a garment that does not lie on it.
    ///
    /// # Examples
    ///
    /// ```no_run
    /// use garnet_io::{Scene, SceneFiles};
    ///
    /// let mut files = SceneFiles::new("shirt.obj");
    /// files.bodies = vec!["body.obj".into()];
    /// files.pose = Some("wave".into());
    /// let scene = Scene::load(&files)?;
    /// println!("the garment is in {}", scene.garment.frame.unit.name());
    /// # Ok::<(), garnet_io::SceneError>(())
    /// ```
    pub fn load(files: &SceneFiles) -> Result<Self, SceneError> {
        Self::of_files(files, ReadFiles::read(files)?)
    }

    /// Reads a `drape-scene/1` file and all that it names.
    ///
    /// # Errors
    ///
    /// [`SceneError`]: a file that cannot be read, or files that are not of one body.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        let NamedFiles {
            scene,
            garment,
            rig,
            target,
        } = NamedFiles::read(path)?;
        let metres = scene.metres_per_unit as f32;
        let unit = Unit::ALL
            .into_iter()
            .find(|unit| (unit.in_metres() / metres - 1.0).abs() < UNIT_ROUNDING);
        let frame = Frame {
            unit: unit.unwrap_or(Unit::Metre),
            up: UpAxis::Y,
        };
        let mesh = mesh_of(&garment)?;
        let body = rig.into_body();
        let body = body.map_err(|error| unfit(path, &scene.rest_body, error.into()))?;
        let positions = frame.to_metres(target.positions().to_vec());
        check_target(
            &scene.target_body,
            &positions,
            &target.polygon_edges(),
            &KnownMesh::of(body.rest()),
        )?;
        let source = match scene.posed_from_rest {
            Some(transforms) => TargetSource::Transforms(positions, transforms),
            None => TargetSource::Vertices(positions),
        };
        Ok(Self {
            garment: SceneGarment {
                mesh: in_metres(mesh, frame)?,
                file: garment,
                frame,
            },
            own: None,
            body,
            rest: RestSource {
                path: scene.rest_body,
                rig_path: path.to_path_buf(),
                frame,
                file: None,
                file_frame: frame,
            },
            targets: vec![Target {
                path: scene.target_body,
                stem: None,
                source,
            }],
            notes: Vec::new(),
            frame_time: None,
        })
    }

    #[expect(clippy::too_many_lines, reason = "a file after the other")]
    fn of_files(files: &SceneFiles, read: ReadFiles) -> Result<Self, SceneError> {
        let ReadFiles {
            garment,
            mut bodies,
            rest_body,
            rig,
            rig_path,
            own,
            parts,
        } = read;
        let is_posed = files.pose.is_some();
        let first = bodies.first_mut();
        let rest_obj = rest_body.or_else(|| {
            // An unposed body stands for the rest body, and its text for the output.
            first.filter(|_| is_posed).and_then(|body| body.file.take())
        });
        // What a file of graphics shows may be a frame of an animation.
        let shows_a_frame = rest_obj.is_none() && is_graphics(&rig_path);
        let rest_mesh = rest_obj.as_ref().map(mesh_of).transpose()?;
        let (rig, places) = match &rest_mesh {
            Some(mesh) => matched_rig(rig, mesh, || {
                rest_obj
                    .as_ref()
                    .map(ObjFile::polygon_edges)
                    .unwrap_or_default()
            }),
            None => (rig, None),
        };
        let taken = RestMesh::taken(rest_obj.as_ref(), &rig, &rig_path, files)?;
        for body in &mut bodies {
            match_body(body, &taken.mesh, places.as_deref());
        }
        let mesh = mesh_of(&garment)?;
        let has_faces_of_body = files.own_rig.is_none() && mesh.faces() == taken.mesh.faces();
        let body_as_garment = || SceneError::BodyAsGarment {
            garment: files.garment.clone(),
            problem: SceneProblem::FacesOfBody {
                body: taken.path.clone(),
            },
        };
        let num_vertices = taken.mesh.num_vertices();
        if has_faces_of_body && (bodies.iter()).any(|body| body.positions.len() != num_vertices) {
            return Err(body_as_garment());
        }
        let frames = taken.frames(&bodies, files)?;
        let mut frame = Frame {
            unit: files.units.garment.unwrap_or(frames.obj.unit),
            up: frames.obj.up,
        };
        let mut rig = rig;
        let is_on_bind = shows_a_frame && lies_on_bind(&rig, frames.rig, &mesh, frame)?;
        if is_on_bind {
            rig.rest_pose = None;
        }
        let body = rest_body_of(rig, &taken, &frames, &rig_path)?;
        let mut alignment = None;
        // A garment with a body of its own is in metres, whatever the bodies are in.
        let mesh = match files.own_rig {
            Some(_) => mesh,
            None if files.place => {
                let mesh = in_metres(mesh, frame)?;
                let (mesh, found) = brought(files, &mesh, (&body.rest, &taken.path))?;
                // It is in the units of the body from here on.
                frame = frames.obj;
                alignment = Some(found);
                mesh
            }
            None => placed(
                files,
                mesh,
                frame,
                (&body.rest, &taken.path, frames.obj.unit),
            )?,
        };
        if has_faces_of_body && !is_suit(mesh.positions(), body.rest.rest().positions()) {
            return Err(body_as_garment());
        }
        let own = own.map(Rig::into_body).transpose()?;
        let own = own.filter(|own| !is_same(own, &body.rest));
        let mut notes: Vec<PoseNote> = parts.into_iter().map(PoseNote::Parts).collect();
        notes.extend(is_on_bind.then(|| PoseNote::OnBind {
            rig: rig_path.clone(),
        }));
        notes.extend(alignment.map(|alignment| PoseNote::Placed {
            garment: files.garment.clone(),
            alignment,
        }));
        notes.extend(body.notes(&taken.path, &rig_path));
        notes.extend(frames.notes(&bodies));
        let RestBodies { rest, zero, .. } = body;
        let zero = zero.map(Arc::new);
        let (targets, of_poses, frame_time) = match &files.pose {
            Some(pose) => posed_targets(
                (pose, &files.motion),
                (&rest, zero.as_ref()),
                &bodies,
                &frames,
                &rig_path,
            )?,
            None => (mesh_targets(bodies, &rest, &frames)?, Vec::new(), None),
        };
        notes.extend(of_poses);
        Ok(Self {
            garment: SceneGarment {
                file: garment,
                frame,
                mesh,
            },
            own,
            rest: RestSource {
                path: match &rest_obj {
                    Some(file) => file.path().to_path_buf(),
                    None => taken.path,
                },
                rig_path,
                frame: match &rest_obj {
                    Some(_) => frames.obj,
                    None => frames.rest,
                },
                // A posed body lies under the drape beside it.
                file_frame: frame,
                file: rest_obj,
            },
            body: rest,
            targets,
            notes,
            frame_time,
        })
    }
}

/// A garment brought to the body, and what was done.
fn brought(
    files: &SceneFiles,
    mesh: &TriMesh,
    (body, path): (&Body, &Path),
) -> Result<(TriMesh, Alignment), SceneError> {
    let found = aligned(mesh, body)?;
    // What hardly any limb goes through is of no size or kind that was tried.
    let is_worn = |(_, alignment): &(TriMesh, Alignment)| {
        let [openings, threaded] = alignment.openings;
        openings < 2 || 2 * threaded >= openings
    };
    found.filter(is_worn).ok_or_else(|| SceneError::Unplaced {
        garment: files.garment.clone(),
        body: path.to_path_buf(),
    })
}

/// A garment in metres with y up, once its size and place are those of one on the body.
fn placed(
    files: &SceneFiles,
    mesh: TriMesh,
    frame: Frame,
    (body, path, body_unit): (&Body, &Path, Unit),
) -> Result<TriMesh, SceneError> {
    let mesh = in_metres(mesh, frame)?;
    if let Some(body) = Bounds::of_faces(body.rest().positions(), body.rest().faces()) {
        check_pieces(&mesh, &body, frame).map_err(|problem| SceneError::Misplaced {
            garment: files.garment.clone(),
            body: path.to_path_buf(),
            frame,
            body_unit,
            problem,
        })?;
    }
    Ok(mesh)
}

/// Whether vertices that are numbered like those of a body are a suit that was made of it, and not
/// the body, at rest or in a pose.
fn is_suit(garment: &[Point3], body: &[Point3]) -> bool {
    (SAME..MAX_SUIT).contains(&largest_distance(garment, body))
}

/// Whether a rig comes from a GLB, glTF or VRM.
fn is_graphics(rig: &Path) -> bool {
    is_rig(rig)
        && rig
            .extension()
            .is_none_or(|extension| !extension.eq_ignore_ascii_case("npz"))
}

/// Whether a garment lies on the bind pose of a rig, where the rig shows another one: the pose in
/// which fewer of its vertices are inside the body.
fn lies_on_bind(
    rig: &Rig,
    rig_frame: Frame,
    garment: &TriMesh,
    frame: Frame,
) -> Result<bool, SceneError> {
    let (Some(mesh), Some(pose)) = (&rig.rest, &rig.rest_pose) else {
        return Ok(false);
    };
    let transforms = rig.skeleton.transforms(pose)?;
    let shown = skin_linear(mesh.positions(), &rig.weights, &transforms);
    let vertices = frame.to_metres(garment.positions().to_vec());
    let num_inside = |positions: Vec<Point3>| -> Result<usize, SceneError> {
        let moved = mesh.with_positions(positions);
        let moved = moved.map_err(|source| SceneError::OutOfRange {
            unit: rig_frame.unit,
            source,
        })?;
        let inside = Surface::new(&in_metres(moved, rig_frame)?).contains_all(&vertices);
        Ok(inside.into_iter().filter(|&is_inside| is_inside).count())
    };
    Ok(num_inside(mesh.positions().to_vec())? < num_inside(shown)?)
}

/// Whether a garment that lies on one body lies on the other.
fn is_same(own: &Body, other: &Body) -> bool {
    let (own, other) = (own.rest(), other.rest());
    own.faces() == other.faces() && largest_distance(own.positions(), other.positions()) < SAME
}

fn mesh_targets(
    bodies: Vec<BodyFile>,
    rest: &Body,
    frames: &Frames,
) -> Result<Vec<Target>, SceneError> {
    let mut targets = Vec::with_capacity(bodies.len());
    let known = KnownMesh::of(rest.rest());
    for (body, frame) in bodies.into_iter().zip(&frames.bodies) {
        let positions = frame.to_metres(body.positions);
        check_target(&body.path, &positions, &body.edges, &known)?;
        targets.push(Target {
            path: body.path,
            stem: None,
            source: TargetSource::Vertices(positions),
        });
    }
    Ok(targets)
}

/// The targets of poses, what is to be told of them, and the time between two frames.
type PosedTargets = (Vec<Target>, Vec<PoseNote>, Option<f64>);

fn posed_targets(
    (source, of_motion): (&PoseSource, &MotionOptions),
    (rest, zero): (&Body, Option<&Arc<Zero>>),
    given: &[BodyFile],
    frames: &Frames,
    rig: &Path,
) -> Result<PosedTargets, SceneError> {
    for (body, frame) in given.iter().zip(&frames.bodies) {
        let positions = frame.to_metres(body.positions.clone());
        let from_zero = zero.iter().map(|zero| zero.body.rest());
        let rests = std::iter::once(rest.rest()).chain(from_zero);
        let at_rest = body
            .at_rest
            .clone()
            .map(|positions| frame.to_metres(positions));
        let found = std::iter::once(&positions).chain(&at_rest);
        let found: Vec<&Vec<Point3>> = found.collect();
        let distances = rests.flat_map(|mesh| {
            let own = || rest.of_skin(mesh.positions());
            let found = found.iter();
            found.map(move |found| largest_distance(own(), rest.of_skin(found)))
        });
        let distance = distances.fold(f32::INFINITY, f32::min);
        if distance > SAME {
            return Err(SceneError::NotAtRest {
                path: body.path.clone(),
                problem: SceneProblem::Moved { distance },
            });
        }
    }
    let posed = zero.map_or(rest, |zero| &zero.body);
    let posing = source.read(posed, of_motion);
    let Posing {
        poses,
        notes,
        seconds,
    } = posing.map_err(|error| error.of_rig(rig))?;
    let mut targets = Vec::with_capacity(poses.len());
    for named in poses {
        let of_target = match zero {
            None => TargetSource::Pose(named.pose),
            Some(zero) => TargetSource::PoseOfRig(named.pose, RigRest(Arc::clone(zero))),
        };
        let is_several = source.is_several();
        targets.push(Target {
            path: if is_several {
                named.label.into()
            } else {
                source.path.clone()
            },
            stem: is_several.then_some(named.stem),
            source: of_target,
        });
    }
    Ok((targets, notes, seconds))
}

impl RigRest {
    /// A rest body in a pose of the body that the rig has in its pose zero.
    fn posed(&self, pose: &Pose, body: &Body) -> Result<PosedBody, SkinError> {
        let zero = &self.0;
        let posed_from_zero = zero.body.skeleton().transforms(pose)?;
        let positions = zero
            .body
            .transformed_positions(&posed_from_zero, Method::DualQuaternion);
        let pairs = posed_from_zero.iter().zip(&zero.rest_from_zero);
        let posed_from_rest = pairs.map(|(posed, rest)| posed * rest.inverse()).collect();
        body.fitted_by(&positions, posed_from_rest)
    }
}
