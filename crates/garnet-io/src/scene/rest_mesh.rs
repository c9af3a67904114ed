//! The mesh of the rest body, and units and axes of the files of a body.

use std::path::{Path, PathBuf};

use garnet_mesh::{Bounds, Kinship, KnownMesh, Point3, TriMesh, Unit, UpAxis, kinship};
use garnet_skin::Rig;

use super::{
    PoseNote, SceneError, SceneFiles, SceneProblem,
    files::BodyFile,
    frame::{Frame, detected_unit, detected_up, unit_of},
    is_rig,
};
use crate::{ObjFile, guess_up_axis};

/// The mesh of the rest body, in the unit of its file.
#[derive(Debug)]
pub(super) struct RestMesh {
    pub(super) mesh: TriMesh,
    pub(super) path: PathBuf,
    pub(super) is_obj: bool,
}

/// Units and axes of the files of a body.
#[derive(Debug)]
pub(super) struct Frames {
    /// Of the OBJ files.
    pub(super) obj: Frame,
    /// Of the rest mesh.
    pub(super) rest: Frame,
    /// Of the rig.
    pub(super) rig: Frame,
    /// Of each body.
    pub(super) bodies: Vec<Frame>,
}

impl Frames {
    /// Bodies in an imperial unit, if the rest body is not in it.
    pub(super) fn notes<'a>(&self, bodies: &'a [BodyFile]) -> impl Iterator<Item = PoseNote> + 'a {
        let rest = self.rest.unit;
        let units: Vec<Unit> = self.bodies.iter().map(|frame| frame.unit).collect();
        let is_told = move |unit: &Unit| *unit != rest && !Unit::METRIC.contains(unit);
        let pairs = bodies.iter().zip(units);
        let told = pairs.filter(move |(_, unit)| is_told(unit));
        told.map(|(body, unit)| PoseNote::InUnit {
            path: body.path.clone(),
            unit,
        })
    }
}

impl RestMesh {
    pub(super) fn taken(
        obj: Option<&ObjFile>,
        rig: &Rig,
        rig_path: &Path,
        files: &SceneFiles,
    ) -> Result<Self, SceneError> {
        // With a rest mesh in the rig, an unposed BODY is compared with it and not needed.
        let is_needed = files.rest_body.is_some() || rig.rest.is_none();
        match (obj.filter(|_| is_needed), &rig.rest) {
            (Some(file), _) => Ok(Self {
                mesh: mesh_of(file)?,
                path: file.path().to_path_buf(),
                is_obj: true,
            }),
            (None, Some(mesh)) => Ok(Self {
                mesh: mesh.clone(),
                path: rig_path.to_path_buf(),
                is_obj: false,
            }),
            (None, None) => Err(SceneError::NoRestBody {
                problem: SceneProblem::SkeletonAlone {
                    rig: rig_path.to_path_buf(),
                },
            }),
        }
    }

    pub(super) fn frames(
        &self,
        bodies: &[BodyFile],
        files: &SceneFiles,
    ) -> Result<Frames, SceneError> {
        let mut ratios = Vec::with_capacity(bodies.len());
        for body in bodies {
            ratios.push(self.ratio(&body.path, &body.positions)?);
        }
        let first = ratios.first().copied().unwrap_or(1.0);
        let detected = detected_unit(&self.mesh);
        let unit = match (files.units.body, self.is_obj) {
            (None, _) => detected,
            (Some(unit), true) => unit,
            (Some(unit), false) => unit_of(unit, 1.0 / first).unwrap_or(unit),
        };
        // An axis that is named holds for the rig, too, unless that clearly stands otherwise.
        let clear = up_of(self.mesh.positions(), self.mesh.faces());
        let up = clear
            .or(files.up)
            .unwrap_or_else(|| detected_up(&self.mesh));
        let at_rest = bodies.iter().find(|body| {
            // With a pose, BODY is the rest body in an OBJ of its own.
            files.pose.is_some() && !self.is_obj && !is_rig(&body.path)
        });
        let obj_up = files.up.unwrap_or_else(|| match at_rest {
            Some(body) => up_of(&body.positions, self.mesh.faces()).unwrap_or(up),
            None => up,
        });
        let rest = Frame {
            unit,
            up: if self.is_obj { obj_up } else { up },
        };
        let of_bodies = bodies.iter().zip(ratios).map(|(body, ratio)| {
            let unit = unit_of(unit, ratio).ok_or_else(|| SceneError::OtherSize {
                path: body.path.clone(),
                problem: SceneProblem::Ratio { ratio },
            })?;
            let up = if is_rig(&body.path) { up } else { obj_up };
            Ok(Frame { unit, up })
        });
        let of_bodies = of_bodies.collect::<Result<Vec<Frame>, SceneError>>()?;
        let obj_unit = match (self.is_obj, of_bodies.first()) {
            (false, Some(body)) => body.unit,
            _ => unit,
        };
        Ok(Frames {
            obj: Frame {
                unit: obj_unit,
                up: obj_up,
            },
            rig: rest,
            rest,
            bodies: of_bodies,
        })
    }

    /// How many times as long the edges of another mesh of this topology are.
    fn ratio(&self, path: &Path, positions: &[Point3]) -> Result<f32, SceneError> {
        let (found, expected) = (positions.len(), self.mesh.num_vertices());
        if found != expected {
            return Err(other_topology(
                path,
                SceneProblem::VertexCount {
                    found,
                    expected,
                    rest: self.path.clone(),
                },
            ));
        }
        match kinship(self.mesh.positions(), positions, self.mesh.faces()) {
            Kinship::Scaled { ratio } => Ok(ratio),
            Kinship::Stranger => Err(other_topology(
                path,
                SceneProblem::VertexOrder {
                    rest: self.path.clone(),
                },
            )),
        }
    }
}

/// The axis that points up in a body at rest, where that is clear.
fn up_of(positions: &[Point3], faces: &[[u32; 3]]) -> Option<UpAxis> {
    guess_up_axis(Bounds::of_faces(positions, faces)?.extent())
}

/// A mesh that is not the rest body in another pose and shape.
pub(super) fn other_topology(path: &Path, problem: SceneProblem) -> SceneError {
    SceneError::OtherTopology {
        path: path.to_path_buf(),
        problem,
    }
}

/// Refuses a target that is not the rest body in another pose and shape, whose vertices are at
/// `positions`, in metres, and whose polygons have `edges`.
pub(super) fn check_target(
    path: &Path,
    positions: &[Point3],
    edges: &[[u32; 2]],
    rest: &KnownMesh<'_>,
) -> Result<(), SceneError> {
    let checked = rest.check(positions, edges).map(|_| ());
    checked.map_err(|difference| other_topology(path, SceneProblem::Difference(difference)))
}

/// The mesh of an OBJ.
pub(super) fn mesh_of(file: &ObjFile) -> Result<TriMesh, SceneError> {
    file.mesh().map_err(|source| SceneError::Mesh {
        path: file.path().to_path_buf(),
        source,
    })
}
