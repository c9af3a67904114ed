//! Vertices at one place treated as one.
//!
//! Files often split a vertex along a seam into two at the same place. As two they would be
//! smoothed and pushed apart; as one the cloth stays closed. Where each copy was moved or rounded
//! by itself, they lie beside each other, on rims that are none.

use std::collections::HashMap;

use garnet_mesh::{Bounds, Point3, Topology, TriMesh, Vector3};

/// Bits of a coordinate in the number by which nodes are ordered.
const ORDER_BITS: u32 = 10;

/// Vertices on rims are one if they are no farther apart than this part of the largest extent of
/// the mesh: 0.1 mm of a shirt, the last digit of files in metres. Larger values close slits that
/// were cut, smaller ones leave coordinates open that were rounded.
const NEAR: f32 = 1.2e-4;

/// They are no farther apart, either, than this part of the shortest edge at them: faces keep their
/// corners apart.
const NEAR_IN_EDGES: f32 = 0.1;

/// Which vertices of a mesh lie at the same place.
///
/// Nodes are numbered along a Morton curve, so that near ones have near numbers: what is done to
/// all nodes in turn then stays in the cache.
#[derive(Debug, Clone)]
pub struct Weld {
    node_of_vertex: Vec<u32>,
    vertex_of_node: Vec<u32>,
}

impl Weld {
    /// Finds the vertices with equal coordinates; each such place becomes one node.
    pub fn new(positions: &[Point3]) -> Self {
        let mut nodes: HashMap<[u32; 3], u32> = HashMap::with_capacity(positions.len());
        let mut vertex_of_node = Vec::with_capacity(positions.len());
        let mut node_of_vertex = Vec::with_capacity(positions.len());
        for (vertex, position) in positions.iter().enumerate() {
            // Adding zero turns -0 into 0, so that both count as the same place.
            let place = [position.x, position.y, position.z].map(|value| (value + 0.0).to_bits());
            let node = *nodes.entry(place).or_insert_with(|| {
                vertex_of_node.push(vertex as u32);
                vertex_of_node.len() as u32 - 1
            });
            node_of_vertex.push(node);
        }
        Self {
            node_of_vertex,
            vertex_of_node,
        }
        .ordered(positions)
    }

    /// The same of a mesh that is cloth: vertices on its rims that lie as near to each other as
    /// rounding leaves them are one, at the place of the first.
    pub fn sewn(mesh: &TriMesh) -> Self {
        Self::sewn_within(mesh, NEAR)
    }

    /// The same of vertices as near as this share of the largest extent.
    pub(crate) fn sewn_within(mesh: &TriMesh, share: f32) -> Self {
        let positions = mesh.positions();
        let weld = Self::new(positions);
        let topology = Topology::new(weld.num_nodes(), &weld.faces(mesh));
        let place = |node: u32| positions[weld.vertex_of_node[node as usize] as usize];
        let bounds = Bounds::of_faces(positions, mesh.faces());
        let near = share * bounds.unwrap_or_default().extent().max();
        // The farthest from a node on a rim that another one may be.
        let mut reach: HashMap<u32, f32> = HashMap::new();
        for &edge in &topology.boundary_edges() {
            let nodes = topology.edges()[edge as usize];
            let length = NEAR_IN_EDGES * (place(nodes[0]) - place(nodes[1])).norm();
            for node in nodes {
                let reach = reach.entry(node).or_insert(near);
                *reach = reach.min(length);
            }
        }
        let mut on_rims: Vec<u32> = reach.keys().copied().collect();
        on_rims.sort_unstable_by_key(|&node| weld.vertex_of_node[node as usize]);
        let cell_of = |point: &Point3| point.coords.map(|value| (value / near).floor());
        let key = |cell: Vector3| [cell.x, cell.y, cell.z].map(|value| (value + 0.0).to_bits());
        let mut cells: HashMap<[u32; 3], Vec<u32>> = HashMap::new();
        let mut first: Vec<u32> = (0..weld.num_nodes() as u32).collect();
        for node in on_rims {
            let (point, own) = (place(node), reach[&node]);
            let cell = cell_of(&point);
            let around = (0..27_u8).map(|step| {
                let [x, y, z] =
                    [step % 3, step / 3 % 3, step / 9].map(|step| f32::from(step) - 1.0);
                cell + Vector3::new(x, y, z)
            });
            let others = around.filter_map(|cell| cells.get(&key(cell))).flatten();
            let distances = others.map(|&other| (other, (place(other) - point).norm()));
            let others = distances.filter(|(other, distance)| *distance <= own.min(reach[other]));
            let nearest = others.min_by(|a, b| a.1.total_cmp(&b.1));
            match nearest {
                Some((other, _)) => first[node as usize] = other,
                None => cells.entry(key(cell)).or_default().push(node),
            }
        }
        let is_first = |node: &u32| first[*node as usize] == *node;
        let kept: Vec<u32> = (0..weld.num_nodes() as u32).filter(is_first).collect();
        if kept.len() == weld.num_nodes() {
            return weld;
        }
        let mut rank = vec![0_u32; weld.num_nodes()];
        for (place, &node) in kept.iter().enumerate() {
            rank[node as usize] = place as u32;
        }
        let nodes = weld.node_of_vertex.iter();
        Self {
            node_of_vertex: nodes.map(|&n| rank[first[n as usize] as usize]).collect(),
            vertex_of_node: kept
                .iter()
                .map(|&n| weld.vertex_of_node[n as usize])
                .collect(),
        }
        .ordered(positions)
    }

    /// The same nodes, numbered along a Morton curve.
    fn ordered(self, positions: &[Point3]) -> Self {
        let Self {
            node_of_vertex,
            vertex_of_node,
        } = self;
        let mut order: Vec<u32> = (0..vertex_of_node.len() as u32).collect();
        let codes = morton_codes(positions);
        order.sort_by_key(|&node| (codes[vertex_of_node[node as usize] as usize], node));
        let mut rank = vec![0_u32; order.len()];
        for (place, &node) in order.iter().enumerate() {
            rank[node as usize] = place as u32;
        }
        Self {
            node_of_vertex: node_of_vertex.iter().map(|&n| rank[n as usize]).collect(),
            vertex_of_node: order.iter().map(|&n| vertex_of_node[n as usize]).collect(),
        }
    }

    /// How many different places there are.
    pub fn num_nodes(&self) -> usize {
        self.vertex_of_node.len()
    }

    /// The node of each vertex `[vertex]`.
    pub fn node_of_vertex(&self) -> &[u32] {
        &self.node_of_vertex
    }

    /// The faces of `mesh` between nodes; faces that become a line or a point are left out.
    pub fn faces(&self, mesh: &TriMesh) -> Vec<[u32; 3]> {
        let to_nodes = |face: &[u32; 3]| face.map(|vertex| self.node_of_vertex[vertex as usize]);
        mesh.faces()
            .iter()
            .map(to_nodes)
            .filter(|&[a, b, c]| a != b && b != c && c != a)
            .collect()
    }

    /// The values at the nodes, of values `[vertex]`: those of the first vertex at each.
    pub fn gather<T: Copy>(&self, values: &[T]) -> Vec<T> {
        let value_at = |&vertex: &u32| values[vertex as usize];
        self.vertex_of_node.iter().map(value_at).collect()
    }

    /// The values at the vertices, of values `[node]`.
    pub fn scatter<T: Copy>(&self, values: &[T]) -> Vec<T> {
        let value_at = |&node: &u32| values[node as usize];
        self.node_of_vertex.iter().map(value_at).collect()
    }
}

/// The place of each position along a Morton curve through the box of all.
fn morton_codes(positions: &[Point3]) -> Vec<u32> {
    let low = positions
        .iter()
        .fold(Point3::from([f32::MAX; 3]), |low, p| low.inf(p));
    let high = positions
        .iter()
        .fold(Point3::from([f32::MIN; 3]), |high, p| high.sup(p));
    let extent = (high - low).max().max(f32::MIN_POSITIVE);
    let scale = ((1 << ORDER_BITS) - 1) as f32 / extent;
    #[allow(
        clippy::cast_sign_loss,
        reason = "offsets from the low corner are not negative"
    )]
    let code = |position: &Point3| {
        // A cast from float saturates, so a coordinate that overflows stays in the last cell.
        let cell = ((position - low) * scale).map(|value| value as u32);
        (0..ORDER_BITS).fold(0, |code, bit| {
            let bit_of = |axis: usize| ((cell[axis] >> bit) & 1) << (3 * bit + axis as u32);
            code | bit_of(0) | bit_of(1) | bit_of(2)
        })
    };
    positions.iter().map(code).collect()
}

#[cfg(test)]
mod tests {
    use garnet_mesh::primitives::{grid, icosphere};

    use super::*;

    #[test]
    fn vertices_at_one_place_share_a_node() {
        let positions = [
            Point3::new(0.0, 0.0, 0.0),
            Point3::new(1.0, 0.0, 0.0),
            Point3::new(-0.0, 0.0, 0.0),
        ];
        let weld = Weld::new(&positions);
        assert_eq!(weld.node_of_vertex(), [0, 1, 0]);
        assert_eq!(weld.gather(&[5, 6, 5]), [5, 6]);
        assert_eq!(weld.scatter(&[5, 6]), [5, 6, 5]);
    }

    #[test]
    fn corners_that_were_rounded_apart_share_a_node() {
        let sheet = grid(4, 5, [0.4, 0.5]);
        for (noise, is_one) in [(0.0, true), (1e-7, true), (1e-5, true), (2e-3, false)] {
            let corners = sheet.faces().as_flattened().iter();
            let split: Vec<Point3> = corners
                .enumerate()
                .map(|(corner, &vertex)| {
                    let off = |axis: usize| ((corner * 7 + axis * 5) % 11) as f32 / 11.0 - 0.5;
                    let off = Vector3::new(off(0), off(1), off(2)) * noise;
                    sheet.positions()[vertex as usize] + off
                })
                .collect();
            let faces = (0..split.len() as u32 / 3).map(|face| [0, 1, 2].map(|k| 3 * face + k));
            let soup = TriMesh::new(split, faces.collect()).unwrap();
            let weld = Weld::sewn(&soup);
            let is_sheet = weld.num_nodes() == sheet.num_vertices();
            assert_eq!(is_sheet, is_one, "{noise}: {} nodes", weld.num_nodes());
            // Who was at a vertex of the sheet is at one node.
            let corners = sheet
                .faces()
                .as_flattened()
                .iter()
                .zip(weld.node_of_vertex());
            let mut node_of: HashMap<u32, u32> = HashMap::new();
            for (&vertex, &node) in corners {
                let first = *node_of.entry(vertex).or_insert(node);
                assert!(!is_one || first == node, "{noise}: vertex {vertex}");
            }
        }
    }

    #[test]
    fn what_is_not_on_rims_stays_apart() {
        let closed = icosphere(2, 1.0);
        let (mut positions, mut faces) = closed.clone().into_parts();
        let count = positions.len() as u32;
        positions.extend(closed.positions().iter().map(|point| point * 1.00001));
        faces.extend(
            closed
                .faces()
                .iter()
                .map(|face| face.map(|vertex| vertex + count)),
        );
        let double = TriMesh::new(positions, faces).unwrap();
        assert_eq!(Weld::sewn(&double).num_nodes(), 2 * count as usize);
    }
}
