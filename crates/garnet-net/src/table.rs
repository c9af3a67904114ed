//! Lists of neighbors, as kernels read them.

/// For each row, the numbers of the rows that it gathers; rows may differ in length.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RowLists {
    offsets: Vec<u32>,
    indices: Vec<u32>,
}

impl RowLists {
    /// Of one list a row.
    pub fn from_lists<I: IntoIterator<Item = u32>>(lists: impl IntoIterator<Item = I>) -> Self {
        let mut offsets = vec![0];
        let mut indices = Vec::new();
        for list in lists {
            indices.extend(list);
            offsets.push(indices.len() as u32);
        }
        Self { offsets, indices }
    }

    /// How many rows there are.
    pub fn num_rows(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Where each row begins in [`RowLists::indices`], and the end of the last.
    pub fn offsets(&self) -> &[u32] {
        &self.offsets
    }

    /// All lists, one after the other.
    pub fn indices(&self) -> &[u32] {
        &self.indices
    }

    /// The list of one row.
    ///
    /// # Panics
    ///
    /// If there is no such row.
    pub fn row(&self, row: usize) -> &[u32] {
        &self.indices[self.offsets[row] as usize..self.offsets[row + 1] as usize]
    }
}

/// For each row the same number of rows that it gathers.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RowTable {
    /// Numbers `[row][column]`, row after row.
    pub indices: Vec<u32>,
    /// Numbers a row; at least one.
    pub num_columns: usize,
}

impl RowTable {
    /// How many rows there are.
    pub fn num_rows(&self) -> usize {
        self.indices.len() / self.num_columns.max(1)
    }
}
