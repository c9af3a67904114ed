//! Interpolation between scenes.

use faer::linalg::solvers::{DenseSolveCore, Solve};
use faer::{Mat, MatRef, Side};
use garnet_net::pose_space::covariance;
use rayon::prelude::*;

/// Where scenes are among all `[scene, number]`, and where their mirror images are.
pub(super) struct Places {
    pub(super) own: Mat<f64>,
    pub(super) mirrored: Option<Mat<f64>>,
}

/// A Gaussian process of some scenes and of their mirror images.
///
/// Shares of shapes that are the same in the mirror, and of those that change their sign, are told
/// by the sum and by the difference of the covariances with scenes and with mirror images: a scene
/// and its image have one weight.
///
/// Source: *Rasmussen and Williams 2006, equations 2.25 and 5.10 to 5.12*.
pub(super) struct Regression {
    /// `[scene, share]`.
    weights: Mat<f64>,
    /// For each parity the shares that have it, and the inverse of the covariances with the ridge
    /// on the diagonal `[scene, scene]`.
    inverses: Vec<(Vec<usize>, Mat<f64>)>,
}

impl Regression {
    /// Of places and what is known there `[scene, share]`, with the parity of each share; none if
    /// the ridge is too small for the precision of numbers.
    pub(super) fn new(
        places: &Places,
        shares: &Mat<f64>,
        parity: &[f32],
        ridge: f64,
    ) -> Option<Self> {
        let own = covariances(&places.own, &places.own);
        let images = (places.mirrored.as_ref()).map(|images| covariances(&places.own, images));
        Self::of_covariances(&own, images.as_ref(), shares, parity, ridge)
    }

    /// The same without mirror images, of the squared distances between places `[scene, scene]`.
    pub(super) fn of_distances(squared: &Mat<f64>, shares: &Mat<f64>, ridge: f64) -> Option<Self> {
        let count = squared.nrows();
        let columns = (0..count).into_par_iter().flat_map_iter(|column| {
            let squared = squared.col(column).iter();
            squared.map(|&squared| covariance(squared))
        });
        let alike: Vec<f64> = columns.collect();
        let own = MatRef::from_column_major_slice(&alike, count, count).to_owned();
        Self::of_covariances(&own, None, shares, &vec![1.0; shares.ncols()], ridge)
    }

    fn of_covariances(
        own: &Mat<f64>,
        images: Option<&Mat<f64>>,
        shares: &Mat<f64>,
        parity: &[f32],
        ridge: f64,
    ) -> Option<Self> {
        let count = shares.nrows();
        let mut weights = Mat::zeros(count, shares.ncols());
        let mut inverses = Vec::new();
        for sign in [1.0, -1.0] {
            let of_sign = (0..shares.ncols()).filter(|&share| parity[share] * sign > 0.0);
            let of_sign: Vec<usize> = of_sign.collect();
            if of_sign.is_empty() {
                continue;
            }
            let mut matrix = own.clone();
            if let Some(images) = images {
                // Rounding leaves a matrix that should be symmetric nearly so.
                matrix += faer::Scale(0.5 * f64::from(sign)) * (images + images.transpose());
            }
            for scene in 0..count {
                matrix[(scene, scene)] += ridge;
            }
            let inverse = matrix.llt(Side::Lower).ok()?.inverse();
            let known = Mat::from_fn(count, of_sign.len(), |row, column| {
                shares[(row, of_sign[column])]
            });
            let found = &inverse * &known;
            for (column, &share) in of_sign.iter().enumerate() {
                weights.col_mut(share).copy_from(found.col(column));
            }
            inverses.push((of_sign, inverse));
        }
        Some(Self { weights, inverses })
    }

    /// The same with as much more of a ridge as it takes, and what that is.
    pub(super) fn surely(
        places: &Places,
        shares: &Mat<f64>,
        parity: &[f32],
        ridge: f64,
    ) -> (Self, f64) {
        let mut ridge = ridge.max(f64::EPSILON);
        loop {
            if let Some(found) = Self::new(places, shares, parity, ridge) {
                return (found, ridge);
            }
            ridge *= 10.0;
        }
    }

    /// `[scene, share]`.
    pub(super) fn weights(&self) -> &Mat<f64> {
        &self.weights
    }

    /// By how much each scene is missed by a regression of all scenes but those that it is left out
    /// with `[scene, share]`; `with` `[scene][scenes]` has the scene itself among them.
    ///
    /// A block of the inverse, inverted, is the covariance of what the others do not tell of it.
    pub(super) fn left_out(&self, with: &[Vec<usize>]) -> Mat<f64> {
        let mut errors = Mat::zeros(self.weights.nrows(), self.weights.ncols());
        for (shares, inverse) in &self.inverses {
            let missed = |(scene, with): (usize, &Vec<usize>)| -> Vec<f64> {
                let count = with.len();
                let block = Mat::from_fn(count, count, |row, column| {
                    inverse[(with[row], with[column])]
                });
                let unit = Mat::from_fn(count, 1, |row, _| f64::from(u8::from(with[row] == scene)));
                let column = block.partial_piv_lu().solve(&unit);
                let product = |&share: &usize| -> f64 {
                    let rows = with.iter().enumerate();
                    rows.map(|(row, &other)| column[(row, 0)] * self.weights[(other, share)])
                        .sum()
                };
                shares.iter().map(product).collect()
            };
            let rows: Vec<Vec<f64>> = with.par_iter().enumerate().map(missed).collect();
            for (scene, row) in rows.iter().enumerate() {
                for (&share, missed) in shares.iter().zip(row) {
                    errors[(scene, share)] = *missed;
                }
            }
        }
        errors
    }
}

/// How alike places of two sets are `[first, second]`.
fn covariances(first: &Mat<f64>, second: &Mat<f64>) -> Mat<f64> {
    let squares = |places: &Mat<f64>| -> Vec<f64> {
        let rows = 0..places.nrows();
        rows.map(|row| places.row(row).squared_norm_l2()).collect()
    };
    let (of_first, of_second) = (squares(first), squares(second));
    let products = first * second.transpose();
    let columns = of_second.par_iter().enumerate();
    let alike = columns.flat_map_iter(|(column, of_second)| {
        let products = products.col(column).iter().zip(&of_first);
        products.map(move |(product, of_first)| {
            covariance((of_first + of_second - 2.0 * product).max(0.0))
        })
    });
    let alike: Vec<f64> = alike.collect();
    MatRef::from_column_major_slice(&alike, first.nrows(), second.nrows()).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVEN: [f32; 2] = [1.0, 1.0];

    fn sample() -> (Places, Mat<f64>) {
        let own = Mat::from_fn(9, 2, |row, column| ((row * (column + 3)) as f64).sin());
        let shares = Mat::from_fn(9, 2, |row, column| {
            (2.0 * own[(row, 0)]).sin() + column as f64 * own[(row, 1)]
        });
        let mirrored = None;
        (Places { own, mirrored }, shares)
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
        let all = Regression::new(&places, &shares, &EVEN, 1e-2).unwrap();
        let mut with: Vec<Vec<usize>> = (0..9).map(|scene| vec![scene]).collect();
        with[3] = vec![1, 3, 8];
        let errors = all.left_out(&with);
        let others = [0, 2, 4, 5, 6, 7];
        let without = |matrix: &Mat<f64>| {
            Mat::from_fn(others.len(), 2, |row, column| matrix[(others[row], column)])
        };
        let own = without(&places.own);
        let others = Places {
            own: own.clone(),
            mirrored: None,
        };
        let rest = Regression::new(&others, &without(&shares), &EVEN, 1e-2).unwrap();
        for share in 0..2 {
            let at = [places.own[(3, 0)], places.own[(3, 1)]];
            let found = predicted(&own, rest.weights(), at, share);
            let expected = shares[(3, share)] - found;
            assert!((errors[(3, share)] - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn a_small_ridge_meets_what_is_known() {
        let (places, shares) = sample();
        let all = Regression::new(&places, &shares, &EVEN, 1e-9).unwrap();
        let at = [places.own[(5, 0)], places.own[(5, 1)]];
        let found = predicted(&places.own, all.weights(), at, 1);
        assert!((found - shares[(5, 1)]).abs() < 1e-6);
    }

    #[test]
    fn scenes_that_are_the_same_need_a_ridge() {
        let places = Places {
            own: Mat::zeros(4, 1),
            mirrored: None,
        };
        let shares = Mat::from_fn(4, 1, |row, _| row as f64);
        let (found, _) = Regression::surely(&places, &shares, &[1.0], 0.0);
        assert!(found.weights()[(0, 0)].is_finite());
    }

    #[test]
    fn a_mirror_is_as_good_as_all_scenes_twice() {
        let (Places { own, .. }, shares) = sample();
        // The second number and the second share change their signs.
        let flip = |matrix: &Mat<f64>| {
            Mat::from_fn(9, 2, |row, column| {
                matrix[(row, column)] * [1.0, -1.0][column]
            })
        };
        let both = |a: &Mat<f64>, b: &Mat<f64>| {
            Mat::from_fn(18, 2, |row, column| match row {
                0..9 => a[(row, column)],
                _ => b[(row - 9, column)],
            })
        };
        let twice = Places {
            own: both(&own, &flip(&own)),
            mirrored: None,
        };
        let doubled = both(&shares, &flip(&shares));
        let twice = Regression::new(&twice, &doubled, &EVEN, 1e-2).unwrap();
        let once = Places {
            mirrored: Some(flip(&own)),
            own,
        };
        let once = Regression::new(&once, &shares, &[1.0, -1.0], 1e-2).unwrap();
        for scene in 0..9 {
            for share in 0..2 {
                let (a, b) = (
                    once.weights()[(scene, share)],
                    twice.weights()[(scene, share)],
                );
                assert!((a - b).abs() < 1e-9 * a.abs().max(1.0), "{a} {b}");
            }
        }
        let with: Vec<Vec<usize>> = (0..9).map(|scene| vec![scene]).collect();
        let images: Vec<Vec<usize>> = (0..18)
            .map(|scene| vec![scene % 9, scene % 9 + 9])
            .collect();
        let (once, twice) = (once.left_out(&with), twice.left_out(&images));
        for scene in 0..9 {
            for share in 0..2 {
                assert!((once[(scene, share)] - twice[(scene, share)]).abs() < 1e-9);
            }
        }
    }
}
