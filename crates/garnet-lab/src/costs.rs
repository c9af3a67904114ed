//! What drapes of the variants of a package cost on this machine, measured and stored.

use std::path::PathBuf;

use clap::Args;
use garnet_drape::{GarmentPackage, Package};

use crate::Outcome;

/// Whose costs to measure.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The garment package.
    package: PathBuf,
    /// Print the costs alone, and leave the package as it is.
    #[arg(long)]
    dry_run: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let package = Package::open(&arguments.package)?;
    let names: Vec<String> = (package.manifest().variants.iter())
        .map(|variant| variant.name.clone())
        .collect();
    let in_ms = |seconds: Option<f64>| {
        seconds.map_or("-".to_owned(), |seconds| format!("{:.1}", 1e3 * seconds))
    };
    println!("{:<20}{:>12}{:>14}", "", "as it is", "relaxed, ms");
    if !arguments.dry_run {
        // The first variant that is measured tells the machine.
        GarmentPackage::change_manifest(&arguments.package, |manifest| manifest.cost = None)?;
    }
    for name in names {
        let cost = package.measure(&name)?;
        println!(
            "{name:<20}{:>12}{:>14}",
            in_ms(cost.seconds),
            in_ms(cost.settled_seconds)
        );
        if !arguments.dry_run {
            GarmentPackage::change_manifest(&arguments.package, |manifest| {
                manifest.set_cost(&name, &cost);
            })?;
        }
    }
    Ok(())
}
