//! What a build without the feature `burn` reads, and what it refuses.

#![cfg(not(feature = "burn"))]
#![allow(clippy::unwrap_used, reason = "tests")]

use std::path::Path;

use garnet_net::{CheckpointError, ModelFile, ModelHeader, Moment};

#[test]
fn a_garnet_is_refused_by_its_name_and_a_deformation_is_read() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let network = root.join("tests/data/network.weights.safetensors");
    // It still says what it is.
    assert!(ModelHeader::read(&network).unwrap().config.is_some());
    let error = ModelFile::read(&network).unwrap_err();
    assert!(
        matches!(&error, CheckpointError::NoNetworks { variant, .. } if variant == "network.weights"),
        "{error}"
    );
    assert!(error.to_string().contains("feature `network`"), "{error}");

    let midway = root.join("../../models/tshirt/midway.safetensors");
    ModelFile::read(&midway).unwrap();
    assert_eq!(ModelHeader::read(&midway).unwrap().moment, Moment::Midway);
}
