//! The noise floor of the teacher for each garment and fabric.
//!
//! How far a drape moves in the mean if one shoulder (of jeans: one hip) turns by a small angle, in
//! millimetres: median and mean over sampled poses of the built-in body, and in how many of them it
//! moves by more than 0.2 mm.

use std::{
    io::{self, Write},
    sync::atomic::AtomicBool,
};

use clap::Args;
use garnet_body::poses::SoundPose;
use garnet_data::{DataError, NOISE_TURN, Tailor, moved_by_turn, noise_joint};
use garnet_drape::{Quality, StoredFabric};
use garnet_pattern::GarmentKind;
use garnet_sim::{FABRIC_NAMES, Fabric};
use garnet_skin::Body;
use rayon::prelude::*;

use crate::{Outcome, sampled};

/// What a drape should move less than, in metres.
const BAR: f64 = 2e-4;

/// What to drape.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Vertices of the garments.
    vertices: usize,
    /// Number of poses.
    num_poses: u64,
    /// Garments and fabrics (all without any), constants of the fabrics (`compression=0.001`), and
    /// parameters of the patterns (`chest-ease=0.2`).
    #[arg(value_name = "GARMENT|FABRIC|NAME=VALUE")]
    words: Vec<String>,
    /// By what angle the joint turns, in radians.
    #[arg(long, default_value_t = NOISE_TURN)]
    turn: f32,
    /// Turn one joint after the other of those that some of the garment goes along with.
    #[arg(long)]
    joints: bool,
}

/// A constant of a fabric, by the name of its field.
fn constant<'a>(fabric: &'a mut Fabric, name: &str) -> Option<&'a mut f32> {
    match name {
        "density" => Some(&mut fabric.density),
        "membrane" => Some(&mut fabric.membrane),
        "compression" => Some(&mut fabric.compression),
        "bending" => Some(&mut fabric.bending),
        "friction" => Some(&mut fabric.friction),
        "thickness" => Some(&mut fabric.thickness),
        _ => None,
    }
}

/// Tells the mean of each joint, where poses turn one after the other.
fn tell_joints(
    log: &mut impl Write,
    body: &Body,
    joints: &[usize],
    by_pose: &[f64],
) -> io::Result<()> {
    for (first, &joint) in joints.iter().enumerate().take(by_pose.len()) {
        let of_joint = by_pose.iter().skip(first).step_by(joints.len());
        let mean = of_joint.clone().sum::<f64>() / of_joint.count() as f64;
        let name = &body.skeleton().joints()[joint].name;
        writeln!(log, "  {name}: mean {:.2} mm", 1e3 * mean)?;
    }
    Ok(())
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let &Arguments {
        vertices,
        num_poses,
        turn,
        joints: takes_turns,
        ..
    } = arguments;
    let (mut garments, mut fabrics) = (Vec::new(), Vec::new());
    let mut changes: Vec<(&str, f64)> = Vec::new();
    for word in &arguments.words {
        if let Some((name, value)) = word.split_once('=') {
            changes.push((name, value.parse()?));
        } else if FABRIC_NAMES.contains(&word.as_str()) {
            fabrics.push(word.as_str());
        } else {
            garments.push(word.parse::<GarmentKind>()?);
        }
    }
    if garments.is_empty() {
        garments = GarmentKind::ALL.to_vec();
    }
    if fabrics.is_empty() {
        fabrics = FABRIC_NAMES.to_vec();
    }
    let stop = AtomicBool::new(false);
    let (body, wearer, poses) = sampled::posed_body(num_poses)?;
    let mut log = io::stdout().lock();
    for kind in garments {
        for &name in &fabrics {
            let mut fabric = Fabric::named(name).ok_or("an unknown fabric")?;
            let mut parameters = kind.parameters();
            for &(changed, value) in &changes {
                match constant(&mut fabric, changed) {
                    Some(constant) => *constant = value as f32,
                    None => parameters.set(changed, value)?,
                }
            }
            let stored = StoredFabric::new(name, &fabric);
            let tailor = Tailor::new(parameters, vertices, stored)?;
            let worn = tailor.dress(&body, &wearer, &stop)?;
            let simulator = tailor.simulator(&worn, &body)?;
            let joints: Vec<usize> = if takes_turns {
                let all = 0..body.skeleton().num_joints();
                all.filter(|&joint| simulator.is_moved_by(joint)).collect()
            } else {
                vec![noise_joint(&simulator, &body)]
            };
            let floor = |(index, sound): (usize, &SoundPose)| {
                let turn = (joints[index % joints.len()], turn);
                moved_by_turn(
                    &simulator,
                    &body,
                    &sound.pose,
                    Quality::Teacher,
                    turn,
                    &stop,
                )
                .map_err(Box::new)
            };
            let floors: Result<Vec<f64>, Box<DataError>> =
                poses.par_iter().enumerate().map(floor).collect();
            let by_pose = floors?;
            let mut floors = by_pose.clone();
            floors.sort_unstable_by(f64::total_cmp);
            writeln!(
                log,
                "{} of {name}: median {:.2}, mean {:.2}, worst {:.2} mm, above {:.1} mm in {} of {num_poses} poses",
                kind.name(),
                1e3 * floors[floors.len() / 2],
                1e3 * floors.iter().sum::<f64>() / floors.len() as f64,
                1e3 * floors[floors.len() - 1],
                1e3 * BAR,
                floors.iter().filter(|&&floor| floor > BAR).count(),
            )?;
            if takes_turns {
                tell_joints(&mut log, &body, &joints, &by_pose)?;
            }
        }
    }
    Ok(())
}
