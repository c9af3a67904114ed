//! The sparse symmetric system of a Newton step: one 3×3 block for each pair of coupled vertices.

use nalgebra::Matrix3;

/// Which vertices are coupled: the lower triangle of the block matrix, by columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Pattern {
    /// Where each column begins in `rows`, `[vertex]` and the end.
    starts: Vec<usize>,
    /// Row vertices of each column, sorted; the first is the column itself.
    rows: Vec<u32>,
}

impl Pattern {
    /// The pattern with a diagonal and a block for each of `pairs`, in any order, repeated or not.
    pub(super) fn new(num_vertices: usize, pairs: impl Iterator<Item = [u32; 2]>) -> Self {
        let mut keys: Vec<[u32; 2]> = pairs
            .filter(|[a, b]| a != b)
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        keys.extend((0..num_vertices as u32).map(|vertex| [vertex, vertex]));
        keys.sort_unstable();
        keys.dedup();
        let mut starts = vec![0; num_vertices + 1];
        for &[column, _] in &keys {
            starts[column as usize + 1] += 1;
        }
        for vertex in 0..num_vertices {
            starts[vertex + 1] += starts[vertex];
        }
        let rows = keys.into_iter().map(|[_, row]| row).collect();
        Self { starts, rows }
    }

    pub(super) fn num_vertices(&self) -> usize {
        self.starts.len() - 1
    }

    pub(super) fn num_blocks(&self) -> usize {
        self.rows.len()
    }

    /// The block on the diagonal of a vertex.
    pub(super) fn diagonal(&self, vertex: usize) -> usize {
        self.starts[vertex]
    }

    /// The block of two vertices, of which the larger is the row.
    ///
    /// # Panics
    ///
    /// If the pattern does not couple them.
    pub(super) fn block(&self, a: u32, b: u32) -> usize {
        let (column, row) = (a.min(b) as usize, a.max(b));
        let start = self.starts[column];
        let rows = &self.rows[start..self.starts[column + 1]];
        let place = rows.binary_search(&row);
        start + place.expect("an element couples vertices of the pattern")
    }

    /// Rows and blocks of a column, the diagonal first.
    pub(super) fn column(&self, vertex: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let range = self.starts[vertex]..self.starts[vertex + 1];
        range.map(|block| (self.rows[block] as usize, block))
    }

    /// The blocks' places: column pointers and row indices.
    pub(super) fn block_columns(&self) -> (Vec<usize>, Vec<usize>) {
        let rows = self.rows.iter().map(|&row| row as usize).collect();
        (self.starts.clone(), rows)
    }

    /// The scalar matrix's lower triangle: column pointers and row indices.
    pub(super) fn scalar_columns(&self) -> (Vec<usize>, Vec<usize>) {
        let size = 3 * self.num_vertices();
        let mut pointers = Vec::with_capacity(size + 1);
        let mut indices = Vec::with_capacity(9 * self.num_blocks());
        pointers.push(0);
        for vertex in 0..self.num_vertices() {
            for axis in 0..3 {
                for (row, _) in self.column(vertex) {
                    let first = if row == vertex { axis } else { 0 };
                    indices.extend((first..3).map(|row_axis| 3 * row + row_axis));
                }
                pointers.push(indices.len());
            }
        }
        (pointers, indices)
    }

    /// The values of the scalar matrix, in the order of [`Pattern::scalar_columns`].
    pub(super) fn scalar_values(&self, blocks: &[Matrix3<f64>], values: &mut Vec<f64>) {
        values.clear();
        for vertex in 0..self.num_vertices() {
            for axis in 0..3 {
                for (row, block) in self.column(vertex) {
                    let first = if row == vertex { axis } else { 0 };
                    values.extend((first..3).map(|row_axis| blocks[block][(row_axis, axis)]));
                }
            }
        }
    }
}
