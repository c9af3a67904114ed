//! The drape, and what is told of it.

use std::sync::Arc;

use garnet::Draper;
use numpy::{PyArray1, PyArray2};
use pyo3::{exceptions::PyTypeError, prelude::*, types::PyDict};

use crate::{
    arrays,
    body::{self, PosedBody},
    errors::failed,
    garment::Garment,
    options::Options,
    package::Package,
};

/// A draped garment, and how it came about.
#[pyclass(frozen, module = "garnet")]
pub(crate) struct Drape {
    inner: garnet::Drape,
    /// Whether the body has another shape than that on which the garment lies.
    pub(crate) has_other_shape: bool,
    /// How long it took to fit the body to the target, in seconds.
    fit: f64,
}

#[pymethods]
impl Drape {
    /// Vertices [n, 3], metres, in the order of the garment's.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::of_points(py, &self.inner.positions)
    }

    /// Whether each vertex is caught where the body runs through itself [n]; empty if the drape
    /// was not untangled.
    #[getter]
    fn trapped<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_slice(py, &self.inner.is_trapped)
    }

    /// What untangling found and left: counts of vertices and faces, lengths in metres; None if it
    /// was not asked for.
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(report) = &self.inner.report else {
            return Ok(None);
        };
        let dict = PyDict::new(py);
        let counts = [
            ("inside_before", report.inside_before),
            ("inside", report.inside),
            ("trapped", report.trapped),
            ("trapped_inside", report.trapped_inside),
            ("crossing_faces", report.crossing_faces),
            ("crossing_faces_trapped", report.crossing_faces_trapped),
            ("moved", report.moved),
        ];
        for (name, count) in counts {
            dict.set_item(name, count)?;
        }
        let lengths = [
            ("deepest", report.deepest),
            ("deepest_before", report.deepest_before),
            ("max_displacement", report.max_displacement),
            ("min_distance", report.min_distance),
        ];
        for (name, length) in lengths {
            dict.set_item(name, f64::from(length))?;
        }
        Ok(Some(dict))
    }

    /// How long each step took; `fit` is 0 on a posed body.
    #[getter]
    fn seconds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let seconds = &self.inner.seconds;
        let dict = PyDict::new(py);
        dict.set_item("fit", self.fit)?;
        dict.set_item("warp", seconds.warp)?;
        dict.set_item("predict", seconds.predict)?;
        dict.set_item("relax", seconds.relax)?;
        dict.set_item("untangle", seconds.untangle)?;
        dict.set_item("total", self.fit + seconds.total())?;
        Ok(dict)
    }

    /// The moment of the simulation at which a network predicted the cloth; None without one.
    #[getter]
    fn predicted(&self) -> Option<&'static str> {
        let moment = self.inner.provenance.predicted?;
        Some(moment.name())
    }

    /// What of the body is beyond the network's training, if the drape was carried there.
    #[getter]
    fn beyond(&self) -> Option<String> {
        let beyond = self.inner.provenance.beyond.as_ref();
        beyond.map(ToString::to_string)
    }

    /// Why the garment was warped in place of what was asked for; None if it was not.
    #[getter]
    fn fallback(&self) -> Option<String> {
        let fallback = self.inner.provenance.fallback.as_ref();
        fallback.map(ToString::to_string)
    }

    fn __repr__(&self) -> String {
        let vertices = self.inner.positions.len();
        let milliseconds = 1e3 * self.inner.seconds.total();
        match &self.inner.report {
            Some(report) => format!(
                "Drape({vertices} vertices, {} inside the body, {milliseconds:.1} ms)",
                report.inside
            ),
            None => format!("Drape({vertices} vertices, not untangled, {milliseconds:.1} ms)"),
        }
    }
}

/// Drapes a Garment, or that of a Package, and gives its vertices [n, 3] alone.
///
/// The arguments are those of Garment.drape and Package.drape.
#[pyfunction]
#[pyo3(signature = (garment, target, *, method=None, clearance=None, untangle=true, settle=None))]
pub(crate) fn drape<'py>(
    py: Python<'py>,
    garment: &Bound<'py, PyAny>,
    target: &Bound<'py, PyAny>,
    method: Option<String>,
    clearance: Option<f64>,
    untangle: bool,
    settle: Option<u32>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let options = Options {
        method,
        clearance,
        untangle,
        settle,
    };
    let drape = if let Ok(package) = garment.cast::<Package>() {
        package.get().draped(py, target, &options)?
    } else if let Ok(garment) = garment.cast::<Garment>() {
        garment.get().draped(py, target, &options)?
    } else {
        return Err(PyTypeError::new_err(
            "the garment must be a garnet.Garment or a garnet.Package",
        ));
    };
    drape.vertices(py)
}

/// Drapes on a target: a posed body, or the vertices of one.
pub(crate) fn drape_on(
    py: Python<'_>,
    draper: &Draper,
    body: &Arc<garnet::Body>,
    target: &Bound<'_, PyAny>,
) -> PyResult<Drape> {
    let ((inner, has_other_shape), fit) = with_target(py, body, target, |posed| {
        let has_other_shape = posed.shape_offsets().is_some();
        Ok((draper.drape(posed)?, has_other_shape))
    })?;
    Ok(Drape {
        inner,
        has_other_shape,
        fit,
    })
}

/// Calls `work` without the interpreter, on a target: a posed body, or the vertices of one. Tells
/// how long it took to fit the body to them, in seconds.
pub(crate) fn with_target<T: Send>(
    py: Python<'_>,
    body: &Arc<garnet::Body>,
    target: &Bound<'_, PyAny>,
    work: impl FnOnce(&garnet::PosedBody) -> Result<T, garnet::Error> + Send,
) -> PyResult<(T, f64)> {
    let mut fit = 0.0;
    let of_other;
    let posed = match target.cast::<PosedBody>() {
        Ok(posed) if Arc::ptr_eq(&posed.get().body, body) => &posed.get().inner,
        Ok(posed) => {
            // Another body, of which that of the garment may take the pose and the shape.
            let vertices = posed.getattr("vertices")?;
            (of_other, fit) = body::fitted(py, body, "target", &vertices)?;
            &of_other.inner
        }
        Err(_) => {
            (of_other, fit) = body::fitted(py, body, "target", target)?;
            &of_other.inner
        }
    };
    let done = py.detach(|| work(posed)).map_err(failed)?;
    Ok((done, fit))
}
