//! Max-pooling over all rows: `y = max_i x_i` for each channel.

use rayon::prelude::*;

use crate::instructions::Kernel;
use crate::lanes::Lanes;
use crate::{Features, Workspace, check};

/// Rows a tile.
const TILE_ROWS: usize = 256;

/// Writes the largest values to `y`, `[channels]`, and the rows that have them to `largest`.
///
/// Among equal values the first row wins. A value that is not a number is never larger than
/// another.
///
/// # Panics
///
/// Panics if there is no row, or the length of a slice does not fit.
pub fn global_max_forward(
    features: Features<'_>,
    y: &mut [f32],
    largest: &mut [u32],
    workspace: &Workspace,
) {
    let channels = features.channels;
    check::shape("y", y, 1, channels);
    check::indices("largest", largest, 1, channels);
    if channels == 0 {
        return;
    }
    let rows = features.values.len() / channels;
    features.check("features", rows);
    assert!(rows > 0, "the maximum over no rows is undefined");

    let mut tiles: Vec<(Vec<f32>, Vec<u32>)> = (features.values.par_chunks(TILE_ROWS * channels))
        .enumerate()
        .map(|(tile, values)| {
            let mut found = (vec![0.0; channels], vec![0; channels]);
            workspace.instructions().run(MaxOfRows {
                features: Features { values, channels },
                first_row: tile * TILE_ROWS,
                y: &mut found.0,
                largest: &mut found.1,
            });
            found
        })
        .collect();

    let (first_y, first_largest) = tiles.remove(0);
    y.copy_from_slice(&first_y);
    largest.copy_from_slice(&first_largest);
    for (values, rows) in tiles {
        for channel in 0..channels {
            if values[channel] > y[channel] {
                (y[channel], largest[channel]) = (values[channel], rows[channel]);
            }
        }
    }
}

struct MaxOfRows<'a> {
    features: Features<'a>,
    first_row: usize,
    y: &'a mut [f32],
    largest: &'a mut [u32],
}

impl Kernel for MaxOfRows<'_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        let Self {
            features,
            first_row,
            y,
            largest,
        } = self;
        let channels = features.channels;
        for channel in (0..channels).step_by(V::LANES) {
            let end = channels.min(channel + V::LANES);
            let mut value = V::load_part(&features.row(0)[channel..end]);
            let mut index = V::splat_index(first_row as u32);
            for row in 1..features.values.len() / channels {
                let candidate = V::load_part(&features.row(row)[channel..end]);
                let candidate_index = V::splat_index((first_row + row) as u32);
                (value, index) = value.larger(index, candidate, candidate_index);
            }
            value.store_part(&mut y[channel..end]);
            V::store_indices(index, &mut largest[channel..end]);
        }
    }
}

/// Writes to `dx`, `[rows, channels]`, the gradient of the features from that of the output,
/// `[channels]`.
///
/// # Panics
///
/// Panics if the length of a slice does not fit.
pub fn global_max_backward(largest: &[u32], dy: &[f32], dx: &mut [f32]) {
    let channels = dy.len();
    check::indices("largest", largest, 1, channels);
    if channels == 0 {
        return;
    }
    let rows = dx.len() / channels;
    check::shape("dx", dx, rows, channels);
    dx.fill(0.0);
    for (channel, (&row, &dy)) in largest.iter().zip(dy).enumerate() {
        dx[row as usize * channels + channel] = dy;
    }
}
