//! The fusion: from all features of a vertex to its translation.

use burn::module::Module;
use garnet_kernel::Activation;

use super::shared_mlp::{SharedLinear, SharedMlp};
use super::weights::WeightSource;
use crate::ops::Engine;

/// Shared MLP blocks; the last gives 3 channels without activation, and zero until it has
/// learned: an untrained network leaves the warp as it is.
///
/// Source: *Gundogdu et al. 2020, figure 2*.
#[derive(Module, Debug)]
pub(crate) struct Fusion {
    hidden: SharedMlp,
    translation: SharedLinear,
}

impl Fusion {
    pub(crate) fn new(inputs: usize, hidden: &[usize], source: &mut WeightSource) -> Self {
        let last = hidden.last().copied().unwrap_or(inputs);
        Self {
            hidden: SharedMlp::new(inputs, hidden, source),
            translation: SharedLinear::silent(last, 3, source),
        }
    }

    /// The same with random weights in the last layer, for tests.
    #[cfg(test)]
    pub(crate) fn awake(self, source: &mut WeightSource) -> Self {
        let [inputs, outputs] = self.translation.weight.dims();
        let random = SharedLinear::new(inputs, outputs, source);
        // The numbers of the weights stay: those of another source are taken in this network.
        let translation = SharedLinear {
            weight: (self.translation.weight).map(|_| random.weight.val()),
            bias: self.translation.bias,
        };
        Self {
            translation,
            ..self
        }
    }

    /// Translates each vertex.
    ///
    /// # Shapes
    ///
    /// - `parts`: `[vertex, channels]` or `[1, channels]` each
    /// - output: `[vertex, 3]`
    pub(crate) fn forward<E: Engine>(&self, engine: &E, parts: &[&E::Matrix]) -> E::Matrix {
        let features = self.hidden.forward(engine, parts);
        self.translation
            .forward(engine, &[&features], Activation::None)
    }
}
