//! Which vertices a vertex sees in a mesh convolution.

use crate::KernelError;
use crate::adjacency_tiles::{SlotsOfVertices, Tiles};

/// Neighbor lists of all vertices, each with the vertex itself first.
///
/// Made once for a mesh. Beside the lists it keeps how the gradients of a backward pass are
/// gathered: each tile of vertices adds up what it sends to the vertices it sees, and each vertex
/// collects its sums tile by tile. No two threads write to one place, and the order of every sum is
/// fixed.
///
/// ```
/// use garnet_kernel::Adjacency;
///
/// let square = Adjacency::from_faces(5, &[[0, 1, 2], [0, 2, 3]])?;
/// assert_eq!(square.neighbors(1), [1, 0, 2]);
/// assert_eq!(square.neighbors(4), [4]); // No face names it: it sees itself alone.
/// # Ok::<(), garnet_kernel::KernelError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Adjacency {
    offsets: Vec<u32>,
    neighbors: Vec<u32>,
    tiles: Tiles,
    slots: SlotsOfVertices,
}

impl Adjacency {
    /// The one-ring of each vertex of a triangle mesh, in ascending order after the vertex itself.
    ///
    /// # Errors
    ///
    /// [`KernelError::FaceIndexOutOfRange`] and [`KernelError::TooLarge`].
    pub fn from_faces(num_vertices: usize, faces: &[[u32; 3]]) -> Result<Self, KernelError> {
        let mut lists = vec![Vec::new(); num_vertices];
        for (face, corners) in faces.iter().enumerate() {
            if let Some(&vertex) = corners
                .iter()
                .find(|&&corner| corner as usize >= num_vertices)
            {
                return Err(KernelError::FaceIndexOutOfRange {
                    face,
                    vertex,
                    num_vertices,
                });
            }
            for corner in 0..3 {
                let vertex = corners[corner] as usize;
                lists[vertex].extend([corners[(corner + 1) % 3], corners[(corner + 2) % 3]]);
            }
        }
        lists.iter_mut().for_each(|list| list.sort_unstable());
        Self::from_lists(&lists)
    }

    /// Lists of any directed graph: the list of a vertex names those that it takes features from.
    ///
    /// The vertex itself is put first whether it is named or not; what is named twice counts once.
    /// The order is kept otherwise, and sums follow it.
    ///
    /// # Errors
    ///
    /// [`KernelError::NeighborOutOfRange`] and [`KernelError::TooLarge`].
    pub fn from_lists(lists: &[impl AsRef<[u32]>]) -> Result<Self, KernelError> {
        let num_vertices = lists.len();
        let num_named: usize = lists.iter().map(|list| list.as_ref().len()).sum();
        let count = num_named + num_vertices;
        if u32::try_from(count).is_err() {
            return Err(KernelError::TooLarge { count });
        }

        let mut offsets = vec![0];
        let mut neighbors: Vec<u32> = Vec::with_capacity(count);
        let mut last_row_that_named = vec![u32::MAX; num_vertices];
        for (row, list) in lists.iter().enumerate() {
            for &neighbor in [row as u32].iter().chain(list.as_ref()) {
                match last_row_that_named.get_mut(neighbor as usize) {
                    None => {
                        return Err(KernelError::NeighborOutOfRange {
                            row,
                            neighbor,
                            num_sources: num_vertices,
                        });
                    }
                    Some(last) if *last == row as u32 => {}
                    Some(last) => {
                        *last = row as u32;
                        neighbors.push(neighbor);
                    }
                }
            }
            offsets.push(neighbors.len() as u32);
        }

        let tiles = Tiles::new(&offsets, &neighbors);
        let slots = SlotsOfVertices::new(num_vertices, &tiles);
        Ok(Self {
            offsets,
            neighbors,
            tiles,
            slots,
        })
    }

    /// Number of vertices.
    pub fn num_vertices(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Number of directed edges, those from a vertex to itself included.
    pub fn num_edges(&self) -> usize {
        self.neighbors.len()
    }

    /// The vertices that `vertex` takes features from, itself first.
    ///
    /// # Panics
    ///
    /// Panics if there is no such vertex.
    pub fn neighbors(&self, vertex: usize) -> &[u32] {
        &self.neighbors[self.edges(vertex)]
    }

    /// The numbers of the edges of a vertex.
    #[inline(always)]
    pub(crate) fn edges(&self, vertex: usize) -> std::ops::Range<usize> {
        self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize
    }

    /// The tiles of vertices.
    pub(crate) fn tiles(&self) -> &Tiles {
        &self.tiles
    }

    /// The slots that each vertex collects.
    pub(crate) fn slots(&self) -> &SlotsOfVertices {
        &self.slots
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vertex_is_its_own_first_neighbor_and_none_comes_twice() {
        let adjacency = Adjacency::from_lists(&[vec![2, 0, 2, 1], vec![], vec![1]]).expect("valid");
        assert_eq!(adjacency.neighbors(0), [0, 2, 1]);
        assert_eq!(adjacency.neighbors(1), [1]);
        assert_eq!(adjacency.neighbors(2), [2, 1]);
        assert_eq!(adjacency.num_edges(), 6);
    }

    #[test]
    fn a_degenerate_face_gives_no_double_neighbor() {
        let adjacency = Adjacency::from_faces(3, &[[0, 0, 1], [0, 1, 2]]).expect("valid");
        assert_eq!(adjacency.neighbors(0), [0, 1, 2]);
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        assert_eq!(
            Adjacency::from_faces(3, &[[0, 1, 2], [0, 1, 7]]).map(|_| ()),
            Err(KernelError::FaceIndexOutOfRange {
                face: 1,
                vertex: 7,
                num_vertices: 3
            })
        );
        assert_eq!(
            Adjacency::from_lists(&[vec![0], vec![2]]).map(|_| ()),
            Err(KernelError::NeighborOutOfRange {
                row: 1,
                neighbor: 2,
                num_sources: 2
            })
        );
    }

    #[test]
    fn no_vertices_are_a_graph_too() {
        let adjacency = Adjacency::from_faces(0, &[]).expect("valid");
        assert_eq!((adjacency.num_vertices(), adjacency.num_edges()), (0, 0));
    }
}
