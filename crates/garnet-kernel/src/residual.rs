//! Sum of two branches with activation: `y = act(a + b)`.

use rayon::prelude::*;

use crate::{Activation, check};

/// Values a task.
const CHUNK: usize = 16_384;

/// Writes `act(a + b)` to `y`; all have the same length.
///
/// # Panics
///
/// Panics if the lengths differ.
pub fn add_forward(a: &[f32], b: &[f32], activation: Activation, y: &mut [f32]) {
    check::shape("a", a, 1, y.len());
    check::shape("b", b, 1, y.len());
    let inputs = a.par_chunks(CHUNK).zip(b.par_chunks(CHUNK));
    y.par_chunks_mut(CHUNK).zip(inputs).for_each(|(y, (a, b))| {
        y.iter_mut()
            .zip(a)
            .zip(b)
            .for_each(|((y, a), b)| *y = a + b);
        activation.apply(y);
    });
}

/// Writes to `d_sum` the gradient of what the activation was applied to, from its output `y` and
/// gradient `dy`.
///
/// It is the gradient of both summands of [`add_forward`].
///
/// # Panics
///
/// Panics if the lengths differ.
pub fn add_backward(y: &[f32], dy: &[f32], activation: Activation, d_sum: &mut [f32]) {
    check::shape("y", y, 1, d_sum.len());
    check::shape("dy", dy, 1, d_sum.len());
    let inputs = y.par_chunks(CHUNK).zip(dy.par_chunks(CHUNK));
    d_sum
        .par_chunks_mut(CHUNK)
        .zip(inputs)
        .for_each(|(d_sum, (y, dy))| {
            activation.gradient(y, dy, d_sum);
        });
}
