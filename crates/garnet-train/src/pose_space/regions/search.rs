//! How much each feature tells of a region.

use faer::Mat;
use garnet_net::pose_space::Features;
use rayon::prelude::*;

use super::super::regression::Regression;
use super::super::relevance::{GROWTH, LEAST_SPREAD, RIDGE, SHRINKING, STEP, TURN, mean_root};
use super::super::scenes::together;
use super::{Sample, is_turn};

/// Features without which the error is no larger than this times the least are left out in the end.
const LEAST_WORTH: f64 = 1.0002;

/// What is searched among.
pub(super) struct Search<'a> {
    pub(super) features: &'a Features,
    /// The feature of each number.
    pub(super) owners: &'a [usize],
    pub(super) samples: &'a [Sample],
    /// The samples that are looked at.
    pub(super) searched: &'a [usize],
    /// The numbers of the features of each sample.
    pub(super) numbers: &'a [Vec<f32>],
}

impl Search<'_> {
    /// What to multiply the numbers of each feature by `[feature]`, so that a Gaussian process
    /// misses bodies and sequences that are left out least; zero for those that make no difference.
    ///
    /// `shares` `[sample, shape]`; `go_on` is told the rounds that are done and the error, in units
    /// of the shares.
    pub(super) fn found(
        &self,
        shares: &Mat<f64>,
        shapes: usize,
        rounds: u32,
        go_on: &mut dyn FnMut(u32, f64) -> bool,
    ) -> Vec<f64> {
        let shapes = shapes.min(shares.ncols());
        let shares = Mat::from_fn(self.searched.len(), shapes, |row, shape| {
            shares[(self.searched[row], shape)]
        });
        let keys: Vec<_> = (self.searched.iter())
            .map(|&sample| {
                let Sample { body, sequence, .. } = &self.samples[sample];
                (*body, sequence.as_str())
            })
            .collect();
        let apart = self.apart();
        let count = apart.len();
        let units = self.features.all.iter();
        let units = units.map(|&feature| if is_turn(feature) { TURN } else { GROWTH });
        let mut factors = vec![0.0; count + 2];
        factors[count + 1] = RIDGE.ln();
        for (factor, apart) in factors.iter_mut().zip(&apart) {
            if apart.is_none() {
                *factor = f64::NEG_INFINITY;
            }
        }
        let mut state = State {
            units: units.collect(),
            with: together(&keys),
            squared: Mat::zeros(keys.len(), keys.len()),
            apart,
            shares,
            factors,
            least: f64::INFINITY,
        };
        state.begin();
        let mut step = STEP;
        let mut round = 0;
        while state.least.is_finite() && go_on(round, state.least) && round < rounds {
            for number in 0..count + 2 {
                let _is_nearer = state.is_nearer(number, step) || state.is_nearer(number, -step);
            }
            step *= SHRINKING;
            round += 1;
        }
        for feature in 0..count {
            state.leave_out(feature);
        }
        (0..count).map(|feature| state.scale(feature)).collect()
    }

    /// The squared distances of samples in each feature `[feature]` `[sample, sample]`; none where
    /// it never changes.
    fn apart(&self) -> Vec<Option<Mat<f64>>> {
        let features = 0..self.features.all.len();
        let of_feature = |feature: usize| {
            let numbers = (0..self.owners.len()).filter(|&number| self.owners[number] == feature);
            let numbers: Vec<usize> = numbers.collect();
            let at = |row: usize, number: usize| self.numbers[self.searched[row]][number];
            let count = self.searched.len();
            let squared = Mat::from_fn(count, count, |row, column| {
                let difference = |&number: &usize| f64::from(at(row, number) - at(column, number));
                numbers.iter().map(difference).map(|d| d * d).sum()
            });
            let most: f64 = squared.norm_max();
            (most.sqrt() > f64::from(LEAST_SPREAD)).then_some(squared)
        };
        features.into_par_iter().map(of_feature).collect()
    }
}

/// Where a search has come to.
struct State {
    /// See [`Search::apart`].
    apart: Vec<Option<Mat<f64>>>,
    /// What each feature is multiplied by before the search `[feature]`.
    units: Vec<f64>,
    /// What is to be told `[sample, shape]`.
    shares: Mat<f64>,
    /// See [`together`].
    with: Vec<Vec<usize>>,
    /// Logarithms of the factors of the features, of all of them alike, and of the ridge.
    factors: Vec<f64>,
    /// Squared distances, without the factor of all features.
    squared: Mat<f64>,
    least: f64,
}

impl State {
    fn begin(&mut self) {
        for (feature, apart) in self.apart.iter().enumerate() {
            if let Some(apart) = apart {
                self.squared += faer::Scale(self.square(feature)) * apart;
            }
        }
        self.least = self.error(&self.squared).unwrap_or(f64::INFINITY);
    }

    /// What a feature is multiplied by.
    fn scale(&self, feature: usize) -> f64 {
        self.units[feature] * (self.factors[feature] + self.factors[self.units.len()]).exp()
    }

    /// The square of the same without the factor of all features.
    fn square(&self, feature: usize) -> f64 {
        (self.units[feature] * self.factors[feature].exp()).powi(2)
    }

    /// By how much bodies and sequences are missed that are left out.
    fn error(&self, squared: &Mat<f64>) -> Option<f64> {
        let count = self.units.len();
        let squared = faer::Scale((2.0 * self.factors[count]).exp()) * squared;
        let ridge = self.factors[count + 1].exp();
        let found = Regression::of_distances(&squared, &self.shares, ridge);
        let missed = found.map(|found| mean_root(&found.left_out(&self.with)));
        missed.filter(|missed| missed.is_finite())
    }

    /// Changes a factor if that is nearer.
    fn is_nearer(&mut self, number: usize, change: f64) -> bool {
        let before = self.factors[number];
        if before == f64::NEG_INFINITY {
            return false;
        }
        let old = (number < self.units.len()).then(|| self.square(number));
        self.factors[number] = before + change;
        let known = self.apart.get(number).and_then(Option::as_ref);
        let moved = known.zip(old).map(|(apart, old)| {
            let more = self.square(number) - old;
            &self.squared + faer::Scale(more) * apart
        });
        match self.error(moved.as_ref().unwrap_or(&self.squared)) {
            Some(found) if found < self.least => {
                self.least = found;
                if let Some(moved) = moved {
                    self.squared = moved;
                }
                true
            }
            _ => {
                self.factors[number] = before;
                false
            }
        }
    }

    /// Leaves a feature out if it makes no difference.
    fn leave_out(&mut self, feature: usize) {
        let Some(apart) = &self.apart[feature] else {
            return;
        };
        let without = &self.squared - faer::Scale(self.square(feature)) * apart;
        if let Some(found) = self.error(&without)
            && found < LEAST_WORTH * self.least
        {
            self.least = self.least.max(found);
            self.factors[feature] = f64::NEG_INFINITY;
            self.squared = without;
        }
    }
}

#[cfg(test)]
mod tests {
    use garnet_net::pose_space::{Aspect, Feature};

    use super::*;

    #[test]
    fn what_tells_nothing_is_left_out() {
        let aspects = [Aspect::Up, Aspect::Shape, Aspect::Turn];
        let features = Features {
            parents: vec![None],
            hub: 0,
            all: aspects.map(|aspect| Feature { joint: 0, aspect }).to_vec(),
            cuts: None,
        };
        // Numbers of the first feature tell the share, those of the second are noise, those of the
        // third never change.
        let number = |scene: usize, of: usize| ((scene * (7 * of + 3)) as f32 * 0.37).sin();
        let row = |scene: usize| -> Vec<f32> {
            let told = (0..7).map(|of| number(scene, of) * if of < 3 { 10.0 } else { 0.5 });
            told.chain([1.0; 6]).collect()
        };
        let numbers: Vec<Vec<f32>> = (0..60).map(row).collect();
        let samples: Vec<Sample> = (0..60)
            .map(|scene| Sample {
                body: (0, scene),
                sequence: scene.to_string(),
                parameters: Vec::new(),
                cut: [0.0; 3],
                offsets: Vec::new(),
            })
            .collect();
        let shares = Mat::from_fn(60, 1, |scene, _| {
            f64::from(numbers[scene][0] + 0.5 * numbers[scene][2])
        });
        let searched: Vec<usize> = (0..60).collect();
        let search = Search {
            owners: &features.owners(),
            features: &features,
            samples: &samples,
            searched: &searched,
            numbers: &numbers,
        };
        let mut errors = Vec::new();
        let found = search.found(&shares, 48, 4, &mut |_, error| {
            errors.push(error);
            true
        });
        assert_eq!(errors.len(), 5);
        assert!(errors.is_sorted_by(|a, b| a >= b), "{errors:?}");
        assert!(errors[4] < 0.2 * errors[0], "{errors:?}");
        assert!(found[0] > 0.0, "{found:?}");
        assert!(found[1] < 0.2 * GROWTH, "{found:?}");
        assert_eq!(found[2].to_bits(), 0.0_f64.to_bits());
    }
}
