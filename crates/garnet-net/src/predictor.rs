//! Inference: bind once, predict many times.

use std::sync::Arc;

use garnet_mesh::Point3;

use crate::network::Inputs;
use crate::ops::{Buffer, SliceEngine};
use crate::{BodySampling, GarNet, GarmentGraph, NetError, Scene, SceneInput};

/// A network bound to a garment and a body, without derivatives and without tensors.
///
/// Weights are copied out, tables of the template are made, and all memory is kept from scene to
/// scene.
#[derive(Debug)]
pub struct Predictor {
    model: GarNet,
    engine: SliceEngine,
    garment: GarmentGraph,
    sampling: BodySampling,
    scene: Scene,
}

impl Predictor {
    /// Binds a model to a garment; see [`Checkpoint::accepts`](crate::Checkpoint::accepts) for
    /// whether it is the one it was trained for.
    ///
    /// # Errors
    ///
    /// [`NetError::Count`] for another number of sewing parameters than the model has.
    pub fn new(
        model: GarNet,
        garment: GarmentGraph,
        sampling: BodySampling,
    ) -> Result<Self, NetError> {
        let (found, expected) = (
            garment.sewing_parameters().len(),
            model.config().num_sewing_parameters,
        );
        if found != expected {
            return Err(NetError::Count {
                what: "sewing parameters",
                found,
                expected,
            });
        }
        Ok(Self {
            engine: SliceEngine::new(&model),
            model,
            garment,
            sampling,
            scene: Scene::default(),
        })
    }

    /// The model.
    pub fn model(&self) -> &GarNet {
        &self.model
    }

    /// Drapes: the vertices of a scene `[vertex]`, in metres.
    ///
    /// # Errors
    ///
    /// As [`Scene::prepare`], and [`NetError::Diverged`].
    pub fn predict(&mut self, input: &SceneInput<'_>) -> Result<Vec<Point3>, NetError> {
        self.prepare(input)?;
        let translations = self.run();
        self.scene.moved(translations.values())
    }

    /// The first half of [`Predictor::predict`]: neighbors, frames, features.
    ///
    /// # Errors
    ///
    /// As [`Scene::prepare`].
    pub fn prepare(&mut self, input: &SceneInput<'_>) -> Result<(), NetError> {
        let config = self.model.config();
        (self.scene).prepare(config, &self.garment, &self.sampling, input)
    }

    /// The translations of the prepared scene `[vertex][3]`, in units of 0.1 m and in the frame of
    /// prediction.
    ///
    /// # Panics
    ///
    /// If no scene was prepared.
    pub fn translations(&mut self) -> Vec<f32> {
        self.run().values().to_vec()
    }

    /// Memory kept between scenes, in bytes.
    pub fn num_bytes(&self) -> usize {
        self.engine.num_bytes()
    }

    fn run(&self) -> Arc<Buffer> {
        let config = self.model.config();
        let matrix = |values: &[f32], columns| self.engine.matrix(values, columns);
        let inputs = Inputs::new(config, &self.garment, &self.sampling, &self.scene, matrix);
        self.model.run(&self.engine, &inputs)
    }
}
