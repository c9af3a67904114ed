//! Matrix products, one thread each: kernels split their rows into tiles and call this for a tile.
//!
//! A product within a tile never depends on the number of threads, so neither do the results.

#![allow(unsafe_code, reason = "the crate `gemm` takes pointers")]
#![allow(clippy::cast_possible_wrap, reason = "strides are lengths of slices")]

use gemm::Parallelism;

/// A matrix that is read, of any strides.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MatrixRef<'a> {
    values: &'a [f32],
    rows: usize,
    columns: usize,
    row_stride: usize,
    column_stride: usize,
}

impl<'a> MatrixRef<'a> {
    /// A row-major matrix without gaps.
    pub(crate) fn new(values: &'a [f32], rows: usize, columns: usize) -> Self {
        Self::strided(values, rows, columns, columns)
    }

    /// A row-major matrix whose rows start `row_stride` apart.
    pub(crate) fn strided(
        values: &'a [f32],
        rows: usize,
        columns: usize,
        row_stride: usize,
    ) -> Self {
        assert_fits(values.len(), rows, columns, row_stride);
        Self {
            values,
            rows,
            columns,
            row_stride,
            column_stride: 1,
        }
    }

    /// Numbers of rows and columns.
    pub(crate) fn shape(&self) -> (usize, usize) {
        (self.rows, self.columns)
    }

    /// Some of the rows of a row-major matrix.
    pub(crate) fn rows(self, rows: std::ops::Range<usize>) -> Self {
        let values = &self.values[rows.start * self.row_stride..];
        Self::strided(values, rows.len(), self.columns, self.row_stride)
    }

    /// The same values with rows and columns exchanged.
    pub(crate) fn transposed(self) -> Self {
        Self {
            rows: self.columns,
            columns: self.rows,
            row_stride: self.column_stride,
            column_stride: self.row_stride,
            ..self
        }
    }
}

/// A row-major matrix that is written.
#[derive(Debug)]
pub(crate) struct MatrixMut<'a> {
    values: &'a mut [f32],
    rows: usize,
    columns: usize,
    row_stride: usize,
}

impl<'a> MatrixMut<'a> {
    /// A row-major matrix without gaps.
    pub(crate) fn new(values: &'a mut [f32], rows: usize, columns: usize) -> Self {
        assert_fits(values.len(), rows, columns, columns);
        Self {
            values,
            rows,
            columns,
            row_stride: columns,
        }
    }

    /// Sets this matrix to the product `a b`.
    pub(crate) fn set_product(self, a: MatrixRef<'_>, b: MatrixRef<'_>) {
        self.product(a, b, false);
    }

    /// Adds the product `a b` to this matrix.
    pub(crate) fn add_product(self, a: MatrixRef<'_>, b: MatrixRef<'_>) {
        self.product(a, b, true);
    }

    fn product(self, a: MatrixRef<'_>, b: MatrixRef<'_>, add: bool) {
        assert!(
            a.columns == b.rows && a.rows == self.rows && b.columns == self.columns,
            "matrices of {} x {} and {} x {} do not give {} x {}",
            a.rows,
            a.columns,
            b.rows,
            b.columns,
            self.rows,
            self.columns
        );
        if self.rows == 0 || self.columns == 0 {
            return;
        }
        // SAFETY: every matrix was checked on creation to lie in its slice, the shapes agree, and
        // the borrow rules keep the written one apart from the others.
        unsafe {
            gemm::gemm(
                self.rows,
                self.columns,
                a.columns,
                self.values.as_mut_ptr(),
                1,
                self.row_stride as isize,
                add,
                a.values.as_ptr(),
                a.column_stride as isize,
                a.row_stride as isize,
                b.values.as_ptr(),
                b.column_stride as isize,
                b.row_stride as isize,
                1.0,
                1.0,
                false,
                false,
                false,
                Parallelism::None,
            );
        }
    }
}

fn assert_fits(len: usize, rows: usize, columns: usize, row_stride: usize) {
    let needed = if rows == 0 || columns == 0 {
        0
    } else {
        (rows - 1) * row_stride + columns
    };
    assert!(
        columns <= row_stride && needed <= len,
        "{rows} rows of {columns} values, {row_stride} apart, do not fit in {len}"
    );
}
