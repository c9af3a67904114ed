//! A small T-shirt on the built-in body.

#![allow(dead_code, reason = "not every test uses every helper")]
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::sync::atomic::AtomicBool;

use garnet_body::shape::{BodyParameters, ParametricBody};
use garnet_data::{Tailor, default_rest_body, usual_fabric, wearer_of};
use garnet_drape::{GarmentPackage, StoredParameters};
use garnet_pattern::GarmentKind;

/// Vertices of the garment: few, so that a scene takes a tenth of a second.
pub(crate) const NUM_VERTICES: usize = 700;

pub(crate) fn body() -> ParametricBody {
    ParametricBody::build(&default_rest_body()).unwrap()
}

pub(crate) fn parameters() -> BodyParameters {
    default_rest_body()
}

/// A package of a T-shirt on the default body.
pub(crate) fn tshirt() -> GarmentPackage {
    tshirt_of(NUM_VERTICES)
}

pub(crate) fn tshirt_of(num_vertices: usize) -> GarmentPackage {
    let body = body().into_body();
    let kind = GarmentKind::Tshirt;
    let tailor = Tailor::new(kind.parameters(), num_vertices, usual_fabric(kind)).unwrap();
    let wearer = wearer_of(&body).unwrap().unwrap();
    let stop = AtomicBool::new(false);
    let worn = tailor.dress(&body, &wearer, &stop).unwrap();
    let parameters = StoredParameters::from(&parameters());
    tailor
        .package("tshirt".to_owned(), &worn, body, Some(parameters))
        .unwrap()
}
