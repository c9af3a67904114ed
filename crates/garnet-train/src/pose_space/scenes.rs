//! Which scenes a fit looks at, and which it leaves out together.

use std::ops::Range;

use crate::subject::Example;

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

/// The scenes that each scene is left out with `[scene][scenes]`, itself among them: those of its body,
/// and those whose poses are from its sequence. A drape of the test has neither.
///
/// What all scenes have in common does not count.
pub(super) fn left_out_with(examples: &[&Example]) -> Vec<Vec<usize>> {
    let all_alike = |alike: fn(&Example, &Example) -> bool| {
        let first = examples.first();
        first.is_none_or(|first| examples.iter().all(|other| alike(first, other)))
    };
    let of_body = |a: &Example, b: &Example| a.scene.body == b.scene.body;
    let of_sequence = |a: &Example, b: &Example| a.sequence == b.sequence;
    let (one_body, one_sequence) = (all_alike(of_body), all_alike(of_sequence));
    let with = |scene: usize| {
        let this = examples[scene];
        let others = examples.iter().enumerate().filter(|&(other, example)| {
            other == scene
                || (!one_body && of_body(this, example))
                || (!one_sequence && of_sequence(this, example))
        });
        others.map(|(other, _)| other).collect()
    };
    (0..examples.len()).map(with).collect()
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
