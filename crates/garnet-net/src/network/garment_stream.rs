//! The garment stream: point-wise, patch-wise and global features of the garment.

use burn::module::Module;
use garnet_kernel::Activation;

use super::mesh_conv::{Mesh, ResidualBlock};
use super::shared_mlp::{SharedLinear, SharedMlp};
use super::stn::Stn;
use super::weights::WeightSource;
use crate::GarNetConfig;
use crate::ops::{Engine, Op};

/// Source: *Gundogdu et al. 2020, figures 3 and 4*.
#[derive(Module, Debug)]
pub(crate) struct GarmentStream {
    stn: Stn,
    points: SharedMlp,
    /// Takes the global body features in, early.
    input: SharedLinear,
    blocks: Vec<ResidualBlock>,
    global: SharedLinear,
}

/// What the garment stream gives.
#[derive(Debug)]
pub(crate) struct GarmentFeatures<M> {
    /// Of each stage `[vertex, channels]`: point-wise, joined with the body's, after each block.
    pub(crate) stages: Vec<M>,
    /// Of the whole garment `[1, global]`.
    pub(crate) global: M,
}

impl GarmentStream {
    pub(crate) fn new(
        config: &GarNetConfig,
        body_global: usize,
        source: &mut WeightSource,
    ) -> Self {
        let widths = &config.garment;
        let points = widths.points.last().copied().unwrap_or(3);
        let blocks = if config.has_mesh_convolutions() {
            widths.blocks.as_slice()
        } else {
            &[]
        };
        let before = std::iter::once(&widths.input).chain(blocks);
        let last = blocks.last().copied().unwrap_or(widths.input);
        Self {
            stn: Stn::new(&widths.stn, source),
            points: SharedMlp::new(3 + config.num_vertex_features(), &widths.points, source),
            input: SharedLinear::new(points + body_global, widths.input, source),
            blocks: before
                .zip(blocks)
                .map(|(&inputs, &outputs)| ResidualBlock::new(config, [inputs, outputs], source))
                .collect(),
            global: SharedLinear::new(last, widths.global, source),
        }
    }

    /// Computes the features of all stages.
    ///
    /// # Shapes
    ///
    /// - `mesh.places`: `[vertex, 3]`
    /// - `inputs`: `[vertex, features]`, what vertices bring along
    /// - `body`: `[1, channels]` each, `body global` together
    pub(crate) fn forward<E: Engine>(
        &self,
        engine: &E,
        mesh: &Mesh<'_, E::Matrix>,
        inputs: Option<&E::Matrix>,
        body: &[&E::Matrix],
    ) -> GarmentFeatures<E::Matrix> {
        let turned = self.stn.forward(engine, mesh.places);
        let mut parts = vec![&turned];
        parts.extend(inputs);
        let points = self.points.forward(engine, &parts);
        let mut parts = vec![&points];
        parts.extend(body);
        let joined = self.input.forward(engine, &parts, Activation::LeakyRelu);
        let mut features = joined.clone();
        let mut stages = vec![points, joined];
        for block in &self.blocks {
            features = block.forward(engine, mesh, &features);
            stages.push(features.clone());
        }
        let lifted = self
            .global
            .forward(engine, &[&features], Activation::LeakyRelu);
        let global = engine.call(Op::GlobalMax, &[&lifted]);
        GarmentFeatures { stages, global }
    }
}
