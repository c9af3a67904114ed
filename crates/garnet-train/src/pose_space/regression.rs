//! Interpolation between scenes.

use std::ops::Range;

use faer::linalg::solvers::{DenseSolveCore, Solve};
use faer::{Mat, Side};
use garnet_net::pose_space::covariance;

/// A Gaussian process of some scenes.
///
/// Source: *Rasmussen and Williams 2006, equations 2.25 and 5.10 to 5.12*.
pub(super) struct Regression {
    /// Of the covariances with the ridge on the diagonal `[scene, scene]`.
    inverse: Mat<f64>,
    /// `[scene, share]`.
    weights: Mat<f64>,
}

impl Regression {
    /// Of places `[scene, number]` and what is known there `[scene, share]`; none if the ridge is too
    /// small for the precision of numbers.
    pub(super) fn new(places: &Mat<f64>, shares: &Mat<f64>, ridge: f64) -> Option<Self> {
        let products = places * places.transpose();
        let count = places.nrows();
        let covariances = Mat::<f64>::from_fn(count, count, |a, b| {
            let squared = products[(a, a)] + products[(b, b)] - 2.0 * products[(a, b)];
            covariance(squared.max(0.0)) + if a == b { ridge } else { 0.0 }
        });
        let inverse = covariances.llt(Side::Lower).ok()?.inverse();
        Some(Self {
            weights: &inverse * shares,
            inverse,
        })
    }

    /// The same with as much more of a ridge as it takes, and what that is.
    pub(super) fn surely(places: &Mat<f64>, shares: &Mat<f64>, ridge: f64) -> (Self, f64) {
        let mut ridge = ridge.max(f64::EPSILON);
        loop {
            if let Some(found) = Self::new(places, shares, ridge) {
                return (found, ridge);
            }
            ridge *= 10.0;
        }
    }

    /// `[scene, share]`.
    pub(super) fn weights(&self) -> &Mat<f64> {
        &self.weights
    }

    /// By how much each scene is missed by a regression of all but the scenes of its body
    /// `[scene, share]`.
    pub(super) fn left_out(&self, bodies: &[Range<usize>]) -> Mat<f64> {
        let mut errors = Mat::zeros(self.weights.nrows(), self.weights.ncols());
        for body in bodies {
            let block = self
                .inverse
                .submatrix(body.start, body.start, body.len(), body.len());
            let weights = self.weights.subrows(body.start, body.len()).to_owned();
            let found = block.partial_piv_lu().solve(&weights);
            errors.subrows_mut(body.start, body.len()).copy_from(&found);
        }
        errors
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> (Mat<f64>, Mat<f64>) {
        let places = Mat::from_fn(9, 2, |row, column| ((row * (column + 3)) as f64).sin());
        let shares = Mat::from_fn(9, 2, |row, column| {
            (2.0 * places[(row, 0)]).sin() + column as f64 * places[(row, 1)]
        });
        (places, shares)
    }

    fn predicted(places: &Mat<f64>, weights: &Mat<f64>, at: [f64; 2], share: usize) -> f64 {
        let rows = (0..places.nrows()).map(|row| {
            let apart = [places[(row, 0)] - at[0], places[(row, 1)] - at[1]];
            covariance(apart[0] * apart[0] + apart[1] * apart[1]) * weights[(row, share)]
        });
        rows.sum()
    }

    #[test]
    fn what_is_left_out_is_as_if_it_had_never_been_there() {
        let (places, shares) = sample();
        let all = Regression::new(&places, &shares, 1e-2).unwrap();
        let errors = all.left_out(&[0..3, 3..4, 4..9]);
        let others = [0, 1, 2, 4, 5, 6, 7, 8];
        let without = |matrix: &Mat<f64>| {
            Mat::from_fn(others.len(), 2, |row, column| matrix[(others[row], column)])
        };
        let rest = Regression::new(&without(&places), &without(&shares), 1e-2).unwrap();
        for share in 0..2 {
            let at = [places[(3, 0)], places[(3, 1)]];
            let found = predicted(&without(&places), rest.weights(), at, share);
            let expected = shares[(3, share)] - found;
            assert!((errors[(3, share)] - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn a_small_ridge_meets_what_is_known() {
        let (places, shares) = sample();
        let all = Regression::new(&places, &shares, 1e-9).unwrap();
        let at = [places[(5, 0)], places[(5, 1)]];
        let found = predicted(&places, all.weights(), at, 1);
        assert!((found - shares[(5, 1)]).abs() < 1e-6);
    }

    #[test]
    fn scenes_that_are_the_same_need_a_ridge() {
        let places = Mat::zeros(4, 1);
        let shares = Mat::from_fn(4, 1, |row, _| row as f64);
        let (found, _) = Regression::surely(&places, &shares, 0.0);
        assert!(found.weights()[(0, 0)].is_finite());
    }
}
