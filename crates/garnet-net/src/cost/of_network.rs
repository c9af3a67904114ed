//! The work of a network, counted on the network itself.

use burn::module::Module;
use burn::tensor::Device;
use garnet_mesh::{Point3, TriMesh};

use super::Cost;
use crate::network::Inputs;
use crate::ops::{CostEngine, Extent};
use crate::{BodySampling, GarNetConfig, GarmentGraph, NetError};

impl GarNetConfig {
    /// Counts weights, and work for `num_vertices` garment vertices and a body of `num_points`
    /// points, of which the network looks at as many as the configuration says.
    ///
    /// # Errors
    ///
    /// [`NetError::Config`], also where there are no vertices or points.
    pub fn cost(&self, num_vertices: usize, num_points: usize) -> Result<Cost, NetError> {
        let config = self;
        let net = config.blank(&Device::flex())?;
        let engine = CostEngine::default();
        // The tables only lend their sizes: any garment and body of these counts will do.
        let most = if self.body.points == 0 {
            num_points
        } else {
            num_points.min(self.body.points)
        };
        let points = vec![Point3::origin(); most.max(1)];
        let vertices = vec![Point3::origin(); num_vertices.max(3)];
        let garment = GarmentGraph::new(&TriMesh::new(vertices, vec![[0, 1, 2]])?, &[])?;
        let sampling = BodySampling::new(&points, None, &self.pooling)?;
        let scene = crate::Scene::of_extent(config, &garment, &sampling)?;
        let matrix =
            |values: &[f32], columns: usize| -> Extent { [values.len() / columns, columns] };
        let inputs = Inputs::new(config, &garment, &sampling, &scene, matrix);
        net.run(&engine, &inputs);
        Ok(Cost {
            parameters: net.num_params() as u64,
            flops: engine.flops(),
        })
    }
}
