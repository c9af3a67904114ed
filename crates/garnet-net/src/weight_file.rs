//! What the files of models have in common: safetensors with one JSON text that a checksum guards.

use std::collections::HashMap;
use std::path::Path;

use garnet_mesh::{Fingerprint, MOST_BYTES, read_bounded};
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

/// How the name of the scales ends that belong to a tensor of 8 bits.
const SCALE: &str = ".scale";

/// The largest number of 8 bits.
const MOST: f32 = 127.0;

/// What a kind of file says about itself.
pub(crate) trait Header: Serialize + DeserializeOwned {
    /// The schema of files whose numbers are stored as they are.
    const SCHEMA: &'static str;

    /// The schema of files with tensors of 8 bits.
    const PACKED: &'static str;

    /// The schema of the file.
    fn schema(&mut self) -> &mut String;

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

/// A tensor on its way into a file.
#[derive(Debug)]
pub(crate) struct Stored {
    pub(crate) name: String,
    shape: Vec<usize>,
    dtype: Dtype,
    bytes: Vec<u8>,
}

impl Stored {
    /// As safetensors takes it.
    pub(crate) fn view(&self, path: &Path) -> Result<TensorView<'_>, CheckpointError> {
        let view = TensorView::new(self.dtype, self.shape.clone(), &self.bytes);
        view.map_err(|source| not_safetensors(path, source))
    }
}

impl Precision {
    /// A number that stands alone, as it comes back from a file; those of 8 bits come in rows, and
    /// have 16 bits alone.
    pub fn rounded(self, number: f32) -> f32 {
        match self {
            Self::F32 => number,
            Self::F16 | Self::I8 => f16::from_f32(number).to_f32(),
        }
    }

    /// That of numbers for which 8 bits are too few.
    pub(crate) const fn of_places(self) -> Self {
        match self {
            Self::F32 => Self::F32,
            Self::F16 | Self::I8 => Self::F16,
        }
    }

    /// Numbers as they are stored: a tensor, and if it is of 8 bits its scales. What is no matrix
    /// is not stored in 8 bits, but in 32.
    pub(crate) fn stored(self, name: String, shape: Vec<usize>, numbers: &[f32]) -> Vec<Stored> {
        let single = |name, shape, numbers: &[f32]| Stored {
            name,
            shape,
            dtype: Dtype::F32,
            bytes: (numbers.iter()).flat_map(|n| n.to_le_bytes()).collect(),
        };
        match self {
            Self::F16 => {
                let halves = numbers.iter().map(|&number| f16::from_f32(number));
                vec![Stored {
                    name,
                    shape,
                    dtype: Dtype::F16,
                    bytes: halves.flat_map(f16::to_le_bytes).collect(),
                }]
            }
            Self::I8 if shape.len() > 1 && !numbers.is_empty() => {
                let row = numbers.len() / shape[0];
                let (bytes, scales): (Vec<Vec<u8>>, Vec<f32>) =
                    numbers.chunks_exact(row).map(packed).unzip();
                let scale = single(name.clone() + SCALE, vec![shape[0]], &scales);
                let tensor = Stored {
                    name,
                    shape,
                    dtype: Dtype::I8,
                    bytes: bytes.concat(),
                };
                vec![tensor, scale]
            }
            Self::F32 | Self::I8 => vec![single(name, shape, numbers)],
        }
    }
}

/// A row in 8 bits, and what its numbers are multiplied by: none, of a row that has a number that
/// is none.
fn packed(row: &[f32]) -> (Vec<u8>, f32) {
    let most = row
        .iter()
        .fold(0.0_f32, |most, number| most.max(number.abs()));
    if !row.iter().all(|number| number.is_finite()) {
        return (vec![0; row.len()], f32::NAN);
    }
    let scale = most / MOST;
    if scale == 0.0 {
        return (vec![0; row.len()], 0.0);
    }
    let byte = |number: &f32| (number / scale).round().clamp(-MOST, MOST) as i8;
    let bytes = row.iter().flat_map(|number| byte(number).to_le_bytes());
    (bytes.collect(), scale)
}

pub(crate) fn read(path: &Path) -> Result<Vec<u8>, CheckpointError> {
    read_bounded(path, MOST_BYTES).map_err(|source| CheckpointError::Io {
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
    let is_packed = views.iter().any(|(_, view)| view.dtype() == Dtype::I8);
    let schema = if is_packed { H::PACKED } else { H::SCHEMA };
    schema.clone_into(header.schema());
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
    if ![H::SCHEMA, H::PACKED].contains(&schema_in(&any)) {
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
    let is_packed = header.schema() == H::PACKED;
    for (name, view) in &views {
        if view.dtype() == Dtype::I8 && !(is_packed && has_scales(&tensors, name, view)) {
            return Err(CheckpointError::Tensor {
                path: path.to_path_buf(),
                name: (*name).to_owned(),
                found: "of 8 bits".to_owned(),
                expected: format!("a scale for each row, in a file of schema `{}`", H::PACKED),
            });
        }
    }
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
        Dtype::I8 => true,
        other => {
            return Err(CheckpointError::Tensor {
                path: path.to_path_buf(),
                name: name.to_owned(),
                found: format!("of type {other:?}"),
                expected: "F32, F16 or I8".to_owned(),
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

/// Whether a tensor of 8 bits has a scale for each row.
fn has_scales(tensors: &SafeTensors<'_>, name: &str, view: &TensorView<'_>) -> bool {
    let scales = tensors.tensor(&(name.to_owned() + SCALE));
    let expected = view.shape().first().copied();
    view.shape().len() > 1
        && scales.is_ok_and(|scales| {
            scales.dtype() == Dtype::F32 && Some(scales.data().len() / 4) == expected
        })
}

/// The numbers of a tensor of a file that was [checked]; none if there is no such.
pub(crate) fn numbers(tensors: &SafeTensors<'_>, name: &str) -> Option<Vec<f32>> {
    let view = tensors.tensor(name).ok()?;
    let bytes = view.data();
    let single = |&number: &[u8; 4]| f32::from_le_bytes(number);
    match view.dtype() {
        Dtype::F32 => Some(bytes.as_chunks().0.iter().map(single).collect()),
        Dtype::F16 => {
            let halves: Vec<f16> = halves(bytes).collect();
            Some(halves.to_f32_vec())
        }
        Dtype::I8 => {
            let scales = tensors.tensor(&(name.to_owned() + SCALE)).ok()?;
            let scales = scales.data().as_chunks().0.iter().map(single);
            let row = bytes.len() / view.shape().first().copied()?.max(1);
            let rows = bytes.chunks_exact(row.max(1)).zip(scales);
            let numbers = rows.flat_map(|(row, scale)| {
                let whole = |&byte: &u8| f32::from(i8::from_le_bytes([byte]));
                row.iter().map(move |byte| scale * whole(byte))
            });
            Some(numbers.collect())
        }
        _ => None,
    }
}

/// The bytes of a file that was [checked] with its matrices of 8 bits in 32, without scales; none
/// if it has none of 8 bits.
#[cfg(feature = "burn")]
pub(crate) fn widened(path: &Path, bytes: &[u8]) -> Result<Option<Vec<u8>>, CheckpointError> {
    let failed = |source| not_safetensors(path, source);
    let tensors = SafeTensors::deserialize(bytes).map_err(failed)?;
    let is_packed = |name: &str| {
        let view = tensors.tensor(name);
        view.is_ok_and(|view| view.dtype() == Dtype::I8)
    };
    if !tensors.names().into_iter().any(&is_packed) {
        return Ok(None);
    }
    let mut wide = Vec::new();
    for (name, view) in tensors.iter() {
        if name.strip_suffix(SCALE).is_some_and(is_packed) {
            continue;
        }
        let numbers = numbers(&tensors, name).unwrap_or_default();
        wide.extend(Precision::F32.stored(name.to_owned(), view.shape().to_vec(), &numbers));
    }
    let views = wide
        .iter()
        .map(|stored| Ok((&stored.name, stored.view(path)?)));
    let views: Vec<_> = views.collect::<Result<_, CheckpointError>>()?;
    safetensors::serialize(views, None)
        .map(Some)
        .map_err(failed)
}

fn halves(bytes: &[u8]) -> impl Iterator<Item = f16> {
    (bytes.as_chunks().0.iter()).map(|&number| f16::from_le_bytes(number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_bits_are_off_by_half_a_step_at_most() {
        let numbers: Vec<f32> = (0..60)
            .map(|n| (n as f32 * 1.7).sin() * 10_f32.powi(n / 20))
            .collect();
        let stored = Precision::I8.stored("m".to_owned(), vec![3, 4, 5], &numbers);
        let names: Vec<&str> = stored.iter().map(|stored| stored.name.as_str()).collect();
        assert_eq!(names, ["m", "m.scale"]);
        let path = Path::new("m.safetensors");
        let views = stored
            .iter()
            .map(|stored| (&stored.name, stored.view(path).unwrap()));
        let bytes = safetensors::serialize(views, None).unwrap();
        let tensors = SafeTensors::deserialize(&bytes).unwrap();
        let back = super::numbers(&tensors, "m").unwrap();
        for (row, back) in numbers.chunks(20).zip(back.chunks(20)) {
            let most = row
                .iter()
                .fold(0.0_f32, |most, number| most.max(number.abs()));
            for (number, back) in row.iter().zip(back) {
                // Half a step, and the rounding of the product.
                assert!((number - back).abs() <= most * (0.5 / MOST + 1e-6));
            }
        }
        // What came back is stored as it is.
        let again = Precision::I8.stored("m".to_owned(), vec![3, 4, 5], &back);
        assert_eq!(again[0].bytes, stored[0].bytes);
    }

    #[test]
    fn rows_of_nothing_and_numbers_that_are_none_are_told_apart() {
        assert_eq!(packed(&[0.0, -0.0]), (vec![0, 0], 0.0));
        assert!(packed(&[1.0, f32::NAN]).1.is_nan());
        assert!(packed(&[1.0, f32::INFINITY]).1.is_nan());
        // Too small for a step of their own.
        assert_eq!(packed(&[1e-45, 0.0]), (vec![0, 0], 0.0));
        let bias = Precision::I8.stored("b".to_owned(), vec![3], &[0.25; 3]);
        assert!(bias.len() == 1 && bias[0].dtype == Dtype::F32);
    }
}
