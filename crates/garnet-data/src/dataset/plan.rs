//! Which bodies and poses a data set has.

use garnet_body::{
    poses::{Group, PoseSampler, SequenceSet},
    shape::{BodyParameters, Population},
};
use serde::{Deserialize, Serialize};

use super::record::Split;
use crate::DataError;

/// How many bodies each split has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Counts {
    /// Bodies that models learn from.
    pub train: u32,
    /// Bodies that models are chosen by.
    pub valid: u32,
    /// Bodies that models are judged by.
    pub test: u32,
}

impl Counts {
    /// The number of a split.
    pub const fn of(self, split: Split) -> u32 {
        match split {
            Split::Train => self.train,
            Split::Valid => self.valid,
            Split::Test => self.test,
        }
    }

    /// The number of all bodies.
    pub const fn total(self) -> u32 {
        self.train + self.valid + self.test
    }
}

/// What is new to a network in the scenes that it is tested on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Protocol {
    /// Bodies and sequences of poses: the harder one.
    #[default]
    UnseenSequences,
    /// Bodies alone: all are in the same poses, of walks, yoga and dances. GarNet++ is tested so,
    /// as we read it.
    SeenPoses,
}

impl Protocol {
    /// The name in files and messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::UnseenSequences => "unseen-sequences",
            Self::SeenPoses => "seen-poses",
        }
    }

    /// The name in text.
    pub const fn title(self) -> &'static str {
        match self {
            Self::UnseenSequences => "unseen sequences",
            Self::SeenPoses => "seen poses",
        }
    }

    /// Whether it is the default one.
    #[expect(
        clippy::trivially_copy_pass_by_ref,
        reason = "serde passes a reference"
    )]
    pub(super) fn is_unseen_sequences(&self) -> bool {
        *self == Self::UnseenSequences
    }

    /// Draws the poses of a split.
    pub fn sampler(self, seed: u64, split: Split) -> PoseSampler {
        match self {
            Self::UnseenSequences => sampler(seed, split),
            Self::SeenPoses => {
                let groups = [Group::Walk, Group::Yoga, Group::Dance];
                let of_paper = SequenceSet::of(|sequence, _| groups.contains(&sequence.group));
                PoseSampler::new(seed).among(of_paper).drawn_once()
            }
        }
    }

    /// The number of a pose of a body among those that the sampler draws.
    pub const fn number(self, body: u32, pose: u32, poses_a_body: u32) -> u64 {
        match self {
            Self::UnseenSequences => body as u64 * poses_a_body as u64 + pose as u64,
            Self::SeenPoses => pose as u64,
        }
    }
}

/// Bodies of the population that a data set uses, by split: numbers in the population.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    bodies: [Vec<u64>; 3],
    /// Bodies of the population that were looked at.
    pub tried: u64,
}

/// Bodies that are looked at for each one that is needed, at most.
const MAX_TRIES: u64 = 200;

impl Plan {
    /// Goes through the population of a seed in order and takes the bodies that the garment fits.
    /// Training, validation and test bodies come after one another, so that no body is in two.
    ///
    /// # Errors
    ///
    /// [`DataError::FewFit`] if not one body in 200 fits.
    pub fn new(
        seed: u64,
        counts: Counts,
        mut fits: impl FnMut(&BodyParameters) -> bool,
    ) -> Result<Self, DataError> {
        let population = Population::new(seed);
        let needed = counts.total() as usize;
        let mut taken = Vec::with_capacity(needed);
        let mut tried = 0;
        while taken.len() < needed {
            if tried >= MAX_TRIES * needed as u64 {
                return Err(DataError::FewFit {
                    found: taken.len(),
                    tried: tried as usize,
                    needed,
                });
            }
            if fits(&population.sample(tried)) {
                taken.push(tried);
            }
            tried += 1;
        }
        let mut rest = taken.into_iter();
        let bodies =
            Split::ALL.map(|split| rest.by_ref().take(counts.of(split) as usize).collect());
        Ok(Self { bodies, tried })
    }

    /// Number in the population of each body of a split.
    pub fn bodies(&self, split: Split) -> &[u64] {
        &self.bodies[split as usize]
    }
}

/// The sequences of a split. In each group of movements one of seven is kept for the test and one
/// for the validation: no sequence is in two splits.
pub fn sequences(split: Split) -> SequenceSet {
    SequenceSet::of(|_, number| {
        let of_number = match number % 7 {
            3 => Split::Test,
            5 => Split::Valid,
            _ => Split::Train,
        };
        of_number == split
    })
}

/// Draws the poses of a split.
pub fn sampler(seed: u64, split: Split) -> PoseSampler {
    PoseSampler::new(seed).among(sequences(split))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use garnet_body::shape::Measure;

    use super::*;

    #[test]
    fn no_body_and_no_sequence_is_in_two_splits() {
        let counts = Counts {
            train: 9,
            valid: 3,
            test: 4,
        };
        let is_slim = |body: &BodyParameters| body.measure(Measure::Chest) < Some(1.0);
        let plan = Plan::new(5, counts, is_slim).unwrap();
        let all: Vec<u64> = Split::ALL
            .into_iter()
            .flat_map(|split| plan.bodies(split).to_vec())
            .collect();
        assert_eq!(all.len(), 16);
        assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), 16);
        assert!(plan.tried > 16);
        let names: Vec<&str> = Split::ALL
            .into_iter()
            .flat_map(|split| sequences(split).names())
            .collect();
        assert_eq!(names.len(), names.iter().collect::<BTreeSet<_>>().len());
        assert_eq!(names.len(), garnet_body::poses::SEQUENCES.len());
    }

    #[test]
    fn every_split_has_walking_yoga_and_dance() {
        for split in Split::ALL {
            let names: Vec<&str> = sequences(split).names().collect();
            for group in ["walk_", "yoga_", "dance_"] {
                assert!(
                    names.iter().any(|name| name.starts_with(group)),
                    "{split:?}: {names:?}"
                );
            }
        }
    }

    #[test]
    fn a_garment_that_fits_nobody_is_told() {
        let counts = Counts {
            train: 1,
            valid: 0,
            test: 0,
        };
        let error = Plan::new(1, counts, |_| false).unwrap_err();
        assert!(error.to_string().contains("fits only 0 of 200"), "{error}");
    }
}
