//! The network of a region.

use burn::module::{Module, Param};
use burn::optim::{AdamWConfig, GradientsParams};
use burn::tensor::activation::silu;
use burn::tensor::{Device, Tensor, TensorData};
use faer::Mat;
use garnet_net::pose_space::Layer;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Scenes a step.
const BATCH: usize = 64;

/// The learning rate of Adam after the first steps; it falls as a cosine.
const RATE: f64 = 1e-3;

/// Steps in which it rises from zero; a tenth of all, if those are few.
const WARM_UP: usize = 500;

/// Weights shrink by the learning rate times this in each step (*Loshchilov and Hutter 2019*):
/// sequences of poses that no scene has are missed by less.
const DECAY: f32 = 0.1;

/// Layers with as many numbers as asked for.
pub(in super::super) const HIDDEN_LAYERS: usize = 3;

/// The smallest square of what is missed that has a root with a slope.
const LEAST_SQUARE: f32 = 1e-6;

/// The last layer begins with so much less.
const TIMID: f32 = 0.1;

/// A layer.
#[derive(Module, Debug)]
struct Linear {
    weight: Param<Tensor<2>>,
    bias: Param<Tensor<1>>,
}

/// Layers, with the sigmoid linear unit between them.
#[derive(Module, Debug)]
struct Network {
    layers: Vec<Linear>,
}

/// What a network is fitted to.
#[derive(Clone, Copy)]
pub(super) struct Fit<'a> {
    /// Its inputs `[scene][number]`.
    pub(super) inputs: &'a [Vec<f32>],
    /// What it is to predict `[scene, shape]`, in metres.
    pub(super) shares: &'a Mat<f64>,
    /// The scenes that it learns from.
    pub(super) scenes: &'a [usize],
    /// Numbers of each layer in the middle.
    pub(super) hidden: usize,
    /// Times that each scene is seen.
    pub(super) passes: u32,
    /// Of the first weights and of the order of the scenes.
    pub(super) seed: u64,
}

impl Network {
    fn forward(&self, input: Tensor<2>) -> Tensor<2> {
        let mut values = input;
        for (number, layer) in self.layers.iter().enumerate() {
            if number > 0 {
                values = silu(values);
            }
            values = values.matmul(layer.weight.val()) + layer.bias.val().unsqueeze();
        }
        values
    }
}

impl Fit<'_> {
    /// Learns; the layers predict shares in metres. The loss is the distance of a scene from its
    /// prediction, not its square: most scenes, and those of sequences that were held out, came
    /// nearer by it. `go_on` is told the passes that are done and the mean of that distance over
    /// the root mean square of the shares.
    pub(super) fn learned(&self, go_on: &mut dyn FnMut(u32, f64) -> bool) -> Vec<Layer> {
        let (num_scenes, num_shapes) = (self.scenes.len(), self.shares.ncols());
        let num_inputs = self.inputs.first().map_or(0, Vec::len);
        let device = Device::flex().autodiff();
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        let mut sizes = vec![num_inputs];
        sizes.extend([self.hidden; HIDDEN_LAYERS]);
        sizes.push(num_shapes);
        let layers = sizes.windows(2).enumerate().map(|(depth, sizes)| {
            let timid = if depth == HIDDEN_LAYERS { TIMID } else { 1.0 };
            linear([sizes[0], sizes[1]], timid, &mut random, &device)
        });
        let mut network = Network {
            layers: layers.collect(),
        };
        // Of all scenes, whichever are learned from: it is a unit, not what they predict.
        let count = (self.inputs.len() * num_shapes).max(1) as f64;
        let unit = (self.shares.squared_norm_l2() / count)
            .sqrt()
            .max(f64::MIN_POSITIVE);
        let mut optimizer = AdamWConfig::new().with_weight_decay(DECAY).init();
        let root_of_shapes = (num_shapes.max(1) as f64).sqrt();
        let steps_a_pass = num_scenes.div_ceil(BATCH);
        let num_steps = steps_a_pass * self.passes as usize;
        let mut order = self.scenes.to_vec();
        let mut step = 0;
        for pass in 0..self.passes {
            order.shuffle(&mut random);
            let mut sum = 0.0;
            for scenes in order.chunks(BATCH) {
                let input = scenes.iter().flat_map(|&scene| &self.inputs[scene]);
                let input = TensorData::new(input.copied().collect(), [scenes.len(), num_inputs]);
                let target = scenes.iter().flat_map(|&scene| {
                    (0..num_shapes).map(move |shape| (self.shares[(scene, shape)] / unit) as f32)
                });
                let target: Vec<f32> = target.collect();
                let target = TensorData::new(target, [scenes.len(), num_shapes]);
                let missed = network.forward(Tensor::from_data(input, &device))
                    - Tensor::from_data(target, &device);
                let squares = (missed.clone() * missed).sum_dim(1);
                let loss = (squares + LEAST_SQUARE).sqrt().mean();
                sum += scenes.len() as f64 * f64::from(loss.clone().into_scalar::<f32>());
                let gradients = GradientsParams::from_grads(loss.backward(), &network);
                step += 1;
                network = optimizer.step(rate(step, num_steps), network, gradients);
            }
            let missed = sum / (num_scenes.max(1) as f64 * root_of_shapes);
            if !go_on(pass + 1, missed) {
                break;
            }
        }
        let mut layers: Vec<Layer> = (network.layers.iter())
            .map(|layer| Layer {
                weight: numbers(layer.weight.val().to_data()),
                bias: numbers(layer.bias.val().to_data()),
            })
            .collect();
        if let Some(Layer { weight, bias }) = layers.last_mut() {
            for number in weight.iter_mut().chain(bias) {
                *number *= unit as f32;
            }
        }
        layers
    }
}

/// The learning rate of a step, from 1.
fn rate(step: usize, num_steps: usize) -> f64 {
    let warm_up = WARM_UP.min(num_steps / 10).max(1);
    let rise = (step as f64 / warm_up as f64).min(1.0);
    let fall = 0.5 * (1.0 + (std::f64::consts::PI * step as f64 / num_steps.max(1) as f64).cos());
    RATE * rise * fall
}

/// Random weights that keep the variance.
fn linear(
    [inputs, outputs]: [usize; 2],
    timid: f32,
    random: &mut ChaCha8Rng,
    device: &Device,
) -> Linear {
    // Of the same variance as a normal distribution.
    let most = timid * (3.0 / inputs.max(1) as f32).sqrt();
    let weights = (0..inputs * outputs).map(|_| most * random.random_range(-1.0..1.0_f32));
    let weights = TensorData::new(weights.collect::<Vec<f32>>(), [inputs, outputs]);
    Linear {
        weight: Param::from_tensor(Tensor::from_data(weights, device)),
        bias: Param::from_tensor(Tensor::zeros([outputs], device)),
    }
}

fn numbers(data: TensorData) -> Vec<f32> {
    data.try_into_vec()
        .expect("networks compute in single precision")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_product_of_two_numbers_is_learned() {
        let at = |scene: usize| [(scene as f32 * 0.7).sin(), (scene as f32 * 1.3).cos()];
        let inputs: Vec<Vec<f32>> = (0..200).map(|scene| at(scene).to_vec()).collect();
        let shares = Mat::from_fn(200, 2, |scene, shape| {
            let [a, b] = at(scene).map(f64::from);
            0.01 * [a * b, a - b][shape]
        });
        let all: Vec<usize> = (0..200).collect();
        let fit = Fit {
            inputs: &inputs,
            shares: &shares,
            scenes: &all,
            hidden: 32,
            passes: 300,
            seed: 3,
        };
        let mut losses = Vec::new();
        let layers = fit.learned(&mut |_, loss| {
            losses.push(loss);
            true
        });
        assert_eq!(losses.len(), 300);
        assert!(losses[299] < 0.01, "{}", losses[299]);
        let sizes: Vec<_> = layers
            .iter()
            .map(|layer| (layer.num_inputs(), layer.bias.len()))
            .collect();
        assert_eq!(sizes, [(2, 32), (32, 32), (32, 32), (32, 2)]);
        // The same seed gives the same numbers, and a training that is stopped has layers, too.
        assert_eq!(layers, fit.learned(&mut |_, _| true));
        assert_eq!(fit.learned(&mut |_, _| false).len(), 4);
    }

    #[test]
    fn the_rate_rises_and_falls() {
        let rates: Vec<f64> = (1..=100).map(|step| rate(step, 100)).collect();
        assert!(rates[..10].is_sorted());
        assert!(rates[10..].is_sorted_by(|a, b| a >= b));
        assert!(rates[99] < 1e-12);
    }
}
