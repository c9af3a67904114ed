//! Measures what posing does to the built-in bodies, over sampled bodies and poses.
//!
//! Tells how much the volume changes, how many poses were corrected or thrown away for
//! self-contact, how deep the contacts left are, and the time of a posed body.

#[path = "../../../garnet-body/tests/common/bent.rs"]
mod bent;
mod folds;

use std::time::Instant;

use bent::{BentRing, Hinge, bent_ring};
use clap::{Args, ValueEnum};
use garnet_body::poses::{self, PoseSampler, Poser, SelfContact};
use garnet_body::shape::{ParametricBody, Population};
use garnet_skin::{Body, Method, Point3};

use crate::Outcome;

/// Poses of one body.
const POSES_PER_BODY: u64 = 25;

/// Seed of bodies and poses.
const SEED: u64 = 11;

/// How far limbs are bent, in degrees.
const LARGEST_FLEXION: u32 = 140;
const FLEXION_STEP: usize = 20;

/// What to measure.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Volumes and contacts of sampled poses, elbows and knees bent to 140 degrees, or where skin
    /// is turned over or crosses itself.
    #[arg(value_enum, default_value = "volumes")]
    what: What,
    /// Number of poses (of bodies for `bends`) [default: 500, 20 and 200].
    count: Option<u64>,
}

/// What posing may do to a body.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum What {
    Volumes,
    Bends,
    Folds,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let count = arguments.count;
    match arguments.what {
        What::Volumes => volumes(count.unwrap_or(500)),
        What::Bends => bends(count.unwrap_or(20)),
        What::Folds => folds::folds(count.unwrap_or(200), POSES_PER_BODY, SEED),
    }
}

/// How volumes change, and how poses touch themselves.
fn volumes(num_poses: u64) -> Outcome {
    let (population, sampler) = (Population::new(SEED), PoseSampler::new(SEED));
    let mut changes = Vec::new();
    let mut depths = Vec::new();
    let mut times = Vec::new();
    let (mut num_corrected, mut num_rejected, mut num_refused) = (0, 0, 0);
    for number in 0..num_poses.div_ceil(POSES_PER_BODY) {
        let Ok(built) = ParametricBody::build(&population.sample(number)) else {
            num_refused += 1;
            continue;
        };
        let body = built.into_body();
        let poser = Poser::new(body.skeleton())?;
        let contact = SelfContact::new(&body)?;
        let rest = volume(body.rest().positions(), body.rest().faces());
        for index in 0..POSES_PER_BODY {
            let sound = sampler.sample_for(&poser, &contact, number * POSES_PER_BODY + index)?;
            let start = Instant::now();
            let posed = body.posed_positions(&sound.pose, Method::DualQuaternion)?;
            times.push(1e3 * start.elapsed().as_secs_f64());
            let change = volume(&posed, body.rest().faces()) / rest - 1.0;
            changes.push((change.abs(), format!("body {number}, `{}`", sound.sequence)));
            depths.push(1e3 * f64::from(sound.depths[1]));
            num_corrected += usize::from(matches!(sound.outcome, poses::Outcome::Corrected { .. }));
            num_rejected += sound.num_rejected as usize;
        }
    }
    changes.sort_by(|a, b| b.0.total_cmp(&a.0));
    times.sort_by(f64::total_cmp);
    depths.sort_by(f64::total_cmp);
    let count = changes.len();
    let beyond = changes.iter().filter(|(change, _)| *change > 0.05).count();
    println!("{count} poses, {num_refused} bodies refused");
    println!("corrected {num_corrected}, draws thrown away {num_rejected}");
    let touching = depths.iter().filter(|depth| **depth > 0.0).count();
    println!(
        "touching {touching}, deepest {:.1} mm",
        depths.last().unwrap_or(&0.0)
    );
    println!("volume changed by more than 5 %: {beyond}; the most:");
    for (change, what) in changes.iter().take(5) {
        println!("  {:.1} % {what}", 100.0 * change);
    }
    println!("a posed body takes {:.2} ms (median)", times[count / 2]);
    Ok(())
}

/// The worst rings of bent elbows and knees over some bodies.
fn bends(count: u64) -> Outcome {
    let population = Population::new(SEED);
    let bodies: Vec<Body> = (0..count)
        .filter_map(|number| ParametricBody::build(&population.sample(number)).ok())
        .map(ParametricBody::into_body)
        .collect();
    println!(
        "{} bodies; the worst radius of the ring at the joint",
        bodies.len()
    );
    for hinge in Hinge::ALL {
        for degrees in (0..=LARGEST_FLEXION).step_by(FLEXION_STEP) {
            let mut worst = BentRing::default();
            for body in &bodies {
                let ring = bent_ring(body, hinge, f64::from(degrees))?;
                worst.bulge = worst.bulge.max(ring.bulge);
                worst.fold_collapse = worst.fold_collapse.max(ring.fold_collapse);
                worst.outer_collapse = worst.outer_collapse.max(ring.outer_collapse);
            }
            println!(
                "{hinge:?} {degrees:>3} degrees: bulge {:>4.1} %, collapse in the fold {:>4.1} %, \
                 outside {:>4.1} %",
                100.0 * worst.bulge,
                100.0 * worst.fold_collapse,
                100.0 * worst.outer_collapse
            );
        }
    }
    Ok(())
}

/// The volume inside a closed mesh, in m³.
fn volume(positions: &[Point3], faces: &[[u32; 3]]) -> f64 {
    let of_face = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|vertex| positions[vertex as usize].coords.cast::<f64>());
        a.cross(&b).dot(&c) / 6.0
    };
    faces.iter().map(of_face).sum()
}
