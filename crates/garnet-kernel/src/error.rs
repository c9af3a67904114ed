//! What can be wrong with neighborhoods given to the kernels.

use thiserror::Error;

/// Why an [`Adjacency`](crate::Adjacency) or a [`NeighborTable`](crate::NeighborTable) cannot be
/// made.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum KernelError {
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {vertex}, but there are {num_vertices} vertices")]
    FaceIndexOutOfRange {
        /// Number of the face.
        face: usize,
        /// The vertex that it names.
        vertex: u32,
        /// Number of vertices.
        num_vertices: usize,
    },
    /// A list of neighbors names a row that does not exist.
    #[error("row {row} names neighbor {neighbor}, but there are {num_sources} rows to choose from")]
    NeighborOutOfRange {
        /// Number of the row.
        row: usize,
        /// The neighbor that it names.
        neighbor: u32,
        /// Number of rows that may be named.
        num_sources: usize,
    },
    /// A table has no neighbors at all, or a length that is no multiple of the neighbors a row.
    #[error("{len} indices do not make rows of {neighbors_per_row} neighbors, at least one each")]
    UnevenTable {
        /// Number of indices given.
        len: usize,
        /// Neighbors a row.
        neighbors_per_row: usize,
    },
    /// More vertices or neighbors than `u32` can count.
    #[error("{count} vertices or neighbors are more than fit in 32 bits")]
    TooLarge {
        /// Number of vertices or neighbors.
        count: usize,
    },
}
