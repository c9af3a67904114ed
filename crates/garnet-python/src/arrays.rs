//! Arrays of `NumPy` in and out, checked.

use garnet::{Point3, TriMesh, Vector3};
use numpy::{PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::{exceptions::PyValueError, prelude::*, types::IntoPyDict};

use crate::errors::refused;

/// Numbers of an array `[rows, columns]` of finite floats, row after row.
///
/// # Errors
///
/// `ValueError` for what is no array of numbers, of another shape, or has a number that is not
/// finite.
pub(crate) fn floats<const COLUMNS: usize>(
    name: &str,
    values: &Bound<'_, PyAny>,
) -> PyResult<Vec<[f32; COLUMNS]>> {
    let (values, shape) = unchecked(name, values)?;
    if shape.len() != 2 || shape[1] != COLUMNS {
        let shape = shown(&shape);
        return Err(PyValueError::new_err(format!(
            "{name} must have the shape [n, {COLUMNS}], found {shape}"
        )));
    }
    check_finite(name, &values, &shape)?;
    let rows = values.as_chunks::<COLUMNS>().0.iter().copied();
    Ok(rows.collect())
}

/// Numbers of an array of any shape, row after row, and its shape.
pub(crate) fn numbers(name: &str, values: &Bound<'_, PyAny>) -> PyResult<(Vec<f32>, Vec<usize>)> {
    let (values, shape) = unchecked(name, values)?;
    check_finite(name, &values, &shape)?;
    Ok((values, shape))
}

fn unchecked(name: &str, values: &Bound<'_, PyAny>) -> PyResult<(Vec<f32>, Vec<usize>)> {
    let array = contiguous(name, values, "float64")?;
    let array = array.cast::<PyArrayDyn<f64>>()?.readonly();
    let values = array.as_slice()?.iter().map(|&value| value as f32);
    Ok((values.collect(), array.shape().to_vec()))
}

/// Refuses numbers that are not finite, or too large for 32 bits.
fn check_finite(name: &str, values: &[f32], shape: &[usize]) -> PyResult<()> {
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        let row = at / shape.last().copied().unwrap_or(1).max(1);
        let value = values[at];
        return Err(PyValueError::new_err(format!(
            "{name} has a number that is not finite: {value} in row {row}"
        )));
    }
    Ok(())
}

/// Points `[n, 3]`, in metres.
pub(crate) fn points(name: &str, values: &Bound<'_, PyAny>) -> PyResult<Vec<Point3>> {
    let rows = floats::<3>(name, values)?;
    Ok(rows.into_iter().map(Point3::from).collect())
}

/// One vector `[3]`.
pub(crate) fn vector(name: &str, values: &Bound<'_, PyAny>) -> PyResult<Vector3> {
    let (values, shape) = numbers(name, values)?;
    match (values.as_slice(), shape.as_slice()) {
        (&[x, y, z], [3]) => Ok(Vector3::new(x, y, z)),
        _ => Err(PyValueError::new_err(format!(
            "{name} must have the shape [3], found {}",
            shown(&shape)
        ))),
    }
}

/// Whole numbers of an array of any shape, row after row, and its shape.
pub(crate) fn integers(name: &str, values: &Bound<'_, PyAny>) -> PyResult<(Vec<i64>, Vec<usize>)> {
    let kind = module(values.py())?.call_method1("asarray", (values,));
    let kind = kind.and_then(|array| array.getattr("dtype")?.getattr("kind")?.extract::<char>());
    if !matches!(kind, Ok('i' | 'u')) {
        return Err(PyValueError::new_err(format!(
            "{name} must be an array of integers"
        )));
    }
    let array = contiguous(name, values, "int64")?;
    let array = array.cast::<PyArrayDyn<i64>>()?.readonly();
    Ok((array.as_slice()?.to_vec(), array.shape().to_vec()))
}

/// A mesh of vertices `[n, 3]` and faces `[m, 3]`.
///
/// # Errors
///
/// `ValueError` for arrays of other shapes, numbers that are not finite, and faces that name a
/// vertex which there is not.
pub(crate) fn mesh(vertices: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>) -> PyResult<TriMesh> {
    let positions = points("vertices", vertices)?;
    let (corners, shape) = integers("faces", faces)?;
    if shape.len() != 2 || shape[1] != 3 {
        return Err(PyValueError::new_err(format!(
            "faces must have the shape [m, 3] (triangles), found {}",
            shown(&shape)
        )));
    }
    let count = positions.len() as i64;
    if let Some(at) = corners.iter().position(|index| !(0..count).contains(index)) {
        let (index, face) = (corners[at], at / 3);
        return Err(PyValueError::new_err(format!(
            "faces[{face}] names vertex {index}; there are {count} vertices"
        )));
    }
    let faces = corners.as_chunks::<3>().0.iter();
    let faces = faces.map(|face| face.map(|corner| corner as u32));
    TriMesh::new(positions, faces.collect()).map_err(|error| refused("vertices", error))
}

/// Points as an array `[n, 3]` of `float64`.
pub(crate) fn of_points<'py>(
    py: Python<'py>,
    points: &[Point3],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let numbers = points.iter().flat_map(|point| [point.x, point.y, point.z]);
    of_numbers(py, numbers.map(f64::from).collect(), 3)
}

/// Numbers as an array of so many columns.
pub(crate) fn of_numbers(
    py: Python<'_>,
    numbers: Vec<f64>,
    columns: usize,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let rows = numbers.len() / columns.max(1);
    PyArray1::from_vec(py, numbers).reshape([rows, columns])
}

/// Faces as an array `[m, 3]` of `int64`.
pub(crate) fn of_faces<'py>(
    py: Python<'py>,
    faces: &[[u32; 3]],
) -> PyResult<Bound<'py, PyArray2<i64>>> {
    let corners = faces.iter().flatten().map(|&corner| i64::from(corner));
    PyArray1::from_vec(py, corners.collect()).reshape([faces.len(), 3])
}

fn module(py: Python<'_>) -> PyResult<Bound<'_, PyModule>> {
    py.import("numpy")
}

/// Values as an array of a type, row after row in memory.
fn contiguous<'py>(
    name: &str,
    values: &Bound<'py, PyAny>,
    kind: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let py = values.py();
    let options = [("dtype", kind), ("order", "C")].into_py_dict(py)?;
    let array = module(py)?.call_method("asarray", (values,), Some(&options));
    array.map_err(|error| {
        let reason = error.value(py);
        PyValueError::new_err(format!("{name} must be an array of numbers: {reason}"))
    })
}

fn shown(shape: &[usize]) -> String {
    format!("{shape:?}")
}
