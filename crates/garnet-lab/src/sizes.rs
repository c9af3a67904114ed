//! The garment of a package in all letter sizes, stored beside its template.

use std::{path::PathBuf, sync::atomic::AtomicBool};

use clap::Args;
use garnet_body::shape::ParametricBody;
use garnet_data::{CutOptions, body_of_size, recut};
use garnet_drape::GarmentPackage;
use garnet_pattern::Size;

use crate::Outcome;

/// Of which packages to store sizes.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Garment packages, as `models/tshirt`.
    #[arg(required = true, value_name = "PACKAGE")]
    packages: Vec<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let never = AtomicBool::new(false);
    for folder in &arguments.packages {
        let package = GarmentPackage::read(folder)?;
        let mut sizes = Vec::new();
        for size in Size::ALL {
            let options = CutOptions {
                size: Some(size),
                parameters: None,
            };
            let wearer = body_of_size(&package, size);
            let body = ParametricBody::build(&wearer)?.into_body();
            let cut = recut(&package, body, &options, &never)?;
            let cut = cut.ok_or("the package has no sewing pattern, or no built-in body")?;
            sizes.push((size.to_string(), wearer, cut));
        }
        let path = package.write_sizes(folder, &sizes)?;
        let bytes = std::fs::metadata(&path)?.len();
        println!("{}: {:.2} MB", path.display(), bytes as f64 / 1e6);
    }
    Ok(())
}
