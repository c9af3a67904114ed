//! The one-rings of a garment.

use std::collections::HashMap;

use garnet_kernel::{Adjacency, KernelError};
use garnet_mesh::{Point3, Topology};

/// One-rings across seams: each vertex itself, then the first vertices at its neighbors' places.
pub(super) fn rings(positions: &[Point3], topology: &Topology) -> Result<Adjacency, KernelError> {
    let representatives = representatives(positions);
    let mut joined: Vec<Vec<u32>> = vec![Vec::new(); positions.len()];
    for (vertex, &own) in representatives.iter().enumerate() {
        let others = topology.neighbors(vertex).iter();
        let others = others.map(|&other| representatives[other as usize]);
        joined[own as usize].extend(others.filter(|&other| other != own));
    }
    for ring in &mut joined {
        ring.sort_unstable();
        ring.dedup();
    }
    let lists = representatives.iter().map(|&own| &joined[own as usize]);
    Adjacency::from_lists(&lists.collect::<Vec<_>>())
}

/// For each vertex the first one at its place.
fn representatives(positions: &[Point3]) -> Vec<u32> {
    let mut first: HashMap<[u32; 3], u32> = HashMap::with_capacity(positions.len());
    let place = |point: &Point3| [point.x, point.y, point.z].map(|value| (value + 0.0).to_bits());
    let own = |(vertex, point)| *first.entry(place(point)).or_insert(vertex);
    (0..).zip(positions).map(own).collect()
}

#[cfg(test)]
mod tests {
    use garnet_mesh::TriMesh;
    use garnet_mesh::primitives::grid;

    use super::*;
    use crate::GarmentGraph;

    #[test]
    fn rings_begin_with_the_vertex_itself() {
        let graph = GarmentGraph::new(&grid(2, 2, [0.2, 0.2]), &[]).unwrap();
        assert_eq!(graph.rings().neighbors(0)[0], 0);
        assert_eq!(graph.rings().neighbors(4).len(), 7);
        assert!(graph.mean_edge_length() > 0.1 && graph.mean_edge_length() < 0.15);
    }

    #[test]
    fn a_vertex_without_faces_is_a_ring_of_its_own() {
        let mut positions = grid(1, 1, [1.0, 1.0]).positions().to_vec();
        positions.push(Point3::new(5.0, 5.0, 5.0));
        let mesh = TriMesh::new(positions, vec![[0, 1, 2], [1, 3, 2]]).unwrap();
        let graph = GarmentGraph::new(&mesh, &[]).unwrap();
        assert_eq!(graph.rings().neighbors(4), [4]);
    }

    #[test]
    fn rings_reach_across_seams() {
        let [a, b, c, d] =
            [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|[x, y]| Point3::new(x, y, 0.0));
        let mesh = TriMesh::new(vec![a, b, c, b, d, c], vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let graph = GarmentGraph::new(&mesh, &[]).unwrap();
        assert_eq!(graph.rings().neighbors(1), [1, 0, 2, 4]);
        assert_eq!(graph.rings().neighbors(3), [3, 0, 2, 4]);
    }
}
