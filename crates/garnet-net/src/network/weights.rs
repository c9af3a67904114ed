//! First values of weights, from one named seed.

use burn::module::{Param, ParamId};
use burn::tensor::{Device, Tensor, TensorData};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Draws weights in the order in which modules ask.
#[derive(Debug)]
pub(crate) struct WeightSource {
    /// None where no weights are drawn, because a file fills them or their shapes are enough.
    random: Option<ChaCha8Rng>,
    device: Device,
    num_made: u64,
    /// All numbers of the weights that were asked for.
    num_weights: u64,
}

impl WeightSource {
    /// From a seed, onto a device.
    pub(crate) fn new(seed: u64, device: &Device) -> Self {
        Self {
            random: Some(ChaCha8Rng::seed_from_u64(seed)),
            device: device.clone(),
            num_made: 0,
            num_weights: 0,
        }
    }

    /// Shapes alone, for a device: zeros take memory only where they are looked at, so that a file
    /// that claims to be huge takes none.
    pub(crate) fn blank(device: &Device) -> Self {
        Self {
            random: None,
            device: device.clone(),
            num_made: 0,
            num_weights: 0,
        }
    }

    /// How many weights were asked for.
    pub(crate) const fn num_weights(&self) -> u64 {
        self.num_weights
    }

    /// Independent normal numbers of the given deviation.
    pub(crate) fn normal(&mut self, shape: [usize; 2], deviation: f32) -> Param<Tensor<2>> {
        let values = self.random.as_mut().map(|random| {
            let draw = |_| deviation * standard_normal(random);
            (0..shape[0] * shape[1]).map(draw).collect()
        });
        self.param(shape, values)
    }

    /// Zeros.
    pub(crate) fn zeros(&mut self, len: usize) -> Param<Tensor<1>> {
        self.param([len], None)
    }

    /// Weights are numbered in the order in which they are made, not at random: the state of an
    /// optimizer, which is stored by these numbers, then fits the same network made again.
    fn param<const D: usize>(
        &mut self,
        shape: [usize; D],
        values: Option<Vec<f32>>,
    ) -> Param<Tensor<D>> {
        self.num_made += 1;
        self.num_weights += shape.iter().product::<usize>() as u64;
        let id = ParamId::from(self.num_made);
        let make = move |device: &Device, require_grad| {
            let tensor = match values {
                Some(values) => Tensor::from_data(TensorData::new(values, shape), device),
                None => Tensor::zeros(shape, device),
            };
            tensor.set_require_grad(require_grad)
        };
        Param::uninitialized(id, make, self.device.clone(), true, shape.into())
    }
}

/// Box and Muller 1958; only one of the two is used, so that draws stay simple to repeat.
fn standard_normal(random: &mut ChaCha8Rng) -> f32 {
    let [a, b] = [(); 2].map(|()| f64::from(random.next_u32()) / (1_u64 << 32) as f64);
    let radius = (-2.0 * (1.0 - a).ln()).sqrt();
    (radius * (std::f64::consts::TAU * b).cos()) as f32
}
