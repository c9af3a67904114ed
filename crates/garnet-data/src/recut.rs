//! Garments of packages that are cut anew: for whoever wears them, in a size, or with other
//! parameters.

use std::sync::atomic::AtomicBool;

use garnet_body::shape::{BodyParameters, Measure};
use garnet_drape::GarmentPackage;
use garnet_mesh::Fingerprint;
use garnet_pattern::{Parameters, Size};
use garnet_skin::Body;

use crate::{DataError, Tailor, wearer_of};

/// How the garment of a package is cut anew.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CutOptions {
    /// The size; none cuts it to the measures of the body that it is put on.
    pub size: Option<Size>,
    /// The parameters of its pattern; none are those of the package.
    pub parameters: Option<Parameters>,
}

/// The package with its garment cut anew and put on `body`, which is a built-in body at rest:
/// template, rest shape and body are new, fabric and variants are as they were.
///
/// None for packages without a pattern, and for bodies whose measures cannot be taken.
///
/// # Errors
///
/// [`DataError::Pattern`] if the pattern cannot be cut so, [`DataError::Sim`] if the cloth cannot
/// be put on, [`DataError::Package`] once `stop` is set.
pub fn recut(
    package: &GarmentPackage,
    body: Body,
    options: &CutOptions,
    stop: &AtomicBool,
) -> Result<Option<GarmentPackage>, DataError> {
    let (Some(mut tailor), Some(wearer)) = (Tailor::of_package(package)?, wearer_of(&body)) else {
        return Ok(None);
    };
    if let Some(parameters) = &options.parameters {
        tailor = tailor.with_parameters(parameters.clone());
    }
    let tailor = tailor.with_size(options.size);
    let worn = tailor.dress(&body, &wearer?, stop)?;
    let name = package.manifest.name.clone();
    let mut cut = tailor.package(name, &worn, body, None)?;
    let positions = Fingerprint::of_positions(cut.mesh.positions()).to_string();
    let mut manifest = package.manifest.clone();
    if let (Some(pattern), Some(made)) = (&mut manifest.pattern, &cut.manifest.pattern) {
        pattern.size.clone_from(&made.size);
        pattern.parameters.clone_from(&made.parameters);
    }
    manifest.positions = positions;
    cut.manifest = manifest;
    Ok(Some(cut))
}

/// Whom a size of a package is cut for: of the stature and girths of the size, and of the sex of
/// the body of the package, if that is known.
pub fn body_of_size(package: &GarmentPackage, size: Size) -> BodyParameters {
    let own = package.manifest.rest_body.parameters.as_ref();
    let cut = size.measures();
    let given = [
        (Measure::Stature, cut.stature),
        (Measure::Chest, cut.chest),
        (Measure::Waist, cut.waist),
        (Measure::Hip, cut.hip),
    ];
    let body = BodyParameters::new(own.map_or(0.5, |own| own.sex));
    // As files keep them, so that the body that is read is this one.
    let rounded = |value: f64| f64::from(value as f32);
    (given.into_iter()).fold(body, |body, (measure, value)| {
        body.with(measure, rounded(value))
    })
}
