//! What the page says of its numbers, as JSON.

use std::collections::HashMap;

use garnet_mesh::Point3;
use serde::Serialize;

use super::{Coloring, Page, PageMesh, PagePart, pack::Packer};
use crate::{Rgb, palette, prepared::range_of};

/// All but the numbers.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Description<'a> {
    schema: &'static str,
    title: &'a str,
    frames: Vec<&'a str>,
    fps: f64,
    background: String,
    wire: String,
    not_finite: String,
    panes: Vec<Pane<'a>>,
    topologies: Vec<Topology>,
    meshes: Vec<Mesh<'a>>,
    colorings: Vec<Scale<'a>>,
}

#[derive(Debug, Serialize)]
struct Pane<'a> {
    name: &'a str,
    meshes: &'a [usize],
}

/// Triangles that meshes share.
#[derive(Debug, Serialize)]
struct Topology {
    faces: usize,
}

#[derive(Debug, Serialize)]
struct Mesh<'a> {
    name: &'a str,
    part: &'static str,
    color: String,
    vertices: usize,
    topology: usize,
    step: f64,
    origins: Vec<[f64; 3]>,
    values: Vec<Values>,
}

/// The values of a mesh under a coloring.
#[derive(Debug, Serialize)]
struct Values {
    coloring: usize,
    frames: usize,
    low: f64,
    step: f64,
}

/// A coloring with its bar.
#[derive(Debug, Serialize)]
struct Scale<'a> {
    label: &'a str,
    low: f32,
    high: f32,
    colors: Vec<String>,
    /// What each color stands for, if they do not blend into each other.
    kinds: Vec<&'static str>,
}

impl<'a> Description<'a> {
    /// Describes a page that was checked, and packs its numbers: the triangles of each topology,
    /// then positions and values of each mesh.
    pub(super) fn new(page: &'a Page<'a>, packer: &mut Packer) -> Self {
        let (topologies, of_mesh) = topologies(page, packer);
        let (colorings, labels) = scales(page);
        let meshes = page.meshes.iter().zip(of_mesh);
        let meshes = meshes.map(|(mesh, topology)| described(mesh, topology, &labels, packer));
        Self {
            schema: "garnet.page/1",
            title: &page.title,
            frames: match &page.frames[..] {
                [] => vec![""],
                frames => frames.iter().map(String::as_str).collect(),
            },
            fps: page.fps,
            background: hex(palette::BACKGROUND),
            wire: hex(palette::WIRE),
            not_finite: hex(palette::NON_FINITE),
            panes: (page.panes.iter())
                .map(|pane| Pane {
                    name: &pane.name,
                    meshes: &pane.meshes,
                })
                .collect(),
            topologies,
            meshes: meshes.collect(),
            colorings,
        }
    }

    pub(super) fn to_json(&self) -> String {
        serde_json::to_string(self).expect("texts and numbers become JSON")
    }
}

/// Packs each list of triangles once, and tells which one each mesh has.
fn topologies(page: &Page<'_>, packer: &mut Packer) -> (Vec<Topology>, Vec<usize>) {
    let mut numbers: HashMap<&[[u32; 3]], usize> = HashMap::new();
    let mut topologies = Vec::new();
    let of_mesh = page.meshes.iter().map(|mesh| {
        let faces = mesh.mesh.faces();
        *numbers.entry(faces).or_insert_with(|| {
            packer.faces(faces);
            topologies.push(Topology { faces: faces.len() });
            topologies.len() - 1
        })
    });
    let of_mesh = of_mesh.collect();
    (topologies, of_mesh)
}

/// The color bars, and their labels, in the order in which they come.
fn scales<'a>(page: &'a Page<'a>) -> (Vec<Scale<'a>>, Vec<&'a str>) {
    let all = || page.meshes.iter().flat_map(|mesh| &mesh.colorings);
    let mut labels: Vec<&str> = Vec::new();
    for coloring in all() {
        if !labels.contains(&coloring.label.as_str()) {
            labels.push(&coloring.label);
        }
    }
    let scale = |&label: &&'a str| {
        let of_label: Vec<&Coloring> = all().filter(|found| found.label == label).collect();
        let map = of_label[0].map;
        let given = of_label.iter().find_map(|coloring| coloring.range);
        let [low, high] = given.unwrap_or_else(|| {
            let frames = of_label.iter().flat_map(|coloring| &coloring.values);
            let values: Vec<f32> = frames.flatten().copied().collect();
            range_of(&values, map)
        });
        Scale {
            label,
            low,
            high,
            colors: map.points().iter().copied().map(hex).collect(),
            kinds: if map.blends() {
                Vec::new()
            } else {
                map.kinds()
            },
        }
    };
    (labels.iter().map(scale).collect(), labels)
}

fn described<'a>(
    mesh: &'a PageMesh<'_>,
    topology: usize,
    labels: &[&str],
    packer: &mut Packer,
) -> Mesh<'a> {
    let later = mesh.later.iter().map(Vec::as_slice);
    let frames: Vec<&[Point3]> = std::iter::once(mesh.mesh.positions())
        .chain(later)
        .collect();
    let rounding = packer.positions(&frames);
    let values = mesh.colorings.iter().map(|coloring| {
        let label = labels.iter().position(|label| *label == coloring.label);
        let rounding = packer.values(&coloring.values);
        Values {
            coloring: label.expect("each label has a color bar"),
            frames: coloring.values.len(),
            low: rounding.low,
            step: rounding.step,
        }
    });
    let values = values.collect();
    Mesh {
        name: &mesh.name,
        part: match mesh.part {
            PagePart::Garment => "garment",
            PagePart::Body => "body",
        },
        color: hex(mesh.color),
        vertices: mesh.mesh.num_vertices(),
        topology,
        step: rounding.step,
        origins: rounding.origins,
        values,
    }
}

/// A color as style sheets write it.
fn hex(color: Rgb) -> String {
    let [red, green, blue] = color.channels();
    format!("#{red:02x}{green:02x}{blue:02x}")
}
