//! The mean of weights over the steps of a training.

use std::collections::BTreeMap;

use burn::module::{Module, ModuleMapper, ModuleVisitor, Param};
use burn::tensor::{Tensor, TensorData};
use garnet_net::GarNet;

/// The share of the past in a step: in the first steps there is little past.
pub(crate) fn share(asked: f64, step: u64) -> f64 {
    let step = step as f64;
    asked.min((1.0 + step) / (10.0 + step))
}

/// The mean moved towards the weights of a network, of which it keeps a share.
///
/// Source: *Polyak and Juditsky 1992*, with exponential weights.
pub(crate) fn moved(mean: GarNet, model: &GarNet, share: f64) -> GarNet {
    let mut weights = Weights::default();
    model.visit(&mut weights);
    mean.map(&mut Blend {
        weights: weights.0,
        share: share as f32,
    })
}

/// The numbers of each weight, by its own number.
#[derive(Default)]
struct Weights(BTreeMap<u64, Vec<f32>>);

impl ModuleVisitor for Weights {
    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        self.0.insert(param.id.val(), numbers(param.val()));
    }
}

struct Blend {
    weights: BTreeMap<u64, Vec<f32>>,
    share: f32,
}

impl ModuleMapper for Blend {
    fn map_float<const D: usize>(&mut self, param: Param<Tensor<D>>) -> Param<Tensor<D>> {
        let Some(new) = self.weights.get(&param.id.val()) else {
            return param;
        };
        let share = self.share;
        param.map(|mean| {
            let (shape, device) = (mean.dims(), mean.device());
            let pairs = numbers(mean).into_iter().zip(new);
            let blended = pairs.map(|(mean, new)| share * mean + (1.0 - share) * new);
            let data = TensorData::new(blended.collect::<Vec<f32>>(), shape);
            Tensor::from_data(data, &device)
        })
    }
}

fn numbers<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    (tensor.into_data().try_into_vec()).expect("networks compute in single precision")
}

#[cfg(test)]
mod tests {
    use burn::tensor::Device;
    use garnet_net::GarNetConfig;

    use super::*;

    #[test]
    fn a_mean_lies_between() {
        let config = GarNetConfig::preset("tiny").unwrap();
        let device = Device::flex().autodiff();
        let [old, new] = [1, 2].map(|seed| config.init(seed, &device).unwrap());
        let all = |model: &GarNet| {
            let mut weights = Weights::default();
            model.visit(&mut weights);
            weights.0
        };
        let (before, after) = (all(&old), all(&new));
        let found = all(&moved(old, &new, 0.75));
        assert_eq!(found.len(), before.len());
        for (id, found) in &found {
            for ((found, before), after) in found.iter().zip(&before[id]).zip(&after[id]) {
                assert!((found - (0.75 * before + 0.25 * after)).abs() < 1e-6);
            }
        }
        assert!(share(0.999, 0) < 0.2 && (share(0.999, 100_000) - 0.999).abs() < 1e-12);
    }
}
