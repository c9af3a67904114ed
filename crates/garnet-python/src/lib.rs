//! The Python module `garnet`: drapes on arrays, without files.
//!
//! Arrays are checked where they enter ([`arrays`]); what Python sees is in four classes and one
//! function, whose documentation is in `python/garnet/_garnet.pyi`. The interpreter is let go while
//! the library works, so that threads of Python drape side by side.

mod arrays;
mod body;
mod drape;
mod errors;
mod garment;
mod judge;
mod options;
mod package;

use pyo3::prelude::*;

/// What `import garnet` brings.
#[pymodule]
fn _garnet(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("GarnetError", module.py().get_type::<errors::GarnetError>())?;
    module.add_class::<body::Body>()?;
    module.add_class::<body::PosedBody>()?;
    module.add_class::<garment::Garment>()?;
    module.add_class::<package::Package>()?;
    module.add_class::<drape::Drape>()?;
    module.add_function(wrap_pyfunction!(drape::drape, module)?)?;
    module.add_function(wrap_pyfunction!(body::poses, module)?)?;
    Ok(())
}
