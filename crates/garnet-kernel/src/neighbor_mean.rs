//! Average pooling over neighbors: `y_i = 1/k Σ_j x_j`, `j` over the `k` neighbors of `i`.

use rayon::prelude::*;

use crate::instructions::Kernel;
use crate::lanes::{Lanes, whole};
use crate::{Features, NeighborTable, Workspace, check};

/// Rows a tile.
const TILE_ROWS: usize = 128;

/// Writes the averages to `y`, `[num_rows, channels]`.
///
/// `features` has a row for each source of the table.
///
/// # Panics
///
/// Panics if the length of a slice does not fit.
pub fn neighbor_mean_forward(
    table: &NeighborTable,
    features: Features<'_>,
    y: &mut [f32],
    workspace: &Workspace,
) {
    features.check("features", table.num_sources());
    check::shape("y", y, table.num_rows(), features.channels);
    each_row(
        y,
        features,
        workspace,
        |row| table.neighbors(row),
        share(table),
    );
}

/// Writes to `dx`, `[num_sources, channels]`, the gradient of the features from that of the output.
///
/// # Panics
///
/// Panics if the length of a slice does not fit.
pub fn neighbor_mean_backward(
    table: &NeighborTable,
    dy: Features<'_>,
    dx: &mut [f32],
    workspace: &Workspace,
) {
    dy.check("dy", table.num_rows());
    check::shape("dx", dx, table.num_sources(), dy.channels);
    let transposed = table.rows_of_sources();
    each_row(
        dx,
        dy,
        workspace,
        |source| transposed.of(source),
        share(table),
    );
}

fn share(table: &NeighborTable) -> f32 {
    1.0 / table.neighbors_per_row() as f32
}

/// Writes to each row of `sums` the scaled sum of the rows that `terms` names.
fn each_row<'a>(
    sums: &mut [f32],
    features: Features<'_>,
    workspace: &Workspace,
    terms: impl Fn(usize) -> &'a [u32] + Sync,
    scale: f32,
) {
    let channels = features.channels;
    if channels == 0 {
        return;
    }
    sums.par_chunks_mut(TILE_ROWS * channels)
        .enumerate()
        .for_each(|(tile, sums)| {
            for (row, sum) in sums.chunks_exact_mut(channels).enumerate() {
                let terms = terms(tile * TILE_ROWS + row);
                workspace.instructions().run(ScaledSum {
                    features,
                    terms,
                    scale,
                    sum,
                });
            }
        });
}

struct ScaledSum<'a> {
    features: Features<'a>,
    terms: &'a [u32],
    scale: f32,
    sum: &'a mut [f32],
}

impl Kernel for ScaledSum<'_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        let Self {
            features,
            terms,
            scale,
            sum,
        } = self;
        let whole = whole::<V>(sum.len());
        for channel in (0..whole).step_by(V::LANES) {
            scaled_sum(features, terms, scale, channel, V::load).store(&mut sum[channel..]);
        }
        if whole < sum.len() {
            let rest = scaled_sum(features, terms, scale, whole, V::load_part);
            rest.store_part(&mut sum[whole..]);
        }
    }
}

#[inline(always)]
fn scaled_sum<V: Lanes>(
    features: Features<'_>,
    terms: &[u32],
    scale: f32,
    channel: usize,
    load: impl Fn(&[f32]) -> V,
) -> V {
    let mut sum = V::splat(0.0);
    for &term in terms {
        sum = sum.add(load(&features.row(term as usize)[channel..]));
    }
    sum.mul(V::splat(scale))
}
