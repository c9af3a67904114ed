//! What deleting the skin under clothes does to drapes.
//!
//! Games delete skin that clothes hide. Drapes of the warp over such bodies are compared with those
//! over whole ones, vertex by vertex.

use std::{error::Error, path::PathBuf};

use clap::Args;
use garnet::{Body, Draper, Garment, Point3, TriMesh};
use garnet_body::poses::{Poser, key_pose};
use garnet_drape::Package;
use garnet_knn::Surface;
use garnet_mesh::{Topology, vertex_distances, vertex_normals};
use garnet_tests::without;

use crate::Outcome;

/// Skin with cloth in front of it that is no farther than this is hidden, in metres.
const COVERED: f32 = 0.12;

/// Skin nearer than this to an opening of the garment is kept, in metres.
const FROM_OPENING: f32 = 0.05;

/// The poses.
const POSES: [&str; 7] = [
    "squat",
    "sit",
    "wave",
    "warrior_two",
    "lean_forward",
    "hands_on_hips",
    "stairs_up",
];

/// What to measure.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Garment packages.
    #[arg(required = true)]
    packages: Vec<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    print!("| mm apart, mean | skin deleted |");
    for pose in POSES {
        print!(" `{pose}` |");
    }
    println!(" mean |\n|---|{}", "---|".repeat(POSES.len() + 2));
    let mut all = Vec::new();
    for folder in &arguments.packages {
        let package = Package::open(folder)?;
        let garment = package.garment().mesh();
        let whole = package.body();
        let hidden = hidden(whole, garment);
        let open = without(whole, |vertex| hidden[vertex]);
        let deleted = 1.0 - open.rest().num_faces() as f64 / whole.rest().num_faces() as f64;
        print!("| {} | {:.0} % |", package.manifest().name, 100.0 * deleted);
        let mut row = Vec::new();
        for pose in POSES {
            let right = draped_on(whole, garment, pose)?;
            let found = draped_on(&open, garment, pose)?;
            let apart = vertex_distances(&right, &found)?;
            row.push(1e3 * apart.iter().copied().map(f64::from).sum::<f64>() / apart.len() as f64);
        }
        for mean in &row {
            print!(" {mean:.1} |");
        }
        println!(" {:.1} |", mean(&row));
        all.extend(row);
    }
    println!("\nmean of all: {:.2} mm", mean(&all));
    Ok(())
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Whether the garment hides each vertex of the skin `[vertex]`.
fn hidden(body: &Body, garment: &TriMesh) -> Vec<bool> {
    let skin = body.rest();
    let normals = vertex_normals(skin.positions(), skin.faces());
    let cloth = Surface::new(garment);
    let topology = Topology::new(garment.num_vertices(), garment.faces());
    let rims: Vec<Point3> = (0..garment.num_vertices())
        .filter(|&vertex| topology.is_boundary(vertex))
        .map(|vertex| garment.positions()[vertex])
        .collect();
    let is_hidden = |(place, normal): (&Point3, &garnet::Vector3)| {
        let over = cloth.closest(*place);
        let offset = over.point - place;
        offset.norm() < COVERED
            && offset.dot(normal) > 0.0
            && rims
                .iter()
                .all(|rim| (rim - over.point).norm() > FROM_OPENING)
    };
    skin.positions()
        .iter()
        .zip(&normals)
        .map(is_hidden)
        .collect()
}

/// Positions of the garment `[vertex]`, by the warp.
fn draped_on(body: &Body, garment: &TriMesh, pose: &str) -> Result<Vec<Point3>, Box<dyn Error>> {
    let bound = Garment::new(garment.clone()).bind(body)?;
    let key = key_pose(pose).ok_or_else(|| format!("there is no pose `{pose}`"))?;
    let posed = body.posed(&Poser::new(body.skeleton())?.pose(&key.angles))?;
    Ok(Draper::new(bound).drape(&posed)?.positions)
}
