//! GarNet: two streams and their fusion.

mod body_stream;
mod fusion;
mod garment_stream;
mod inputs;
mod mesh_conv;
mod shared_mlp;
mod stn;
#[cfg(test)]
mod tests;
mod weights;

pub(crate) use inputs::Inputs;

use std::sync::Arc;

use burn::module::Module;
use burn::tensor::{Device, Tensor};
use garnet_kernel::Workspace;

use crate::ops::{Engine, Op, TensorEngine};
use crate::{BodySampling, GarNetConfig, GarmentGraph, NetError, Scene};
use body_stream::BodyStream;
use fusion::Fusion;
use garment_stream::GarmentStream;
use mesh_conv::Mesh;
use shared_mlp::SharedMlp;
use weights::WeightSource;

/// The network f(M, B): a translation for each vertex of the warped garment.
///
/// Source: *Gundogdu et al. 2020, figures 2 to 5*.
#[derive(Module, Debug)]
pub struct GarNet {
    body: Option<BodyStream>,
    parameters: Option<SharedMlp>,
    garment: GarmentStream,
    fusion: Fusion,
    #[module(skip)]
    config: GarNetConfig,
    /// Memory of the kernels, kept from step to step.
    #[module(skip)]
    workspace: Arc<Workspace>,
}

/// Most weights of a network: a training keeps four numbers for each, of which these take 1.6 GB.
const MAX_WEIGHTS: u64 = 100_000_000;

impl GarNetConfig {
    /// Makes a network with random weights from a seed; it leaves the warp as it is.
    ///
    /// # Errors
    ///
    /// [`NetError::Config`].
    pub fn init(&self, seed: u64, device: &Device) -> Result<GarNet, NetError> {
        self.check_size()?;
        Ok(self.made_of(&mut WeightSource::new(seed, device)))
    }

    /// Makes a network of shapes alone, to be filled.
    pub(crate) fn blank(&self, device: &Device) -> Result<GarNet, NetError> {
        self.validate()?;
        let mut source = WeightSource::blank(device);
        let network = self.made_of(&mut source);
        let found = source.num_weights();
        if found <= MAX_WEIGHTS {
            return Ok(network);
        }
        Err(NetError::Config {
            field: "weights",
            value: found as f64,
            min: 1.0,
            max: MAX_WEIGHTS as f64,
        })
    }

    /// Checks that memory has room for a network: widths that are in their ranges may together ask
    /// for too many weights.
    ///
    /// # Errors
    ///
    /// [`NetError::Config`] of the field `weights`, or as [`GarNetConfig::validate`].
    pub fn check_size(&self) -> Result<(), NetError> {
        self.blank(&Device::flex()).map(drop)
    }

    /// Of a configuration whose numbers are in their ranges.
    fn made_of(&self, source: &mut WeightSource) -> GarNet {
        let parameters = (self.has_body_parameters())
            .then(|| SharedMlp::new(self.num_body_parameters, &self.body.parameters, source));
        let mut body_global = 0;
        if self.has_body_stream() {
            body_global += self.body.global;
        }
        if self.has_body_parameters() {
            let last = self.body.parameters.last().copied();
            body_global += last.unwrap_or(self.num_body_parameters);
        }
        let stages = &self.garment;
        let points = stages.points.last().copied().unwrap_or(3);
        let mut fused = points + stages.input + body_global + stages.global;
        if self.has_mesh_convolutions() {
            fused += stages.blocks.iter().sum::<usize>();
        }
        if self.has_local_pooling() {
            fused += self.body.second.last().copied().unwrap_or(0);
        }
        GarNet {
            body: self
                .has_body_stream()
                .then(|| BodyStream::new(self, source)),
            parameters,
            garment: GarmentStream::new(self, body_global, source),
            fusion: Fusion::new(fused, &self.fusion, source),
            config: self.clone(),
            workspace: Arc::default(),
        }
    }
}

impl GarNet {
    /// What it is made of.
    pub fn config(&self) -> &GarNetConfig {
        &self.config
    }

    /// Translates the vertices of a scene, in units of 0.1 m and in the frame of prediction.
    ///
    /// On a device that records derivatives, the result has them. [`Scene::moved`] applies it.
    ///
    /// # Shapes
    ///
    /// - output: `[vertex, 3]`
    ///
    /// # Panics
    ///
    /// If the scene was prepared for another configuration, garment or sampling.
    pub fn forward(
        &self,
        garment: &GarmentGraph,
        sampling: &BodySampling,
        scene: &Scene,
        device: &Device,
    ) -> Tensor<2> {
        let engine = TensorEngine::new(device, &self.workspace);
        let matrix = |values: &[f32], columns| engine.matrix(values, columns);
        let inputs = Inputs::new(&self.config, garment, sampling, scene, matrix);
        self.run(&engine, &inputs)
    }

    /// The figure of the paper, on whatever runs the steps.
    pub(crate) fn run<E: Engine>(&self, engine: &E, inputs: &Inputs<'_, E::Matrix>) -> E::Matrix {
        let mut near = None;
        let mut body = Vec::new();
        if let Some(stream) = &self.body {
            let (points, normals) = inputs.body();
            let features = stream.forward(engine, points, normals);
            near = inputs.nearest.map(|nearest| {
                let means = Op::NeighborMean(inputs.averaged.clone());
                let kept = engine.call(means, &[&features.points]);
                engine.call(Op::NeighborMax(nearest.clone()), &[&kept])
            });
            body.push(features.global);
        }
        if let Some(layers) = &self.parameters {
            body.push(layers.forward(engine, &[inputs.parameters()]));
        }
        let body: Vec<&E::Matrix> = body.iter().collect();
        let mesh = Mesh::new(&self.config, inputs.adjacency, &inputs.vertices);
        let features = inputs.features.as_ref();
        let garment = self.garment.forward(engine, &mesh, features, &body);
        let mut parts: Vec<&E::Matrix> = garment.stages.iter().collect();
        parts.extend(&near);
        parts.extend(body);
        parts.push(&garment.global);
        self.fusion.forward(engine, &parts)
    }
}

/// A scalar whose derivative by `output` is `gradient`.
///
/// The losses compute their derivatives by hand; this is how they enter the network:
/// `surrogate(output, scene.pulled_back(&report.gradient)).backward()`.
///
/// # Panics
///
/// If there are not as many derivatives as numbers in `output`.
pub fn surrogate(output: Tensor<2>, gradient: Vec<f32>) -> Tensor<1> {
    let shape = output.dims();
    let data = burn::tensor::TensorData::new(gradient, shape);
    let gradient = Tensor::from_data(data, &output.device());
    (output * gradient).sum()
}
