//! How much of a drape is a matter of chance.
//!
//! Distance and angle, in millimetres and degrees, of the teacher's drapes from those of the same
//! simulation in two patches (the same constraints in another order), of a movement half as long
//! again, and of the fast quality; and how much the teacher's cloth is strained: along its edges,
//! and along that direction of each face in which it is longest. Medians and means over sampled
//! poses of the built-in body.

use std::{
    io::{self, Write},
    sync::atomic::AtomicBool,
};

use clap::Args;
use garnet_body::poses::SoundPose;
use garnet_data::{DataError, Tailor, Worn, usual_fabric};
use garnet_drape::{BodyPath, Quality, Simulator};
use garnet_mesh::{Point3, StretchSummary, normal_angles, vertex_distances};
use garnet_pattern::GarmentKind;
use garnet_sim::Schedule;
use garnet_skin::Body;
use nalgebra::{Matrix2, Matrix3x2};
use rayon::prelude::*;

use crate::{Outcome, sampled};

/// The teacher's ways to a pose that should not matter, and a cheaper one.
const WAYS: [&str; 3] = ["in two patches", "half as long again", "fast"];

/// What one pose shows.
struct Findings {
    /// Metres and radians from the teacher's drape, of each of [`WAYS`].
    apart: [[f64; 2]; 3],
    /// Strain that 1 % of the edges and of the faces exceed.
    strain: [f64; 2],
}

/// What to drape.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Vertices of the garments.
    vertices: usize,
    /// Number of poses.
    num_poses: u64,
    /// Garments; all without any.
    garments: Vec<GarmentKind>,
}

pub(crate) fn run(arguments: Arguments) -> Outcome {
    let Arguments {
        vertices,
        num_poses,
        garments: mut kinds,
    } = arguments;
    if kinds.is_empty() {
        kinds = GarmentKind::ALL.to_vec();
    }
    let stop = AtomicBool::new(false);
    let (body, wearer, poses) = sampled::posed_body(num_poses)?;
    let mut log = io::stdout().lock();
    for kind in kinds {
        let tailor = Tailor::new(kind.parameters(), vertices, usual_fabric(kind))?;
        let worn = tailor.dress(&body, &wearer, &stop)?;
        let simulator = tailor.simulator(&worn, &body)?;
        let find = |sound: &SoundPose| find(&simulator, &worn, &body, sound, &stop);
        let findings: Result<Vec<Findings>, Box<DataError>> = poses.par_iter().map(find).collect();
        let findings = findings?;
        writeln!(log, "{}, {} poses:", kind.name(), findings.len())?;
        for (way, name) in WAYS.iter().enumerate() {
            let [distance, angle] = [1e3, f64::to_degrees(1.0)]
                .iter()
                .enumerate()
                .map(|(which, unit)| summary(findings.iter().map(|of| unit * of.apart[way][which])))
                .collect::<Vec<_>>()
                .try_into()
                .expect("two of them");
            writeln!(log, "  {name}: {distance} mm, {angle} degrees")?;
        }
        for (which, name) in ["edges", "faces"].iter().enumerate() {
            let strain = summary(findings.iter().map(|of| 100.0 * of.strain[which]));
            writeln!(log, "  strain p99 of {name}: {strain} %")?;
        }
    }
    Ok(())
}

fn find(
    simulator: &Simulator,
    worn: &Worn,
    body: &Body,
    sound: &SoundPose,
    stop: &AtomicBool,
) -> Result<Findings, Box<DataError>> {
    let path = BodyPath::to_shape(body, body, &sound.pose).map_err(boxed)?;
    let drape = |schedule: Schedule| {
        let drape = simulator.drape_by(&path, schedule, stop, &mut |_| {});
        drape.map(|drape| drape.positions).map_err(boxed)
    };
    let asked = simulator.schedule(Quality::Teacher);
    let first = drape(asked.clone())?;
    let ways = [
        Schedule {
            patches: 2,
            ..asked.clone()
        },
        Schedule {
            motion_frames: asked.motion_frames * 3 / 2,
            ..asked
        },
        simulator.schedule(Quality::Fast),
    ];
    let faces = &worn.sewn.faces;
    let mut apart = [[0.0; 2]; 3];
    for (apart, way) in apart.iter_mut().zip(ways) {
        let other = drape(way)?;
        *apart = [
            mean(&vertex_distances(&first, &other).map_err(boxed)?),
            mean(&normal_angles(faces, &first, &other).map_err(boxed)?),
        ];
    }
    let edges = worn.sewn.faces.iter().zip(&worn.sewn.flat);
    let edges = edges.flat_map(|(face, flat)| {
        [[0, 1], [1, 2], [2, 0]].map(|[a, b]| {
            let [x, y] = [0, 1].map(|axis| flat[a][axis] - flat[b][axis]);
            let length = (first[face[a] as usize] - first[face[b] as usize]).norm();
            length / x.hypot(y)
        })
    });
    let faces = worn.sewn.faces.iter().zip(&worn.sewn.flat);
    let faces = faces.map(|(&face, flat)| longest(face.map(|corner| first[corner as usize]), flat));
    let p99 = |stretches: Vec<f32>| f64::from(StretchSummary::of(stretches).p99) - 1.0;
    Ok(Findings {
        apart,
        strain: [p99(edges.collect()), p99(faces.collect())],
    })
}

/// The larger singular value of the deformation of a face.
fn longest([a, b, c]: [Point3; 3], flat: &[[f32; 2]; 3]) -> f32 {
    let side = |corner: usize| [0, 1].map(|axis| flat[corner][axis] - flat[0][axis]);
    let ([ux, uy], [vx, vy]) = (side(1), side(2));
    let flat = Matrix2::new(ux, vx, uy, vy);
    let Some(inverse) = flat.try_inverse() else {
        return 1.0;
    };
    let deformation = Matrix3x2::from_columns(&[b - a, c - a]) * inverse;
    deformation.singular_values().max()
}

fn boxed(error: impl Into<DataError>) -> Box<DataError> {
    Box::new(error.into())
}

fn mean(values: &[f32]) -> f64 {
    let sum: f64 = values.iter().map(|&value| f64::from(value)).sum();
    sum / values.len().max(1) as f64
}

/// Median and mean of some numbers, as text.
fn summary(values: impl Iterator<Item = f64>) -> String {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    let median = values.get(values.len() / 2).copied().unwrap_or_default();
    format!("median {median:.2}, mean {mean:.2}")
}
