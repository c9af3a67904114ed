//! What is wrong with a garment on a body, whoever draped it.

use std::sync::Arc;

use garnet::{BoundGarment, knn::Surface, mesh::edge_stretch, sim::Penetration, untangle};
use pyo3::{exceptions::PyValueError, prelude::*, types::PyDict};

use crate::{arrays, drape::with_target, errors::failed};

/// Counts what of a garment at `vertices` is in the skin of a target, and measures its stretch.
pub(crate) fn judge<'py>(
    py: Python<'py>,
    garment: &BoundGarment,
    body: &Arc<garnet::Body>,
    vertices: &Bound<'py, PyAny>,
    target: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let positions = arrays::points("vertices", vertices)?;
    let expected = garment.mesh().num_vertices();
    if positions.len() != expected {
        return Err(PyValueError::new_err(format!(
            "vertices has {} rows; the garment has {expected} vertices",
            positions.len()
        )));
    }
    let mesh = garment.mesh().with_positions(positions);
    let mesh = mesh.map_err(failed)?;
    let cloth = garment.cloth();
    let nodes = cloth.weld().gather(mesh.positions());
    let edges = cloth.topology().edges();
    let stretch = edge_stretch(cloth.rest_nodes(), &nodes, edges).map_err(failed)?;
    let ((found, crossing), _) = with_target(py, body, target, |posed| {
        let skin = posed.skin();
        let crossing = untangle::free_crossing_faces(&Surface::new(&mesh), skin).len();
        Ok((Penetration::of(mesh.positions(), skin, 1.0), crossing))
    })?;
    let dict = PyDict::new(py);
    dict.set_item("inside", found.num_inside)?;
    dict.set_item("deepest", f64::from(found.deepest))?;
    dict.set_item("trapped", found.num_trapped)?;
    dict.set_item("crossing_faces", crossing)?;
    dict.set_item("stretch_p50", f64::from(stretch.p50))?;
    dict.set_item("stretch_p99", f64::from(stretch.p99))?;
    dict.set_item("stretch_max", f64::from(stretch.max))?;
    Ok(dict)
}
