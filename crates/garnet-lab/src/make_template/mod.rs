//! Makes the mesh that all built-in bodies share, and stores it in the crate.
//!
//! The surface half-way between the mean man and the mean woman is sampled (surface nets), remeshed
//! to even triangles on its left half, coarsened to a subset of the vertices, and given skinning
//! weights by heat diffusion. The right half is the mirror image.

mod remesh;
mod store;
mod surface_nets;
mod weights;

use std::{error::Error, path::PathBuf};

use clap::Args;
use garnet_body::shape::BodySurface;

use crate::Outcome;
use remesh::Mesh;
use store::{Stored, Weights};

/// A point or vector, in metres.
type Vec3 = nalgebra::Vector3<f64>;

/// How long the edges of the fine level shall be, in metres.
fn edge_length(surface: &BodySurface, point: &Vec3) -> f64 {
    const BODY: f64 = 0.0175;
    const HAND: f64 = 0.0080;
    const FOOT: f64 = 0.0118;
    const HEAD: f64 = 0.0120;
    const FACE: f64 = 0.0092;
    let joints = surface.joints();
    let at = |name: &str| {
        let joint = joints.iter().find(|joint| joint.name == name);
        let position = joint.expect("the joint is one of ours").rest_position;
        Vec3::new(position.x.into(), position.y.into(), position.z.into())
    };
    let wrist = at("left_wrist");
    let fingertip = Vec3::from(surface.tips()[0]);
    let along = (point - wrist).dot(&(fingertip - wrist).normalize());
    let fade = |value: f64, from: f64, to: f64| {
        let share = ((value - from) / (to - from)).clamp(0.0, 1.0);
        share * share * (3.0 - 2.0 * share)
    };
    let mut length = BODY;
    let is_arm_side = point.x > 0.3;
    if is_arm_side {
        length += fade(along, -0.07, 0.03) * (HAND - BODY);
    }
    length += fade(-point.y, -0.16, -0.05) * (FOOT - BODY);
    let neck = at("neck").y;
    length += fade(point.y, neck, neck + 0.10) * (HEAD - BODY);
    if point.y > neck + 0.06 && point.z > 0.0 {
        length +=
            fade(point.z, 0.03, 0.08) * fade(point.y, neck + 0.06, neck + 0.10) * (FACE - HEAD);
    }
    length
}

/// What to make.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The file, `crates/garnet-body/src/shape/template.bin`.
    path: PathBuf,
    /// Keep the mesh that is stored there, and make its weights anew.
    #[arg(long)]
    weights: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let path = &arguments.path;
    let surface = BodySurface::template();
    if arguments.weights {
        let bytes = std::fs::read(path)?;
        let mut stored = Stored::new(&bytes).ok_or("no template, or a truncated one")?;
        let mesh = Mesh::new(std::mem::take(&mut stored.half));
        std::fs::write(
            path,
            store::reweighted(&stored, &weights_of(&surface, &mesh)?),
        )?;
        return Ok(());
    }
    // Where the samples leave open how the surface runs, others do not.
    let mut fine = (0..24)
        .map(|attempt| 0.006 - 0.000_11 * f64::from(attempt))
        .map(|step| Mesh::new(surface_nets::left_half(&surface, step)))
        .find(Mesh::is_manifold)
        .ok_or("no sampling gave a manifold")?;
    fine.remesh(&surface, |point| edge_length(&surface, point), 14);
    let fine = fine.compacted();
    if !fine.is_manifold() {
        return Err("remeshing left a mesh that is no manifold".into());
    }
    let coarse = fine.coarsened(|point| 2.3 * edge_length(&surface, point));
    let weights = weights_of(&surface, &fine)?;
    std::fs::write(path, store::bytes(&fine, &coarse, &weights))?;
    eprintln!(
        "half: {} vertices ({} in the middle), {} faces; coarse {} vertices, {} faces",
        fine.positions.len(),
        fine.num_middle(),
        fine.faces.len(),
        coarse.vertices.len(),
        coarse.faces.len(),
    );
    Ok(())
}

fn weights_of(surface: &BodySurface, half: &Mesh) -> Result<Weights, Box<dyn Error>> {
    Ok(Weights {
        arm_shares: weights::arm_shares(surface, half)?,
        influences: weights::heat(surface, half)?,
    })
}
