//! How the triangles of a mesh hang together.

use crate::edges::{components, edges_of, sides};
use crate::lists::Lists;

/// Edges, neighbors, hinges, boundary loops and components of a set of faces.
///
/// Computed once from the faces alone; every list is sorted, so that the same faces give the same
/// topology on every run.
#[derive(Debug, Clone)]
pub struct Topology {
    faces: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    edge_faces: Lists,
    neighbors: Lists,
    vertex_faces: Lists,
    is_boundary: Vec<bool>,
    component: Vec<u32>,
    num_components: usize,
}

/// Two faces at an edge, as bending sees them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Hinge {
    /// Vertices of the edge, the smaller first.
    pub edge: [u32; 2],
    /// The third vertex of each face.
    ///
    /// First that of the face on the left of the edge from `edge[0]` to `edge[1]`, seen from
    /// outside; where both faces lie on the same side (they are badly oriented), that of the face
    /// with the smaller number.
    pub opposite: [u32; 2],
}

impl Topology {
    /// Reads the topology off `faces`, whose indices are below `num_vertices`.
    ///
    /// # Panics
    ///
    /// If a face names a vertex that is not below `num_vertices`.
    pub fn new(num_vertices: usize, faces: &[[u32; 3]]) -> Self {
        let (edges, edge_faces) = edges_of(num_vertices, faces);
        // A vertex meets its smaller neighbors as the second of an edge before it meets its
        // larger ones as the first, so its list is sorted.
        let ends = edges.iter().flat_map(|&[a, b]| [(a, b), (b, a)]);
        let mut is_boundary = vec![false; num_vertices];
        for (edge, vertices) in edges.iter().enumerate() {
            if edge_faces.list(edge).len() == 1 {
                for &vertex in vertices {
                    is_boundary[vertex as usize] = true;
                }
            }
        }
        let corners = faces.iter().enumerate().flat_map(|(face, corners)| {
            unique_corners(corners).map(move |vertex| (vertex, face as u32))
        });
        let (component, num_components) = components(num_vertices, &edges);
        Self {
            neighbors: Lists::from_pairs(num_vertices, ends),
            vertex_faces: Lists::from_pairs(num_vertices, corners),
            faces: faces.to_vec(),
            edges,
            edge_faces,
            is_boundary,
            component,
            num_components,
        }
    }

    /// The faces that were given.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// How many vertices there are, unused ones included.
    pub fn num_vertices(&self) -> usize {
        self.component.len()
    }

    /// Edges `[edge]`, each with the smaller vertex first, sorted.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The faces at an edge: one at a boundary, two inside a manifold, more elsewhere.
    ///
    /// # Panics
    ///
    /// If there is no such edge.
    pub fn edge_faces(&self, edge: usize) -> &[u32] {
        self.edge_faces.list(edge)
    }

    /// The vertices that share an edge with `vertex` (its one-ring), sorted.
    ///
    /// # Panics
    ///
    /// If there is no such vertex.
    pub fn neighbors(&self, vertex: usize) -> &[u32] {
        self.neighbors.list(vertex)
    }

    /// The faces at a vertex, sorted.
    ///
    /// # Panics
    ///
    /// If there is no such vertex.
    pub fn vertex_faces(&self, vertex: usize) -> &[u32] {
        self.vertex_faces.list(vertex)
    }

    /// Whether a vertex lies on an edge with a single face.
    ///
    /// # Panics
    ///
    /// If there is no such vertex.
    pub fn is_boundary(&self, vertex: usize) -> bool {
        self.is_boundary[vertex]
    }

    /// The component of each vertex; an unused vertex is a component of its own.
    pub fn components(&self) -> &[u32] {
        &self.component
    }

    /// How many components there are.
    pub fn num_components(&self) -> usize {
        self.num_components
    }

    /// The component of each face, and how many have a face: numbered by their first face.
    pub fn face_components(&self) -> (Vec<u32>, usize) {
        let mut number = vec![u32::MAX; self.num_components];
        let mut count = 0;
        let mut numbered = Vec::with_capacity(self.faces.len());
        for face in &self.faces {
            let slot = &mut number[self.component[face[0] as usize] as usize];
            if *slot == u32::MAX {
                *slot = count;
                count += 1;
            }
            numbered.push(*slot);
        }
        (numbered, count as usize)
    }

    /// Pairs of vertices two edges apart and not one, each with the smaller first, sorted.
    pub fn two_ring_pairs(&self) -> Vec<[u32; 2]> {
        let num_vertices = self.num_vertices();
        let mut pairs = Vec::with_capacity(3 * self.edges.len());
        let mut last_seen = vec![u32::MAX; num_vertices];
        for vertex in 0..num_vertices as u32 {
            let ring = self.neighbors(vertex as usize);
            for &neighbor in ring {
                last_seen[neighbor as usize] = vertex;
            }
            let first = pairs.len();
            for &neighbor in ring {
                for &other in self.neighbors(neighbor as usize) {
                    if other > vertex && last_seen[other as usize] != vertex {
                        last_seen[other as usize] = vertex;
                        pairs.push([vertex, other]);
                    }
                }
            }
            pairs[first..].sort_unstable();
        }
        pairs
    }

    /// The edges with two faces and the vertices that face each other across them, sorted.
    pub fn hinges(&self) -> Vec<Hinge> {
        let mut hinges = Vec::with_capacity(self.edges.len());
        for (edge, &vertices) in self.edges.iter().enumerate() {
            let &[first, second] = self.edge_faces(edge) else {
                continue;
            };
            let third = |face: u32| third_vertex(self.faces[face as usize], vertices);
            let (Some(a), Some(b)) = (third(first), third(second)) else {
                continue;
            };
            let is_left = |face: u32| runs_along(self.faces[face as usize], vertices);
            let opposite = match (is_left(first), is_left(second)) {
                (false, true) => [b, a],
                _ => [a, b],
            };
            hinges.push(Hinge {
                edge: vertices,
                opposite,
            });
        }
        hinges
    }

    /// The numbers of edges with more than two faces.
    pub fn non_manifold_edges(&self) -> Vec<u32> {
        self.edges_where(|edge| self.edge_faces(edge).len() > 2)
    }

    /// The numbers of edges whose two faces look to different sides.
    pub fn inconsistent_edges(&self) -> Vec<u32> {
        self.edges_where(|edge| match *self.edge_faces(edge) {
            [first, second] => {
                let direction = |face: u32| runs_along(self.faces[face as usize], self.edges[edge]);
                direction(first) == direction(second)
            }
            _ => false,
        })
    }

    /// The numbers of edges with a single face.
    pub fn boundary_edges(&self) -> Vec<u32> {
        self.edges_where(|edge| self.edge_faces(edge).len() == 1)
    }

    /// The rims of the surface, each once around, in the direction of the sides of the faces.
    ///
    /// The surface lies on the left, seen from outside. A rim that touches itself is split into
    /// loops that do not. Where a rim runs into an edge of three faces, or faces are badly
    /// oriented, a loop may be left open: it is given from one end to the other.
    pub fn boundary_loops(&self) -> Vec<Vec<u32>> {
        crate::boundary::boundary_loops(&self.directed_boundary())
    }

    /// The boundary edges in the direction of their faces' sides, sorted.
    fn directed_boundary(&self) -> Vec<[u32; 2]> {
        let mut sides: Vec<[u32; 2]> = Vec::new();
        for (edge, &[a, b]) in self.edges.iter().enumerate() {
            if let &[face] = self.edge_faces(edge) {
                let is_along = runs_along(self.faces[face as usize], [a, b]);
                sides.push(if is_along { [a, b] } else { [b, a] });
            }
        }
        sides.sort_unstable();
        sides
    }

    fn edges_where(&self, is_wanted: impl Fn(usize) -> bool) -> Vec<u32> {
        (0..self.edges.len())
            .filter(|&edge| is_wanted(edge))
            .map(|edge| edge as u32)
            .collect()
    }
}

/// The vertices of a face, without repetition.
fn unique_corners(&[a, b, c]: &[u32; 3]) -> impl Iterator<Item = u32> + Clone {
    let second = (b != a).then_some(b);
    let third = (c != a && c != b).then_some(c);
    std::iter::once(a).chain(second).chain(third)
}

/// Whether a side of the face runs from the first vertex of the edge to the second.
fn runs_along(face: [u32; 3], edge: [u32; 2]) -> bool {
    sides(&face).contains(&edge)
}

fn third_vertex(face: [u32; 3], edge: [u32; 2]) -> Option<u32> {
    face.into_iter().find(|vertex| !edge.contains(vertex))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::primitives::{grid, icosphere, tube};

    fn topology_of(mesh: &crate::TriMesh) -> Topology {
        Topology::new(mesh.num_vertices(), mesh.faces())
    }

    #[test]
    fn a_grid_has_one_loop_around_with_the_surface_on_the_left() {
        let topology = topology_of(&grid(2, 2, [1.0, 1.0]));
        assert_eq!(topology.boundary_loops(), [[0, 1, 2, 5, 8, 7, 6, 3]]);
        assert!(!topology.is_boundary(4));
        assert_eq!(topology.boundary_edges().len(), 8);
    }

    #[test]
    fn a_hinge_has_the_left_face_first() {
        let topology = Topology::new(4, &[[1, 0, 3], [0, 1, 2]]);
        let hinge = Hinge {
            edge: [0, 1],
            opposite: [2, 3],
        };
        assert_eq!(topology.hinges(), [hinge]);
        assert!(topology.inconsistent_edges().is_empty());
    }

    #[test]
    fn a_turned_face_makes_its_edges_inconsistent() {
        let topology = Topology::new(4, &[[0, 1, 2], [0, 1, 3]]);
        assert_eq!(topology.inconsistent_edges(), [0]);
        assert_eq!(topology.hinges()[0].opposite, [2, 3]);
    }

    #[test]
    fn an_edge_of_three_faces_is_not_manifold() {
        let topology = Topology::new(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
        assert_eq!(topology.non_manifold_edges(), [0]);
        assert!(topology.hinges().is_empty());
        assert_eq!(topology.edge_faces(0), [0, 1, 2]);
    }

    #[test]
    fn two_triangles_at_a_vertex_have_two_loops() {
        let topology = Topology::new(5, &[[0, 1, 2], [0, 3, 4]]);
        assert_eq!(topology.boundary_loops(), [[0, 1, 2], [0, 3, 4]]);
        assert_eq!(topology.num_components(), 1);
    }

    #[test]
    fn a_collapsed_face_has_one_edge() {
        let topology = Topology::new(3, &[[0, 1, 1], [2, 2, 2]]);
        assert_eq!(topology.edges(), [[0, 1]]);
        assert_eq!(topology.edge_faces(0), [0]);
        assert_eq!(topology.vertex_faces(1), [0]);
        assert_eq!(topology.face_components(), (vec![0, 1], 2));
    }

    #[test]
    fn an_unused_vertex_is_no_component_of_faces() {
        let topology = Topology::new(7, &[[1, 2, 3], [4, 5, 6]]);
        assert_eq!(topology.num_components(), 3);
        assert_eq!(topology.face_components(), (vec![0, 1], 2));
    }

    #[test]
    fn inside_a_closed_mesh_each_hinge_is_an_edge() {
        let topology = topology_of(&icosphere(2, 1.0));
        assert_eq!(topology.hinges().len(), topology.edges().len());
        assert_eq!(topology.edges().len(), 480);
    }

    #[test]
    fn a_tube_has_two_loops_of_its_segments() {
        let loops = topology_of(&tube(1.0, 1.0, 7, 3)).boundary_loops();
        assert_eq!(loops.iter().map(Vec::len).collect::<Vec<_>>(), [7, 7]);
    }

    fn any_faces() -> impl Strategy<Value = Vec<[u32; 3]>> {
        proptest::collection::vec(prop::array::uniform3(0_u32..12), 1..40)
    }

    proptest! {
        #[test]
        fn any_faces_have_a_topology_that_fits(faces in any_faces()) {
            let topology = Topology::new(12, &faces);
            prop_assert!(topology.edges().is_sorted());
            for (edge, &[a, b]) in topology.edges().iter().enumerate() {
                prop_assert!(a < b);
                prop_assert!(topology.neighbors(a as usize).contains(&b));
                prop_assert!(!topology.edge_faces(edge).is_empty());
                for &face in topology.edge_faces(edge) {
                    let corners = faces[face as usize];
                    prop_assert!(corners.contains(&a) && corners.contains(&b));
                }
            }
            for vertex in 0..12 {
                prop_assert!(topology.neighbors(vertex).is_sorted());
                prop_assert!(topology.vertex_faces(vertex).is_sorted());
            }
            let loops = topology.boundary_loops();
            let num_sides: usize = loops.iter().map(Vec::len).sum();
            prop_assert!(num_sides >= topology.boundary_edges().len());
        }

        #[test]
        fn two_ring_pairs_are_those_two_edges_apart(faces in any_faces()) {
            let topology = Topology::new(12, &faces);
            let is_near = |a: u32, b: u32| topology.neighbors(a as usize).contains(&b);
            let mut expected = Vec::new();
            for a in 0..12 {
                for b in a + 1..12 {
                    if !is_near(a, b) && (0..12).any(|c| is_near(a, c) && is_near(c, b)) {
                        expected.push([a, b]);
                    }
                }
            }
            prop_assert_eq!(topology.two_ring_pairs(), expected);
        }
    }
}
