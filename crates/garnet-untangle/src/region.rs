//! The part of the cloth that is being moved.

use garnet_skin::ClothGraph;

/// A set of nodes, as a list in order and as a mask.
#[derive(Debug, Clone, Default)]
pub(crate) struct Region {
    nodes: Vec<u32>,
    mask: Vec<bool>,
}

impl Region {
    /// All nodes.
    pub(crate) fn all(num_nodes: usize) -> Self {
        Self {
            nodes: (0..num_nodes as u32).collect(),
            mask: vec![true; num_nodes],
        }
    }

    /// The nodes no more than `rings` edges away from `seeds`.
    pub(crate) fn around(
        graph: &ClothGraph,
        seeds: impl IntoIterator<Item = u32>,
        rings: usize,
    ) -> Self {
        let mut mask = vec![false; graph.num_nodes()];
        let mut nodes = Vec::new();
        for seed in seeds {
            if !mask[seed as usize] {
                mask[seed as usize] = true;
                nodes.push(seed);
            }
        }
        let mut first = 0;
        for _ in 0..rings {
            let end = nodes.len();
            if first == end {
                break;
            }
            for index in first..end {
                for half in graph.half_edges(nodes[index] as usize) {
                    if !mask[half.node as usize] {
                        mask[half.node as usize] = true;
                        nodes.push(half.node);
                    }
                }
            }
            first = end;
        }
        nodes.sort_unstable();
        Self { nodes, mask }
    }

    /// The nodes, in order.
    pub(crate) fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// The place of a node in the list; where it would be if it does not belong to the region.
    pub(crate) fn index_of(&self, node: u32) -> usize {
        self.nodes.partition_point(|&other| other < node)
    }

    /// Whether each node belongs to the region.
    pub(crate) fn mask(&self) -> &[bool] {
        &self.mask
    }
}

/// How many edges make up a `length`, in metres, on the average.
pub(crate) fn rings_of(graph: &ClothGraph, length: f32) -> usize {
    let lengths = &graph.rest_lengths()[..graph.num_cloth_edges()];
    let sum: f64 = lengths.iter().map(|&length| f64::from(length)).sum();
    let mean = sum / lengths.len().max(1) as f64;
    if mean > 0.0 {
        (f64::from(length) / mean).ceil() as usize
    } else {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use garnet_mesh::{Topology, primitives};

    #[test]
    fn a_region_grows_by_one_ring_a_step() {
        let grid = primitives::grid(10, 10, [1.0, 1.0]);
        let topology = Topology::new(grid.num_vertices(), grid.faces());
        let graph = ClothGraph::new(grid.positions(), grid.faces(), &topology, &[]);
        let mut expected: Vec<u32> = topology.neighbors(60).to_vec();
        expected.push(60);
        expected.sort_unstable();
        assert_eq!(Region::around(&graph, [60], 1).nodes(), expected);
        let all = Region::around(&graph, [60], 20);
        assert_eq!(all.nodes(), Region::all(grid.num_vertices()).nodes());
    }
}
