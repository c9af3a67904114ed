//! Weights as JSON.

use std::path::Path;

use garnet_skin::SkinWeights;
use serde::Deserialize;

use super::{FileError, FileProblem, json};

#[derive(Debug, Deserialize)]
struct WeightsJson {
    joints: usize,
    joint_index: Vec<Vec<usize>>,
    weight: Vec<Vec<f32>>,
}

/// Reads `{"joints": J, "joint_index": [vertex][], "weight": [vertex][]}`.
///
/// Slots without use have weight 0; other fields are ignored.
///
/// # Errors
///
/// [`FileError`] if the file cannot be read, does not parse, or has impossible weights.
pub fn read_weights(path: impl AsRef<Path>) -> Result<SkinWeights, FileError> {
    json::read_with(path.as_ref(), |bytes| {
        let file: WeightsJson = json::parse(bytes)?;
        if file.weight.len() != file.joint_index.len() {
            return Err(FileProblem::ListLength {
                field: "weight".to_owned(),
                found: file.weight.len(),
                expected: file.joint_index.len(),
            });
        }
        let rows = file.joint_index.iter().zip(&file.weight).enumerate();
        for (vertex, (joints, weights)) in rows {
            if joints.len() != weights.len() {
                return Err(FileProblem::ListLength {
                    field: format!("weight[{vertex}]"),
                    found: weights.len(),
                    expected: joints.len(),
                });
            }
        }
        let rows = file.joint_index.iter().zip(&file.weight);
        let pairs =
            rows.map(|(joints, weights)| joints.iter().copied().zip(weights.iter().copied()));
        Ok(SkinWeights::from_influences(file.joints, pairs)?)
    })
}
