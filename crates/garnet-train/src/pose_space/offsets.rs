//! How far drapes are from the warp.

use faer::Mat;

use super::mirror::GarmentMirror;
use crate::context::Example;

/// The offsets of drapes from the warp, in the skinning frames, in metres.
pub(super) struct Offsets {
    /// Of all scenes and their mirror images `[vertex][3]`.
    pub(super) mean: Vec<f32>,
    /// What is the same in the mirror, from the mean `[3 vertex, scene]`; without a mirror, all of
    /// it.
    pub(super) even: Mat<f32>,
    /// What changes its sign in the mirror `[3 vertex, scene]`.
    pub(super) odd: Option<Mat<f32>>,
}

impl Offsets {
    pub(super) fn of(examples: &[&Example], mirror: Option<&GarmentMirror>) -> Self {
        let rows = examples
            .first()
            .map_or(0, |example| 3 * example.draped.len());
        let mut even = Mat::<f32>::zeros(rows, examples.len());
        let mut odd = mirror.map(|_| Mat::<f32>::zeros(rows, examples.len()));
        let mut sums = vec![0.0_f64; rows];
        for (column, example) in examples.iter().enumerate() {
            let (first, second) = halves(example, mirror);
            for (row, (offset, sum)) in first.into_iter().zip(&mut sums).enumerate() {
                even[(row, column)] = offset;
                *sum += f64::from(offset);
            }
            if let Some(odd) = &mut odd {
                for (row, offset) in second.into_iter().enumerate() {
                    odd[(row, column)] = offset;
                }
            }
        }
        let count = examples.len().max(1) as f64;
        let mean: Vec<f32> = sums.iter().map(|sum| (sum / count) as f32).collect();
        for column in 0..examples.len() {
            for (row, mean) in mean.iter().enumerate() {
                even[(row, column)] -= mean;
            }
        }
        Self { mean, even, odd }
    }
}

/// What of the offsets of a scene is the same in the mirror, and what changes its sign; all of them
/// and nothing without a mirror `[3 vertex]`.
pub(super) fn halves(example: &Example, mirror: Option<&GarmentMirror>) -> (Vec<f32>, Vec<f32>) {
    let offsets = offsets_of(example);
    let Some(mirror) = mirror else {
        return (offsets, Vec::new());
    };
    let image = mirror.offsets(&offsets);
    let pairs = || offsets.iter().zip(&image);
    (
        pairs().map(|(own, image)| 0.5 * (own + image)).collect(),
        pairs().map(|(own, image)| 0.5 * (own - image)).collect(),
    )
}

/// The offset of each vertex, coordinate by coordinate.
pub(super) fn offsets_of(example: &Example) -> Vec<f32> {
    let warped = &example.warped;
    let pairs = warped.positions.iter().zip(&example.draped);
    let offsets = pairs
        .zip(&warped.rotations)
        .flat_map(|((from, to), rotation)| {
            let offset = rotation.inverse() * (to - from);
            [offset.x, offset.y, offset.z]
        });
    offsets.collect()
}
