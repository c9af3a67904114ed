//! Sequences: chains of key poses.

use super::{BodyAngles, GaitCycle, key_pose};

/// A kind of movement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Group {
    /// The gait cycle.
    Walk,
    /// Asanas.
    Yoga,
    /// Ballet and social dances.
    Dance,
    /// Reaching in all directions.
    Reach,
    /// Standing, sitting, lifting, gestures.
    Everyday,
}

impl Group {
    /// All groups of sequences.
    pub const ALL: [Self; 5] = [
        Self::Walk,
        Self::Yoga,
        Self::Dance,
        Self::Reach,
        Self::Everyday,
    ];

    /// Share of the sampler's poses, in percent.
    pub const fn percent(self) -> u64 {
        match self {
            Self::Walk => 30,
            Self::Yoga | Self::Dance => 20,
            Self::Reach | Self::Everyday => 15,
        }
    }
}

/// A movement: the gait cycle, or key poses one after the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sequence {
    /// Its name.
    pub name: &'static str,
    /// What kind it is.
    pub group: Group,
    path: Path,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Path {
    Gait(GaitCycle),
    /// Names of key poses, with spaces between them; a `~` before a name mirrors the pose.
    Keys(&'static str),
}

const fn walk(name: &'static str, speed: f64, arm_swing: f64) -> Sequence {
    Sequence {
        name,
        group: Group::Walk,
        path: Path::Gait(GaitCycle { speed, arm_swing }),
    }
}

const fn keys(name: &'static str, group: Group, names: &'static str) -> Sequence {
    Sequence {
        name,
        group,
        path: Path::Keys(names),
    }
}

/// All sequences of the library.
pub const SEQUENCES: &[Sequence] = &[
    walk("walk_stroll", 0.5, 0.8),
    walk("walk_slow", 0.75, 1.0),
    walk("walk_natural", 1.0, 1.0),
    walk("walk_brisk", 1.35, 1.1),
    walk("walk_hurried", 1.7, 1.3),
    walk("walk_arms_still", 0.9, 0.1),
    keys(
        "yoga_sun_salutation",
        Group::Yoga,
        "mountain upward_salute half_lift forward_fold half_lift chair upward_salute \
         mountain_prayer",
    ),
    keys(
        "yoga_tree",
        Group::Yoga,
        "mountain tree_prayer tree tree_prayer mountain_prayer ~tree_prayer ~tree",
    ),
    keys(
        "yoga_warriors",
        Group::Yoga,
        "mountain warrior_one high_lunge warrior_three upward_salute ~warrior_one \
         ~high_lunge",
    ),
    keys(
        "yoga_open_warriors",
        Group::Yoga,
        "star warrior_two reverse_warrior warrior_two extended_side_angle triangle star \
         ~triangle ~warrior_two",
    ),
    keys(
        "yoga_bends",
        Group::Yoga,
        "mountain upward_salute standing_side_bend upward_salute ~standing_side_bend \
         standing_back_bend mountain_prayer",
    ),
    keys(
        "yoga_chair",
        Group::Yoga,
        "mountain_prayer chair revolved_chair chair ~revolved_chair garland",
    ),
    keys(
        "yoga_goddess",
        Group::Yoga,
        "star goddess garland goddess star",
    ),
    keys(
        "yoga_balance",
        Group::Yoga,
        "mountain knee_to_chest dancer knee_to_chest warrior_three ~dancer",
    ),
    keys(
        "yoga_floor",
        Group::Yoga,
        "downward_dog plank table cat table downward_dog",
    ),
    keys(
        "yoga_kneeling",
        Group::Yoga,
        "kneel camel kneel low_lunge kneel ~low_lunge",
    ),
    keys("yoga_sitting", Group::Yoga, "staff boat staff bound_angle"),
    keys("yoga_prone", Group::Yoga, "cobra plank"),
    keys(
        "dance_port_de_bras",
        Group::Dance,
        "ballet_low port_de_bras_one port_de_bras_two port_de_bras_three \
         port_de_bras_four port_de_bras_five ballet_low",
    ),
    keys(
        "dance_plie",
        Group::Dance,
        "ballet_low demi_plie grand_plie_second demi_plie releve port_de_bras_two",
    ),
    keys(
        "dance_tendu",
        Group::Dance,
        "port_de_bras_one tendu_front tendu_side tendu_back port_de_bras_two \
         ~tendu_front ~tendu_side",
    ),
    keys(
        "dance_arabesque",
        Group::Dance,
        "tendu_back first_arabesque third_arabesque penchee attitude_back",
    ),
    keys(
        "dance_adagio",
        Group::Dance,
        "retire attitude_front developpe_front retire developpe_side tendu_side",
    ),
    keys(
        "dance_cambre",
        Group::Dance,
        "port_de_bras_five cambre_back port_de_bras_five cambre_side ~cambre_side",
    ),
    keys(
        "dance_leap",
        Group::Dance,
        "lunge_fourth grand_jete lunge_fourth",
    ),
    keys(
        "dance_jazz",
        Group::Dance,
        "jazz_lunge contraction body_wave ~jazz_lunge disco_point ~disco_point",
    ),
    keys(
        "dance_twist",
        Group::Dance,
        "twist_left ~twist_left body_wave twist_left",
    ),
    keys(
        "dance_swing",
        Group::Dance,
        "swing_kick salsa_step ~swing_kick ~salsa_step",
    ),
    keys(
        "dance_ballroom",
        Group::Dance,
        "ballroom_frame salsa_step ballroom_frame flamenco ~flamenco",
    ),
    keys(
        "reach_forward",
        Group::Reach,
        "stand reach_front reach_front_far push pull",
    ),
    keys(
        "reach_up",
        Group::Reach,
        "stand reach_shelf reach_high reach_high_left ~reach_high_left",
    ),
    keys(
        "reach_down",
        Group::Reach,
        "stand reach_low reach_low_left ~reach_low_left reach_floor_beside",
    ),
    keys(
        "reach_sideways",
        Group::Reach,
        "reach_left reach_sides ~reach_left reach_across ~reach_across twist_reach",
    ),
    keys(
        "reach_back",
        Group::Reach,
        "reach_behind reach_behind_both hand_to_small_of_back hand_between_shoulders \
         hands_behind_head",
    ),
    keys(
        "reach_around",
        Group::Reach,
        "reach_sides hug hand_to_opposite_shoulder ~hand_to_opposite_shoulder",
    ),
    keys(
        "reach_sports",
        Group::Reach,
        "throw reach_diagonal serve swim ~swim reach_up_and_down",
    ),
    keys(
        "everyday_standing",
        Group::Everyday,
        "stand stand_at_ease hands_on_hips ~lean_on_one_leg hands_in_pockets \
         hands_behind_back arms_crossed stand_wide a_pose",
    ),
    keys(
        "everyday_gestures",
        Group::Everyday,
        "stand wave point shrug salute scratch_head t_pose",
    ),
    keys(
        "everyday_phone",
        Group::Everyday,
        "texting phone_at_ear drink ~phone_at_ear look_back",
    ),
    keys(
        "everyday_sitting",
        Group::Everyday,
        "stand lean_forward sit type_at_desk sit_slouched sit_leaning_on_knees",
    ),
    keys(
        "everyday_lifting",
        Group::Everyday,
        "stand squat pick_up carry_box lean_forward",
    ),
    keys(
        "everyday_stairs",
        Group::Everyday,
        "stairs_up stairs_push_off ~stairs_up ~stairs_push_off step_forward",
    ),
    keys(
        "everyday_shoes",
        Group::Everyday,
        "step_forward kneel_on_one_knee tie_shoe kneel_on_one_knee",
    ),
];

/// Some of the [`SEQUENCES`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SequenceSet(u64);

const _: () = assert!(SEQUENCES.len() <= 64, "a set has one bit a sequence");

impl SequenceSet {
    /// The set of all sequences.
    pub const ALL: Self = Self(u64::MAX);

    /// The sequences for which `is_in` holds, given the number of the sequence in its group.
    pub fn of(mut is_in: impl FnMut(&Sequence, usize) -> bool) -> Self {
        let mut bits = 0;
        for group in Group::ALL {
            for (number, sequence) in Sequence::of_group(group).enumerate() {
                if is_in(sequence, number) {
                    bits |= bit(sequence);
                }
            }
        }
        Self(bits)
    }

    /// Whether a sequence is in the set.
    pub fn contains(self, sequence: &Sequence) -> bool {
        self.0 & bit(sequence) != 0
    }

    /// Whether no sequence is in the set.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The names of the sequences, in order.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        let all = SEQUENCES.iter();
        all.filter(move |sequence| self.contains(sequence))
            .map(|sequence| sequence.name)
    }
}

fn bit(sequence: &Sequence) -> u64 {
    let index = SEQUENCES
        .iter()
        .position(|other| other.name == sequence.name);
    index.map_or(0, |index| 1 << index)
}

impl Sequence {
    /// The sequence of a name.
    pub fn find(name: &str) -> Option<&'static Self> {
        SEQUENCES.iter().find(|sequence| sequence.name == name)
    }

    /// The sequences of a group.
    pub fn of_group(group: Group) -> impl Iterator<Item = &'static Self> {
        SEQUENCES
            .iter()
            .filter(move |sequence| sequence.group == group)
    }

    /// The pose at a phase from 0 to 1: from the first key pose to the last one, or once through
    /// the gait cycle.
    pub fn angles(&self, phase: f64) -> BodyAngles {
        let names: Vec<&str> = match self.path {
            Path::Gait(gait) => return gait.angles(phase),
            Path::Keys(names) => names.split(' ').collect(),
        };
        let phase = if phase.is_finite() {
            phase.clamp(0.0, 1.0)
        } else {
            0.0
        };
        let place = phase * names.len().saturating_sub(1) as f64;
        let first = (place as usize).min(names.len().saturating_sub(2));
        let key = |index: usize| {
            names
                .get(index)
                .map(|name| angles_of(name))
                .unwrap_or_default()
        };
        key(first).blended(&key(first + 1), place - first as f64)
    }

    /// Names of the key poses, without the marks of mirrored ones; empty for the gait cycle.
    pub fn key_names(&self) -> impl Iterator<Item = &'static str> {
        let names = match self.path {
            Path::Gait(_) => "",
            Path::Keys(names) => names,
        };
        let names = names.split_whitespace();
        names.map(|name| name.trim_start_matches('~'))
    }
}

fn angles_of(name: &str) -> BodyAngles {
    let found = key_pose(name.trim_start_matches('~'));
    let angles = found.map(|pose| pose.angles).unwrap_or_default();
    if name.starts_with('~') {
        angles.mirrored()
    } else {
        angles
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::poses::key_poses;

    #[test]
    fn every_key_pose_is_in_a_sequence_and_every_name_is_a_key_pose() {
        let used: BTreeSet<&str> = SEQUENCES.iter().flat_map(Sequence::key_names).collect();
        let known: BTreeSet<&str> = key_poses().map(|pose| pose.name).collect();
        assert_eq!(
            used.difference(&known).collect::<Vec<_>>(),
            Vec::<&&str>::new()
        );
        assert_eq!(
            known.difference(&used).collect::<Vec<_>>(),
            Vec::<&&str>::new()
        );
        assert_eq!(known.len(), key_poses().count(), "two poses have one name");
    }

    #[test]
    fn names_of_sequences_tell_their_group_and_are_unique() {
        let names: BTreeSet<&str> = SEQUENCES.iter().map(|sequence| sequence.name).collect();
        assert_eq!(names.len(), SEQUENCES.len());
        for sequence in SEQUENCES {
            let prefix = match sequence.group {
                Group::Walk => "walk_",
                Group::Yoga => "yoga_",
                Group::Dance => "dance_",
                Group::Reach => "reach_",
                Group::Everyday => "everyday_",
            };
            assert!(sequence.name.starts_with(prefix), "{}", sequence.name);
        }
        assert_eq!(Group::ALL.map(Group::percent).iter().sum::<u64>(), 100);
    }

    #[test]
    fn the_library_is_as_large_as_promised_and_within_the_ranges_of_trained_people() {
        let count = |prefix: &[&str]| {
            let sequences = SEQUENCES.iter().filter(|sequence| {
                prefix
                    .iter()
                    .any(|prefix| sequence.name.starts_with(prefix))
            });
            sequences
                .flat_map(Sequence::key_names)
                .collect::<BTreeSet<_>>()
                .len()
        };
        assert!(count(&["yoga_", "everyday_"]) >= 50);
        assert!(count(&["dance_", "reach_"]) >= 50);
        for pose in key_poses() {
            assert_eq!(pose.angles.beyond_ranges(), Vec::new(), "{}", pose.name);
        }
    }

    #[test]
    fn a_sequence_passes_through_its_key_poses() {
        let sequence = Sequence::find("yoga_tree").unwrap();
        let names: Vec<&str> = sequence.key_names().collect();
        for (index, name) in names.iter().enumerate().take(5) {
            let found = sequence
                .angles(index as f64 / (names.len() - 1) as f64)
                .to_array();
            let expected = key_pose(name).unwrap().angles.to_array();
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-6, "{name}");
            }
        }
        for phase in [f64::NAN, -1.0, 2.0] {
            assert!(
                sequence
                    .angles(phase)
                    .to_array()
                    .iter()
                    .all(|angle| angle.is_finite())
            );
        }
    }
}
