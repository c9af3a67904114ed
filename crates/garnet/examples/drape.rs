//! Drapes a garment of one's own on a body: warp, then untangle.
//!
//! `cargo run --example drape -- OUT.obj`

use std::error::Error;
use std::path::Path;

use garnet::{Draper, Garment, io};

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "draped.obj".into());
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/demo");
    let file = io::ObjFile::read(demo.join("tunic.obj"))?;
    let body = io::read_body(demo.join("body.rig.npz"))?;
    let reach = io::ObjFile::read(demo.join("reach.obj"))?;

    let draper = Draper::new(Garment::new(file.mesh()?).bind(&body)?);
    let drape = draper.drape(&body.fitted(reach.positions())?)?;
    file.write_with_positions(out, &drape.positions)?;
    Ok(())
}
