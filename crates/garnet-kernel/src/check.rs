//! Checks of shapes at the border of each kernel.

/// Asserts that a slice is a row-major matrix of `rows` by `columns`.
///
/// # Panics
///
/// Panics with the name of the argument, what was found and what was expected.
#[track_caller]
pub(crate) fn shape(name: &str, values: &[f32], rows: usize, columns: usize) {
    assert!(
        values.len() == rows * columns,
        "`{name}` has {} values, expected {rows} rows of {columns} = {}",
        values.len(),
        rows * columns
    );
}

/// Asserts that a slice of row numbers is a row-major matrix of `rows` by `columns`.
///
/// # Panics
///
/// As [`shape`].
#[track_caller]
pub(crate) fn indices(name: &str, values: &[u32], rows: usize, columns: usize) {
    assert!(
        values.len() == rows * columns,
        "`{name}` has {} values, expected {rows} rows of {columns} = {}",
        values.len(),
        rows * columns
    );
}
