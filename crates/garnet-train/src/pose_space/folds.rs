//! Which fit tells a scene as if it had not seen it.
//!
//! Bodies are dealt into folds, and so are sequences of poses. A fit leaves out a fold of what
//! drapes of the test have not: sequences, bodies, or both. Of both, fits leave out every body with
//! every sequence, so each scene has a fit that knows neither its body nor its sequence; but it
//! knows less than half of the scenes.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::regions::Sample;

/// A fit, and what it is for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Fold {
    /// The samples that it learns from.
    pub(super) learned: Vec<usize>,
    /// The samples that it tells.
    pub(super) told: Vec<usize>,
}

/// What a fit must not know of the scenes that it tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LeftOut {
    /// Their bodies and their sequences: as many fits as the square of the folds.
    Both,
    /// Their sequences of poses.
    Sequences,
    /// Their bodies.
    Bodies,
}

/// The folds of the samples of the first data set: `count` of bodies, of sequences, or of each
/// times the other, as far as there are so many.
///
/// What all samples have in common is not left out; if that is body and sequence, samples are
/// dealt themselves. Samples of other data sets are learned from, and their bodies are others.
pub(super) fn folds(samples: &[Sample], count: usize, left_out: LeftOut) -> Vec<Fold> {
    let count = count.max(1);
    let own = |sample: &Sample| (sample.body.0 == 0).then_some(sample.body.1);
    let bodies = dealt(samples.iter().filter_map(own), count);
    let sequences = dealt(samples.iter().map(|sample| sample.sequence.as_str()), count);
    let by_body = bodies.len() > 1 && left_out != LeftOut::Sequences;
    let by_sequence = sequences.len() > 1 && left_out != LeftOut::Bodies;
    let is_alone = !by_body && !by_sequence;
    // None where nothing is left out.
    let place = |number: usize| -> (Option<usize>, Option<usize>) {
        let sample = &samples[number];
        let body = own(sample).and_then(|body| bodies.get(&body).copied());
        let sequence = sequences.get(sample.sequence.as_str()).copied();
        match (own(sample), is_alone) {
            (Some(_), true) => (Some(number % count), None),
            _ => (body.filter(|_| by_body), sequence.filter(|_| by_sequence)),
        }
    };
    let places: Vec<_> = (0..samples.len()).map(place).collect();
    let of_own = samples.iter().zip(&places);
    let of_own = of_own.filter(|(sample, _)| own(sample).is_some());
    let asked: BTreeSet<_> = of_own.map(|(_, place)| *place).collect();
    let fold = |(body, sequence): (Option<usize>, Option<usize>)| {
        let is_known = |&number: &usize| {
            let (other_body, other_sequence) = places[number];
            (body.is_none() || other_body != body)
                && (sequence.is_none() || other_sequence != sequence)
        };
        let is_told =
            |&number: &usize| own(&samples[number]).is_some() && places[number] == (body, sequence);
        Fold {
            learned: (0..samples.len()).filter(is_known).collect(),
            told: (0..samples.len()).filter(is_told).collect(),
        }
    };
    asked.into_iter().map(fold).collect()
}

/// The fold of each key: those of most samples first, each into the fold that has fewest.
fn dealt<K: Ord + Copy>(keys: impl Iterator<Item = K>, count: usize) -> BTreeMap<K, usize> {
    let mut sizes: BTreeMap<K, usize> = BTreeMap::new();
    for key in keys {
        *sizes.entry(key).or_default() += 1;
    }
    let mut order: Vec<(K, usize)> = sizes.into_iter().collect();
    order.sort_by_key(|&(key, size)| (std::cmp::Reverse(size), key));
    let mut filled = vec![0; count];
    let deal = |(key, size): (K, usize)| {
        let fold = (0..count).min_by_key(|&fold| filled[fold]).unwrap_or(0);
        filled[fold] += size;
        (key, fold)
    };
    order.into_iter().map(deal).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(set: usize, body: u32, sequence: &str) -> Sample {
        Sample {
            body: (set, body),
            sequence: sequence.to_owned(),
            parameters: Vec::new(),
            cut: [0.0; 3],
            offsets: Vec::new(),
        }
    }

    #[test]
    fn each_scene_is_told_once_by_what_knows_neither_its_body_nor_its_sequence() {
        let mut samples = Vec::new();
        for body in 0..7 {
            for number in 0..5 {
                samples.push(sample(0, body, &format!("s{}", (3 * body + number) % 11)));
            }
        }
        samples.extend((0..9).map(|body| sample(1, body, &format!("s{body}"))));
        let found = folds(&samples, 3, LeftOut::Both);
        assert_eq!(found.len(), 9);
        let mut told = vec![0; samples.len()];
        for fold in &found {
            assert!(!fold.learned.is_empty());
            for &number in &fold.told {
                told[number] += 1;
                for &known in &fold.learned {
                    assert_ne!(samples[number].body, samples[known].body);
                    assert_ne!(samples[number].sequence, samples[known].sequence);
                }
            }
            // Other bodies of another data set tell what they can.
            let others = fold.learned.iter().filter(|&&known| known >= 35);
            assert!(others.count() >= 5);
        }
        assert!(told[..35].iter().all(|&count| count == 1), "{told:?}");
        assert!(told[35..].iter().all(|&count| count == 0));
        // Folds are of like size.
        let sizes: Vec<usize> = found.iter().map(|fold| fold.told.len()).collect();
        assert!(sizes.iter().all(|&size| size >= 1), "{sizes:?}");
    }

    #[test]
    fn of_sequences_alone_a_fit_knows_most_scenes() {
        let of = |number: u32| sample(0, number % 6, &format!("s{}", number % 8));
        let samples: Vec<Sample> = (0..48).map(of).collect();
        for (left_out, is_known) in [(LeftOut::Sequences, true), (LeftOut::Bodies, false)] {
            let found = folds(&samples, 4, left_out);
            assert_eq!(found.len(), 4);
            let told: usize = found.iter().map(|fold| fold.told.len()).sum();
            assert_eq!(told, samples.len());
            for fold in &found {
                assert_eq!(fold.told.len() + fold.learned.len(), samples.len());
                for (&told, &known) in fold.told.iter().zip(&fold.learned) {
                    let (told, known) = (&samples[told], &samples[known]);
                    let shares = if is_known {
                        told.sequence == known.sequence
                    } else {
                        told.body == known.body
                    };
                    assert!(!shares);
                }
            }
        }
    }

    #[test]
    fn what_all_have_in_common_is_not_left_out() {
        let one_sequence: Vec<Sample> = (0..4).map(|body| sample(0, body, "walk")).collect();
        let found = folds(&one_sequence, 2, LeftOut::Both);
        assert_eq!(found.len(), 2);
        assert!(found.iter().all(|fold| fold.learned.len() == 2));
        let alone: Vec<Sample> = (0..4).map(|_| sample(0, 0, "walk")).collect();
        let found = folds(&alone, 2, LeftOut::Both);
        let expected = [(vec![1, 3], vec![0, 2]), (vec![0, 2], vec![1, 3])];
        let expected = expected.map(|(learned, told)| Fold { learned, told });
        assert_eq!(found, expected);
    }
}
