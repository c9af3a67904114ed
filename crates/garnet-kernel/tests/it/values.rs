//! Random inputs, and comparison of results.

use garnet_kernel::Adjacency;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Rounding in `f32`, relative to the largest value.
pub(crate) const ROUNDING: f64 = 1e-5;

/// A source of numbers.
pub(crate) struct Values(ChaCha8Rng);

impl Values {
    pub(crate) fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Numbers in `[-1, 1)`.
    pub(crate) fn numbers(&mut self, len: usize) -> Vec<f32> {
        (0..len)
            .map(|_| self.0.random_range(-1.0_f32..1.0))
            .collect()
    }

    pub(crate) fn indices(&mut self, len: usize, end: usize) -> Vec<u32> {
        (0..len)
            .map(|_| self.0.random_range(0..end as u32))
            .collect()
    }

    /// Some of the numbers below `end`, all if they are few.
    pub(crate) fn sample(&mut self, end: usize, at_most: usize) -> Vec<usize> {
        if end <= at_most {
            return (0..end).collect();
        }
        (0..at_most).map(|_| self.0.random_range(0..end)).collect()
    }

    /// A directed graph in which a third of the vertices see no one and the others up to nine at
    /// random.
    pub(crate) fn graph(&mut self, num_vertices: usize) -> Adjacency {
        let lists: Vec<Vec<u32>> = (0..num_vertices)
            .map(|vertex| {
                let degree = if vertex % 3 == 1 {
                    0
                } else {
                    self.0.random_range(0..10)
                };
                self.indices(degree, num_vertices)
            })
            .collect();
        Adjacency::from_lists(&lists).expect("indices are in range")
    }
}

/// Asserts that results agree, relative to the largest expected value.
#[track_caller]
pub(crate) fn assert_close(name: &str, found: &[f32], expected: &[f64], tolerance: f64) {
    let largest = expected.iter().map(|value| value.abs());
    assert_close_at(
        name,
        found,
        expected,
        tolerance * largest.fold(1e-3, f64::max),
    );
}

/// Asserts that results agree to an absolute tolerance.
#[track_caller]
pub(crate) fn assert_close_at(name: &str, found: &[f32], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{name}");
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        let error = (f64::from(*found) - expected).abs();
        assert!(
            error <= tolerance,
            "{name}[{i}]: {found} instead of {expected} (tolerance {tolerance})"
        );
    }
}

pub(crate) fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().map(|value| f64::from(*value)).collect()
}
