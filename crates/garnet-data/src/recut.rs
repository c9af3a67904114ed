//! Packages whose garment is cut anew for whoever wears it.

use std::sync::atomic::AtomicBool;

use garnet_drape::GarmentPackage;
use garnet_mesh::Fingerprint;
use garnet_skin::Body;

use crate::{DataError, Tailor, wearer_of};

/// The package with its garment cut to the measures of `body`, which is a built-in body at rest,
/// and put on it: template, rest shape and body are new, pattern, fabric and variants are as they
/// were.
///
/// None for packages without a pattern, and for bodies whose measures cannot be taken.
///
/// # Errors
///
/// [`DataError::Pattern`] if the pattern cannot be cut for these measures, [`DataError::Sim`] if
/// the cloth cannot be put on, [`DataError::Package`] once `stop` is set.
pub fn recut(
    package: &GarmentPackage,
    body: Body,
    stop: &AtomicBool,
) -> Result<Option<GarmentPackage>, DataError> {
    let (Some(tailor), Some(wearer)) = (Tailor::of_package(package)?, wearer_of(&body)) else {
        return Ok(None);
    };
    let tailor = tailor.with_size(None);
    let worn = tailor.dress(&body, &wearer?, stop)?;
    let name = package.manifest.name.clone();
    let mut cut = tailor.package(name, &worn, body, None)?;
    let positions = Fingerprint::of_positions(cut.mesh.positions()).to_string();
    cut.manifest = package.manifest.clone();
    cut.manifest.positions = positions;
    Ok(Some(cut))
}
