//! Which scenes a fit looks at, and which it leaves out together.

use std::collections::BTreeSet;
use std::ops::Range;

use super::regions::Sample;
use crate::context::Example;

/// The scenes of each body, which follow each other.
fn bodies(examples: &[&Example]) -> Vec<Range<usize>> {
    let same = |a: &&Example, b: &&Example| a.scene.body == b.scene.body;
    let mut first = 0;
    let ranges = examples.chunk_by(same).map(|scenes| {
        let range = first..first + scenes.len();
        first = range.end;
        range
    });
    ranges.collect()
}

/// The scenes that each scene is left out with `[scene][scenes]`, itself among them: those of its
/// body, and those whose poses are from its sequence. A drape of the test has neither.
///
/// What all scenes have in common does not count.
pub(super) fn left_out_with(examples: &[&Example]) -> Vec<Vec<usize>> {
    let keys = examples.iter();
    let keys: Vec<_> = keys
        .map(|example| ((0, example.scene.body), example.sequence.as_str()))
        .collect();
    together(&keys)
}

/// The same of the bodies, by data set and number, and sequences of scenes.
pub(super) fn together(keys: &[((usize, u32), &str)]) -> Vec<Vec<usize>> {
    let one_body = keys.iter().all(|key| key.0 == keys[0].0);
    let one_sequence = keys.iter().all(|key| key.1 == keys[0].1);
    let with = |scene: usize| {
        let this = keys[scene];
        let others = keys.iter().enumerate().filter(|&(other, key)| {
            other == scene || (!one_body && this.0 == key.0) || (!one_sequence && this.1 == key.1)
        });
        others.map(|(other, _)| other).collect()
    };
    (0..keys.len()).map(with).collect()
}

/// The samples of evenly chosen bodies, `most` at most.
pub(super) fn evenly(samples: &[Sample], most: usize) -> Vec<usize> {
    let mut bodies: Vec<(usize, u32)> = samples.iter().map(|sample| sample.body).collect();
    bodies.dedup();
    let step = samples.len().div_ceil(most.max(1)).max(1);
    let taken: BTreeSet<(usize, u32)> = bodies.into_iter().step_by(step).collect();
    let is_taken = |&sample: &usize| taken.contains(&samples[sample].body);
    (0..samples.len()).filter(is_taken).take(most).collect()
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
