//! Drawing poses.

use garnet_skin::Pose;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::{
    BodyAngles, NUM_ANGLES, Poser, SelfContact, SeparationOptions, Sequence, SequenceSet, ranges,
    sequences::Group,
};
use crate::motion::{Ground, RetargetError, put_on_ground};
use crate::uniform;

/// How often a pose is drawn anew before the sampler gives up.
const MAX_TRIES: u32 = 8;

/// The largest area of skin that a drawn pose may turn over at the shoulders, in m²: there it traps
/// cloth. An arm that hangs on a heavy body turns 15 cm² in the armpit.
const MAX_TURNED_AREA: f64 = 30e-4;

/// Draws poses: by group in the shares of [`Group::percent`], within a group any sequence of its
/// set, within a sequence any phase, left and right exchanged in half of them, with noise inside
/// the ranges of motion. Or [mixed](Self::mixed) of several such draws.
///
/// A pose depends on seed and number alone: poses can be drawn in any order, on any thread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseSampler {
    seed: u64,
    noise: f64,
    is_mixed: bool,
    tries: u32,
    sequences: SequenceSet,
}

/// A pose that was drawn from the library.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SampledPose {
    /// Name of its sequence; of the first one of a mixed pose, as all that follows but the angles.
    pub sequence: &'static str,
    /// Kind of its sequence.
    pub group: Group,
    /// Where in the sequence it is, 0 to 1.
    pub phase: f64,
    /// Whether left and right are exchanged.
    pub is_mirrored: bool,
    /// The pose.
    pub angles: BodyAngles,
}

/// What the test for self-contact made of a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    /// Nothing.
    Sound,
    /// Joints were turned until the parts of the body were apart.
    Corrected {
        /// The largest turn of a joint, in radians.
        turn: f64,
    },
}

/// A pose in which a body does not run through itself, standing on the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct SoundPose {
    /// Name of its sequence; of the first one of a mixed pose, as its phase.
    pub sequence: &'static str,
    /// Where in the sequence it is, 0 to 1.
    pub phase: f64,
    /// The pose.
    pub pose: Pose,
    /// What was done to it.
    pub outcome: Outcome,
    /// How many draws were thrown away before it.
    pub num_rejected: u32,
    /// The deepest self-contact before and after correction, in metres.
    pub depths: [f32; 2],
}

/// Why no pose can be drawn for a body.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SampleError {
    /// The body runs through itself in every draw.
    #[error("pose {index}: the body runs through itself in each of {tries} draws of `{sequence}`")]
    NoSoundPose {
        /// Number of the pose.
        index: u64,
        /// The sequence.
        sequence: &'static str,
        /// How many draws were made.
        tries: u32,
    },
    /// The skeleton is no human figure or the pose impossible.
    #[error(transparent)]
    Pose(#[from] RetargetError),
}

impl PoseSampler {
    /// A sampler; samplers with other seeds draw other poses.
    pub const fn new(seed: u64) -> Self {
        Self {
            seed,
            noise: 1.0,
            is_mixed: false,
            tries: MAX_TRIES,
            sequences: SequenceSet::ALL,
        }
    }

    /// The noise scaled by `noise`; 0 stays on the sequences.
    #[must_use]
    pub const fn with_noise(self, noise: f64) -> Self {
        Self { noise, ..self }
    }

    /// Poses that are put together: trunk and legs between two draws in half of them, arms of
    /// another draw or of two in three of four. They go beyond what single sequences have, inside
    /// the ranges of motion.
    #[must_use]
    pub const fn mixed(self, is_mixed: bool) -> Self {
        Self { is_mixed, ..self }
    }

    /// Bodies that run through themselves in a pose, even when it is corrected, get no other draw
    /// in its place: all bodies have the same poses, and some have fewer.
    #[must_use]
    pub const fn drawn_once(self) -> Self {
        Self { tries: 1, ..self }
    }

    /// Poses of these sequences alone; groups without any give their share to the others. The empty
    /// set is taken for all.
    #[must_use]
    pub fn among(self, sequences: SequenceSet) -> Self {
        let sequences = if sequences.is_empty() {
            SequenceSet::ALL
        } else {
            sequences
        };
        Self { sequences, ..self }
    }

    /// The pose of a number.
    pub fn sample(&self, index: u64) -> SampledPose {
        self.draw(index, 0)
    }

    /// The pose of a number in one sequence.
    pub fn sample_of(&self, sequence: &'static Sequence, index: u64) -> SampledPose {
        draw_of(sequence, &mut self.source(index, 0), self.noise)
    }

    /// The pose of a number on a body: corrected if its parts run into each other, drawn anew from
    /// the same sequence if that does not help or the shoulders' skin is turned over (30 cm² at
    /// most, else the least of all draws), and put on the ground.
    ///
    /// # Errors
    ///
    /// [`SampleError::NoSoundPose`] after 8 draws, the last of them without noise; after one if
    /// poses are [drawn once](Self::drawn_once).
    pub fn sample_for(
        &self,
        poser: &Poser,
        contact: &SelfContact,
        index: u64,
    ) -> Result<SoundPose, SampleError> {
        let mut name = "";
        let mut best: Option<(f64, SoundPose)> = None;
        for try_index in 0..self.tries {
            let drawn = self.draw(index, try_index);
            name = drawn.sequence;
            let pose = poser.pose(&drawn.angles);
            let separated = contact.separated(&pose, &SeparationOptions::default());
            let Some(separated) = separated.map_err(RetargetError::from)? else {
                continue;
            };
            let turned_area = contact.turned_shoulder_area(&separated.pose);
            let turned_area = turned_area.map_err(RetargetError::from)?;
            if best.as_ref().is_some_and(|(area, _)| *area <= turned_area) {
                continue;
            }
            let sound = SoundPose {
                sequence: drawn.sequence,
                phase: drawn.phase,
                pose: separated.pose,
                outcome: match separated.num_steps {
                    0 => Outcome::Sound,
                    _ => Outcome::Corrected {
                        turn: separated.largest_turn,
                    },
                },
                num_rejected: try_index,
                depths: separated.depths,
            };
            best = Some((turned_area, sound));
            if turned_area <= MAX_TURNED_AREA {
                break;
            }
        }
        let Some((_, mut sound)) = best else {
            return Err(SampleError::NoSoundPose {
                index,
                sequence: name,
                tries: self.tries,
            });
        };
        let poses = std::slice::from_mut(&mut sound.pose);
        put_on_ground(contact.body(), poses, Ground::EachPose).map_err(RetargetError::from)?;
        Ok(sound)
    }

    fn draw(&self, index: u64, try_index: u32) -> SampledPose {
        // Later tries keep the sequence: the shares stay as they are.
        let mut of_sequence = self.source(index, 0);
        let sequence = self.pick(&mut of_sequence);
        let less = 1.0 - f64::from(try_index) / f64::from(MAX_TRIES - 1);
        let mut source = if try_index == 0 {
            of_sequence
        } else {
            self.source(index, try_index)
        };
        let noise = self.noise * less;
        let mut drawn = draw_of(sequence, &mut source, noise);
        if self.is_mixed {
            drawn.angles = self.mixed_with_others(drawn.angles, &mut source, noise);
        }
        drawn
    }

    /// The angles, mixed with those of up to three more draws.
    fn mixed_with_others(
        &self,
        mut angles: BodyAngles,
        source: &mut ChaCha8Rng,
        noise: f64,
    ) -> BodyAngles {
        let mut other = || draw_of(self.pick(source), source, noise).angles;
        let [trunk, left, right] = [(); 3].map(|()| other());
        if below(source, 2) == 1 {
            angles = angles.blended(&trunk, uniform(source));
        }
        let arms = match below(source, 4) {
            0 => return angles,
            1 => left.arms,
            _ => [left.arms[0], right.arms[1]],
        };
        // Hands that are elsewhere are not where the body leans on them.
        BodyAngles {
            arms,
            hands_planted: false,
            ..angles
        }
    }

    /// A sequence, by the shares of the groups.
    fn pick(&self, source: &mut ChaCha8Rng) -> &'static Sequence {
        let of_group = |group: Group| -> Vec<&'static Sequence> {
            let all = Sequence::of_group(group);
            all.filter(|sequence| self.sequences.contains(sequence))
                .collect()
        };
        let groups = Group::ALL.map(|group| (group.percent(), of_group(group)));
        let groups: Vec<_> = groups.iter().filter(|(_, all)| !all.is_empty()).collect();
        let total = groups.iter().map(|(percent, _)| percent).sum();
        let mut percent = below(source, total);
        let mut sequences: &[&'static Sequence] = &[];
        for (share, all) in groups {
            sequences = all;
            if percent < *share {
                break;
            }
            percent -= share;
        }
        sequences[below(source, sequences.len() as u64) as usize]
    }

    fn source(&self, index: u64, try_index: u32) -> ChaCha8Rng {
        let mut seed = [0_u8; 32];
        seed[..8].copy_from_slice(&self.seed.to_le_bytes());
        seed[8..16].copy_from_slice(&index.to_le_bytes());
        seed[16..20].copy_from_slice(&try_index.to_le_bytes());
        seed[20..].copy_from_slice(b"garnet poses");
        ChaCha8Rng::from_seed(seed)
    }
}

fn draw_of(sequence: &'static Sequence, source: &mut ChaCha8Rng, noise: f64) -> SampledPose {
    let phase = uniform(source);
    let is_mirrored = below(source, 2) == 1;
    let angles = sequence.angles(phase);
    let angles = if is_mirrored {
        angles.mirrored()
    } else {
        angles
    };
    let mut shifts = [0.0; NUM_ANGLES];
    for (shift, range) in shifts.iter_mut().zip(ranges()) {
        *shift = noise * range.noise * bell(source);
    }
    SampledPose {
        sequence: sequence.name,
        group: sequence.group,
        phase,
        is_mirrored,
        angles: angles.moved_within_ranges(&shifts),
    }
}

/// A whole number below `end`.
fn below(source: &mut ChaCha8Rng, end: u64) -> u64 {
    (uniform(source) * end as f64) as u64
}

/// About a normal number of variance 1, within 3: the sum of three uniform ones.
fn bell(source: &mut ChaCha8Rng) -> f64 {
    2.0 * (uniform(source) + uniform(source) + uniform(source) - 1.5)
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, BTreeSet};

    use super::*;

    #[test]
    fn a_pose_depends_on_seed_and_number_alone() {
        let sampler = PoseSampler::new(3);
        let forwards: Vec<SampledPose> = (0..50).map(|index| sampler.sample(index)).collect();
        let backwards: Vec<SampledPose> =
            (0..50).rev().map(|index| sampler.sample(index)).collect();
        assert!(forwards.iter().eq(backwards.iter().rev()));
        assert_ne!(forwards[0], PoseSampler::new(4).sample(0));
        assert_ne!(forwards[0].angles, forwards[1].angles);
    }

    #[test]
    fn groups_come_in_their_shares() {
        const NUM_POSES: u64 = 4000;
        let sampler = PoseSampler::new(1);
        let mut counts: BTreeMap<Group, u64> = BTreeMap::new();
        for index in 0..NUM_POSES {
            *counts.entry(sampler.sample(index).group).or_default() += 1;
        }
        for group in Group::ALL {
            let percent = counts[&group] as f64 * 100.0 / NUM_POSES as f64;
            // Three standard deviations of a share of 30 % of 4000.
            assert!(
                (percent - group.percent() as f64).abs() < 2.2,
                "{group:?}: {percent}"
            );
        }
    }

    #[test]
    fn a_set_gives_its_own_sequences_alone() {
        let set =
            SequenceSet::of(|sequence, number| sequence.group != Group::Walk && number % 3 == 1);
        let sampler = PoseSampler::new(1).among(set);
        let names: BTreeSet<&str> = (0..400)
            .map(|index| sampler.sample(index).sequence)
            .collect();
        assert!(
            names
                .iter()
                .copied()
                .eq(set.names().collect::<BTreeSet<_>>())
        );
        let of_all = PoseSampler::new(1).among(SequenceSet::of(|_, _| false));
        assert_eq!(of_all, PoseSampler::new(1));
    }

    #[test]
    fn mixed_poses_have_arms_of_other_sequences_and_trunks_between_them() {
        let sampler = PoseSampler::new(7).with_noise(0.0);
        let mixed = sampler.mixed(true);
        let [mut other_arms, mut other_trunks] = [0, 0];
        for index in 0..400 {
            let (plain, mixed) = (sampler.sample(index), mixed.sample(index));
            assert_eq!(
                (plain.sequence, plain.phase, plain.is_mirrored),
                (mixed.sequence, mixed.phase, mixed.is_mirrored)
            );
            let (plain, mixed) = (plain.angles, mixed.angles);
            other_arms += u32::from(plain.arms != mixed.arms);
            other_trunks += u32::from((plain.spine, plain.legs) != (mixed.spine, mixed.legs));
            assert!(plain.arms == mixed.arms || !mixed.hands_planted);
        }
        // Arms stay in an eighth, trunk and legs in a half; three standard deviations of 400 are 20
        // and 30.
        assert!((330..=370).contains(&other_arms), "{other_arms}");
        assert!((170..=230).contains(&other_trunks), "{other_trunks}");
    }

    #[test]
    fn every_angle_stays_in_the_ranges_of_trained_people() {
        let sampler = PoseSampler::new(5).with_noise(3.0);
        let samples = |sampler: PoseSampler| (0..2000).map(move |index| sampler.sample(index));
        for sample in samples(sampler).chain(samples(sampler.mixed(true))) {
            assert_eq!(
                sample.angles.beyond_ranges(),
                Vec::new(),
                "{}",
                sample.sequence
            );
        }
    }

    #[test]
    fn without_noise_a_sample_lies_on_its_sequence() {
        let sampler = PoseSampler::new(2).with_noise(0.0);
        for index in 0..20 {
            let sample = sampler.sample(index);
            let expected = Sequence::find(sample.sequence)
                .unwrap()
                .angles(sample.phase);
            let expected = if sample.is_mirrored {
                expected.mirrored()
            } else {
                expected
            };
            assert_eq!(sample.angles, expected);
        }
    }
}
