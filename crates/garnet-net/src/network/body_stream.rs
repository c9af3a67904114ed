//! The body stream: point-wise and global features of the body.

use burn::module::Module;
use garnet_kernel::Activation;

use super::shared_mlp::{SharedLinear, SharedMlp};
use super::stn::Stn;
use super::weights::WeightSource;
use crate::GarNetConfig;
use crate::ops::{Engine, Op};

/// PointNet with leaky ReLUs and a skip from the transformer's output to the second MLP block.
///
/// Source: *Gundogdu et al. 2020, sections 3.2 and 3.5*.
#[derive(Module, Debug)]
pub(crate) struct BodyStream {
    stn: Stn,
    first: SharedMlp,
    second: SharedMlp,
    global: SharedLinear,
}

/// What the body stream gives.
#[derive(Debug)]
pub(crate) struct BodyFeatures<M> {
    /// Of each point.
    pub(crate) points: M,
    /// Of the whole body.
    pub(crate) global: M,
}

impl BodyStream {
    pub(crate) fn new(config: &GarNetConfig, source: &mut WeightSource) -> Self {
        let widths = &config.body;
        let inputs = config.num_body_features();
        let between = widths.first.last().copied().unwrap_or(inputs) + inputs;
        let points = widths.second.last().copied().unwrap_or(between);
        Self {
            stn: Stn::new(&widths.stn, source),
            first: SharedMlp::new(inputs, &widths.first, source),
            second: SharedMlp::new(between, &widths.second, source),
            global: SharedLinear::new(points, widths.global, source),
        }
    }

    /// Computes point-wise and global features.
    ///
    /// # Shapes
    ///
    /// - `points`, `normals`: `[point, 3]`
    /// - output: `[point, second.last()]` and `[1, global]`
    pub(crate) fn forward<E: Engine>(
        &self,
        engine: &E,
        points: &E::Matrix,
        normals: Option<&E::Matrix>,
    ) -> BodyFeatures<E::Matrix> {
        let turned = self.stn.forward(engine, points);
        let mut inputs = vec![&turned];
        inputs.extend(normals);
        let features = self.first.forward(engine, &inputs);
        inputs.insert(0, &features);
        let points = self.second.forward(engine, &inputs);
        let lifted = self
            .global
            .forward(engine, &[&points], Activation::LeakyRelu);
        let global = engine.call(Op::GlobalMax, &[&lifted]);
        BodyFeatures { points, global }
    }
}
