//! How far drapes are from the warp.

use std::ops::Range;

use faer::Mat;

use crate::subject::Example;

/// The offsets of drapes from the warp, in the skinning frames, in metres.
pub(super) struct Offsets {
    /// Of all scenes `[vertex][3]`.
    pub(super) mean: Vec<f32>,
    /// From the mean `[3 vertex, scene]`.
    pub(super) centered: Mat<f32>,
}

impl Offsets {
    pub(super) fn of(examples: &[&Example]) -> Self {
        let rows = examples
            .first()
            .map_or(0, |example| 3 * example.draped.len());
        let mut centered = Mat::<f32>::zeros(rows, examples.len());
        let mut sums = vec![0.0_f64; rows];
        for (column, example) in examples.iter().enumerate() {
            for (row, offset) in offset_of(example).enumerate() {
                centered[(row, column)] = offset;
                sums[row] += f64::from(offset);
            }
        }
        let count = examples.len().max(1) as f64;
        let mean: Vec<f32> = sums.iter().map(|sum| (sum / count) as f32).collect();
        for column in 0..examples.len() {
            for (row, mean) in mean.iter().enumerate() {
                centered[(row, column)] -= mean;
            }
        }
        Self { mean, centered }
    }
}

/// The offset of each vertex, coordinate by coordinate.
pub(super) fn offset_of(example: &Example) -> impl Iterator<Item = f32> {
    let warped = &example.warped;
    let pairs = warped.positions.iter().zip(&example.draped);
    pairs
        .zip(&warped.rotations)
        .flat_map(|((from, to), rotation)| {
            let offset = rotation.inverse() * (to - from);
            [offset.x, offset.y, offset.z]
        })
}

/// The scenes of each body, which follow each other; each scene by itself if there is one body alone.
pub(super) fn bodies(examples: &[&Example]) -> Vec<Range<usize>> {
    let same = |a: &&Example, b: &&Example| a.scene.body == b.scene.body;
    let mut first = 0;
    let ranges = examples.chunk_by(same).map(|scenes| {
        let range = first..first + scenes.len();
        first = range.end;
        range
    });
    let ranges: Vec<Range<usize>> = ranges.collect();
    if ranges.len() > 1 {
        return ranges;
    }
    (0..examples.len()).map(|scene| scene..scene + 1).collect()
}

/// The scenes of evenly chosen bodies, `most` at most; of one body at least.
pub(super) fn chosen<E: AsRef<Example>>(examples: &[E], most: usize) -> Vec<&Example> {
    let all: Vec<&Example> = examples.iter().map(AsRef::as_ref).collect();
    let ranges = bodies(&all);
    let mut step = all.len().div_ceil(most.max(1)).max(1);
    loop {
        let taken = ranges.iter().step_by(step);
        let count: usize = taken.clone().map(ExactSizeIterator::len).sum();
        if count <= most || step >= ranges.len() {
            return taken
                .flat_map(|range| all[range.clone()].iter().copied())
                .collect();
        }
        step += 1;
    }
}
