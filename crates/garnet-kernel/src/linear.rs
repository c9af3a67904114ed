//! Linear layers with bias and activation: `y = act(b + Σ_k x_k W_k)`.
//!
//! The input may come in parts that are never concatenated. A part that is the same for all rows (a
//! global feature) is multiplied once and joins the bias.

use rayon::prelude::*;

use crate::matmul::{MatrixMut, MatrixRef};
use crate::{Activation, Features, Workspace, check};

/// Rows a tile: its outputs stay in L2 until they are activated.
pub(crate) const TILE_ROWS: usize = 256;

/// A part of the input of a linear layer.
#[derive(Debug, Clone, Copy)]
pub enum LinearInput<'a> {
    /// One vector a row, `[rows, channels]`.
    PerRow(Features<'a>),
    /// One vector for all rows, `[channels]`.
    Broadcast(&'a [f32]),
}

impl LinearInput<'_> {
    /// Number of input channels.
    pub fn channels(&self) -> usize {
        match self {
            Self::PerRow(part) => part.channels,
            Self::Broadcast(vector) => vector.len(),
        }
    }
}

/// Weights of a linear layer.
#[derive(Debug, Clone, Copy)]
pub struct LinearLayer<'a> {
    /// Number of output channels.
    pub out_channels: usize,
    /// Weights, `[in_channels, out_channels]`: the rows are the input channels of all parts in
    /// turn.
    pub w: &'a [f32],
    /// Bias, `[out_channels]`; absent means zero.
    pub b: Option<&'a [f32]>,
    /// What is done to the sums.
    pub activation: Activation,
}

impl LinearLayer<'_> {
    /// Asserts that layer, parts and number of rows fit.
    #[track_caller]
    pub(crate) fn check(&self, parts: &[LinearInput<'_>], rows: usize) {
        assert!(
            self.out_channels > 0,
            "a linear layer needs one output channel at least"
        );
        let in_channels = parts.iter().map(LinearInput::channels).sum();
        check::shape("w", self.w, in_channels, self.out_channels);
        if let Some(b) = self.b {
            check::shape("b", b, 1, self.out_channels);
        }
        for part in parts {
            if let LinearInput::PerRow(part) = part {
                part.check("part of the input", rows);
            }
        }
    }

    /// The parts, each with its rows of `w`.
    pub(crate) fn parts<'a>(
        &'a self,
        parts: &'a [LinearInput<'a>],
    ) -> impl Iterator<Item = (&'a LinearInput<'a>, MatrixRef<'a>)> {
        let mut first = 0;
        parts.iter().map(move |part| {
            let len = part.channels() * self.out_channels;
            let w = MatrixRef::new(
                &self.w[first..first + len],
                part.channels(),
                self.out_channels,
            );
            first += len;
            (part, w)
        })
    }
}

/// Writes `act(b + Σ_k x_k W_k)` to `y`, `[rows, out_channels]`.
///
/// # Panics
///
/// Panics if the length of a slice does not fit the shapes given with the types.
pub fn linear_forward(
    layer: &LinearLayer<'_>,
    parts: &[LinearInput<'_>],
    y: &mut [f32],
    workspace: &Workspace,
) {
    let out_channels = layer.out_channels;
    assert!(
        out_channels > 0,
        "a linear layer needs one output channel at least"
    );
    let rows = y.len() / out_channels;
    check::shape("y", y, rows, out_channels);
    layer.check(parts, rows);

    let mut bias = workspace.zeros(out_channels);
    if let Some(b) = layer.b {
        bias.copy_from_slice(b);
    }
    for (part, w) in layer.parts(parts) {
        if let LinearInput::Broadcast(vector) = part {
            MatrixMut::new(&mut bias, 1, out_channels)
                .add_product(MatrixRef::new(vector, 1, vector.len()), w);
        }
    }

    y.par_chunks_mut(TILE_ROWS * out_channels)
        .enumerate()
        .for_each(|(tile, y)| {
            let rows = y.len() / out_channels;
            y.chunks_exact_mut(out_channels)
                .for_each(|row| row.copy_from_slice(&bias));
            for (part, w) in layer.parts(parts) {
                if let LinearInput::PerRow(part) = part {
                    let x =
                        &part.values[tile * TILE_ROWS * part.channels..][..rows * part.channels];
                    MatrixMut::new(y, rows, out_channels)
                        .add_product(MatrixRef::new(x, rows, part.channels), w);
                }
            }
            layer.activation.apply(y);
        });
}
