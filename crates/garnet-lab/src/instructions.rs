//! How far drapes differ between the instructions that kernels of networks use.
//!
//! The simulator gives the same bits with all of them (its tests), and matrix products choose for
//! themselves: what is told is what the kernels of GarNet make of it.

use std::path::PathBuf;

use clap::Args;
use garnet_body::poses::{BodyAngles, Poser};
use garnet_drape::Package;
use garnet_kernel::InstructionSet;
use garnet_mesh::Point3;

use crate::Outcome;

/// What to drape.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The garment package.
    package: PathBuf,
    /// Its variants, in place of all.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    variant: Vec<String>,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let levels = InstructionSet::available();
    println!(
        "{:<20}{:>12}{:>14}{:>14}",
        "", "", "mean, mm", "largest, mm"
    );
    let package = Package::open(&arguments.package)?;
    let all = package.manifest().variants.iter();
    let all = all.map(|variant| variant.name.clone());
    let names: Vec<String> = match arguments.variant.as_slice() {
        [] => all.collect(),
        chosen => chosen.to_vec(),
    };
    for name in names {
        let mut best: Option<Vec<Point3>> = None;
        for level in levels.iter().rev() {
            level.limit();
            // Kernels take their instructions when weights are loaded.
            let drapes = drapes(&Package::open(&arguments.package)?, &name)?;
            let Some(best) = &best else {
                best = Some(drapes);
                continue;
            };
            let apart = drapes.iter().zip(best).map(|(a, b)| (a - b).norm());
            let (sum, largest) = apart.fold((0.0_f64, 0.0_f32), |(sum, largest), apart| {
                (sum + f64::from(apart), largest.max(apart))
            });
            println!(
                "{name:<20}{:>12}{:>14.6}{:>14.6}",
                format!("{level:?}"),
                1e3 * sum / drapes.len().max(1) as f64,
                1e3 * largest
            );
        }
    }
    Ok(())
}

/// Positions of the garment in three poses, one after the other.
fn drapes(package: &Package, variant: &str) -> Result<Vec<Point3>, Box<dyn std::error::Error>> {
    let draper = package.draper(variant)?;
    let poser = Poser::new(package.body().skeleton())?;
    let mut positions = Vec::new();
    for degrees in [10.0, 45.0, 80.0] {
        let mut angles = BodyAngles::default();
        for (arm, leg) in angles.arms.iter_mut().zip(&mut angles.legs) {
            (arm.abduction, arm.elbow) = (degrees, degrees);
            leg.flexion = 0.5 * degrees;
        }
        let posed = package.body().posed(&poser.pose(&angles))?;
        positions.extend(draper.drape(&posed)?.positions);
    }
    Ok(positions)
}
