//! Matrices that kernels read.

use crate::check;

/// One feature vector a row: a row-major matrix `[rows, channels]`.
#[derive(Debug, Clone, Copy)]
pub struct Features<'a> {
    /// Values, row after row.
    pub values: &'a [f32],
    /// Number of values a row.
    pub channels: usize,
}

impl<'a> Features<'a> {
    /// Features of `channels` values a row.
    pub fn new(values: &'a [f32], channels: usize) -> Self {
        Self { values, channels }
    }

    /// Asserts the number of rows.
    #[track_caller]
    pub(crate) fn check(&self, name: &str, rows: usize) {
        check::shape(name, self.values, rows, self.channels);
    }

    /// One row.
    #[inline(always)]
    pub(crate) fn row(&self, row: usize) -> &'a [f32] {
        &self.values[row * self.channels..][..self.channels]
    }
}
