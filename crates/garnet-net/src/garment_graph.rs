//! What the network knows of a garment before any scene.

#[cfg(feature = "burn")]
mod rings;

use std::sync::Arc;

#[cfg(feature = "burn")]
use garnet_kernel::Adjacency;
use garnet_mesh::{Fingerprint, Point3, Topology, TriMesh};

use crate::pose_space::Cut;
use crate::{GarNetConfig, NetError, UNIT};

/// A garment at bind time: its one-rings, its template, its sewing parameters.
///
/// Files split vertices along seams. Vertices at one place of the template share one ring, so
/// mesh convolutions see across seams, and the two sides of a seam that starts closed stay
/// together.
#[derive(Debug, Clone)]
pub struct GarmentGraph {
    fingerprint: Fingerprint,
    #[cfg(feature = "burn")]
    rings: Arc<Adjacency>,
    template: Arc<[f32]>,
    sewing_parameters: Vec<f32>,
    mean_edge_length: f32,
    cut: Cut,
}

impl GarmentGraph {
    /// Reads a template, and the sewing parameters that were fed in training (or none).
    ///
    /// # Errors
    ///
    /// [`NetError::NotFinite`] for a sewing parameter that is no number, `NetError::Kernel` for
    /// more edges than can be numbered.
    pub fn new(template: &TriMesh, sewing_parameters: &[f32]) -> Result<Self, NetError> {
        let topology = Topology::new(template.num_vertices(), template.faces());
        let graph = Self {
            fingerprint: Fingerprint::of_topology(template),
            #[cfg(feature = "burn")]
            rings: Arc::new(rings::rings(template.positions(), &topology)?),
            template: (template.positions().iter())
                .flat_map(|point| (point.coords / UNIT).data.0[0])
                .collect(),
            sewing_parameters: Vec::new(),
            mean_edge_length: mean_edge_length(template.positions(), topology.edges()),
            cut: cut_of(template),
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
        self.template.len() / 3
    }

    /// Each vertex's one-ring, itself first.
    #[cfg(feature = "burn")]
    pub(crate) fn rings(&self) -> &Arc<Adjacency> {
        &self.rings
    }

    /// Places on the template `[vertex][axis]`, in units.
    pub fn template(&self) -> &[f32] {
        &self.template
    }

    /// The sewing parameters of the garment.
    pub fn sewing_parameters(&self) -> &[f32] {
        &self.sewing_parameters
    }

    /// Mean length of the template's edges, in metres.
    pub fn mean_edge_length(&self) -> f32 {
        self.mean_edge_length
    }

    /// How the garment is cut.
    pub fn cut(&self) -> &Cut {
        &self.cut
    }

    /// Takes over what a configuration depends on: edge length and number of sewing parameters.
    #[must_use]
    pub fn configured(&self, mut config: GarNetConfig) -> GarNetConfig {
        config.mean_edge_length = self.mean_edge_length;
        config.num_sewing_parameters = self.sewing_parameters.len();
        config
    }
}

fn cut_of(template: &TriMesh) -> Cut {
    let places = template.positions();
    let (mut low, mut high) = (places[0], places[0]);
    for place in places {
        (low, high) = (low.inf(place), high.sup(place));
    }
    let area: f64 = template
        .faces()
        .iter()
        .map(|face| {
            let [a, b, c] = face.map(|corner| places[corner as usize].cast::<f64>());
            0.5 * (b - a).cross(&(c - a)).norm()
        })
        .sum();
    let [width, height] = [high.x - low.x, high.y - low.y];
    [
        (area / f64::from(height.max(f32::EPSILON))) as f32,
        height,
        width,
    ]
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
