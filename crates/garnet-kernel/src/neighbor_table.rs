//! Tables of neighbors among the rows of another matrix.

use std::sync::OnceLock;

use crate::KernelError;

/// For each row of one matrix the same number of rows of another: the nearest body points of each
/// garment vertex, or the points that a coarser point stands for.
#[derive(Debug, Clone)]
pub struct NeighborTable {
    num_sources: usize,
    neighbors_per_row: usize,
    neighbors: Vec<u32>,
    rows_of_sources: OnceLock<RowsOfSources>,
}

/// The rows that name each source, ascending, as often as they name it.
#[derive(Debug, Clone)]
pub(crate) struct RowsOfSources {
    offsets: Vec<u32>,
    rows: Vec<u32>,
}

impl NeighborTable {
    /// A table from the numbers of the sources of all rows, row after row.
    ///
    /// # Errors
    ///
    /// [`KernelError::UnevenTable`], [`KernelError::NeighborOutOfRange`] and
    /// [`KernelError::TooLarge`].
    pub fn new(
        num_sources: usize,
        neighbors_per_row: usize,
        neighbors: Vec<u32>,
    ) -> Result<Self, KernelError> {
        let len = neighbors.len();
        if neighbors_per_row == 0 || !len.is_multiple_of(neighbors_per_row) {
            return Err(KernelError::UnevenTable {
                len,
                neighbors_per_row,
            });
        }
        let count = len.max(num_sources);
        if u32::try_from(count).is_err() {
            return Err(KernelError::TooLarge { count });
        }
        if let Some(entry) = neighbors
            .iter()
            .position(|&neighbor| neighbor as usize >= num_sources)
        {
            let (row, neighbor) = (entry / neighbors_per_row, neighbors[entry]);
            return Err(KernelError::NeighborOutOfRange {
                row,
                neighbor,
                num_sources,
            });
        }
        Ok(Self {
            num_sources,
            neighbors_per_row,
            neighbors,
            rows_of_sources: OnceLock::new(),
        })
    }

    /// Number of rows.
    pub fn num_rows(&self) -> usize {
        self.neighbors.len() / self.neighbors_per_row
    }

    /// Number of rows that may be named.
    pub fn num_sources(&self) -> usize {
        self.num_sources
    }

    /// Number of neighbors of each row.
    pub fn neighbors_per_row(&self) -> usize {
        self.neighbors_per_row
    }

    /// The sources of a row.
    ///
    /// # Panics
    ///
    /// Panics if there is no such row.
    #[inline]
    pub fn neighbors(&self, row: usize) -> &[u32] {
        &self.neighbors[row * self.neighbors_per_row..][..self.neighbors_per_row]
    }

    /// The sources of all rows, row after row.
    pub fn all(&self) -> &[u32] {
        &self.neighbors
    }

    /// The transposed table, made when a backward pass first asks for it.
    pub(crate) fn rows_of_sources(&self) -> &RowsOfSources {
        self.rows_of_sources
            .get_or_init(|| RowsOfSources::new(self))
    }
}

impl RowsOfSources {
    fn new(table: &NeighborTable) -> Self {
        let mut offsets = vec![0_u32; table.num_sources + 1];
        for &source in &table.neighbors {
            offsets[source as usize + 1] += 1;
        }
        for source in 0..table.num_sources {
            offsets[source + 1] += offsets[source];
        }
        let mut next = offsets.clone();
        let mut rows = vec![0; table.neighbors.len()];
        for (entry, &source) in table.neighbors.iter().enumerate() {
            let place = &mut next[source as usize];
            rows[*place as usize] = (entry / table.neighbors_per_row) as u32;
            *place += 1;
        }
        Self { offsets, rows }
    }

    /// The rows that name a source.
    #[inline(always)]
    pub(crate) fn of(&self, source: usize) -> &[u32] {
        &self.rows[self.offsets[source] as usize..self.offsets[source + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transposed_table_names_every_entry_once() {
        let table = NeighborTable::new(4, 2, vec![3, 1, 1, 1, 0, 3]).expect("valid");
        let rows = table.rows_of_sources();
        assert_eq!(
            [rows.of(0), rows.of(1), rows.of(2), rows.of(3)],
            [&[2][..], &[0, 1, 1], &[], &[0, 2]]
        );
    }

    #[test]
    fn what_is_wrong_is_named() {
        let error = |sources, k, list: &[u32]| NeighborTable::new(sources, k, list.to_vec()).err();
        assert_eq!(
            error(3, 2, &[0, 1, 2]),
            Some(KernelError::UnevenTable {
                len: 3,
                neighbors_per_row: 2
            })
        );
        assert_eq!(
            error(3, 0, &[]),
            Some(KernelError::UnevenTable {
                len: 0,
                neighbors_per_row: 0
            })
        );
        assert_eq!(
            error(3, 2, &[0, 1, 2, 3]),
            Some(KernelError::NeighborOutOfRange {
                row: 1,
                neighbor: 3,
                num_sources: 3
            })
        );
    }
}
