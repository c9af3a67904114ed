//! Garments of the user's, bound to a body.

use std::sync::Arc;

use garnet::Draper;
use numpy::PyArray2;
use pyo3::{exceptions::PyValueError, prelude::*, types::PyDict};

use crate::{
    arrays,
    body::Body,
    drape::{Drape, drape_on},
    errors::failed,
    judge::judge,
    options::Options,
};

/// Garment(vertices, faces, body)
///
/// A garment that lies on a body at rest, bound to it once to be draped many times.
///
/// vertices: [n, 3], metres. faces: [m, 3]. Raises GarnetError if it does not lie on the body.
#[pyclass(frozen, module = "garnet")]
pub(crate) struct Garment {
    draper: Draper,
    body: Arc<garnet::Body>,
}

#[pymethods]
impl Garment {
    #[new]
    fn new(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        body: &Body,
    ) -> PyResult<Self> {
        let mesh = arrays::mesh(vertices, faces)?;
        let bound = py.detach(|| garnet::Garment::new(mesh).bind(&body.inner));
        Ok(Self {
            draper: Draper::new(bound.map_err(failed)?),
            body: Arc::clone(&body.inner),
        })
    }

    /// Drapes the garment on a target.
    ///
    /// target: a PosedBody, or vertices [n, 3] of the garment's body in another pose or shape.
    /// method: "warp" (pose and shape, the default), "dqs" or "lbs".
    /// clearance: least distance of cloth and skin, metres. untangle=False leaves vertices that
    /// are inside the skin.
    ///
    /// Raises ValueError for arguments that are out of range, GarnetError for a garment that cannot
    /// be draped.
    #[pyo3(signature = (target, *, method=None, clearance=None, untangle=true))]
    fn drape(
        &self,
        py: Python<'_>,
        target: &Bound<'_, PyAny>,
        method: Option<String>,
        clearance: Option<f64>,
        untangle: bool,
    ) -> PyResult<Drape> {
        let options = Options {
            method,
            clearance,
            untangle,
            settle: None,
        };
        self.draped(py, target, &options)
    }

    /// What is wrong with the garment at vertices [n, 3] on a target, whoever draped it.
    ///
    /// Vertices inside the skin that are not trapped, the deepest, in metres; faces that cross the
    /// skin; and edges over their length at rest.
    fn judge<'py>(
        &self,
        py: Python<'py>,
        vertices: &Bound<'py, PyAny>,
        target: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyDict>> {
        judge(py, self.draper.garment(), &self.body, vertices, target)
    }

    /// Vertices on the body at rest [n, 3], metres.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::of_points(py, self.draper.garment().mesh().positions())
    }

    /// Faces [m, 3].
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        arrays::of_faces(py, self.draper.garment().mesh().faces())
    }

    /// The body that the garment lies on.
    #[getter]
    fn body(&self) -> Body {
        Body {
            inner: Arc::clone(&self.body),
        }
    }

    fn __repr__(&self) -> String {
        let mesh = self.draper.garment().mesh();
        let (vertices, faces) = (mesh.num_vertices(), mesh.num_faces());
        format!("Garment({vertices} vertices, {faces} faces)")
    }
}

impl Garment {
    pub(crate) fn draped(
        &self,
        py: Python<'_>,
        target: &Bound<'_, PyAny>,
        options: &Options,
    ) -> PyResult<Drape> {
        match options.method.as_deref() {
            None | Some("auto" | "warp" | "dqs" | "lbs") => {}
            Some(other) => {
                return Err(PyValueError::new_err(format!(
                    "there is no method `{other}` of a garment without a package; there are warp, \
                     dqs and lbs"
                )));
            }
        }
        if options.settle.is_some() {
            return Err(PyValueError::new_err(
                "settle: only garments of packages are simulated",
            ));
        }
        drape_on(py, &options.applied(&self.draper)?, &self.body, target)
    }
}
