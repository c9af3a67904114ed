//! From files to values in metres: the garment, the rest body, and the targets.

use std::path::{Path, PathBuf};

use anyhow::Context;
use garnet::{
    Body, Garment, Isometry3, KnownMesh, Method, Point3, Pose, PosedBody, Refit, Rig, TriMesh,
    Unit, UpAxis, io::ObjFile, package::GarmentPackage,
};

use super::{
    args::{Source, SourceFiles},
    files::{BodyFile, Files, SceneFiles},
    frame::Frame,
    placement,
    rest_body::{RestBodies, Zero, does_not_fit, in_metres, largest_distance, rest_body_of},
    rest_mesh::{Frames, RestMesh, check_target, mesh_of},
};
use crate::{
    failure::refused,
    posing::{PoseSource, Posing, of_rig},
};

/// All that a drape starts from, in metres with y up.
#[derive(Debug)]
pub(crate) struct Prepared {
    pub(crate) garment_file: ObjFile,
    pub(crate) garment_frame: Frame,
    pub(crate) garment: TriMesh,
    /// How the garment came to the body, if it was made for another one.
    pub(crate) refit: Option<Refit>,
    pub(crate) rest: RestBody,
    pub(crate) body: Body,
    pub(crate) targets: Vec<Target>,
    pub(crate) pose: Option<PoseSource>,
    /// What was taken for granted while poses were read.
    pub(crate) notes: Vec<String>,
}

/// Where the rest body came from.
#[derive(Debug)]
pub(crate) struct RestBody {
    /// The file with its mesh.
    pub(crate) path: PathBuf,
    /// The file with its skeleton and weights.
    pub(crate) rig_path: PathBuf,
    pub(crate) frame: Frame,
    /// The OBJ in which a posed body is written; none if the mesh came from the rig alone.
    pub(crate) file: Option<ObjFile>,
    /// Unit and axis of that OBJ.
    pub(crate) file_frame: Frame,
}

/// A body to drape on.
#[derive(Debug)]
pub(crate) struct Target {
    /// The file that tells its pose.
    pub(crate) path: PathBuf,
    /// What outputs are called, if it is one frame of several.
    pub(crate) stem: Option<String>,
    pub(crate) aim: Aim,
}

/// What is known of a target.
#[derive(Debug)]
pub(crate) enum Aim {
    /// Where its vertices are.
    Vertices(Vec<Point3>),
    /// Where its vertices are, and how each joint moved.
    Transforms(Vec<Point3>, Vec<Isometry3<f32>>),
    /// The pose of the rest body.
    Pose(Pose),
}

impl Target {
    /// The body in its pose.
    pub(crate) fn posed(&self, body: &Body) -> anyhow::Result<PosedBody> {
        let posed = match &self.aim {
            Aim::Vertices(positions) => body.fitted(positions),
            Aim::Transforms(positions, transforms) => body.fitted_by(positions, transforms.clone()),
            Aim::Pose(pose) => body.posed(pose),
        };
        posed.with_context(|| format!("cannot pose the body as in `{}`", self.path.display()))
    }
}

/// A target whose vertices are as near as this to those of the rest body is the rest body, in
/// metres.
const SAME: f32 = 2e-3;

/// Relative rounding of the length of a unit.
const UNIT_ROUNDING: f32 = 1e-3;

impl Prepared {
    /// Reads the files and brings them together.
    pub(crate) fn read(source: &Source) -> anyhow::Result<Self> {
        match source {
            Source::Scene(path) => Self::of_scene(path, SceneFiles::read(path)?),
            Source::Files(source) => Self::of_files(source, Files::read(source)?),
        }
    }

    fn of_scene(path: &Path, files: SceneFiles) -> anyhow::Result<Self> {
        let SceneFiles {
            scene,
            garment,
            rig,
            target,
        } = files;
        let metres = scene.metres_per_unit as f32;
        let unit = Unit::ALL
            .into_iter()
            .find(|unit| (unit.in_metres() / metres - 1.0).abs() < UNIT_ROUNDING);
        let frame = Frame {
            unit: unit.unwrap_or(Unit::Metre),
            up: UpAxis::Y,
        };
        let mesh = mesh_of(&garment)?;
        let body = rig
            .into_body()
            .context(does_not_fit(path, &scene.rest_body))?;
        let positions = frame.to_metres(target.positions().to_vec());
        check_target(
            &scene.target_body,
            &positions,
            &target.polygon_edges(),
            &KnownMesh::of(body.rest()),
        )?;
        let aim = match scene.posed_from_rest {
            Some(transforms) => Aim::Transforms(positions, transforms),
            None => Aim::Vertices(positions),
        };
        Ok(Self {
            garment: in_metres(mesh, frame)?,
            refit: None,
            garment_file: garment,
            garment_frame: frame,
            rest: RestBody {
                path: scene.rest_body,
                rig_path: path.to_path_buf(),
                frame,
                file: None,
                file_frame: frame,
            },
            body,
            targets: vec![Target {
                path: scene.target_body,
                stem: None,
                aim,
            }],
            pose: None,
            notes: Vec::new(),
        })
    }

    fn of_files(source: &SourceFiles, files: Files) -> anyhow::Result<Self> {
        let Files {
            garment,
            mut bodies,
            rest_body,
            rig,
            rig_path,
            own,
        } = files;
        let is_posed = source.pose.is_some();
        let first = bodies.first_mut();
        let rest_obj = rest_body.or_else(|| {
            // An unposed body stands for the rest body, and its text for the output.
            first.filter(|_| is_posed).and_then(|body| body.file.take())
        });
        let taken = RestMesh::taken(rest_obj.as_ref(), &rig, &rig_path, source)?;
        let frames = taken.frames(&bodies, source)?;
        let body = rest_body_of(rig, &taken, &frames, &rig_path)?;
        let garment_mesh = mesh_of(&garment)?;
        if let Some(folder) = &source.package {
            check_template(folder, garment.path(), &garment_mesh)?;
        }
        let garment_frame = Frame {
            unit: source.units.garment.unwrap_or(frames.obj.unit),
            up: frames.obj.up,
        };
        // What the user says is not doubted; binding still refuses what cannot be.
        if source.units.garment.is_none() && source.package.is_none() {
            placement::check(
                [&source.garment, &taken.path],
                &garment_mesh,
                garment_frame,
                (body.rest.rest(), frames.obj.unit),
            )?;
        }
        let mut refit = None;
        let garment_in_metres = if source.package.is_some() {
            // A package is in metres, whatever the bodies are in.
            match own.map(Rig::into_body).transpose()? {
                Some(own) if !is_same(&own, &body.rest) => {
                    let (worn, way) = refitted(source, garment_mesh, own, &body.rest)?;
                    refit = Some(way);
                    worn
                }
                _ => garment_mesh,
            }
        } else {
            in_metres(garment_mesh, garment_frame)?
        };
        let (targets, notes) = match &source.pose {
            Some(pose) => posed_targets(pose, &body, &bodies, &frames)
                .map_err(|error| of_rig(error, &rig_path))?,
            None => (mesh_targets(bodies, &body.rest, &frames)?, Vec::new()),
        };
        Ok(Self {
            garment: garment_in_metres,
            refit,
            garment_file: garment,
            garment_frame,
            rest: RestBody {
                path: match &rest_obj {
                    Some(file) => file.path().to_path_buf(),
                    None => taken.path,
                },
                rig_path,
                frame: frames.rest,
                file: rest_obj,
                file_frame: frames.obj,
            },
            body: body.rest,
            targets,
            pose: source.pose.clone(),
            notes,
        })
    }
}

/// Refuses a template that was changed: networks have learned another one, and the pattern is of another one.
fn check_template(folder: &Path, path: &Path, mesh: &TriMesh) -> anyhow::Result<()> {
    let manifest = GarmentPackage::read_manifest(folder)?;
    Ok(manifest.check_template(path, mesh)?)
}

/// Whether a garment that lies on one body lies on the other.
fn is_same(own: &Body, other: &Body) -> bool {
    let (own, other) = (own.rest(), other.rest());
    own.faces() == other.faces() && largest_distance(own.positions(), other.positions()) < SAME
}

/// The garment of a package on another body at rest.
fn refitted(
    source: &SourceFiles,
    garment: TriMesh,
    own: Body,
    other: &Body,
) -> anyhow::Result<(TriMesh, Refit)> {
    let cannot = || {
        let garment = source.garment.display();
        format!("cannot bring `{garment}` from the body of its package to the other one")
    };
    let refit = Refit::new(Garment::new(garment), own, other).with_context(cannot)?;
    let worn = refit.dressed(other).with_context(cannot)?;
    Ok((worn, refit))
}

fn mesh_targets(
    bodies: Vec<BodyFile>,
    rest: &Body,
    frames: &Frames,
) -> anyhow::Result<Vec<Target>> {
    let mut targets = Vec::with_capacity(bodies.len());
    let known = KnownMesh::of(rest.rest());
    for (body, frame) in bodies.into_iter().zip(&frames.bodies) {
        let positions = frame.to_metres(body.positions);
        check_target(&body.path, &positions, &body.edges, &known)?;
        targets.push(Target {
            path: body.path,
            stem: None,
            aim: Aim::Vertices(positions),
        });
    }
    Ok(targets)
}

fn posed_targets(
    source: &PoseSource,
    bodies: &RestBodies,
    given: &[BodyFile],
    frames: &Frames,
) -> anyhow::Result<(Vec<Target>, Vec<String>)> {
    let rest = &bodies.rest;
    for (body, frame) in given.iter().zip(&frames.bodies) {
        let positions = frame.to_metres(body.positions.clone());
        let from_zero = bodies.zero.iter().map(|zero| zero.body.rest());
        let rests = std::iter::once(rest.rest()).chain(from_zero);
        let found = || rest.of_skin(&positions);
        let distances = rests.map(|mesh| largest_distance(rest.of_skin(mesh.positions()), found()));
        let distance = distances.fold(f32::INFINITY, f32::min);
        if distance > SAME {
            return Err(refused(
                format!("`{}` is not the rest body", body.path.display()),
                format!(
                    "a vertex is {:.1} mm away from its place at rest",
                    1e3 * distance
                ),
                "`--pose` poses the rest body: give the rest body itself, or a posed body without \
                 `--pose`",
            ));
        }
    }
    let posed = bodies.zero.as_ref().map_or(rest, |zero| &zero.body);
    let Posing { poses, notes } = source.read(posed)?;
    let mut targets = Vec::with_capacity(poses.len());
    for named in poses {
        let aim = match &bodies.zero {
            None => Aim::Pose(named.pose),
            Some(zero) => from_zero(zero, &named.pose)?,
        };
        let is_several = source.is_several();
        targets.push(Target {
            path: if is_several {
                named.label.into()
            } else {
                source.path.clone()
            },
            stem: is_several.then_some(named.stem),
            aim,
        });
    }
    Ok((targets, notes))
}

/// A pose of the body that the rig has in its pose zero.
fn from_zero(zero: &Zero, pose: &Pose) -> anyhow::Result<Aim> {
    let posed_from_zero = zero.body.skeleton().transforms(pose)?;
    let positions = zero
        .body
        .transformed_positions(&posed_from_zero, Method::DualQuaternion);
    let pairs = posed_from_zero.iter().zip(&zero.rest_from_zero);
    let posed_from_rest = pairs.map(|(posed, rest)| posed * rest.inverse()).collect();
    Ok(Aim::Transforms(positions, posed_from_rest))
}
