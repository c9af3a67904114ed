//! Tensors of a safetensors file, as packages and data sets keep them.

use std::collections::HashMap;

use garnet_mesh::{Fingerprint, Point3, Vector3};
use nalgebra::{Quaternion, UnitQuaternion};
use rayon::prelude::*;
use safetensors::{Dtype, SafeTensorError, SafeTensors, View, serialize};

/// Key under which the text of a file is kept. There is one key alone, because the format does not
/// order several.
const TEXT_KEY: &str = "garnet";

/// An array of `f32` with a shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Lengths of its axes.
    pub shape: Vec<usize>,
    /// Its numbers, row after row.
    pub values: Vec<f32>,
}

impl Array {
    /// Rows of points `[row, vertex, 3]`.
    pub fn of_points<'a>(rows: impl Iterator<Item = &'a [Point3]>, num_points: usize) -> Self {
        let values: Vec<f32> = rows
            .flat_map(|row| row.iter().flat_map(|point| [point.x, point.y, point.z]))
            .collect();
        let row = (3 * num_points).max(1);
        Self {
            shape: vec![values.len() / row, num_points, 3],
            values,
        }
    }

    /// Number of rows: the length of the first axis.
    pub fn num_rows(&self) -> usize {
        self.shape.first().copied().unwrap_or(0)
    }

    /// The values of a row.
    pub fn row(&self, row: usize) -> &[f32] {
        let size: usize = self.shape.iter().skip(1).product();
        &self.values[row * size..(row + 1) * size]
    }

    /// The points of a row.
    pub fn points(&self, row: usize) -> Vec<Point3> {
        let values = self.row(row).chunks_exact(3);
        values.map(|p| Point3::new(p[0], p[1], p[2])).collect()
    }

    /// The rotations of a row, stored as x, y, z, w.
    pub fn rotations(&self, row: usize) -> Vec<UnitQuaternion<f32>> {
        let values = self.row(row).chunks_exact(4);
        // Kept as stored: normalising anew would change the last bit of the body.
        values
            .map(|q| UnitQuaternion::new_unchecked(Quaternion::new(q[3], q[0], q[1], q[2])))
            .collect()
    }

    /// The vector of a row.
    pub fn vector(&self, row: usize) -> Vector3 {
        let values = self.row(row);
        Vector3::new(values[0], values[1], values[2])
    }
}

/// A view as the format wants it.
struct Bytes<'a> {
    shape: &'a [usize],
    data: Vec<u8>,
}

impl View for &Bytes<'_> {
    fn dtype(&self) -> Dtype {
        Dtype::F32
    }

    fn shape(&self) -> &[usize] {
        self.shape
    }

    fn data(&self) -> std::borrow::Cow<'_, [u8]> {
        self.data.as_slice().into()
    }

    fn data_len(&self) -> usize {
        self.data.len()
    }
}

/// The bytes of a file with these arrays and the text that `signed` makes of their
/// [checksum](Contents::checksum) with `text`. Equal contents give equal bytes.
///
/// # Errors
///
/// That of [`serialize`], for a shape that its values do not fill.
pub fn to_bytes(
    arrays: &[(&str, &Array)],
    text: &str,
    signed: impl FnOnce(Fingerprint) -> String,
) -> Result<Vec<u8>, SafeTensorError> {
    let bytes = |array: &Array| -> Vec<u8> {
        let values = array.values.iter();
        values.flat_map(|value| value.to_le_bytes()).collect()
    };
    let views: Vec<(&str, Bytes<'_>)> = arrays
        .iter()
        .map(|(name, array)| {
            let (shape, data) = (array.shape.as_slice(), bytes(array));
            (*name, Bytes { shape, data })
        })
        .collect();
    let mut parts: Vec<(&str, &[usize], &[u8])> = (views.iter())
        .map(|(name, view)| (*name, view.shape, view.data.as_slice()))
        .collect();
    let text = signed(checksum(text, &mut parts));
    let metadata = HashMap::from([(TEXT_KEY.to_owned(), text)]);
    serialize(
        views.iter().map(|(name, view)| (*name, view)),
        Some(metadata),
    )
}

/// Of a text, and of names, shapes and bytes of arrays in the order of their names.
fn checksum(text: &str, arrays: &mut [(&str, &[usize], &[u8])]) -> Fingerprint {
    arrays.sort_unstable_by_key(|(name, ..)| *name);
    let sums = arrays.par_iter().map(|(name, shape, bytes)| {
        let numbers = Fingerprint::of_bytes(bytes);
        format!("{name}{shape:?}{numbers}")
    });
    let sums: Vec<String> = sums.collect();
    Fingerprint::of_bytes((text.to_owned() + &sums.concat()).as_bytes())
}

/// Arrays and text of a file.
#[derive(Debug)]
pub struct Contents<'a> {
    tensors: SafeTensors<'a>,
    /// The text.
    pub text: String,
}

impl<'a> Contents<'a> {
    /// Reads the head of a file; none where it holds no text of ours.
    ///
    /// # Errors
    ///
    /// [`SafeTensorError`] for bytes that are no safetensors file.
    pub fn of(bytes: &'a [u8]) -> Result<Option<Self>, SafeTensorError> {
        let (_, metadata) = SafeTensors::read_metadata(bytes)?;
        let texts = metadata.metadata().as_ref();
        let text = texts.and_then(|texts| texts.get(TEXT_KEY)).cloned();
        let tensors = SafeTensors::deserialize(bytes)?;
        Ok(text.map(|text| Self { tensors, text }))
    }

    /// The checksum of its arrays with `text`.
    pub fn checksum(&self, text: &str) -> Fingerprint {
        let views: Vec<_> = self.tensors.iter().collect();
        let mut parts: Vec<(&str, &[usize], &[u8])> = (views.iter())
            .map(|(name, view)| (*name, view.shape(), view.data()))
            .collect();
        checksum(text, &mut parts)
    }

    /// An array that is not of `names`, or does not hold `f32`, if there is one.
    pub fn foreign(&self, names: &[&str]) -> Option<String> {
        let mut foreign: Vec<String> = (self.tensors.iter())
            .filter(|(name, view)| !names.contains(name) || view.dtype() != Dtype::F32)
            .map(|(name, _)| name.to_owned())
            .collect();
        foreign.sort();
        foreign.into_iter().next()
    }

    /// The names of its arrays.
    pub fn names(&self) -> Vec<&str> {
        self.tensors.names()
    }

    /// An array of a name; none if there is none, or if it does not hold `f32`.
    pub fn array(&self, name: &str) -> Option<Array> {
        let view = self.tensors.tensor(name).ok()?;
        (view.dtype() == Dtype::F32).then(|| Array {
            shape: view.shape().to_vec(),
            values: view
                .data()
                .as_chunks()
                .0
                .iter()
                .map(|bytes| f32::from_le_bytes(*bytes))
                .collect(),
        })
    }
}
