//! How far from the simulation drapes of a package are expected to be, by the pose: fitted on the
//! validation split, stored in the package, and tried on the test split.
//!
//! A row a variant, as `drape` takes it: what is expected in the middle of the poses, by how much
//! that grows with the distance from there, the rank correlation of that distance with the error,
//! and the share of scenes within the bound that is to hold in nine of ten.

use std::{path::PathBuf, sync::atomic::AtomicBool};

use clap::Args;
use garnet::train::{Stage, scenes_found};
use garnet_data::Split;
use garnet_drape::{GarmentPackage, rank_correlation};
use garnet_net::ModelHeader;

use crate::Outcome;

/// Whose drapes to measure.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The garment package.
    package: PathBuf,
    /// Its data set, with validation and test.
    dataset: PathBuf,
    /// Print alone, and leave the package as it is.
    #[arg(long)]
    dry_run: bool,
    /// The variants; all if none is named.
    #[arg(long, value_delimiter = ',')]
    variants: Vec<String>,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let never = AtomicBool::new(false);
    let stage = Stage::open(&arguments.package, &arguments.dataset)?;
    let mut manifest = GarmentPackage::read_manifest(&arguments.package)?;
    let asked = |name: &String| arguments.variants.is_empty() || arguments.variants.contains(name);
    println!(
        "{:<16}{:>12}{:>10}{:>10}{:>16}{:>14}{:>14}",
        "", "middle, mm", "growth", "within", "scenes, test", "correlation", "share within"
    );
    for variant in manifest.variants.clone() {
        let name = &variant.name;
        if !asked(name) {
            continue;
        }
        let weights = arguments.package.join(&variant.weights);
        let moment = ModelHeader::read(&weights)?.moment;
        let frames = variant.settling(moment).frames;
        let valid = scenes_found(&stage, Split::Valid, &weights, frames, &never)?;
        valid.store(&mut manifest, name);
        let stored = manifest.variant(name).and_then(|variant| variant.expected);
        let Some((expected, poses)) = stored.zip(manifest.poses.clone()) else {
            println!("{name:<16}  too few scenes for validation");
            continue;
        };
        if !arguments.dry_run {
            GarmentPackage::change_manifest(&arguments.package, |manifest| {
                valid.store(manifest, name);
            })?;
        }
        let test = scenes_found(&stage, Split::Test, &weights, frames, &never)?.pairs(&poses);
        let within = (test.iter()).filter(|(far, distance)| *distance <= expected.bound(*far));
        println!(
            "{name:<16}{:>12.2}{:>10.3}{:>10.2}{:>16}{:>14.2}{:>14.3}",
            1e3 * expected.distance,
            expected.growth,
            expected.within,
            test.len(),
            rank_correlation(&test),
            within.count() as f64 / test.len().max(1) as f64
        );
    }
    Ok(())
}
