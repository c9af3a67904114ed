//! The network against `PyTorch`: `benches/python/garnet_torch.py` made the reference values, in
//! double precision, from the weights that lie beside them.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;

use garnet_net::{GarmentGraph, Predictor, ReferenceStage};

/// Bound on the difference, relative to the largest translation.
const TOLERANCE: f64 = 1e-4;

#[test]
fn the_same_weights_give_the_same_translations_as_in_pytorch() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let text = std::fs::read_to_string(data.join("network.torch.json")).unwrap();
    let reference: serde_json::Value = serde_json::from_str(&text).unwrap();
    let rows = reference["translations"].as_array().unwrap().iter();
    let expected = rows.flat_map(|row| row.as_array().unwrap());
    let expected: Vec<f64> = expected.map(|value| value.as_f64().unwrap()).collect();

    let stage = ReferenceStage::new(60, 80);
    let garment = GarmentGraph::new(stage.template(), &[]).unwrap();
    let (template, body) = (stage.template().positions(), stage.body().positions());
    let weights = data.join("network.weights.safetensors");
    let mut predictor = Predictor::load(weights, garment, template, body).unwrap();
    predictor.prepare(&stage.input()).unwrap();
    let translations = predictor.translations();
    assert_eq!(translations.len(), expected.len());
    let largest = expected
        .iter()
        .fold(0.0_f64, |most, value| most.max(value.abs()));
    assert!(largest > 1e-3);
    for (number, (&found, expected)) in translations.iter().zip(&expected).enumerate() {
        let error = (f64::from(found) - expected).abs() / largest;
        assert!(error < TOLERANCE, "number {number}: {found} and {expected}");
    }
}
