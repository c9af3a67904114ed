//! How the triangles of a mesh hang together.

use std::ops::Range;

/// Edges, neighbours, boundary loops and components of a set of faces.
///
/// Computed once from the faces alone; every list is sorted, so that the same faces give the same
/// topology on every run.
#[derive(Debug, Clone)]
pub struct Topology {
    edges: Vec<[u32; 2]>,
    edge_faces: Lists,
    neighbors: Lists,
    vertex_faces: Lists,
    component: Vec<u32>,
    num_components: usize,
}

/// Lists of different lengths, stored one after the other.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Lists {
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    /// Sorts pairs `(list, item)` into `num_lists` lists.
    fn from_pairs(num_lists: usize, mut pairs: Vec<(u32, u32)>) -> Self {
        pairs.sort_unstable();
        pairs.dedup();
        let mut starts = vec![0_u32; num_lists + 1];
        for &(list, _) in &pairs {
            starts[list as usize + 1] += 1;
        }
        for list in 0..num_lists {
            starts[list + 1] += starts[list];
        }
        let items = pairs.into_iter().map(|(_, item)| item).collect();
        Self { starts, items }
    }

    fn range(&self, list: usize) -> Range<usize> {
        self.starts[list] as usize..self.starts[list + 1] as usize
    }

    fn list(&self, list: usize) -> &[u32] {
        &self.items[self.range(list)]
    }
}

impl Topology {
    /// Reads the topology off `faces`, whose indices are below `num_vertices`.
    ///
    /// # Panics
    ///
    /// If a face names a vertex that is not below `num_vertices`.
    pub fn new(num_vertices: usize, faces: &[[u32; 3]]) -> Self {
        let mut sides = Vec::with_capacity(3 * faces.len());
        let mut corners = Vec::with_capacity(3 * faces.len());
        for (face, &[a, b, c]) in faces.iter().enumerate() {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                if from != to {
                    sides.push(([from.min(to), from.max(to)], face as u32));
                }
                corners.push((from, face as u32));
            }
        }
        sides.sort_unstable();
        let mut edges: Vec<[u32; 2]> = sides.iter().map(|&(edge, _)| edge).collect();
        edges.dedup();
        let mut edge_index = 0;
        let mut edge_face_pairs = Vec::with_capacity(sides.len());
        for (edge, face) in sides {
            while edges[edge_index] != edge {
                edge_index += 1;
            }
            edge_face_pairs.push((edge_index as u32, face));
        }
        let neighbor_pairs = edges.iter().flat_map(|&[a, b]| [(a, b), (b, a)]).collect();
        let (component, num_components) = components(num_vertices, &edges);
        Self {
            edge_faces: Lists::from_pairs(edges.len(), edge_face_pairs),
            neighbors: Lists::from_pairs(num_vertices, neighbor_pairs),
            vertex_faces: Lists::from_pairs(num_vertices, corners),
            edges,
            component,
            num_components,
        }
    }

    /// Edges `[edge]`, each with the smaller vertex first, sorted.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The faces at an edge: one at a boundary, two inside a manifold, more elsewhere.
    pub fn edge_faces(&self, edge: usize) -> &[u32] {
        self.edge_faces.list(edge)
    }

    /// The vertices that share an edge with `vertex` (its one-ring), sorted.
    pub fn neighbors(&self, vertex: usize) -> &[u32] {
        self.neighbors.list(vertex)
    }

    /// The faces at a vertex, sorted.
    pub fn vertex_faces(&self, vertex: usize) -> &[u32] {
        self.vertex_faces.list(vertex)
    }

    /// The component of each vertex; an unused vertex is a component of its own.
    pub fn components(&self) -> &[u32] {
        &self.component
    }

    /// How many components there are.
    pub fn num_components(&self) -> usize {
        self.num_components
    }
}

/// Numbers connected components in the order of their first vertex.
fn components(num_vertices: usize, edges: &[[u32; 2]]) -> (Vec<u32>, usize) {
    let mut parent: Vec<u32> = (0..num_vertices as u32).collect();
    for &[a, b] in edges {
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        parent[a.max(b) as usize] = a.min(b);
    }
    let mut number = vec![u32::MAX; num_vertices];
    let mut count = 0;
    for vertex in 0..num_vertices as u32 {
        let root = root(&mut parent, vertex) as usize;
        if number[root] == u32::MAX {
            number[root] = count;
            count += 1;
        }
        number[vertex as usize] = number[root];
    }
    (number, count as usize)
}

fn root(parent: &mut [u32], mut vertex: u32) -> u32 {
    while parent[vertex as usize] != vertex {
        parent[vertex as usize] = parent[parent[vertex as usize] as usize];
        vertex = parent[vertex as usize];
    }
    vertex
}
