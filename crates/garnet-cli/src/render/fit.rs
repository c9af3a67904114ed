//! How a garment fits, as values of its vertices.

use std::{path::Path, sync::atomic::AtomicBool};

use anyhow::Context;
use garnet::{
    Garment, Point3,
    body::shape::unposed,
    data::recut,
    drape::{fit_map, wearer_tape},
    io::ObjFile,
    package::GarmentPackage,
};

use crate::failure::{Hint, refused};

/// The levels of a drape of the garment of a package `[vertex]`, on the body of the picture, whose
/// vertices are at `body`, in metres.
pub(super) fn levels(
    folder: &Path,
    file: &ObjFile,
    body: Option<Vec<Point3>>,
) -> anyhow::Result<Vec<f32>> {
    let shown = folder.display();
    let cannot = || format!("cannot tell whether `{}` fits", file.path().display());
    let Some(positions) = body else {
        return Err(refused(
            cannot(),
            "the picture has no body",
            "give the body that it is draped on after it",
        ));
    };
    if !GarmentPackage::is_at(folder) {
        return Err(refused(
            cannot(),
            format!("`{shown}` is no garment package: it has no `garment.toml`"),
            "name the package that was draped: `--color-by fit=PACKAGE`",
        ));
    }
    let package = GarmentPackage::read(folder)?;
    let [found, expected] = [file.num_vertices(), package.mesh.num_vertices()];
    if found != expected {
        return Err(refused(
            cannot(),
            format!("it has {found} vertices, and the garment of `{shown}` has {expected}"),
            "name the package that was draped: `--color-by fit=PACKAGE`",
        ));
    }
    let package = worn(package, &positions).with_context(cannot)?;
    let fitted = package.body.fitted(&positions);
    let not_built_in =
        || "the girths of the built-in body alone are known: a body of `garnet body`".to_owned();
    let fitted = fitted.with_context(cannot).hint(not_built_in)?;
    let tape = wearer_tape(&package.body, &fitted);
    let tape = tape.with_context(|| format!("the body of `{shown}` is not the built-in one"));
    let tape = tape.with_context(cannot).hint(not_built_in)?;
    let garment = Garment::new(package.mesh.clone()).bind(&package.body)?;
    fit_map(&garment, Some(&package.rest), &tape).with_context(cannot)
}

/// The package as the body at `positions` wears it: one that is made to measure is cut for it.
fn worn(package: GarmentPackage, positions: &[Point3]) -> anyhow::Result<GarmentPackage> {
    if !package.manifest.is_made_to_measure() {
        return Ok(package);
    }
    let Some(wearer) = unposed(&package.body, positions).ok().flatten() else {
        return Ok(package);
    };
    let cut = recut(&package, wearer, &AtomicBool::new(false))?;
    Ok(cut.unwrap_or(package))
}
