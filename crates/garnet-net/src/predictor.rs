//! Inference: bind once, predict many times.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use burn::tensor::Device;
use garnet_mesh::Point3;

use crate::network::Inputs;
use crate::ops::{Buffer, SliceEngine};
use crate::{
    BodySampling, Checkpoint, CheckpointError, Cost, GarNet, GarNetConfig, GarmentGraph, NetError,
    ReferenceCase, Scene, SceneInput, TrainedRange,
};

/// A network bound to a garment and a body, without derivatives and without tensors.
///
/// Weights are copied out, tables of the template are made, and all memory is kept from scene to
/// scene. It may be shared by threads: each scene has memory of its own.
#[derive(Debug)]
pub struct Predictor {
    model: GarNet,
    engine: SliceEngine,
    garment: GarmentGraph,
    sampling: BodySampling,
    /// What [`Predictor::prepare`] has prepared.
    scene: Scene,
    /// Memory of scenes that are done.
    scenes: Mutex<Vec<Scene>>,
    range: Option<TrainedRange>,
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
        check_sewing_parameters(&model, &garment)?;
        Ok(Self {
            engine: SliceEngine::new(&model),
            model,
            garment,
            sampling,
            scene: Scene::default(),
            scenes: Mutex::default(),
            range: None,
        })
    }

    /// A network with random weights from a seed: it leaves the warp as it is, but takes as long as
    /// a trained one.
    ///
    /// # Errors
    ///
    /// As [`GarNetConfig::init`] and [`Predictor::new`].
    pub fn untrained(
        config: &GarNetConfig,
        seed: u64,
        garment: GarmentGraph,
        sampling: BodySampling,
    ) -> Result<Self, NetError> {
        Self::new(config.init(seed, &Device::flex())?, garment, sampling)
    }

    /// The garment that it is bound to.
    pub(crate) fn garment(&self) -> &GarmentGraph {
        &self.garment
    }

    /// Reads a weight file and binds it to a garment that lies on a body at rest, in metres.
    ///
    /// # Errors
    ///
    /// [`CheckpointError`] by name: the file is truncated, altered, foreign or of another version,
    /// or, as [`CheckpointError::Unfit`], of another garment.
    pub fn load(
        path: impl AsRef<Path>,
        garment: GarmentGraph,
        template: &[Point3],
        rest_body: &[Point3],
    ) -> Result<Self, CheckpointError> {
        let path = path.as_ref();
        let checkpoint = Checkpoint::load(path, &Device::flex())?;
        Self::of_checkpoint(path, checkpoint, garment, template, rest_body)
    }

    /// Binds the weights of the file `path`.
    pub(crate) fn of_checkpoint(
        path: &Path,
        checkpoint: Checkpoint,
        garment: GarmentGraph,
        template: &[Point3],
        rest_body: &[Point3],
    ) -> Result<Self, CheckpointError> {
        let bind = || {
            checkpoint.accepts(&garment)?;
            let config = checkpoint.model.config();
            let sampling = BodySampling::for_garment(rest_body, template, config)?;
            // More is known of a garment than every network asks for.
            let garment = match config.num_sewing_parameters {
                0 => garment.with_sewing_parameters(&[])?,
                _ => garment,
            };
            Ok(Self {
                range: checkpoint.range,
                ..Self::new(checkpoint.model, garment, sampling)?
            })
        };
        bind().map_err(|source| CheckpointError::Unfit {
            path: path.to_path_buf(),
            source,
        })
    }

    /// Another garment of the same topology, as [`Predictor::predict_on`] takes it: other places at
    /// rest, other sewing parameters.
    ///
    /// # Errors
    ///
    /// [`NetError::OtherGarment`], or [`NetError::Count`] for another number of sewing parameters.
    pub fn accepted(&self, garment: GarmentGraph) -> Result<GarmentGraph, NetError> {
        let (expected, found) = (self.garment.fingerprint(), garment.fingerprint());
        if expected != found {
            return Err(NetError::OtherGarment { expected, found });
        }
        // More is known of a garment than every network asks for.
        let garment = match self.model.config().num_sewing_parameters {
            0 => garment.with_sewing_parameters(&[])?,
            _ => garment,
        };
        check_sewing_parameters(&self.model, &garment)?;
        Ok(garment)
    }

    /// Goes on with another garment of the same topology.
    ///
    /// # Errors
    ///
    /// As [`Predictor::accepted`].
    pub fn rebind(&mut self, garment: GarmentGraph) -> Result<(), NetError> {
        self.garment = self.accepted(garment)?;
        Ok(())
    }

    /// The network that predicts.
    pub fn model(&self) -> &GarNet {
        &self.model
    }

    /// What the network is made of.
    pub fn config(&self) -> &GarNetConfig {
        self.model.config()
    }

    /// Weights and operations of a prediction.
    ///
    /// # Errors
    ///
    /// As [`GarNetConfig::cost`].
    pub fn cost(&self, num_vertices: usize) -> Result<Cost, NetError> {
        self.config().cost(num_vertices, self.num_body_points())
    }

    /// The poses and shapes that it was trained on, if the weight file tells.
    pub fn range(&self) -> Option<&TrainedRange> {
        self.range.as_ref()
    }

    /// Body points that the network looks at.
    pub fn num_body_points(&self) -> usize {
        self.sampling.used().len()
    }

    /// Drapes: the vertices of a scene `[vertex]`, in metres.
    ///
    /// # Errors
    ///
    /// As [`Scene::prepare`], and [`NetError::Diverged`].
    pub fn predict(&self, input: &SceneInput<'_>) -> Result<Vec<Point3>, NetError> {
        self.predict_on(&self.garment, input)
    }

    /// As [`Predictor::predict`], of a garment that [`Predictor::accepted`] has given.
    ///
    /// # Errors
    ///
    /// As [`Predictor::predict`].
    pub fn predict_on(
        &self,
        garment: &GarmentGraph,
        input: &SceneInput<'_>,
    ) -> Result<Vec<Point3>, NetError> {
        let spare = self.scenes.lock().map(|mut scenes| scenes.pop());
        let mut scene = spare.unwrap_or_default().unwrap_or_default();
        scene.prepare(self.model.config(), garment, &self.sampling, input)?;
        let moved = scene.moved(self.run(garment, &scene).values());
        let mut scenes = self.scenes.lock().unwrap_or_else(PoisonError::into_inner);
        scenes.push(scene);
        moved
    }

    /// All that goes into [`Predictor::predict`], and what comes out, for other implementations.
    ///
    /// # Errors
    ///
    /// As [`Predictor::predict`].
    pub fn case(&self, input: &SceneInput<'_>) -> Result<ReferenceCase, NetError> {
        let mut case = ReferenceCase::of_input(input);
        self.add_to(&mut case, None, input)?;
        Ok(case)
    }

    /// Adds what the network is told, and what it says.
    pub(crate) fn add_to(
        &self,
        case: &mut ReferenceCase,
        garment: Option<&GarmentGraph>,
        input: &SceneInput<'_>,
    ) -> Result<(), NetError> {
        let garment = garment.unwrap_or(&self.garment);
        let scene = Scene::new(self.model.config(), garment, &self.sampling, input)?;
        scene.add_to(case);
        let (mut offsets, mut vertices) = (vec![0_u32], Vec::new());
        for vertex in 0..scene.num_vertices() {
            vertices.extend_from_slice(garment.rings().neighbors(vertex));
            offsets.push(vertices.len() as u32);
        }
        case.indices("ring_offsets", &offsets, offsets.len());
        case.indices("ring_vertices", &vertices, vertices.len());
        let averaged = self.sampling.averaged();
        case.indices("averaged", averaged.all(), averaged.neighbors_per_row());
        case.numbers("translations", self.run(garment, &scene).values(), 3);
        Ok(())
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
        self.run(&self.garment, &self.scene).values().to_vec()
    }

    /// Memory kept between scenes, in bytes.
    pub fn num_bytes(&self) -> usize {
        self.engine.num_bytes()
    }

    fn run(&self, garment: &GarmentGraph, scene: &Scene) -> Arc<Buffer> {
        let config = self.model.config();
        let matrix = |values: &[f32], columns| self.engine.matrix(values, columns);
        let inputs = Inputs::new(config, garment, &self.sampling, scene, matrix);
        self.model.run(&self.engine, &inputs)
    }
}

fn check_sewing_parameters(model: &GarNet, garment: &GarmentGraph) -> Result<(), NetError> {
    let found = garment.sewing_parameters().len();
    let expected = model.config().num_sewing_parameters;
    NetError::check_count("sewing parameters", found, expected)
}
