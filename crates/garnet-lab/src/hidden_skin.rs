//! What deleting the skin under clothes does to drapes.
//!
//! Games delete skin that clothes hide. Drapes of the warp over such bodies are compared with those
//! over whole ones, vertex by vertex. So are drapes over bodies without patches of skin anywhere,
//! which tell how deep cloth sinks to where the skin was.

use std::{error::Error, path::PathBuf};

use clap::Args;
use garnet::{Body, Draper, Garment, Point3, PosedBody, TriMesh};
use garnet_body::poses::{Poser, key_pose};
use garnet_drape::Package;
use garnet_knn::Surface;
use garnet_mesh::{Topology, vertex_distances, vertex_normals};
use garnet_stress::without_patches;
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
    /// Delete patches anywhere in place of what the garment hides.
    #[arg(long)]
    patches: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    if arguments.patches {
        return without_some(&arguments.packages);
    }
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

/// Shares of the faces that are deleted in patches, in percent.
const PATCHES: [f64; 3] = [3.0, 5.0, 10.0];

/// Cloth over bodies without patches of skin, beside that over whole ones.
fn without_some(packages: &[PathBuf]) -> Outcome {
    println!(
        "| | skin deleted | drapes | with cloth where skin was | vertices there, of all | the \
         deepest | mm apart, mean |\n|---|---|---|---|---|---|---|"
    );
    for folder in packages {
        let package = Package::open(folder)?;
        let (garment, whole) = (package.garment().mesh(), package.body());
        for percent in PATCHES {
            let (mut sunken, mut vertices, mut deepest) = (0, 0, 0.0_f32);
            let mut apart = Vec::new();
            for (seed, pose) in (0..).zip(POSES) {
                let rest = without_patches(whole.rest(), percent, seed)?;
                let open = Body::new(rest, whole.skeleton().clone(), whole.weights().clone())?;
                let right = draped_on(whole, garment, pose)?;
                let found = draped_on(&open, garment, pose)?;
                let skin = posed_in(whole, pose)?.skin().clone();
                let is_inside = skin.contains_all(&found);
                let inside = found
                    .iter()
                    .zip(&is_inside)
                    .filter(|(_, is_inside)| **is_inside);
                let depths = inside.map(|(place, _)| (skin.closest(*place).point - place).norm());
                let depths: Vec<f32> = depths.collect();
                sunken += usize::from(!depths.is_empty());
                vertices += depths.len();
                deepest = depths.into_iter().fold(deepest, f32::max);
                apart.extend(vertex_distances(&right, &found)?.into_iter().map(f64::from));
            }
            println!(
                "| {} | {percent} % | {} | {sunken} | {vertices} | {:.1} mm | {:.2} |",
                package.manifest().name,
                POSES.len(),
                1e3 * deepest,
                1e3 * mean(&apart)
            );
        }
    }
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
    Ok(Draper::new(bound).drape(&posed_in(body, pose)?)?.positions)
}

fn posed_in(body: &Body, pose: &str) -> Result<PosedBody, Box<dyn Error>> {
    let key = key_pose(pose).ok_or_else(|| format!("there is no pose `{pose}`"))?;
    Ok(body.posed(&Poser::new(body.skeleton())?.pose(&key.angles))?)
}
