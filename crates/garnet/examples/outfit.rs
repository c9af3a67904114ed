//! Drapes a T-shirt and a sweater over it: an outfit, the inner garment first.
//!
//! `cargo run --example outfit -- FOLDER`

use std::error::Error;
use std::path::{Path, PathBuf};

use garnet::{Package, drape::Outfit, io};

#[allow(clippy::print_stderr, reason = "an example tells what it did")]
fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".into()));
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    let reach = io::ObjFile::read(models.join("demo/reach.obj"))?;

    // A shirt under a sweater, by the variants that take the least time.
    let packages = ["tshirt", "sweater"].map(|name| Package::open(models.join(name)));
    let [shirt, sweater] = packages;
    let packages = [shirt?, sweater?];
    let mut outfit = Outfit::default();
    for package in &packages {
        let body = package.body().fitted(reach.positions())?;
        outfit.drape(package.draper("fast")?, body)?;
    }
    outfit.free()?;
    for pair in outfit.layers()? {
        eprintln!("{:.2} % cross", 100.0 * pair.count.crossing_share());
    }
    for (package, drape) in packages.iter().zip(outfit.into_drapes()) {
        let name = format!("{}.obj", package.manifest().name);
        package.write(folder.join(name), &drape.positions)?;
    }
    Ok(())
}
