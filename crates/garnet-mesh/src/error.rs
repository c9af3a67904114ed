//! What can be wrong with a mesh.

use crate::MAX_COORDINATE;

/// What can be wrong with a mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {index}, but there are {num_vertices} vertices")]
    FaceIndexOutOfRange {
        /// Number of the face, from 0.
        face: usize,
        /// The vertex that it names, from 0.
        index: u32,
        /// How many vertices there are.
        num_vertices: usize,
    },
    /// A coordinate is NaN, or beyond [`MAX_COORDINATE`].
    #[error(
        "vertex {vertex} has the coordinate `{value}`, which is not finite or beyond {MAX_COORDINATE}"
    )]
    CoordinateOutOfRange {
        /// Number of the vertex, from 0.
        vertex: usize,
        /// The coordinate as found.
        value: f32,
    },
    /// The mesh has no face.
    #[error("there are no faces")]
    NoFaces,
    /// More vertices or faces than a `u32` can number.
    #[error("{count} vertices or faces are more than the 4294967295 that can be numbered")]
    TooLarge {
        /// How many there are.
        count: usize,
    },
    /// New positions do not fit the mesh.
    #[error("there are {found} positions for {expected} vertices")]
    PositionCount {
        /// How many positions were given.
        found: usize,
        /// How many vertices there are.
        expected: usize,
    },
}
