//! The spatial transformer of PointNet.

use burn::module::Module;
use garnet_kernel::Activation;

use super::shared_mlp::{SharedLinear, SharedMlp};
use super::weights::WeightSource;
use crate::StnConfig;
use crate::ops::{Engine, Op};

/// Learns one matrix for all points of a scene and applies it (PointNet, Qi et al. 2017).
#[derive(Module, Debug)]
pub(crate) struct Stn {
    points: SharedMlp,
    head: SharedMlp,
    matrix: SharedLinear,
}

impl Stn {
    /// Starts as the identity.
    pub(crate) fn new(config: &StnConfig, source: &mut WeightSource) -> Self {
        let pooled = config.points.last().copied().unwrap_or(3);
        Self {
            points: SharedMlp::new(3, &config.points, source),
            head: SharedMlp::new(pooled, &config.head, source),
            matrix: SharedLinear::silent(config.head.last().copied().unwrap_or(pooled), 9, source),
        }
    }

    /// Transforms the points.
    ///
    /// # Shapes
    ///
    /// - `points` and output: `[point, 3]`
    pub(crate) fn forward<E: Engine>(&self, engine: &E, points: &E::Matrix) -> E::Matrix {
        let features = self.points.forward(engine, &[points]);
        let pooled = engine.call(Op::GlobalMax, &[&features]);
        let row = self.head.forward(engine, &[&pooled]);
        let row = self.matrix.forward(engine, &[&row], Activation::None);
        let matrix = engine.near_identity(&row);
        let activation = Activation::None;
        let no_bias = engine.zeros(3);
        engine.call(Op::Linear { activation }, &[points, &matrix, &no_bias])
    }
}
