//! Drapes the T-shirt of the repository on the demo body, and writes it.

use std::error::Error;
use std::path::PathBuf;

use garnet::{Package, io};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let (Some(models), Some(out)) = (arguments.next(), arguments.next()) else {
        return Err("usage: garnet-embed MODELS OUT.obj".into());
    };
    let shirt = Package::open(models.join("tshirt"))?;
    let reach = io::ObjFile::read(models.join("demo/reach.obj"))?;
    let drape = shirt
        .draper("fast")?
        .drape(&shirt.body().fitted(reach.positions())?)?;
    if drape.report.as_ref().is_none_or(|report| report.inside > 0) {
        return Err("vertices are left inside the body".into());
    }
    shirt.write(out, &drape.positions)?;
    Ok(())
}
