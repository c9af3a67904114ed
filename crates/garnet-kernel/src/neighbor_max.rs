//! Max-pooling over neighbors: `y_i = max_j x_j` for each channel, `j` over the neighbors of `i`.

use rayon::prelude::*;

use crate::instructions::Kernel;
use crate::lanes::{Lanes, whole};
use crate::{Features, NeighborTable, Workspace, check};

/// Rows a tile.
const TILE_ROWS: usize = 128;

/// Writes the largest values to `y`, `[num_rows, channels]`, and where they come from to `largest`.
///
/// `features` has a row for each source of the table. `largest` gets source rows in the shape of
/// `y`; it may be empty where no backward pass follows. Among equal values the first of the row
/// wins. A value that is not a number is never larger than another.
///
/// # Panics
///
/// Panics if the length of a slice does not fit.
pub fn neighbor_max_forward(
    table: &NeighborTable,
    features: Features<'_>,
    y: &mut [f32],
    largest: &mut [u32],
    workspace: &Workspace,
) {
    let channels = features.channels;
    features.check("features", table.num_sources());
    check::shape("y", y, table.num_rows(), channels);
    if channels == 0 {
        return;
    }
    let tiles = y.par_chunks_mut(TILE_ROWS * channels).enumerate();
    if largest.is_empty() {
        tiles.for_each(|(tile, y)| {
            let first_row = tile * TILE_ROWS;
            workspace.instructions().run(MaxTile {
                table,
                features,
                first_row,
                y,
                largest: &mut [],
            });
        });
    } else {
        check::indices("largest", largest, table.num_rows(), channels);
        tiles
            .zip(largest.par_chunks_mut(TILE_ROWS * channels))
            .for_each(|((tile, y), largest)| {
                let first_row = tile * TILE_ROWS;
                workspace.instructions().run(MaxTile {
                    table,
                    features,
                    first_row,
                    y,
                    largest,
                });
            });
    }
}

struct MaxTile<'a> {
    table: &'a NeighborTable,
    features: Features<'a>,
    first_row: usize,
    y: &'a mut [f32],
    /// Empty if it is not wanted.
    largest: &'a mut [u32],
}

impl Kernel for MaxTile<'_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        let Self {
            table,
            features,
            first_row,
            y,
            largest,
        } = self;
        let channels = features.channels;
        let whole = whole::<V>(channels);
        for (row, y) in y.chunks_exact_mut(channels).enumerate() {
            let neighbors = table.neighbors(first_row + row);
            if largest.is_empty() {
                for channel in (0..whole).step_by(V::LANES) {
                    largest_of(features, neighbors, channel, V::load).store(&mut y[channel..]);
                }
                if whole < channels {
                    let rest = largest_of(features, neighbors, whole, V::load_part);
                    rest.store_part(&mut y[whole..]);
                }
                continue;
            }
            let largest = &mut largest[row * channels..][..channels];
            for channel in (0..whole).step_by(V::LANES) {
                let (value, index) = largest_with_index(features, neighbors, channel, V::load);
                value.store(&mut y[channel..]);
                V::store_indices(index, &mut largest[channel..]);
            }
            if whole < channels {
                let (value, index) = largest_with_index(features, neighbors, whole, V::load_part);
                value.store_part(&mut y[whole..]);
                V::store_indices(index, &mut largest[whole..]);
            }
        }
    }
}

#[inline(always)]
fn largest_of<V: Lanes>(
    features: Features<'_>,
    neighbors: &[u32],
    channel: usize,
    load: impl Fn(&[f32]) -> V,
) -> V {
    let mut value = load(&features.row(neighbors[0] as usize)[channel..]);
    for &neighbor in &neighbors[1..] {
        // In this order a value that is not a number is passed over, as below.
        value = load(&features.row(neighbor as usize)[channel..]).max(value);
    }
    value
}

#[inline(always)]
fn largest_with_index<V: Lanes>(
    features: Features<'_>,
    neighbors: &[u32],
    channel: usize,
    load: impl Fn(&[f32]) -> V,
) -> (V, V::Indices) {
    let mut value = load(&features.row(neighbors[0] as usize)[channel..]);
    let mut index = V::splat_index(neighbors[0]);
    for &neighbor in &neighbors[1..] {
        let candidate = load(&features.row(neighbor as usize)[channel..]);
        (value, index) = value.larger(index, candidate, V::splat_index(neighbor));
    }
    (value, index)
}

/// Writes to `dx`, `[num_sources, channels]`, the gradient of the features from that of the output.
///
/// Each source collects from the rows that name it, in their order.
///
/// # Panics
///
/// Panics if the length of a slice does not fit.
pub fn neighbor_max_backward(
    table: &NeighborTable,
    largest: &[u32],
    dy: Features<'_>,
    dx: &mut [f32],
    workspace: &Workspace,
) {
    let channels = dy.channels;
    dy.check("dy", table.num_rows());
    check::indices("largest", largest, table.num_rows(), channels);
    check::shape("dx", dx, table.num_sources(), channels);
    if channels == 0 {
        return;
    }
    dx.par_chunks_mut(channels)
        .enumerate()
        .for_each(|(source, dx)| {
            let rows = table.rows_of_sources().of(source);
            workspace.instructions().run(CollectMax {
                source: source as u32,
                rows,
                largest,
                dy,
                dx,
            });
        });
}

struct CollectMax<'a> {
    source: u32,
    rows: &'a [u32],
    largest: &'a [u32],
    dy: Features<'a>,
    dx: &'a mut [f32],
}

impl Kernel for CollectMax<'_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        let Self {
            source,
            rows,
            largest,
            dy,
            dx,
        } = self;
        dx.fill(0.0);
        let mut last = None;
        for &row in rows {
            // A row that names the source twice counts once.
            if last == Some(row) {
                continue;
            }
            last = Some(row);
            let largest = &largest[row as usize * dx.len()..][..dx.len()];
            for ((dx, dy), largest) in dx.iter_mut().zip(dy.row(row as usize)).zip(largest) {
                *dx += if *largest == source { *dy } else { 0.0 };
            }
        }
    }
}
