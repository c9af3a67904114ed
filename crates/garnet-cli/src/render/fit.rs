//! How a garment fits, as values of its vertices.

use std::{ops::RangeInclusive, path::Path};

use anyhow::Context;
use garnet::{
    Body, Garment, Point3,
    body::shape::{Recognized, Tape, recognized, unposed},
    data::{CutOptions, Tailor, wearer_of},
    drape::{fit_map, wearer_tape},
    io::ObjFile,
    package::GarmentPackage,
    pattern::{GarmentKind, Size},
};

use crate::{
    cut_args::{SizeChoice, check_size, chosen_size, cut_on, in_size},
    failure::{Hint, refused},
    wearer_rig::{TOLD, wearer_of_rig},
};

/// Cloth that is draped in the size of its package mostly has faces within these shares of its own:
/// drapes stretch and crumple by a few per cent, two sizes differ by ten. Beyond a note says so: it
/// may be of another size, or stretched on a larger body. A narrower range notes drapes of people
/// who sit.
const SAME_SIZE: RangeInclusive<f64> = 0.94..=1.06;

/// A size is likelier than another one if its cloth is nearer by this, as the logarithm of areas:
/// neighbouring sizes are 0.07 apart, and some networks draw cloth together by 0.05. More notes
/// fewer drapes.
const CLEARLY: f64 = 0.035;

/// Areas that differ by more are in other units.
const ANY_UNIT: RangeInclusive<f64> = 0.3..=3.0;

/// How many times as large as in `rest` the faces are in `positions`: the median of them, which
/// folds do not change.
fn times_as_large(positions: &[Point3], rest: &[Point3], faces: &[[u32; 3]]) -> f64 {
    let area = |positions: &[Point3], face: &[u32; 3]| {
        let [a, b, c] = face.map(|vertex| positions[vertex as usize]);
        f64::from((b - a).cross(&(c - a)).norm())
    };
    let ratio = |face| area(positions, face) / area(rest, face).max(f64::MIN_POSITIVE);
    let mut ratios: Vec<f64> = faces.iter().map(ratio).collect();
    let middle = ratios.len() / 2;
    if ratios.is_empty() {
        return 1.0;
    }
    *ratios.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The levels of a drape of the garment of a package, in a size, `[vertex]`, on the body of the
/// picture: its file, and its vertices in metres. A note tells if the drape may have another size.
pub(super) fn levels(
    (folder, size): (&Path, Option<SizeChoice>),
    file: &ObjFile,
    body: Option<(&Path, Vec<Point3>)>,
) -> anyhow::Result<(Vec<f32>, Option<String>)> {
    let shown = folder.display();
    let cannot = || format!("cannot tell whether `{}` fits", file.path().display());
    let Some((path, positions)) = body else {
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
    let of_rig = wearer_of_rig(path, &positions);
    let wearer = match &of_rig {
        Some(wearer) => Some(wearer.clone()),
        None => unposed(&package.body, &positions).ok().flatten(),
    };
    let own = package.clone();
    let package = worn((folder, size), package, wearer).with_context(cannot)?;
    let (found, rest) = (file.positions(), package.mesh.positions());
    let larger = times_as_large(found, rest, package.mesh.faces());
    // Files in other units are as large in other ways.
    let of_size = if ANY_UNIT.contains(&larger) {
        let likelier = likelier_size((folder, &own), found, larger).with_context(cannot)?;
        doubt(file.path(), folder, likelier, larger)
    } else {
        None
    };
    let body = package.body.rest().with_positions(positions.clone()).ok();
    let is_posed = body.is_some_and(|body| matches!(recognized(&body), Recognized::Posed));
    let is_told = of_rig.is_none() && is_posed;
    let of_pose = is_told.then(|| format!("the girths of `{}` are {TOLD}", path.display()));
    let notes: Vec<String> = of_size.into_iter().chain(of_pose).collect();
    let note = (!notes.is_empty()).then(|| notes.join("; "));
    let fitted = package.body.fitted(&positions);
    let not_built_in =
        || "the girths of the built-in body alone are known: a body of `garnet body`".to_owned();
    let fitted = fitted.with_context(cannot).hint(not_built_in)?;
    let of_rig = of_rig.as_ref().and_then(Tape::around);
    let tape = of_rig.or_else(|| wearer_tape(&package.body, &fitted));
    let tape = tape.with_context(|| format!("the body of `{shown}` is not the built-in one"));
    let tape = tape.with_context(cannot).hint(not_built_in)?;
    let garment = Garment::new(package.mesh.clone()).bind(&package.body)?;
    let levels = fit_map(&garment, Some(&package.rest), &tape).with_context(cannot)?;
    Ok((levels, note))
}

/// What is doubtful about the size of a drape whose cloth is so many times `larger` than that of
/// the package, and nearest to that of a `likelier` size.
fn doubt(drape: &Path, package: &Path, likelier: Option<Size>, larger: f64) -> Option<String> {
    let (drape, package) = (drape.display(), package.display());
    match likelier {
        Some(size) => Some(format!(
            "the cloth of `{drape}` is as large as that of `{package}` in size {size}: if it was \
             draped in that, name it, as `--color-by fit={package}@{size}`; else it is stretched"
        )),
        None => (!SAME_SIZE.contains(&larger)).then(|| {
            format!(
                "the cloth of `{drape}` is {larger:.2} times as large as that of `{package}`: it is \
                 stretched, or was draped in another size"
            )
        }),
    }
}

/// The size whose cloth is nearest to a drape of a package in area, if that is clearly nearer than
/// the one that it is held against. None of trousers, whose sizes differ in two ways.
fn likelier_size(
    (folder, own): (&Path, &GarmentPackage),
    drape: &[Point3],
    larger: f64,
) -> anyhow::Result<Option<Size>> {
    let mut least = larger.ln().abs() - CLEARLY;
    let tailor = Tailor::of_package(own)?.filter(|_| least > 0.0);
    let Some(tailor) = tailor.filter(|tailor| tailor.parameters().garment() != GarmentKind::Jeans)
    else {
        return Ok(None);
    };
    let mut nearest = None;
    for size in tailor.parameters().sizes() {
        let Ok(other) = in_size(own, folder, size) else {
            continue;
        };
        let ratio = times_as_large(drape, other.mesh.positions(), other.mesh.faces());
        if ratio.ln().abs() < least {
            (least, nearest) = (ratio.ln().abs(), Some(size));
        }
    }
    Ok(nearest)
}

/// The package as `wearer` at rest wears it, the body of the package without one: in a size, or cut
/// for it if it is made to measure.
fn worn(
    (folder, size): (&Path, Option<SizeChoice>),
    package: GarmentPackage,
    wearer: Option<Body>,
) -> anyhow::Result<GarmentPackage> {
    let is_to_measure = package.manifest.is_made_to_measure();
    if size.is_none() && !is_to_measure {
        return Ok(package);
    }
    let wearer = wearer.unwrap_or_else(|| package.body.clone());
    let tailor = Tailor::of_package(&package)?.context("the package has no sewing pattern")?;
    let size = match size {
        Some(SizeChoice::Auto) => {
            let measured = wearer_of(&wearer).transpose()?;
            let measured = measured.context("the measures of its body are not known")?;
            chosen_size(tailor.parameters(), &measured.measures).map(|([size, _], _)| size)
        }
        Some(SizeChoice::Named(size)) => {
            check_size(size, tailor.parameters().garment())?;
            Some(size)
        }
        None => None,
    };
    match size {
        Some(size) if !is_to_measure => in_size(&package, folder, size),
        _ => {
            let options = CutOptions {
                size,
                parameters: None,
            };
            cut_on(&package, wearer, &options)
        }
    }
}
