//! Errors as exceptions: `ValueError` for arguments, `GarnetError` for all else.

use std::error::Error;

use pyo3::{
    PyErr, create_exception,
    exceptions::{PyException, PyValueError},
};

create_exception!(
    garnet,
    GarnetError,
    PyException,
    "What the library refuses: a file that cannot be read, a garment that does not lie on its body."
);

/// An error of the library, with all that caused it.
pub(crate) fn failed(error: impl Error) -> PyErr {
    GarnetError::new_err(text_of(&error))
}

/// The same as the fault of an argument.
pub(crate) fn refused(name: &str, error: impl Error) -> PyErr {
    PyValueError::new_err(format!("{name}: {}", text_of(&error)))
}

fn text_of(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        let cause_text = cause.to_string();
        // Transparent errors say what their source says.
        if !text.ends_with(&cause_text) {
            text.push_str(": ");
            text.push_str(&cause_text);
        }
        source = cause.source();
    }
    text
}
