//! The step of a training by itself.

use std::sync::{Arc, OnceLock};

use burn::optim::ModuleOptimizer;
use burn::tensor::Device;
use garnet_data::Split;
use garnet_mesh::{Point3, TriMesh, vertex_normals};
use garnet_net::losses::LossReport;
use garnet_net::{GarNet, GarmentGraph};
use garnet_skin::WarpedGarment;
use nalgebra::{Isometry3, UnitQuaternion};

use crate::context::{Example, TrainingContext};
use crate::scene_gradients::scene_gradients;
use crate::state::optimizer;
use crate::{SceneName, TrainConfig, TrainError};

/// A network that learns one scene again and again: what a training repeats, without a data set.
///
/// ```
/// use garnet_mesh::primitives::{capsule, tube};
/// use garnet_train::{SceneTraining, TrainConfig};
///
/// let (garment, body) = (tube(0.22, 0.7, 16, 12), capsule(0.2, 0.8, 16, 6));
/// let config = TrainConfig::parse("preset = \"tiny\"")?;
/// let mut training = SceneTraining::new(&config, &garment, &body, garment.positions())?;
/// assert!(training.step()?.total().is_finite());
/// # Ok::<(), garnet_train::TrainError>(())
/// ```
pub struct SceneTraining {
    context: TrainingContext,
    example: Example,
    model: GarNet,
    optimizer: ModuleOptimizer,
    device: Device,
    learning_rate: f64,
}

impl std::fmt::Debug for SceneTraining {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // The optimizer has no such form.
        let Self { model, .. } = self;
        formatter.debug_tuple("SceneTraining").field(model).finish()
    }
}

impl SceneTraining {
    /// Of a garment that lies on a body at rest, and where the teacher puts it `[vertex]`.
    ///
    /// # Errors
    ///
    /// [`TrainError::Config`], [`TrainError::ConfigText`] and [`TrainError::Net`] for what cannot
    /// be trained or does not fit.
    pub fn new(
        config: &TrainConfig,
        garment: &TriMesh,
        body: &TriMesh,
        draped: &[Point3],
    ) -> Result<Self, TrainError> {
        config.validate()?;
        let network = config.network_config()?;
        let graph = GarmentGraph::new(garment, &[])?;
        let context =
            TrainingContext::of_meshes(garment, body, graph.configured(network), &config.loss)?;
        let device = Device::flex().autodiff();
        let example = Example {
            scene: SceneName {
                split: Split::Train,
                body: 0,
                pose: 0,
            },
            sequence: String::new(),
            rest: Arc::from(garment.positions()),
            graph,
            warped: WarpedGarment {
                positions: garment.positions().to_vec(),
                rotations: vec![UnitQuaternion::identity(); garment.num_vertices()],
                world_from_root: Isometry3::identity(),
            },
            body: body.positions().to_vec(),
            body_normals: vertex_normals(body.positions(), body.faces()),
            parameters: vec![0.0; context.config.num_body_parameters],
            draped: draped.to_vec(),
            neighbors: OnceLock::new(),
            mirrored_neighbors: OnceLock::new(),
        };
        Ok(Self {
            model: context.config.init(config.seed, &device)?,
            optimizer: optimizer(config),
            learning_rate: config.learning_rate,
            context,
            example,
            device,
        })
    }

    /// One step of the optimizer: the terms of the loss before it.
    ///
    /// # Errors
    ///
    /// [`TrainError::Diverged`] where loss or derivatives are not finite.
    pub fn step(&mut self) -> Result<LossReport, TrainError> {
        let found = scene_gradients(&self.context, &self.example, &self.model, &self.device, 1.0)?;
        let derived = found.map_err(|trouble| TrainError::Diverged {
            epoch: 1,
            trouble,
            num_skipped: 1,
        })?;
        let model = self.model.clone();
        self.model = (self.optimizer).step(self.learning_rate, model, derived.gradients);
        Ok(derived.report)
    }
}
