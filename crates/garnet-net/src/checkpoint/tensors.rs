//! The weights of a network on their way into a file and out of it, by Burn's store.
//!
//! The store would write files too, but the checksum stands in the metadata, before the numbers:
//! they are collected first and written by safetensors itself.

use std::collections::BTreeMap;
use std::path::Path;

use burn::store::{
    ApplyError, FloatCastAdapter, ModuleSnapshot, SafetensorsStore, SafetensorsStoreError,
    burn_pack,
};
use burn::tensor::DType;

use super::Precision;
use crate::weight_file::{self, Stored, not_safetensors};
use crate::{CheckpointError, GarNet};

/// The weights of a network in the order of their names.
pub(super) fn collected(model: &GarNet, precision: Precision) -> Vec<Stored> {
    let read = |tensor: burn_pack::Tensor| {
        let parts = tensor.into_parts();
        let (name, _, shape, _, bytes) = parts.expect("the weights of a network can be read");
        let numbers: Vec<f32> = (bytes.as_chunks().0.iter())
            .map(|&number| f32::from_le_bytes(number))
            .collect();
        (name, (shape.to_vec(), numbers))
    };
    let adapter = Box::new(FloatCastAdapter::to(DType::F32));
    let tensors = model.collect(None, Some(adapter), false);
    let tensors: BTreeMap<_, _> = tensors.into_iter().map(read).collect();
    let stored = |(name, (shape, numbers)): (String, (Vec<usize>, Vec<f32>))| {
        precision.stored(name, shape, &numbers)
    };
    tensors.into_iter().flat_map(stored).collect()
}

/// Puts the tensors of a file, which are checked, into a network.
///
/// All have to be there, and no others. Names and matrices stay as they are, halves become `f32`;
/// numbers of parameters, by which an optimizer knows them, and their derivatives are those of the
/// network.
pub(super) fn fill(model: &mut GarNet, path: &Path, bytes: Vec<u8>) -> Result<(), CheckpointError> {
    let bytes = weight_file::widened(path, &bytes)?.unwrap_or(bytes);
    // The store is told to go on, for it then says what is wrong tensor by tensor, not in one text.
    let mut store = SafetensorsStore::from_bytes(Some(bytes))
        .with_from_adapter(FloatCastAdapter::to(DType::F32))
        .validate(false)
        .allow_partial(true);
    let unloadable = |source| CheckpointError::Unloadable {
        path: path.to_path_buf(),
        source,
    };
    let misfit = |name: &str, found: String, expected: String| CheckpointError::Tensor {
        path: path.to_path_buf(),
        name: name.to_owned(),
        found,
        expected,
    };
    let loaded = model.load_from(&mut store).map_err(|error| match error {
        SafetensorsStoreError::Safetensors(source) => not_safetensors(path, source),
        other => unloadable(other.into()),
    })?;
    if let Some(error) = loaded.errors.into_iter().next() {
        return Err(match error {
            ApplyError::ShapeMismatch {
                path: name,
                expected,
                found,
            } => {
                let [found, expected] = [found, expected].map(|shape| format!("{:?}", &shape[..]));
                misfit(&name, found, expected)
            }
            other => unloadable(other.into()),
        });
    }
    if let Some((name, _)) = loaded.missing.first() {
        return Err(misfit(name, "missing".to_owned(), "one".to_owned()));
    }
    if let Some(name) = loaded.unused.first() {
        let none = "none of this name".to_owned();
        return Err(misfit(name, "there".to_owned(), none));
    }
    Ok(())
}
