//! The order of the columns of aggregates.
//!
//! Vectors of all heads for the same channels lie one behind the other, so that loops over heads
//! have one address. The rows of the weights are put into the same order before the product.

use crate::Workspace;
use crate::workspace::Scratch;

/// For each column of an aggregate the row of the weights that it is multiplied with.
///
/// The columns of a part of the features are `[vector][head][lane]`, then `[head][channel]` for the
/// channels that fill no vector; those of the next part follow.
pub(crate) struct Columns {
    rows: Vec<u32>,
}

impl Columns {
    /// For features in parts of so many channels.
    pub(crate) fn new(
        channels: impl Iterator<Item = usize> + Clone,
        num_heads: usize,
        lanes: usize,
    ) -> Self {
        let in_channels: usize = channels.clone().sum();
        let mut rows = Vec::with_capacity(num_heads * in_channels);
        let mut first = 0;
        for channels in channels {
            for vector in (0..channels).step_by(lanes) {
                for head in 0..num_heads {
                    let row = (head * in_channels + first + vector) as u32;
                    rows.extend(row..row + lanes.min(channels - vector) as u32);
                }
            }
            first += channels;
        }
        Self { rows }
    }

    /// The rows of a matrix in the order of the columns.
    pub(crate) fn ordered<'a>(
        &self,
        matrix: &[f32],
        columns: usize,
        workspace: &'a Workspace,
    ) -> Scratch<'a> {
        let mut ordered = workspace.scratch(matrix.len());
        for (out, &row) in ordered.chunks_exact_mut(columns).zip(&self.rows) {
            out.copy_from_slice(&matrix[row as usize * columns..][..columns]);
        }
        ordered
    }

    /// Brings rows that are in the order of the columns to their places.
    pub(crate) fn restore(&self, ordered: &[f32], matrix: &mut [f32], columns: usize) {
        for (row, &place) in ordered.chunks_exact(columns).zip(&self.rows) {
            matrix[place as usize * columns..][..columns].copy_from_slice(row);
        }
    }

    /// The row of the weights for each column.
    pub(crate) fn rows(&self) -> &[u32] {
        &self.rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_has_one_column_and_comes_back() {
        let columns = Columns::new([18, 3].into_iter(), 5, 8);
        let mut sorted = columns.rows().to_vec();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..5 * 21));
        // The second vector of the second head, first channel.
        assert_eq!(columns.rows()[8 * 5 + 8], 21 + 8);

        let workspace = Workspace::new();
        let matrix: Vec<f32> = (0..5 * 21 * 4).map(|value| value as f32).collect();
        let ordered = columns.ordered(&matrix, 4, &workspace);
        let mut restored = vec![0.0; matrix.len()];
        columns.restore(&ordered, &mut restored, 4);
        assert_eq!(restored, matrix);
    }
}
