//! What is in a rig or a scene.

use std::path::Path;

use garnet::{
    Rig, Skeleton,
    body::shape::tape_measures,
    io::{LeftOut, RigOptions, RigPart, SceneJson, read_rig_with},
};
use serde::Serialize;

use super::table::Table;

/// What is in a rig. Lengths are metres.
#[derive(Debug, Serialize)]
pub(crate) struct RigInfo {
    /// Vertices that the weights are for.
    vertices: usize,
    /// Triangles of the rest mesh; none if there is no rest mesh.
    triangles: Option<usize>,
    /// Most joints that a vertex follows.
    max_influences: usize,
    /// Mean number of joints that a vertex follows.
    mean_influences: f64,
    /// Whether garments are modelled on another pose than that of the rest mesh.
    has_rest_pose: bool,
    /// Tape measures of the built-in body, in centimetres; none of other bodies.
    tape_cm: Option<Vec<(&'static str, f64)>>,
    /// Meshes of a GLB, glTF or VRM, and why each is left out of the body, if it is.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    parts: Vec<PartInfo>,
    joints: Vec<JointInfo>,
}

/// A mesh of a rig file.
#[derive(Debug, Serialize)]
pub(crate) struct PartInfo {
    name: String,
    faces: usize,
    left_out: Option<&'static str>,
}

impl PartInfo {
    pub(super) fn new(part: &RigPart) -> Self {
        Self {
            name: part.name.clone(),
            faces: part.num_faces,
            left_out: part.left_out.map(LeftOut::name),
        }
    }

    pub(super) fn fill(&self, table: &mut Table) {
        let fate = match self.left_out {
            Some(reason) => format!("left out: {reason}"),
            None => "of the body".to_owned(),
        };
        table.row(
            &format!("mesh {}", self.name),
            format_args!("{} faces, {fate}", self.faces),
        );
    }
}

/// A joint.
#[derive(Debug, Serialize)]
pub(crate) struct JointInfo {
    name: String,
    parent: Option<String>,
    rest_position: [f32; 3],
}

impl RigInfo {
    pub(crate) fn read(path: &Path, options: &RigOptions) -> anyhow::Result<Self> {
        let read = read_rig_with(path, options)?;
        let parts = read.parts.iter().map(PartInfo::new);
        Ok(Self {
            parts: parts.collect(),
            ..Self::new(&read.rig)
        })
    }

    fn new(rig: &Rig) -> Self {
        let vertices = rig.weights.num_vertices();
        let influences = || (0..vertices).map(|vertex| rig.weights.vertex(vertex).len());
        Self {
            vertices,
            triangles: rig.rest.as_ref().map(garnet::TriMesh::num_faces),
            max_influences: influences().max().unwrap_or(0),
            mean_influences: influences().sum::<usize>() as f64 / vertices.max(1) as f64,
            has_rest_pose: rig.rest_pose.is_some(),
            tape_cm: tape(rig),
            parts: Vec::new(),
            joints: joints(&rig.skeleton),
        }
    }

    pub(crate) fn fill(&self, table: &mut Table) {
        table.row("kind", "rig");
        table.row("vertices", self.vertices);
        match self.triangles {
            Some(triangles) => table.row("triangles", triangles),
            None => table.row("triangles", "no rest mesh"),
        }
        table.row(
            "weights",
            format_args!(
                "{:.1} joints a vertex, {} at most",
                self.mean_influences, self.max_influences
            ),
        );
        if self.has_rest_pose {
            table.row(
                "rest pose",
                "garments lie on another pose than the rest mesh",
            );
        }
        for (name, centimetres) in self.tape_cm.iter().flatten() {
            table.row(name, format_args!("{centimetres:.1} cm"));
        }
        for part in self.parts.iter().filter(|_| self.parts.len() > 1) {
            part.fill(table);
        }
        fill_joints(&self.joints, table);
    }
}

/// What the tape measures, if it is the built-in body at rest.
pub(super) fn tape(rig: &Rig) -> Option<Vec<(&'static str, f64)>> {
    let body = rig.clone().into_body().ok()?;
    let measures = tape_measures(&body)?;
    let rows = measures.iter();
    Some(
        rows.map(|(measure, m)| (measure.name(), 100.0 * m))
            .collect(),
    )
}

fn joints(skeleton: &Skeleton) -> Vec<JointInfo> {
    let all = skeleton.joints();
    let info = |joint: &garnet::Joint| JointInfo {
        name: joint.name.clone(),
        parent: joint.parent.map(|parent| all[parent].name.clone()),
        rest_position: joint.rest_position.coords.into(),
    };
    all.iter().map(info).collect()
}

fn fill_joints(joints: &[JointInfo], table: &mut Table) {
    table.row("joints", joints.len());
    for joint in joints {
        let [x, y, z] = joint.rest_position;
        let parent = joint.parent.as_deref().unwrap_or("none");
        table.row(
            &format!("  {}", joint.name),
            format_args!("at {x:.3} {y:.3} {z:.3}, parent {parent}"),
        );
    }
}

/// What is in a scene. Lengths are metres.
#[derive(Debug, Serialize)]
pub(crate) struct SceneInfo {
    name: String,
    garment: String,
    rest_body: String,
    target_body: String,
    /// Metres in one unit of the meshes.
    metres_per_unit: f64,
    has_weights: bool,
    has_transforms: bool,
    joints: Vec<JointInfo>,
}

impl SceneInfo {
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let scene = SceneJson::read(path)?;
        let shown = |path: &Path| path.display().to_string();
        Ok(Self {
            garment: shown(&scene.garment),
            rest_body: shown(&scene.rest_body),
            target_body: shown(&scene.target_body),
            metres_per_unit: scene.metres_per_unit,
            has_weights: scene.weights.is_some(),
            has_transforms: scene.posed_from_rest.is_some(),
            joints: joints(&scene.rest_skeleton),
            name: scene.name,
        })
    }

    pub(crate) fn fill(&self, table: &mut Table) {
        let or_missing = |is_there| if is_there { "yes" } else { "no" };
        table.row("kind", "scene");
        table.row("name", &self.name);
        table.row("garment", &self.garment);
        table.row("rest body", &self.rest_body);
        table.row("target body", &self.target_body);
        table.row("metres a unit", self.metres_per_unit);
        table.row("weights", or_missing(self.has_weights));
        table.row("transforms", or_missing(self.has_transforms));
        fill_joints(&self.joints, table);
    }
}
