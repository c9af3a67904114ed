//! Drapes the trained T-shirt of this repository, by the variant that is fast enough.
//!
//! `cargo run --example package -- OUT.obj`

use std::error::Error;
use std::path::Path;

use garnet::{Package, io, package::Limit};

#[allow(clippy::print_stderr, reason = "an example tells what it did")]
fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "shirt.obj".into());
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    let shirt = Package::open(models.join("tshirt"))?;
    let reach = io::ObjFile::read(models.join("demo/reach.obj"))?;
    let target = shirt.body().fitted(reach.positions())?;

    // The cheapest variant within 6 mm of the simulation; `shirt.draper("fast")` takes one by name.
    let (draper, choice) = shirt.draper_within(Limit::Distance(0.006))?;
    let drape = draper.drape(&target)?;
    if let Some(chosen) = choice.candidate() {
        eprintln!("{}: {:.0} ms", chosen.variant, 1e3 * drape.seconds.total());
    }
    shirt.write(out, &drape.positions)?;
    Ok(())
}
