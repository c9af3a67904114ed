//! The regressor of the joints of a model of the SMPL family, dense or sparse.
//!
//! A sparse matrix of `scipy` is an object of Python, unless its parts are saved beside each other:
//! `J_regressor_data`, `J_regressor.indptr`, `J_regressor/indices` and so on.

use super::{ArrayProblem, FileError, FileProblem, npy::NpyArray, npz::NpzFile};

/// Joint, vertex and weight.
pub(super) type Entry = (usize, usize, f64);

const KEY: &str = "J_regressor";

/// The weights of a joint add up to 1 within this.
const SUM_ROUNDING: f64 = 0.05;

/// How many joints and vertices there are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Size {
    pub joints: usize,
    pub vertices: usize,
}

/// The entries of the regressor; none if there is none.
///
/// It is a dense array `[J, V]` or `[V, J]`, rows of joint, vertex and weight, or a sparse matrix
/// in parts: by coordinates, CSR or CSC.
pub(super) fn regressor(npz: &mut NpzFile, size: Size) -> Result<Option<Vec<Entry>>, FileError> {
    let array = npz.array(KEY);
    let data = part(npz, &["data", "values", "val"])?;
    // What an object of Python holds may stand beside it in parts.
    let (array, data) = match (array, data) {
        (Err(_), Some(data)) => (None, Some(data)),
        (array, data) => (array?, data),
    };
    if let Some(array) = array {
        return dense(npz, &array, size).map(Some);
    }
    let Some(data) = data else {
        return Ok(None);
    };
    if data.lengths.len() != 1 {
        let expected = "[_]: a matrix by coordinates, CSR or CSC".to_owned();
        let found = data.lengths;
        return Err(npz.wrong(&data.key, ArrayProblem::Shape { found, expected }));
    }
    let rows = part(npz, &["row", "rows"])?;
    let columns = part(npz, &["col", "cols", "column", "columns"])?;
    let entries = if let (Some(rows), Some(columns)) = (rows, columns) {
        let is_turned = is_turned(npz, size, Some((&rows.values, &columns.values)))?;
        let [joints, vertices] = if is_turned {
            [columns, rows]
        } else {
            [rows, columns]
        };
        [joints, vertices].map(|part| (part.key, part.values))
    } else {
        compressed(npz, &data, size)?
    };
    of_parts(npz, entries, data, size).map(Some)
}

fn dense(npz: &NpzFile, array: &NpyArray, size: Size) -> Result<Vec<Entry>, FileError> {
    let values = array.floats().map_err(|problem| npz.wrong(KEY, problem))?;
    let entries = |columns: usize| {
        let entries = values.iter().enumerate();
        let entries = entries.filter(|&(_, &weight)| weight != 0.0);
        entries.map(move |(index, &weight)| (index / columns, index % columns, weight))
    };
    let Size { joints, vertices } = size;
    match *array.shape.as_slice() {
        [rows, columns] if rows == joints && columns == vertices => Ok(entries(columns).collect()),
        [rows, columns]
            if rows == vertices && columns == joints && (columns != 3 || adds_up(&values)) =>
        {
            let turned = entries(columns).map(|(vertex, joint, weight)| (joint, vertex, weight));
            Ok(turned.collect())
        }
        [_, 3] => {
            let column = |axis: usize| {
                let values = values.chunks_exact(3).map(|row| row[axis]).collect();
                (KEY.to_owned(), values)
            };
            let data = Part {
                key: KEY.to_owned(),
                lengths: vec![array.shape[0]],
                values: column(2).1,
            };
            of_parts(npz, [column(0), column(1)], data, size)
        }
        _ => Err(npz.wrong(
            KEY,
            ArrayProblem::Shape {
                found: array.shape.clone(),
                expected: format!("[{joints}, {vertices}]"),
            },
        )),
    }
}

/// Whether each of three columns adds up to 1, as the weights of a joint do.
fn adds_up(values: &[f64]) -> bool {
    (0..3).all(|column| {
        let sum: f64 = values.chunks_exact(3).map(|row| row[column]).sum();
        (sum - 1.0).abs() < SUM_ROUNDING
    })
}

/// A part of a sparse matrix.
#[derive(Debug)]
struct Part {
    key: String,
    /// Length of each axis.
    lengths: Vec<usize>,
    values: Vec<f64>,
}

/// The part of one of these names behind that of the regressor, whatever stands between them.
fn part(npz: &mut NpzFile, names: &[&str]) -> Result<Option<Part>, FileError> {
    let is_part = |key: &&String| {
        let name = key.strip_prefix(KEY).unwrap_or_default();
        let name = name.trim_start_matches(|letter: char| !letter.is_alphanumeric());
        names.iter().any(|other| name.eq_ignore_ascii_case(other))
    };
    let keys = npz.keys();
    let Some(key) = keys.iter().find(is_part) else {
        return Ok(None);
    };
    let Some(array) = npz.array(key)? else {
        return Ok(None);
    };
    let values = array.floats().map_err(|problem| npz.wrong(key, problem))?;
    Ok(Some(Part {
        key: key.clone(),
        lengths: array.shape,
        values,
    }))
}

/// Whether rows are those of vertices: as the shape of the matrix says, or else its numbers.
fn is_turned(
    npz: &mut NpzFile,
    size: Size,
    numbers: Option<(&[f64], &[f64])>,
) -> Result<bool, FileError> {
    let Size { joints, vertices } = size;
    if let Some(shape) = part(npz, &["shape"])? {
        let counts: Option<Vec<usize>> = shape.values.iter().map(|&value| whole(value)).collect();
        return match counts.as_deref() {
            Some(&[rows, columns]) if rows == joints && columns == vertices => Ok(false),
            Some(&[rows, columns]) if rows == vertices && columns == joints => Ok(true),
            _ => {
                let expected = "the shape of a matrix of the joints and vertices of the model";
                Err(npz.wrong(
                    &shape.key,
                    ArrayProblem::Value {
                        index: 0,
                        value: shape.values.first().copied().unwrap_or(f64::NAN),
                        expected,
                    },
                ))
            }
        };
    }
    let Some((rows, columns)) = numbers else {
        return Ok(false);
    };
    let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    Ok(largest(rows) >= joints as f64 && largest(columns) < joints as f64)
}

/// Joints and vertices of the entries of a compressed matrix, each with the key that they are from.
///
/// Its pointers are as many as there are joints (CSR) or vertices (CSC), and one more.
fn compressed(
    npz: &mut NpzFile,
    data: &Part,
    size: Size,
) -> Result<[(String, Vec<f64>); 2], FileError> {
    let parts = (part(npz, &["indptr"])?, part(npz, &["indices"])?);
    let (starts, indices) = match parts {
        (Some(starts), Some(indices)) => (starts, indices),
        (starts, indices) => {
            let stem = data.key.strip_suffix("data").unwrap_or("J_regressor_");
            let parts = [("indptr", starts.is_none()), ("indices", indices.is_none())];
            let missing = parts.iter().filter(|(_, is_missing)| *is_missing);
            return Err(npz.failed(FileProblem::MissingKeys {
                missing: missing.map(|(name, _)| format!("{stem}{name}")).collect(),
                found: npz.keys(),
            }));
        }
    };
    let num_starts = starts.values.len();
    // A turned matrix has the pointers of the other format.
    let turned = is_turned(npz, size, None)?;
    let is_csr = match (
        num_starts == size.joints + 1,
        num_starts == size.vertices + 1,
    ) {
        (true, true) => is_csr(npz)? != turned,
        (true, false) => true,
        (false, true) => false,
        (false, false) => {
            let expected = format!(
                "[{}] (CSR) or [{}] (CSC)",
                size.joints + 1,
                size.vertices + 1
            );
            let found = starts.lengths;
            return Err(npz.wrong(&starts.key, ArrayProblem::Shape { found, expected }));
        }
    };
    let mut lines = Vec::with_capacity(data.values.len());
    for (index, &value) in starts.values.iter().enumerate() {
        let count = whole(value).filter(|&count| {
            let is_in_order = lines.len() <= count && count <= data.values.len();
            is_in_order && (index > 0 || count == 0)
        });
        let Some(count) = count else {
            let expected = "a number of entries, ascending from 0";
            let problem = ArrayProblem::Value {
                index,
                value,
                expected,
            };
            return Err(npz.wrong(&starts.key, problem));
        };
        lines.resize(count, index.saturating_sub(1) as f64);
    }
    let lines = (starts.key, lines);
    let others = (indices.key, indices.values);
    Ok(if is_csr {
        [lines, others]
    } else {
        [others, lines]
    })
}

/// Whether the format of a matrix of as many joints as vertices is CSR, as it says.
fn is_csr(npz: &mut NpzFile) -> Result<bool, FileError> {
    for separator in ["_", ".", "/"] {
        let key = format!("{KEY}{separator}format");
        if let Some(array) = npz.array(&key)? {
            let texts = array.texts().map_err(|problem| npz.wrong(&key, problem))?;
            return Ok(texts.first().is_none_or(|text| text != "csc"));
        }
    }
    Ok(true)
}

fn of_parts(
    npz: &NpzFile,
    [joints, vertices]: [(String, Vec<f64>); 2],
    data: Part,
    size: Size,
) -> Result<Vec<Entry>, FileError> {
    let mut numbers = [Vec::new(), Vec::new()];
    let parts = [(joints, size.joints), (vertices, size.vertices)];
    for (numbers, ((key, values), count)) in numbers.iter_mut().zip(parts) {
        if values.len() != data.values.len() {
            let expected = format!("[{}]", data.values.len());
            let found = vec![values.len()];
            return Err(npz.wrong(&key, ArrayProblem::Shape { found, expected }));
        }
        for (index, value) in values.into_iter().enumerate() {
            let Some(number) = whole(value).filter(|&number| number < count) else {
                let expected = "the number of a joint or a vertex";
                let problem = ArrayProblem::Value {
                    index,
                    value,
                    expected,
                };
                return Err(npz.wrong(&key, problem));
            };
            numbers.push(number);
        }
    }
    let [joints, vertices] = numbers;
    let places = joints.into_iter().zip(vertices).zip(data.values);
    Ok(places
        .map(|((joint, vertex), weight)| (joint, vertex, weight))
        .collect())
}

/// A number that counts something; none if it is negative, a fraction or not finite.
#[expect(clippy::cast_sign_loss, reason = "the range is checked")]
fn whole(value: f64) -> Option<usize> {
    let is_count = (0.0..=f64::from(u32::MAX)).contains(&value) && value.fract() == 0.0;
    is_count.then_some(value as usize)
}
