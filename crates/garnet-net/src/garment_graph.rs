//! What the network knows of a garment before any scene.

use std::collections::HashMap;
use std::sync::Arc;

use garnet_kernel::{Adjacency, KernelError};
use garnet_mesh::{Fingerprint, Point3, Topology, TriMesh};

use crate::{GarNetConfig, NetError, UNIT};

/// A garment at bind time: its one-rings, its template, its sewing parameters.
///
/// Files split vertices along seams. Vertices at one place of the template share one ring, so
/// mesh convolutions see across seams, and the two sides of a seam that starts closed stay
/// together.
#[derive(Debug, Clone)]
pub struct GarmentGraph {
    fingerprint: Fingerprint,
    rings: Arc<Adjacency>,
    template: Arc<[f32]>,
    sewing_parameters: Vec<f32>,
    mean_edge_length: f32,
}

impl GarmentGraph {
    /// Reads a template, and the sewing parameters that were fed in training (or none).
    ///
    /// # Errors
    ///
    /// [`NetError::NotFinite`] for a sewing parameter that is no number, [`NetError::Kernel`] for
    /// more edges than can be numbered.
    pub fn new(template: &TriMesh, sewing_parameters: &[f32]) -> Result<Self, NetError> {
        let topology = Topology::new(template.num_vertices(), template.faces());
        let graph = Self {
            fingerprint: Fingerprint::of_topology(template),
            rings: Arc::new(rings(template.positions(), &topology)?),
            template: (template.positions().iter())
                .flat_map(|point| (point.coords / UNIT).data.0[0])
                .collect(),
            sewing_parameters: Vec::new(),
            mean_edge_length: mean_edge_length(template.positions(), topology.edges()),
        };
        graph.with_sewing_parameters(sewing_parameters)
    }

    /// The same garment with other sewing parameters.
    ///
    /// # Errors
    ///
    /// [`NetError::NotFinite`] for one that is no number.
    pub fn with_sewing_parameters(mut self, parameters: &[f32]) -> Result<Self, NetError> {
        if let Some(index) = parameters.iter().position(|value| !value.is_finite()) {
            return Err(NetError::NotFinite {
                what: "sewing parameter",
                index,
            });
        }
        self.sewing_parameters = parameters.to_vec();
        Ok(self)
    }

    /// Which garment it is.
    pub fn fingerprint(&self) -> Fingerprint {
        self.fingerprint
    }

    /// How many vertices it has.
    pub fn num_vertices(&self) -> usize {
        self.rings.num_vertices()
    }

    /// Each vertex's one-ring, itself first.
    pub(crate) fn rings(&self) -> &Arc<Adjacency> {
        &self.rings
    }

    /// Places on the template `[vertex][axis]`, in units.
    pub fn template(&self) -> &[f32] {
        &self.template
    }

    /// The sewing parameters.
    pub fn sewing_parameters(&self) -> &[f32] {
        &self.sewing_parameters
    }

    /// Mean length of the template's edges, in metres.
    pub fn mean_edge_length(&self) -> f32 {
        self.mean_edge_length
    }

    /// Takes over what a configuration depends on: edge length and number of sewing parameters.
    #[must_use]
    pub fn configured(&self, mut config: GarNetConfig) -> GarNetConfig {
        config.mean_edge_length = self.mean_edge_length;
        config.num_sewing_parameters = self.sewing_parameters.len();
        config
    }
}

/// One-rings across seams: each vertex itself, then the first vertices at its neighbors' places.
fn rings(positions: &[Point3], topology: &Topology) -> Result<Adjacency, KernelError> {
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

fn mean_edge_length(positions: &[Point3], edges: &[[u32; 2]]) -> f32 {
    let length = |&[a, b]: &[u32; 2]| {
        let (a, b) = (positions[a as usize], positions[b as usize]);
        (a.cast::<f64>() - b.cast::<f64>()).norm()
    };
    let sum: f64 = edges.iter().map(length).sum();
    // A template of degenerate faces alone still needs a scale.
    ((sum / edges.len().max(1) as f64) as f32).max(1e-6)
}

#[cfg(test)]
mod tests {
    use super::*;
    use garnet_mesh::primitives::grid;

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
