//! Which faces meet at a vertex and at an edge, and whether the faces close up.

/// Faces at vertices and edges, in linear time from the faces alone.
#[derive(Debug)]
pub(crate) struct Adjacency {
    corner_starts: Vec<usize>,
    corner_faces: Vec<u32>,
    side_starts: Vec<usize>,
    sides: Vec<Side>,
    is_closed: bool,
}

/// One side of one face, listed under the smaller of its two vertices.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    larger_vertex: u32,
    face: u32,
    runs_upward: bool,
}

impl Adjacency {
    /// Reads the adjacency off `faces`, whose indices are below `num_vertices`.
    pub(crate) fn new(num_vertices: usize, faces: &[[u32; 3]]) -> Self {
        let mut corners = Vec::with_capacity(3 * faces.len());
        let mut sides = Vec::with_capacity(3 * faces.len());
        for (face, &[a, b, c]) in faces.iter().enumerate() {
            let face = face as u32;
            corners.push((a, face));
            if b != a {
                corners.push((b, face));
            }
            if c != a && c != b {
                corners.push((c, face));
            }
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let side = Side {
                    larger_vertex: from.max(to),
                    face,
                    runs_upward: from < to,
                };
                if from != to {
                    sides.push((from.min(to), side));
                }
            }
        }
        let (corner_starts, corner_faces) = grouped(num_vertices, &corners);
        let (side_starts, mut sides) = grouped(num_vertices, &sides);
        let mut is_closed = true;
        for range in side_starts.windows(2) {
            let group = &mut sides[range[0]..range[1]];
            group.sort_unstable();
            is_closed &= group
                .chunk_by(|a, b| a.larger_vertex == b.larger_vertex)
                .all(is_balanced);
        }
        Self {
            corner_starts,
            corner_faces,
            side_starts,
            sides,
            is_closed,
        }
    }

    /// Whether every edge is run through as often one way as the other, which makes winding
    /// numbers whole.
    pub(crate) fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// The faces at a vertex, each once.
    pub(crate) fn vertex_faces(&self, vertex: u32) -> &[u32] {
        let vertex = vertex as usize;
        &self.corner_faces[self.corner_starts[vertex]..self.corner_starts[vertex + 1]]
    }

    /// The faces at the edge between two vertices.
    pub(crate) fn edge_faces(&self, a: u32, b: u32) -> impl Iterator<Item = u32> {
        let (smaller, larger) = (a.min(b) as usize, a.max(b));
        let group = &self.sides[self.side_starts[smaller]..self.side_starts[smaller + 1]];
        let start = group.partition_point(|side| side.larger_vertex < larger);
        let at_edge = group[start..]
            .iter()
            .take_while(move |side| side.larger_vertex == larger);
        at_edge.map(|side| side.face)
    }
}

fn is_balanced(sides: &[Side]) -> bool {
    2 * sides.iter().filter(|side| side.runs_upward).count() == sides.len()
}

/// Sorts items by their group, keeping their order within it; returns where each group starts.
fn grouped<T: Copy + Default>(num_groups: usize, items: &[(u32, T)]) -> (Vec<usize>, Vec<T>) {
    let mut starts = vec![0; num_groups + 1];
    for &(group, _) in items {
        starts[group as usize + 1] += 1;
    }
    for group in 0..num_groups {
        starts[group + 1] += starts[group];
    }
    let mut next = starts.clone();
    let mut sorted = vec![T::default(); items.len()];
    for &(group, item) in items {
        let slot = &mut next[group as usize];
        sorted[*slot] = item;
        *slot += 1;
    }
    (starts, sorted)
}
