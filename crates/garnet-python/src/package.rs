//! Garment packages: a template with trained variants.

use std::{
    collections::BTreeMap,
    ffi::CStr,
    path::PathBuf,
    sync::{Arc, Mutex, PoisonError},
};

use garnet::Draper;
use numpy::PyArray2;
use pyo3::{exceptions::PyUserWarning, prelude::*, types::PyDict};

use crate::{
    arrays,
    body::Body,
    drape::{Drape, drape_on},
    errors::failed,
    judge::judge,
    options::Options,
};

/// What is told of garments that the command would cut anew.
const NOT_CUT: &CStr = c"the garment is made to measure, and is not cut for this body: it is as long \
and as wide as for the package's own; `garnet drape` cuts it for each wearer";

/// Package(folder)
///
/// A garment package: a garment on its body, with trained variants and its simulation.
///
/// Raises GarnetError for a folder that is no package, or a damaged one.
#[pyclass(frozen, module = "garnet")]
pub(crate) struct Package {
    inner: garnet::Package,
    /// Drapers by the name of their variant, each made once; that of no name is the default.
    drapers: Mutex<BTreeMap<String, Arc<Draper>>>,
}

#[pymethods]
impl Package {
    #[new]
    fn new(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        let package = py.detach(|| garnet::Package::open(folder));
        Ok(Self {
            inner: package.map_err(failed)?,
            drapers: Mutex::default(),
        })
    }

    /// The sizes that the package has beside its template, as "l".
    #[getter]
    fn sizes(&self) -> PyResult<Vec<String>> {
        self.inner.sizes().map_err(failed)
    }

    /// The same package with its garment in another of its sizes.
    ///
    /// Raises GarnetError for a size that there is not.
    fn in_size(&self, py: Python<'_>, size: &str) -> PyResult<Self> {
        let package = py.detach(|| self.inner.in_size(size));
        Ok(Self {
            inner: package.map_err(failed)?,
            drapers: Mutex::default(),
        })
    }

    /// Drapes the garment on a target.
    ///
    /// target: a PosedBody, or vertices [n, 3] of the garment's body in another pose or shape.
    /// method: a variant ("fast", "balanced", "accurate"), "warp", "dqs" or "lbs"; by default the
    /// package's default variant.
    /// clearance: least distance of cloth and skin, metres. untangle=False leaves vertices that
    /// are inside the skin. settle: frames of a sixtieth of a second for which the cloth is
    /// simulated; by default what the variant says.
    ///
    /// Warns (UserWarning) of a garment that is made to measure on a body of another shape: it is
    /// not cut for it. Raises ValueError for arguments that are out of range, GarnetError for a
    /// garment that cannot be draped.
    #[pyo3(signature = (target, *, method=None, clearance=None, untangle=true, settle=None))]
    fn drape(
        &self,
        py: Python<'_>,
        target: &Bound<'_, PyAny>,
        method: Option<String>,
        clearance: Option<f64>,
        untangle: bool,
        settle: Option<u32>,
    ) -> PyResult<Drape> {
        let options = Options {
            method,
            clearance,
            untangle,
            settle,
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
        let garment = self.inner.garment();
        judge(py, garment, garment.shared_body(), vertices, target)
    }

    /// The name of the garment.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.manifest().name
    }

    /// The names of the trained variants. GarNets among them are the command's alone.
    #[getter]
    fn variants(&self) -> Vec<&str> {
        let variants = self.inner.manifest().variants.iter();
        variants.map(|variant| variant.name.as_str()).collect()
    }

    /// The name of the variant that drapes by default.
    #[getter]
    fn default_variant(&self) -> Option<&str> {
        let variant = self.inner.manifest().default_variant()?;
        Some(&variant.name)
    }

    /// Whether the command cuts the garment anew for each wearer; here it is draped as it is.
    #[getter]
    fn is_made_to_measure(&self) -> bool {
        self.inner.manifest().is_made_to_measure()
    }

    /// Vertices on the body at rest [n, 3], metres.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::of_points(py, self.inner.garment().mesh().positions())
    }

    /// Faces [m, 3]; polygons of the template are cut into triangles.
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        arrays::of_faces(py, self.inner.garment().mesh().faces())
    }

    /// The body that the garment lies on at rest.
    #[getter]
    fn body(&self) -> Body {
        Body {
            inner: Arc::clone(self.inner.garment().shared_body()),
        }
    }

    fn __repr__(&self) -> String {
        let vertices = self.inner.garment().mesh().num_vertices();
        format!("Package({}, {vertices} vertices)", self.name())
    }
}

impl Package {
    pub(crate) fn draped(
        &self,
        py: Python<'_>,
        target: &Bound<'_, PyAny>,
        options: &Options,
    ) -> PyResult<Drape> {
        let draper = py.detach(|| self.draper(options)).map_err(failed)?;
        let body = self.inner.garment().shared_body();
        let drape = drape_on(py, &options.applied(&draper)?, body, target)?;
        if drape.has_other_shape && self.is_made_to_measure() {
            let category = py.get_type::<PyUserWarning>();
            PyErr::warn(py, &category, NOT_CUT, 1)?;
        }
        Ok(drape)
    }

    fn draper(&self, options: &Options) -> Result<Arc<Draper>, garnet::Error> {
        let name = match options.method.as_deref() {
            None | Some("auto") => "",
            Some(name) => name,
        };
        // A draper that a thread failed to make is not in the map.
        let known = || self.drapers.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(draper) = known().get(name) {
            return Ok(Arc::clone(draper));
        }
        let draper = if options.warp().is_some() {
            let draper = Draper::new(Arc::clone(self.inner.garment()));
            draper.with_simulator(self.inner.simulator()?)
        } else if name.is_empty() {
            self.inner.default_draper()?
        } else {
            self.inner.draper(name)?
        };
        let draper = Arc::new(draper);
        known().insert(name.to_owned(), Arc::clone(&draper));
        Ok(draper)
    }
}
