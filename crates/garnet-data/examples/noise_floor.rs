//! The noise floor of the teacher for each garment and fabric:
//! `cargo run --release -p garnet-data --example noise_floor -- VERTICES POSES [GARMENT…] [FABRIC…] [NAME=VALUE…] [RADIANS] [joints]`.
//!
//! How far a drape moves in the mean if one shoulder (of jeans: one hip) turns by 0.001 rad more, or by what is told, in
//! millimetres: median and mean over sampled poses of the built-in body, and in how many of them it moves by more than
//! 0.2 mm. With `joints` the poses turn one joint after the other of those that some of the garment goes along with, and the
//! mean of each is told, too. `compression=0.001` and the like change a constant of the fabrics, `chest-ease=0.2` and the like a parameter of
//! the patterns.

mod common;

use std::{
    env,
    error::Error,
    io::{self, Write},
    sync::atomic::AtomicBool,
};

use garnet_body::poses::SoundPose;
use garnet_data::{DataError, NOISE_TURN, Tailor, moved_by_turn, noise_joint};
use garnet_drape::{Quality, StoredFabric};
use garnet_pattern::GarmentKind;
use garnet_sim::{FABRIC_NAMES, Fabric};
use garnet_skin::Body;
use rayon::prelude::*;

/// What a drape should move less than, in metres.
const BAR: f64 = 2e-4;

const USAGE: &str =
    "usage: noise_floor VERTICES POSES [GARMENT…] [FABRIC…] [NAME=VALUE…] [RADIANS] [joints]";

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

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [vertices, num_poses, words @ ..] = arguments.as_slice() else {
        return Err(USAGE.into());
    };
    let (vertices, num_poses): (usize, u64) = (vertices.parse()?, num_poses.parse()?);
    let (mut garments, mut fabrics, mut turn) = (Vec::new(), Vec::new(), NOISE_TURN);
    let mut changes: Vec<(&str, f64)> = Vec::new();
    let mut takes_turns = false;
    for word in words {
        if let Ok(number) = word.parse() {
            turn = number;
        } else if word == "joints" {
            takes_turns = true;
        } else if let Some((name, value)) = word.split_once('=') {
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
    let (body, wearer, poses) = common::posed_body(num_poses)?;
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
            let teacher = tailor.teacher(&worn, &body)?;
            let joints: Vec<usize> = if takes_turns {
                let all = 0..body.skeleton().num_joints();
                all.filter(|&joint| teacher.is_moved_by(joint)).collect()
            } else {
                vec![noise_joint(&teacher, &body)]
            };
            let floor = |(index, sound): (usize, &SoundPose)| {
                let turn = (joints[index % joints.len()], turn);
                moved_by_turn(&teacher, &body, &sound.pose, Quality::Teacher, turn, &stop)
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
