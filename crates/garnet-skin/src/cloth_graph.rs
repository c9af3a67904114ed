//! The cloth as a graph: which places pull at each other, and how strongly.

use garnet_mesh::{Point3, Topology};

/// An edge never counts less or more than this, so that slivers neither let go nor dominate.
const WEIGHT_RANGE: [f32; 2] = [0.05, 20.0];

/// Edge lengths below this have no direction worth keeping, in metres.
const MIN_LENGTH: f32 = 1e-6;

/// Edges of the cloth with a positive Laplacian on them.
///
/// The weight of an edge is two thirds of the area of its faces over its squared length: the
/// cotangent Laplacian on equilateral triangles, and positive on any.
#[derive(Debug, Clone)]
pub struct ClothGraph {
    edges: Vec<[u32; 2]>,
    weights: Vec<f32>,
    rest_lengths: Vec<f32>,
    node_areas: Vec<f32>,
    starts: Vec<u32>,
    half_edges: Vec<HalfEdge>,
    num_cloth_edges: usize,
}

/// One end of an edge as seen from the other.
#[derive(Debug, Clone, Copy)]
pub struct HalfEdge {
    /// The node at the far end.
    pub node: u32,
    /// The edge.
    pub edge: u32,
    /// The weight of the edge.
    pub weight: f32,
    /// The length of the edge at rest, in metres.
    pub rest_length: f32,
    /// 1 where the edge starts at the near end, -1 where it ends there.
    pub sign: f32,
}

impl ClothGraph {
    /// Builds the graph of `faces` between nodes at rest `positions`, with `stitches` as further
    /// edges of weight 1 that tie loose pieces to what they sit on.
    pub fn new(
        positions: &[Point3],
        faces: &[[u32; 3]],
        topology: &Topology,
        stitches: &[[u32; 2]],
    ) -> Self {
        let area = |face: u32| {
            let [a, b, c] = faces[face as usize].map(|node| positions[node as usize]);
            0.5 * (b - a).cross(&(c - a)).norm()
        };
        let areas: Vec<f32> = (0..faces.len() as u32).map(area).collect();
        let mut node_areas = vec![0.0_f32; positions.len()];
        for (corners, area) in faces.iter().zip(&areas) {
            for &node in corners {
                node_areas[node as usize] += area / 3.0;
            }
        }
        let mut edges = topology.edges().to_vec();
        let num_cloth_edges = edges.len();
        edges.extend_from_slice(stitches);
        let length = |&[a, b]: &[u32; 2]| (positions[b as usize] - positions[a as usize]).norm();
        let rest_lengths: Vec<f32> = edges.iter().map(length).collect();
        let weight = |edge: usize| {
            let [low, high] = WEIGHT_RANGE;
            let faces = topology.edge_faces(edge).iter();
            let area: f32 = faces.map(|&face| areas[face as usize]).sum();
            let squared = rest_lengths[edge].max(MIN_LENGTH).powi(2);
            (area / (1.5 * squared)).clamp(low, high)
        };
        let mut weights: Vec<f32> = (0..num_cloth_edges).map(weight).collect();
        weights.resize(edges.len(), 1.0);
        let (starts, half_edges) = half_edges(positions.len(), &edges, &weights, &rest_lengths);
        Self {
            edges,
            weights,
            rest_lengths,
            node_areas,
            starts,
            half_edges,
            num_cloth_edges,
        }
    }

    /// How many nodes there are.
    pub fn num_nodes(&self) -> usize {
        self.node_areas.len()
    }

    /// The edges, those of the cloth first, then the stitches.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// How many of the edges belong to the cloth itself.
    pub fn num_cloth_edges(&self) -> usize {
        self.num_cloth_edges
    }

    /// The weight of each edge.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// The length of each edge at rest, in metres.
    pub fn rest_lengths(&self) -> &[f32] {
        &self.rest_lengths
    }

    /// A third of the area of the faces at each node, in square metres.
    pub fn node_areas(&self) -> &[f32] {
        &self.node_areas
    }

    /// The edges at a node, sorted by the node at the far end.
    pub fn half_edges(&self, node: usize) -> &[HalfEdge] {
        &self.half_edges[self.starts[node] as usize..self.starts[node + 1] as usize]
    }

    /// The edges at all nodes, those of one node together.
    pub fn all_half_edges(&self) -> &[HalfEdge] {
        &self.half_edges
    }

    /// Where the half edges of each node start; the last entry is their number.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }
}

fn half_edges(
    num_nodes: usize,
    edges: &[[u32; 2]],
    weights: &[f32],
    rest_lengths: &[f32],
) -> (Vec<u32>, Vec<HalfEdge>) {
    let mut ends = Vec::with_capacity(2 * edges.len());
    for (edge, &[a, b]) in edges.iter().enumerate() {
        ends.push((a, b, edge as u32, true));
        ends.push((b, a, edge as u32, false));
    }
    ends.sort_unstable();
    let mut starts = vec![0_u32; num_nodes + 1];
    for &(from, ..) in &ends {
        starts[from as usize + 1] += 1;
    }
    for node in 0..num_nodes {
        starts[node + 1] += starts[node];
    }
    let half_edge = |&(_, node, edge, is_start): &(u32, u32, u32, bool)| HalfEdge {
        node,
        edge,
        weight: weights[edge as usize],
        rest_length: rest_lengths[edge as usize],
        sign: if is_start { 1.0 } else { -1.0 },
    };
    (starts, ends.iter().map(half_edge).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_of_equilateral_triangles_has_the_cotangent_weight() {
        let height = 0.75_f32.sqrt();
        let positions = [
            Point3::new(0.0, 0.0, 0.0),
            Point3::new(1.0, 0.0, 0.0),
            Point3::new(0.5, height, 0.0),
            Point3::new(0.5, -height, 0.0),
        ];
        let faces = [[0, 1, 2], [1, 0, 3]];
        let topology = Topology::new(4, &faces);
        let graph = ClothGraph::new(&positions, &faces, &topology, &[]);
        let shared = graph
            .edges()
            .iter()
            .position(|&edge| edge == [0, 1])
            .unwrap();
        let cotangent_60_degrees = 1.0 / 3.0_f32.sqrt();
        approx::assert_relative_eq!(
            graph.weights()[shared],
            cotangent_60_degrees,
            max_relative = 1e-5
        );
    }

    #[test]
    fn a_stitch_joins_what_faces_do_not() {
        let positions = [
            Point3::new(0.0, 0.0, 0.0),
            Point3::new(1.0, 0.0, 0.0),
            Point3::new(0.0, 1.0, 0.0),
            Point3::new(0.0, 0.0, 0.1),
        ];
        let faces = [[0, 1, 2]];
        let topology = Topology::new(4, &faces);
        let graph = ClothGraph::new(&positions, &faces, &topology, &[[0, 3]]);
        assert_eq!(graph.num_cloth_edges(), 3);
        let far_ends: Vec<u32> = graph.half_edges(0).iter().map(|half| half.node).collect();
        assert_eq!(far_ends, [1, 2, 3]);
    }
}
