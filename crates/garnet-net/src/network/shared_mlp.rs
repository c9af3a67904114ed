//! Layers that are applied to every point alike.

use burn::module::{Module, Param};
use burn::tensor::Tensor;
use garnet_kernel::Activation;

use super::weights::WeightSource;
use crate::ops::{Engine, Op};

/// Leaky ReLUs of slope 0.1 keep this share of the variance of a centered input.
const LEAKY_VARIANCE: f32 = 0.505;

/// A linear layer; its input may come in parts, whose weights lie one below the other.
#[derive(Module, Debug)]
pub(crate) struct SharedLinear {
    /// `[channels of all parts, out]`.
    pub(crate) weight: Param<Tensor<2>>,
    /// `[out]`.
    pub(crate) bias: Param<Tensor<1>>,
}

impl SharedLinear {
    /// Random weights that keep the variance through a leaky ReLU.
    pub(crate) fn new(inputs: usize, outputs: usize, source: &mut WeightSource) -> Self {
        let deviation = (1.0 / (LEAKY_VARIANCE * inputs as f32)).sqrt();
        Self::of_deviation(inputs, outputs, deviation, source)
    }

    /// All zeros: the layer gives nothing until it has learned.
    pub(crate) fn silent(inputs: usize, outputs: usize, source: &mut WeightSource) -> Self {
        Self::of_deviation(inputs, outputs, 0.0, source)
    }

    fn of_deviation(
        inputs: usize,
        outputs: usize,
        deviation: f32,
        source: &mut WeightSource,
    ) -> Self {
        Self {
            weight: source.normal([inputs, outputs], deviation),
            bias: source.zeros(outputs),
        }
    }

    /// Applies the layer to the parts of each row.
    ///
    /// # Shapes
    ///
    /// - `parts`: `[point, channels]` each, or `[1, channels]` where all points share it
    /// - output: `[point, out]`
    pub(crate) fn forward<E: Engine>(
        &self,
        engine: &E,
        parts: &[&E::Matrix],
        activation: Activation,
    ) -> E::Matrix {
        let weight = engine.weights(&self.weight);
        let bias = engine.weights(&self.bias);
        let mut inputs = parts.to_vec();
        inputs.extend([&weight, &bias]);
        engine.call(Op::Linear { activation }, &inputs)
    }
}

/// The same multilayer perceptron applied to every point (PointNet, Qi et al. 2017).
#[derive(Module, Debug)]
pub(crate) struct SharedMlp {
    layers: Vec<SharedLinear>,
}

impl SharedMlp {
    /// Layers of the given output widths.
    pub(crate) fn new(inputs: usize, widths: &[usize], source: &mut WeightSource) -> Self {
        let before = std::iter::once(&inputs).chain(widths);
        let layers = before.zip(widths);
        Self {
            layers: layers
                .map(|(&inputs, &outputs)| SharedLinear::new(inputs, outputs, source))
                .collect(),
        }
    }

    /// Lifts every point to a feature vector, through leaky ReLUs.
    ///
    /// # Shapes
    ///
    /// - `parts`: `[point, channels]` each
    /// - output: `[point, widths.last()]`, or the first part if there are no layers
    pub(crate) fn forward<E: Engine>(&self, engine: &E, parts: &[&E::Matrix]) -> E::Matrix {
        let Some((first, rest)) = self.layers.split_first() else {
            return parts[0].clone();
        };
        let features = first.forward(engine, parts, Activation::LeakyRelu);
        rest.iter().fold(features, |features, layer| {
            layer.forward(engine, &[&features], Activation::LeakyRelu)
        })
    }
}
