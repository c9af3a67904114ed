//! How much bodies and poses of a data set differ.
//!
//! Bodies: how many, how many of each sex, and least, median and greatest stature, girth of the
//! chest and body mass index. Poses: how many scenes from how many sequences, and by what angle
//! joints are turned from rest, in degrees: median, 95 % and the most over scenes and, where there
//! are two such joints, sides.

use std::{
    collections::{BTreeMap, BTreeSet},
    io::{self, Write},
    path::PathBuf,
};

use clap::Args;
use garnet_body::shape::{JOINT_NAMES, Measure};
use garnet_data::{Dataset, Posed, Split};

use crate::Outcome;

/// The joints that are told of, as their names end.
const JOINTS: [&str; 5] = ["shoulder", "elbow", "hip", "knee", "spine2"];

/// What to measure.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The data set.
    dataset: PathBuf,
    /// The split: train, valid or test.
    #[arg(default_value = "test", value_parser = split)]
    split: Split,
}

/// A split by its name.
pub(crate) fn split(name: &str) -> Result<Split, String> {
    let found = Split::ALL.into_iter().find(|split| split.name() == name);
    found.ok_or_else(|| "expected train, valid or test".to_owned())
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let mut numbers: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    let (mut women, mut bodies, mut scenes) = (0, 0, 0);
    let mut sequences = BTreeSet::new();
    for shard in Dataset::open(&arguments.dataset)?.split(arguments.split) {
        let shard = shard?;
        for stored in shard
            .bodies
            .iter()
            .filter_map(|body| body.parameters.as_ref())
        {
            let body = stored.parameters()?;
            bodies += 1;
            women += usize::from(body.sex() > 0.5);
            let stature = ("stature, m", body.measure(Measure::Stature));
            let chest = ("chest, m", body.measure(Measure::Chest));
            for (name, value) in [stature, chest, ("body mass index", body.bmi())] {
                numbers.entry(name).or_default().extend(value);
            }
        }
        for scene in &shard.scenes {
            scenes += 1;
            sequences.insert(scene.sequence.clone());
            let Posed::Pose(pose) = &scene.posed else {
                continue;
            };
            for (name, turn) in JOINT_NAMES.iter().zip(&pose.rotations) {
                if let Some(joint) = JOINTS.iter().find(|joint| name.ends_with(**joint)) {
                    let angles = numbers.entry(joint).or_default();
                    angles.push(f64::from(turn.angle().to_degrees()));
                }
            }
        }
    }
    let mut out = io::stdout().lock();
    let number = sequences.len();
    writeln!(
        out,
        "{bodies} bodies, {women} women; {scenes} scenes of {number} sequences"
    )?;
    for (name, mut values) in numbers {
        values.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| values[(share * (values.len() - 1) as f64).round() as usize];
        let shares = if JOINTS.contains(&name) {
            [0.5, 0.95, 1.0]
        } else {
            [0.0, 0.5, 1.0]
        };
        let [a, b, c] = shares.map(at);
        writeln!(out, "{name}: {a:.2}, {b:.2}, {c:.2}")?;
    }
    Ok(())
}
