//! What is in a mesh: an OBJ, or a GLB without a skeleton.

use std::path::Path;

use anyhow::Context;
use garnet::{
    Rig, TriMesh,
    body::shape::{Recognized, recognized, times_as_large},
    io::{
        Frame, ObjFile, RigOptions, guess_body_unit, guess_garment_units, guess_up_axis, read_rig,
        rig_beside,
    },
    mesh::{Bounds, MeshDiagnosis, UpAxis, diagnose, is_inside_out},
};
use serde::Serialize;

use crate::moving::Moving;

use super::{
    rig::{PartInfo, tape},
    table::Table,
};

/// What is in a mesh and what is unusual about it. Lengths are in the unit of the file.
#[derive(Debug, Serialize)]
pub(crate) struct MeshInfo {
    /// Frames in which its vertices move; 1 of most.
    frames: usize,
    vertices: usize,
    /// Polygons.
    faces: usize,
    triangles: usize,
    edges: usize,
    texture_vertices: usize,
    normals: usize,
    groups: usize,
    has_vertex_colors: bool,
    /// Smallest coordinates of vertices that faces name.
    min: [f32; 3],
    /// Largest coordinates of vertices that faces name.
    max: [f32; 3],
    mean_edge_length: f64,
    /// The unit, if it is a body.
    unit_if_body: Option<String>,
    /// Units that fit, if it is a garment.
    units_if_garment: Vec<String>,
    /// The axis that points up, if it is a body that stands.
    up_if_body: Option<String>,
    /// Parts that share no vertex.
    components: usize,
    is_closed: bool,
    boundary_loops: usize,
    /// How many vertices each rim has, the longest first.
    boundary_lengths: Vec<usize>,
    unused_vertices: usize,
    duplicate_vertices: usize,
    zero_area_faces: usize,
    duplicate_faces: usize,
    non_manifold_edges: usize,
    inconsistent_edges: usize,
    /// Meshes of a GLB that are left out, and why.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    left_out: Vec<PartInfo>,
    /// Whether most faces look inwards; of a mesh with rims that says little.
    is_inside_out: bool,
    /// Tape measures at rest, in centimetres, if it is a built-in body at rest.
    tape_cm: Option<Vec<(&'static str, f64)>>,
}

/// The built-in body in metres, if the mesh is one at rest.
fn built_in(mesh: &TriMesh) -> Option<Rig> {
    let positions = Frame::detected(mesh).to_metres(mesh.positions().to_vec());
    match recognized(&mesh.with_positions(positions).ok()?) {
        Recognized::Rest(body) => Some(Rig::from(*body)),
        _ => None,
    }
}

/// The axis along which a mesh stands, head last, if it is the built-in body at rest.
fn up_of_built_in(mesh: &TriMesh) -> Option<&'static str> {
    let Recognized::Rest(body) = recognized(mesh) else {
        return None;
    };
    let skeleton = body.skeleton();
    let at = |name| Some(skeleton.joints()[skeleton.find(name)?].rest_position);
    let trunk = at("neck")? - at("pelvis")?;
    let axis = trunk.iamax();
    let names = if trunk[axis] > 0.0 {
        ["x", "y", "z"]
    } else {
        ["-x", "-y", "-z"]
    };
    Some(names[axis])
}

impl MeshInfo {
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let moving = Moving::read(path, &RigOptions::default(), UpAxis::Y)?;
        let (file, note) = (moving.file(), moving.note());
        let parts = note.iter().flat_map(|note| &note.parts);
        let left_out = parts.filter(|part| part.left_out.is_some());
        let mesh = file.mesh();
        let mesh = mesh.with_context(|| format!("cannot read `{}`", path.display()))?;
        let rig = rig_beside(path);
        let rig = if rig.is_file() {
            read_rig(&rig).ok()
        } else {
            built_in(&mesh)
        };
        let found = Self::new(file, &diagnose(&mesh));
        let unit = times_as_large(&mesh).map(|_| Frame::detected(&mesh).unit.to_string());
        let up = up_of_built_in(&mesh).map(str::to_owned);
        Ok(Self {
            unit_if_body: unit.or(found.unit_if_body),
            up_if_body: up.or(found.up_if_body),
            left_out: left_out.map(PartInfo::new).collect(),
            tape_cm: rig.as_ref().and_then(tape),
            is_inside_out: is_inside_out(mesh.positions(), mesh.faces()),
            frames: moving.num_frames(),
            ..found
        })
    }

    fn new(file: &ObjFile, found: &MeshDiagnosis) -> Self {
        let Bounds { min, max } = found.bounds;
        let extent = found.bounds.extent();
        let mut boundary_lengths: Vec<usize> = found.boundary_loops.iter().map(Vec::len).collect();
        boundary_lengths.sort_unstable_by(|a, b| b.cmp(a));
        Self {
            frames: 1,
            vertices: found.num_vertices,
            faces: file.num_polygons(),
            triangles: found.num_faces,
            edges: file.polygon_edges().len(),
            texture_vertices: file.num_texture_vertices(),
            normals: file.num_normals(),
            groups: file.num_groups(),
            has_vertex_colors: file.has_colors(),
            min: min.coords.into(),
            max: max.coords.into(),
            mean_edge_length: found.mean_edge_length,
            unit_if_body: guess_body_unit(extent.y.max(extent.z)).map(|unit| unit.to_string()),
            units_if_garment: guess_garment_units(extent.max())
                .iter()
                .map(ToString::to_string)
                .collect(),
            up_if_body: guess_up_axis(extent).map(|up| up.to_string()),
            components: found.num_components,
            is_closed: found.is_closed,
            boundary_loops: boundary_lengths.len(),
            boundary_lengths,
            unused_vertices: found.unused_vertices.len(),
            duplicate_vertices: found.duplicate_vertices.len(),
            zero_area_faces: found.degenerate_faces.len(),
            duplicate_faces: found.duplicate_faces.len(),
            non_manifold_edges: found.non_manifold_edges.len(),
            inconsistent_edges: found.inconsistent_edges.len(),
            left_out: Vec::new(),
            is_inside_out: false,
            tape_cm: None,
        }
    }

    pub(crate) fn fill(&self, table: &mut Table) {
        table.row("kind", "mesh");
        if self.frames > 1 {
            table.row("frames", self.frames);
        }
        table.row("vertices", self.vertices);
        table.row(
            "faces",
            format_args!("{} ({} triangles)", self.faces, self.triangles),
        );
        table.row("edges", self.edges);
        table.row("texture vertices", self.texture_vertices);
        table.row("normals", self.normals);
        table.row("groups", self.groups);
        if self.has_vertex_colors {
            table.row("vertex colors", "yes");
        }
        let ends = self.min.iter().zip(&self.max);
        let axes = ["x", "y", "z"].into_iter().zip(ends);
        let extents = axes.map(|(axis, (min, max))| format!("{axis} {min:.3} to {max:.3}"));
        table.row("box", extents.collect::<Vec<_>>().join(", "));
        table.row("mean edge", format_args!("{:.4}", self.mean_edge_length));
        let or_unclear = |found: &Option<String>| found.clone().unwrap_or("unclear".to_owned());
        let units = match self.units_if_garment.as_slice() {
            [] => "unclear".to_owned(),
            units => units.join(" or "),
        };
        table.row(
            "unit",
            format_args!(
                "{} if a body, {units} if a garment",
                or_unclear(&self.unit_if_body)
            ),
        );
        table.row(
            "up",
            format_args!("{} if a body", or_unclear(&self.up_if_body)),
        );
        table.row("components", self.components);
        let rims = match self.boundary_lengths.as_slice() {
            [] => "none".to_owned(),
            lengths => {
                let shown: Vec<String> = lengths.iter().take(8).map(ToString::to_string).collect();
                let more = if lengths.len() > shown.len() {
                    ", ..."
                } else {
                    ""
                };
                format!("{} ({}{more} vertices)", lengths.len(), shown.join(", "))
            }
        };
        table.row("rims", rims);
        let oddities = [
            (self.unused_vertices, "unused vertices"),
            (self.duplicate_vertices, "duplicate vertices"),
            (self.zero_area_faces, "faces without area"),
            (self.duplicate_faces, "duplicate faces"),
            (self.non_manifold_edges, "non-manifold edges"),
            (self.inconsistent_edges, "edges between opposite faces"),
        ];
        let found = oddities.into_iter().filter(|(count, _)| *count > 0);
        let mut found: Vec<String> = found
            .map(|(count, what)| format!("{count} {what}"))
            .collect();
        if self.is_closed && self.is_inside_out {
            found.push("faces look inwards".to_owned());
        }
        if found.is_empty() {
            table.row("unusual", "nothing");
        } else {
            table.row("unusual", found.join(", "));
        }
        for part in &self.left_out {
            part.fill(table);
        }
        for (name, centimetres) in self.tape_cm.iter().flatten() {
            table.row(name, format_args!("{centimetres:.1} cm"));
        }
    }
}
