//! Vertices at one place treated as one.
//!
//! Files often split a vertex along a seam into two at the same place. As two they would be
//! smoothed and pushed apart; as one the cloth stays closed.

use std::collections::HashMap;

use garnet_mesh::{Point3, TriMesh};

/// Bits of a coordinate in the number by which nodes are ordered.
const ORDER_BITS: u32 = 10;

/// Which vertices of a mesh lie at exactly the same place.
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

    /// The values at the nodes, of values `[vertex]` that are equal where vertices coincide.
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
}
