//! Sums over tiles in a fixed order, so that they do not depend on the number of threads.

use rayon::prelude::*;

/// Numbers a task; a multiple of a cache line.
const CHUNK: usize = 4096;

/// Writes to `total` the sum of the rows of `parts`, in their order.
pub(crate) fn sum_rows(parts: &[f32], total: &mut [f32]) {
    let stride = total.len();
    total
        .par_chunks_mut(CHUNK)
        .enumerate()
        .for_each(|(chunk, total)| {
            total.fill(0.0);
            for part in parts.chunks_exact(stride) {
                let part = &part[chunk * CHUNK..][..total.len()];
                total
                    .iter_mut()
                    .zip(part)
                    .for_each(|(total, part)| *total += part);
            }
        });
}

/// Splits outputs that may be absent into tiles of rows: `[tile][output]`.
pub(crate) fn split_into_tiles<'a>(
    outputs: &'a mut [Option<&mut [f32]>],
    channels: &[usize],
    rows_per_tile: usize,
    num_tiles: usize,
) -> Vec<Vec<Option<&'a mut [f32]>>> {
    let mut tiles: Vec<Vec<_>> = (0..num_tiles)
        .map(|_| Vec::with_capacity(channels.len()))
        .collect();
    for (output, channels) in outputs.iter_mut().zip(channels) {
        match output {
            None => tiles.iter_mut().for_each(|tile| tile.push(None)),
            Some(values) => {
                let chunks = values.chunks_mut((rows_per_tile * channels).max(1));
                tiles
                    .iter_mut()
                    .zip(chunks)
                    .for_each(|(tile, chunk)| tile.push(Some(chunk)));
            }
        }
    }
    tiles
}
