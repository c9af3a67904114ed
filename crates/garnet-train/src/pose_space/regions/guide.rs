//! What the guide of a region tells.

use garnet_net::pose_space::{Aspect, Feature, Features};

use super::super::relevance::{GROWTH, TURN};

/// Shares of the guide are told apart by relevance in groups that end before these shapes, and at the last one.
const ENDS: [usize; 5] = [4, 12, 28, 48, usize::MAX];

/// What they are multiplied by before the search, once all of a group have a mean square of one.
const UNIT: f64 = 0.3;

/// The shares that guides have of the shapes of a region.
pub(super) struct Guided<'a> {
    /// `[scene][shape]`, in metres.
    shares: &'a [Vec<f32>],
    /// The group of each shape.
    groups: Vec<usize>,
    /// What the shares of a group are divided by `[group]`.
    spreads: Vec<f32>,
}

impl<'a> Guided<'a> {
    pub(super) fn new(shares: &'a [Vec<f32>]) -> Self {
        let num_shapes = shares.first().map_or(0, Vec::len);
        let group = |shape: usize| ENDS.iter().position(|&end| shape < end);
        let groups: Vec<usize> = (0..num_shapes).filter_map(group).collect();
        let spread = |of: usize| {
            let shapes = (0..groups.len()).filter(|&shape| groups[shape] == of);
            let shapes: Vec<usize> = shapes.collect();
            let squares = shares
                .iter()
                .flat_map(|shares| shapes.iter().map(|&shape| shares[shape]));
            let sum: f64 = squares.map(|share| f64::from(share * share)).sum();
            ((sum / shares.len().max(1) as f64).sqrt() as f32).max(f32::MIN_POSITIVE)
        };
        let num_groups = groups.last().map_or(0, |last| last + 1);
        Self {
            shares,
            spreads: (0..num_groups).map(spread).collect(),
            groups,
        }
    }

    /// The numbers of the features, and those of the guide after them `[scene][number]`.
    pub(super) fn beside(&self, numbers: &[Vec<f32>]) -> Vec<Vec<f32>> {
        let mut all = numbers.to_vec();
        for (numbers, shares) in all.iter_mut().zip(self.shares) {
            let told = self.groups.iter().zip(shares);
            numbers.extend(told.map(|(&group, share)| share / self.spreads[group]));
        }
        all
    }

    /// The feature, or the group after them, of each of these numbers.
    pub(super) fn owners(&self, of_features: &[usize], num_features: usize) -> Vec<usize> {
        let groups = self.groups.iter().map(|group| num_features + group);
        of_features.iter().copied().chain(groups).collect()
    }

    /// What the numbers of features, and of groups after them, are multiplied by before the search.
    pub(super) fn units(&self, features: &Features) -> Vec<f64> {
        let unit = |&Feature { aspect, .. }: &Feature| match aspect {
            Aspect::Shape => GROWTH,
            Aspect::Turn | Aspect::AgainstHub | Aspect::Up => TURN,
        };
        let groups = self.spreads.iter().map(|_| UNIT);
        features.all.iter().map(unit).chain(groups).collect()
    }

    /// What the shares of the guide are multiplied by before the network is told them `[shape]`, by the relevance of each
    /// group.
    pub(super) fn scales(&self, relevance: &[f64], gain: f64) -> Vec<f32> {
        let scale = |shape: usize| {
            let group = self.groups[shape];
            (gain * relevance[group]) as f32 / self.spreads[group]
        };
        (0..self.groups.len()).map(scale).collect()
    }
}
