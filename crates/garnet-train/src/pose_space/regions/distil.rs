//! The mean of several networks, distilled into one (*Hinton, Vinyals and Dean 2015*).
//!
//! Networks that begin with other weights miss sequences of poses that no scene has in other ways,
//! and their mean misses less than each. One network learns that mean, at the scenes and between
//! them, where no scene was simulated.

use faer::Mat;
use garnet_net::pose_space::{Layer, predicted};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::super::PoseSpaceConfig;
use super::network::Fit;

/// Places between two scenes, for each scene: more cost as many times the time of the last network.
const BETWEEN: usize = 2;

/// Passes of the last network, as a share of those of the others: it has more places to see.
const SHARE_OF_PASSES: f64 = 0.5;

/// Passes over all networks.
pub(super) fn passes(asked: &PoseSpaceConfig) -> u32 {
    match asked.ensemble {
        0 | 1 => asked.passes,
        count => count * asked.passes + last(asked.passes),
    }
}

fn last(passes: u32) -> u32 {
    ((f64::from(passes) * SHARE_OF_PASSES) as u32).max(1)
}

/// One network, or that of the mean of several.
pub(super) fn learned(
    fit: &Fit<'_>,
    asked: &PoseSpaceConfig,
    go_on: &mut dyn FnMut(u32, f64) -> bool,
) -> Vec<Layer> {
    if asked.ensemble < 2 {
        return fit.learned(go_on);
    }
    let mut networks: Vec<Vec<Layer>> = Vec::new();
    for number in 0..asked.ensemble {
        let member = Fit {
            seed: fit.seed.wrapping_add(u64::from(number) << 48),
            ..*fit
        };
        let before = number * fit.passes;
        networks.push(member.learned(&mut |pass, loss| go_on(before + pass, loss)));
    }
    let inputs = with_places_between(fit.inputs, fit.scenes, fit.seed);
    let means: Vec<Vec<f32>> = inputs.iter().map(|input| mean(&networks, input)).collect();
    let shares = Mat::from_fn(inputs.len(), fit.shares.ncols(), |row, shape| {
        f64::from(means[row][shape])
    });
    let last = Fit {
        inputs: &inputs,
        shares: &shares,
        scenes: &(0..inputs.len()).collect::<Vec<usize>>(),
        passes: last(fit.passes),
        ..*fit
    };
    let before = asked.ensemble * fit.passes;
    last.learned(&mut |pass, loss| go_on(before + pass, loss))
}

/// What networks predict in the mean.
fn mean(networks: &[Vec<Layer>], input: &[f32]) -> Vec<f32> {
    let mut sum: Vec<f32> = Vec::new();
    for layers in networks {
        let shares = predicted(layers, input.to_vec());
        sum.resize(shares.len(), 0.0);
        for (sum, share) in sum.iter_mut().zip(shares) {
            *sum += share / networks.len() as f32;
        }
    }
    sum
}

/// The inputs of the scenes, and some between two of them.
fn with_places_between(inputs: &[Vec<f32>], scenes: &[usize], seed: u64) -> Vec<Vec<f32>> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut all: Vec<Vec<f32>> = scenes.iter().map(|&scene| inputs[scene].clone()).collect();
    for _ in 0..BETWEEN {
        for &scene in scenes {
            let other = &inputs[scenes[random.random_range(0..scenes.len())]];
            let share: f32 = random.random_range(0.0..1.0);
            let pairs = inputs[scene].iter().zip(other);
            all.push(pairs.map(|(a, b)| a + share * (b - a)).collect());
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_network_has_the_mean_of_several() {
        let inputs: Vec<Vec<f32>> = (0..120)
            .map(|scene| vec![(scene as f32 * 0.7).sin(), (scene as f32 * 1.3).cos()])
            .collect();
        let shares = Mat::from_fn(120, 1, |scene, _| 0.01 * f64::from(inputs[scene][0]));
        let fit = Fit {
            inputs: &inputs,
            shares: &shares,
            scenes: &(0..120).collect::<Vec<usize>>(),
            hidden: 16,
            passes: 300,
            seed: 5,
        };
        let asked = PoseSpaceConfig {
            ensemble: 3,
            passes: 300,
            ..PoseSpaceConfig::default()
        };
        let mut seen = Vec::new();
        let layers = learned(&fit, &asked, &mut |pass, _| {
            seen.push(pass);
            true
        });
        assert!(seen.iter().copied().eq(1..=passes(&asked)), "{seen:?}");
        let missed = inputs
            .iter()
            .map(|input| (predicted(&layers, input.clone())[0] - 0.01 * input[0]).abs());
        assert!(missed.fold(0.0, f32::max) < 1e-3);
    }

    #[test]
    fn places_lie_between_scenes_that_are_learned_from() {
        let inputs: Vec<Vec<f32>> = (0..10).map(|scene| vec![scene as f32]).collect();
        let all = with_places_between(&inputs, &[2, 4, 5], 1);
        assert_eq!(all.len(), 3 * (1 + BETWEEN));
        assert!(all.iter().all(|place| (2.0..=5.0).contains(&place[0])));
    }
}
