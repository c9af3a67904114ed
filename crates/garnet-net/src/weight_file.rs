//! What the files of models have in common: safetensors with one JSON text that a checksum guards.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use garnet_mesh::Fingerprint;
use half::f16;
use half::slice::HalfFloatSliceExt;
use rayon::prelude::*;
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensors};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::{CheckpointError, Precision, UNIT};

/// The metadata key of the JSON text.
const KEY: &str = "garnet";

/// How a text without its checksum says so.
const UNSIGNED: &str = r#""checksum":"""#;

/// What a kind of file says about itself.
pub(crate) trait Header: Serialize + DeserializeOwned {
    /// The schema that this version reads and writes.
    const SCHEMA: &'static str;

    /// Checksum of the text without it, and of names and numbers.
    fn checksum(&mut self) -> &mut String;

    /// The length unit, in metres.
    fn unit(&self) -> f32;
}

/// A file, parsed.
pub(crate) struct Parsed<'a, H> {
    pub(crate) header: H,
    text: String,
    tensors: SafeTensors<'a>,
}

impl Precision {
    pub(crate) const fn dtype(self) -> Dtype {
        match self {
            Self::F32 => Dtype::F32,
            Self::F16 => Dtype::F16,
        }
    }

    /// A number as it comes back from a file.
    pub fn rounded(self, number: f32) -> f32 {
        match self {
            Self::F32 => number,
            Self::F16 => f16::from_f32(number).to_f32(),
        }
    }

    /// Numbers as they are stored.
    pub(crate) fn stored(self, numbers: &[f32]) -> Vec<u8> {
        match self {
            Self::F32 => (numbers.iter())
                .flat_map(|number| number.to_le_bytes())
                .collect(),
            Self::F16 => {
                let halves = numbers.iter().map(|&number| f16::from_f32(number));
                halves.flat_map(f16::to_le_bytes).collect()
            }
        }
    }
}

pub(crate) fn read(path: &Path) -> Result<Vec<u8>, CheckpointError> {
    fs::read(path).map_err(|source| CheckpointError::Io {
        path: path.to_path_buf(),
        source,
    })
}

pub(crate) fn not_safetensors(
    path: &Path,
    source: safetensors::SafeTensorError,
) -> CheckpointError {
    CheckpointError::NotSafetensors {
        path: path.to_path_buf(),
        source,
    }
}

/// The fingerprint of a garment that a header names.
pub(crate) fn fingerprint(path: &Path, text: &str) -> Result<Fingerprint, CheckpointError> {
    text.parse().map_err(|_text| CheckpointError::Foreign {
        path: path.to_path_buf(),
        key: "garment",
    })
}

/// The bytes of a file; signs the header.
pub(crate) fn to_bytes<H: Header>(
    path: &Path,
    header: &mut H,
    mut views: Vec<(&str, TensorView<'_>)>,
) -> Result<Vec<u8>, CheckpointError> {
    views.sort_unstable_by_key(|(name, _)| *name);
    (views.iter()).try_for_each(|(name, view)| check(path, name, view))?;
    let text = |header: &H| {
        serde_json::to_string(header).map_err(|source| CheckpointError::Metadata {
            path: path.to_path_buf(),
            source,
        })
    };
    header.checksum().clear();
    *header.checksum() = checksum(&text(header)?, &views).to_string();
    let metadata = HashMap::from([(KEY.to_owned(), text(header)?)]);
    let bytes = safetensors::serialize(views, Some(metadata));
    bytes.map_err(|source| not_safetensors(path, source))
}

/// The schema of a file.
pub(crate) fn schema(path: &Path, bytes: &[u8]) -> Result<String, CheckpointError> {
    let (_, any) = text(path, bytes)?;
    Ok(schema_in(&any).to_owned())
}

fn schema_in(any: &serde_json::Value) -> &str {
    let schema = any.get("schema").and_then(serde_json::Value::as_str);
    schema.unwrap_or("none")
}

/// The text of a file, and what it says.
fn text(path: &Path, bytes: &[u8]) -> Result<(String, serde_json::Value), CheckpointError> {
    let failed = |source| not_safetensors(path, source);
    let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(failed)?;
    let text = metadata.metadata().as_ref().and_then(|map| map.get(KEY));
    let text = text.ok_or_else(|| CheckpointError::Foreign {
        path: path.to_path_buf(),
        key: KEY,
    })?;
    let any = serde_json::from_str(text).map_err(|source| CheckpointError::Metadata {
        path: path.to_path_buf(),
        source,
    })?;
    Ok((text.clone(), any))
}

/// Reads what a file says about itself, and checks no numbers.
pub(crate) fn parse<'a, H: Header>(
    path: &Path,
    bytes: &'a [u8],
) -> Result<Parsed<'a, H>, CheckpointError> {
    let tensors = SafeTensors::deserialize(bytes);
    let (text, any) = text(path, bytes)?;
    let tensors = tensors.map_err(|source| not_safetensors(path, source))?;
    let other = |found| CheckpointError::Schema {
        path: path.to_path_buf(),
        found,
        expected: H::SCHEMA,
    };
    // The schema comes first: the rest of another version need not be understood.
    if schema_in(&any) != H::SCHEMA {
        return Err(other(schema_in(&any).to_owned()));
    }
    let header: H = serde_json::from_value(any).map_err(|source| CheckpointError::Metadata {
        path: path.to_path_buf(),
        source,
    })?;
    if (header.unit() - UNIT).abs() > f32::EPSILON {
        let found = format!("{} in units of {} m", H::SCHEMA, header.unit());
        return Err(other(found));
    }
    Ok(Parsed {
        header,
        text,
        tensors,
    })
}

/// What a file says about itself and its tensors, if they are those that were written.
pub(crate) fn checked<'a, H: Header>(
    path: &Path,
    bytes: &'a [u8],
) -> Result<(H, SafeTensors<'a>), CheckpointError> {
    let Parsed {
        mut header,
        text,
        tensors,
    } = parse::<H>(path, bytes)?;
    let mut views: Vec<(&str, TensorView<'_>)> = tensors.iter().collect();
    views.sort_unstable_by_key(|(name, _)| *name);
    let signed = format!(r#""checksum":"{}""#, header.checksum());
    let found = checksum(&text.replacen(&signed, UNSIGNED, 1), &views);
    let expected = header.checksum().parse();
    let expected = expected.unwrap_or(Fingerprint::of_bytes(&[]));
    if found != expected {
        return Err(CheckpointError::Altered {
            path: path.to_path_buf(),
            found,
            expected,
        });
    }
    (views.iter()).try_for_each(|(name, view)| check(path, name, view))?;
    Ok((header, tensors))
}

/// Of the unsigned text, and of names and numbers in the order of the names.
fn checksum(text: &str, tensors: &[(&str, TensorView<'_>)]) -> Fingerprint {
    let sum = |(name, view): &(&str, TensorView<'_>)| {
        let numbers = Fingerprint::of_bytes(view.data());
        format!("{name}{numbers}")
    };
    let sums: Vec<String> = tensors.par_iter().map(sum).collect();
    Fingerprint::of_bytes((text.to_owned() + &sums.concat()).as_bytes())
}

/// Whether the numbers of a tensor are such as weights have.
fn check(path: &Path, name: &str, view: &TensorView<'_>) -> Result<(), CheckpointError> {
    let bytes = view.data();
    let is_finite = match view.dtype() {
        Dtype::F32 => (bytes.as_chunks().0.iter())
            .map(|&number| f32::from_le_bytes(number))
            .all(f32::is_finite),
        // Looked at as they are: there are millions.
        Dtype::F16 => halves(bytes).all(f16::is_finite),
        other => {
            return Err(CheckpointError::Tensor {
                path: path.to_path_buf(),
                name: name.to_owned(),
                found: format!("of type {other:?}"),
                expected: "F32 or F16".to_owned(),
            });
        }
    };
    if is_finite {
        return Ok(());
    }
    Err(CheckpointError::NotFinite {
        name: name.to_owned(),
    })
}

/// The numbers of a tensor; none of another type than weights have.
pub(crate) fn numbers(view: &TensorView<'_>) -> Option<Vec<f32>> {
    let bytes = view.data();
    let single = |&number: &[u8; 4]| f32::from_le_bytes(number);
    match view.dtype() {
        Dtype::F32 => Some(bytes.as_chunks().0.iter().map(single).collect()),
        Dtype::F16 => {
            let halves: Vec<f16> = halves(bytes).collect();
            Some(halves.to_f32_vec())
        }
        _ => None,
    }
}

fn halves(bytes: &[u8]) -> impl Iterator<Item = f16> {
    (bytes.as_chunks().0.iter()).map(|&number| f16::from_le_bytes(number))
}
