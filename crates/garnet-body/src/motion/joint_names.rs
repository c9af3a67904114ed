//! Which joint is which: the names that rigs give to the joints of limbs and head.
//!
//! A name is cut into words at punctuation and where a capital follows a small letter. One word
//! tells the side: `left`, `right`, `l` or `r`. What follows the side is the name of the joint, or
//! what precedes it where nothing follows, without prefixes such as `mixamorig`. That reads
//! `LeftForeArm`, `left_elbow`, `lowerarm01.L`, `mixamorig:LeftForeArm`, `Bip01 L Forearm`,
//! `lForeArm` and `DEF-forearm.L` alike; the words for each joint are in [`role_names`].
//!
//! Two words mean different joints in different rigs: a `LeftShoulder` is the collarbone where
//! there is a `LeftArm`, and the shoulder joint where there is a `left_collar`; a `left_foot` is
//! the ankle where nothing is called so, and the ball of the foot beside a `left_ankle`.

/// A joint of a limb, or the head. Pelvis, spine and neck are found by what hangs on them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// The joint of skull and neck.
    Head,
    /// The inner end of a collarbone.
    Collar(Side),
    /// The joint of collarbone and upper arm.
    Shoulder(Side),
    /// The joint of upper arm and forearm.
    Elbow(Side),
    /// The joint of forearm and hand.
    Wrist(Side),
    /// The joint of pelvis and thigh.
    Hip(Side),
    /// The joint of thigh and shank.
    Knee(Side),
    /// The joint of shank and foot.
    Ankle(Side),
    /// The ball of the foot.
    Foot(Side),
}

/// A side of the body, as the body itself names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Side {
    /// +x at rest.
    Left,
    /// -x at rest.
    Right,
}

impl Side {
    /// Left, then right.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// 0 for left, 1 for right.
    pub const fn index(self) -> usize {
        match self {
            Self::Left => 0,
            Self::Right => 1,
        }
    }

    /// 1 for left, -1 for right.
    pub const fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

/// How many roles there are.
pub(super) const NUM_ROLES: usize = 17;

impl Role {
    /// All roles.
    pub const ALL: [Self; NUM_ROLES] = {
        use Side::{Left, Right};
        [
            Self::Head,
            Self::Collar(Left),
            Self::Collar(Right),
            Self::Shoulder(Left),
            Self::Shoulder(Right),
            Self::Elbow(Left),
            Self::Elbow(Right),
            Self::Wrist(Left),
            Self::Wrist(Right),
            Self::Hip(Left),
            Self::Hip(Right),
            Self::Knee(Left),
            Self::Knee(Right),
            Self::Ankle(Left),
            Self::Ankle(Right),
            Self::Foot(Left),
            Self::Foot(Right),
        ]
    };

    /// Position in [`Role::ALL`].
    pub(super) const fn index(self) -> usize {
        match self {
            Self::Head => 0,
            Self::Collar(side) => 1 + side.index(),
            Self::Shoulder(side) => 3 + side.index(),
            Self::Elbow(side) => 5 + side.index(),
            Self::Wrist(side) => 7 + side.index(),
            Self::Hip(side) => 9 + side.index(),
            Self::Knee(side) => 11 + side.index(),
            Self::Ankle(side) => 13 + side.index(),
            Self::Foot(side) => 15 + side.index(),
        }
    }

    /// The name of the joint in the built-in skeleton.
    pub const fn name(self) -> &'static str {
        const NAMES: [&str; NUM_ROLES] = [
            "head",
            "left_collar",
            "right_collar",
            "left_shoulder",
            "right_shoulder",
            "left_elbow",
            "right_elbow",
            "left_wrist",
            "right_wrist",
            "left_hip",
            "right_hip",
            "left_knee",
            "right_knee",
            "left_ankle",
            "right_ankle",
            "left_foot",
            "right_foot",
        ];
        NAMES[self.index()]
    }

    /// Whether a figure is no figure without it: all but collarbones and feet.
    pub const fn is_required(self) -> bool {
        !matches!(self, Self::Collar(_) | Self::Foot(_))
    }
}

/// The words for the joints of a limb, without the side, in small letters and without punctuation;
/// the first word that a rig has is taken. The rigs that use a word are named beside it.
pub fn role_names(role: Role) -> &'static [&'static str] {
    match role {
        Role::Head => &["head"],
        // SMPL, classic BVH, DAZ | MakeHuman, Unreal | 3ds Max biped | CMU BVH, Mixamo, Rigify
        Role::Collar(_) => &["collar", "clavicle", "clav", "shoulder"],
        // MakeHuman | Unreal, Rigify, VRM, 3ds Max | others | DAZ, Poser | Acclaim | CMU BVH,
        // Mixamo
        // | SMPL, classic BVH
        Role::Shoulder(_) => &[
            "upperarm01",
            "upperarm",
            "uparm",
            "shldrbend",
            "shldr",
            "humerus",
            "arm",
            "shoulder",
        ],
        // SMPL, classic BVH | CMU BVH, Mixamo, Rigify, biped, Poser | DAZ | MakeHuman | Unreal, VRM
        // | others | Acclaim
        Role::Elbow(_) => &[
            "elbow",
            "forearm",
            "forearmbend",
            "lowerarm01",
            "lowerarm",
            "lowarm",
            "radius",
        ],
        // SMPL, classic BVH, MakeHuman, Acclaim | all others
        Role::Wrist(_) => &["wrist", "hand"],
        // Unreal, Rigify, biped, Poser | DAZ | CMU BVH, Mixamo | MakeHuman | VRM | Acclaim | SMPL,
        // classic BVH
        Role::Hip(_) => &[
            "thigh",
            "thighbend",
            "upleg",
            "upperleg01",
            "upperleg",
            "femur",
            "hip",
        ],
        // SMPL, classic BVH | Rigify, Poser | Unreal, biped | MakeHuman | VRM | others | Acclaim |
        // CMU BVH, Mixamo
        Role::Knee(_) => &[
            "knee",
            "shin",
            "calf",
            "lowerleg01",
            "lowerleg",
            "lowleg",
            "tibia",
            "leg",
        ],
        // SMPL, classic BVH | all others
        Role::Ankle(_) => &["ankle", "foot"],
        // SMPL beside `ankle` | CMU BVH, Mixamo | Rigify, Poser | Acclaim | Unreal | MakeHuman |
        // biped
        Role::Foot(_) => &[
            "foot", "toebase", "toe", "toes", "ball", "toe21", "toe31", "toe11", "toe0",
        ],
    }
}

/// The joint of each role `[role]`, by [`Role::index`].
pub(super) fn find_roles<'a>(names: impl Iterator<Item = &'a str>) -> [Option<usize>; NUM_ROLES] {
    let parsed: Vec<(Option<Side>, String)> = names.map(side_and_word).collect();
    let find = |side: Option<Side>, word: &str| {
        let mut joints = parsed.iter();
        joints.position(|(found, name)| *found == side && name == word)
    };
    let mut roles = [None; NUM_ROLES];
    roles[Role::Head.index()] = find(None, "head");
    for side in Side::BOTH {
        let mut taken = Vec::new();
        // Collarbone and ball of the foot last: they get the words that shoulder and ankle leave.
        for role in [
            Role::Shoulder(side),
            Role::Elbow(side),
            Role::Wrist(side),
            Role::Hip(side),
            Role::Knee(side),
            Role::Ankle(side),
            Role::Collar(side),
            Role::Foot(side),
        ] {
            let words = role_names(role).iter();
            let mut joints = words.filter_map(|word| find(Some(side), word));
            let joint = joints.find(|joint| !taken.contains(joint));
            taken.extend(joint);
            roles[role.index()] = joint;
        }
    }
    roles
}

/// The side and the word of a name.
fn side_and_word(name: &str) -> (Option<Side>, String) {
    let words = words(name.rsplit([':', '|']).next().unwrap_or(name));
    let side_of = |word: &str| match word {
        "left" | "l" => Some(Side::Left),
        "right" | "r" => Some(Side::Right),
        _ => None,
    };
    let side = words
        .iter()
        .enumerate()
        .find_map(|(index, word)| side_of(word).map(|side| (index, side)));
    if let Some((index, side)) = side {
        let after = words[index + 1..].concat();
        let word = if after.is_empty() {
            without_prefix(&words[..index]).concat()
        } else {
            after
        };
        return (Some(side), word);
    }
    let word = without_prefix(&words).concat();
    // `lfemur`, as Acclaim files have it.
    for (letters, side) in [
        ("left", Side::Left),
        ("right", Side::Right),
        ("l", Side::Left),
        ("r", Side::Right),
    ] {
        if let Some(rest) = word.strip_prefix(letters) {
            let is_known = |role: &Role| role_names(*role).contains(&rest);
            if rest != "head" && Role::ALL.iter().any(is_known) {
                return (Some(side), rest.to_owned());
            }
        }
    }
    (None, word)
}

/// Cuts a name at punctuation and before capitals, and makes the letters small.
fn words(name: &str) -> Vec<String> {
    let letters: Vec<char> = name.chars().take(128).collect();
    let mut words: Vec<String> = Vec::new();
    let mut is_open = false;
    for (index, &letter) in letters.iter().enumerate() {
        if !letter.is_ascii_alphanumeric() {
            is_open = false;
            continue;
        }
        let previous = index.checked_sub(1).map(|index| letters[index]);
        let next = letters.get(index + 1);
        let after_small = previous.is_some_and(|previous| !previous.is_ascii_uppercase());
        let before_small = next.is_some_and(char::is_ascii_lowercase);
        if letter.is_ascii_uppercase() && (after_small || before_small) {
            is_open = false;
        }
        if !is_open {
            words.push(String::new());
            is_open = true;
        }
        if let Some(word) = words.last_mut() {
            word.push(letter.to_ascii_lowercase());
        }
    }
    words
}

fn without_prefix(words: &[String]) -> &[String] {
    const PREFIXES: [&str; 6] = ["mixamorig", "bip", "def", "org", "character", "valvebiped"];
    match words {
        [first, rest @ ..] if !rest.is_empty() => {
            let word = first.trim_end_matches(|letter: char| letter.is_ascii_digit());
            if PREFIXES.contains(&word) {
                rest
            } else {
                words
            }
        }
        _ => words,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names of collar, shoulder, elbow, wrist, hip, knee, ankle, ball of the foot and head.
    const RIGS: [&str; 10] = [
        "left_collar, left_shoulder, left_elbow, left_wrist, left_hip, left_knee, \
         left_ankle, left_foot, head",
        "LeftShoulder, LeftArm, LeftForeArm, LeftHand, LeftUpLeg, LeftLeg, LeftFoot, \
         LeftToeBase, Head",
        "mixamorig:LeftShoulder, mixamorig:LeftArm, mixamorig:LeftForeArm, \
         mixamorig:LeftHand, mixamorig:LeftUpLeg, mixamorig:LeftLeg, mixamorig:LeftFoot, \
         mixamorig:LeftToeBase, mixamorig:Head",
        "clavicle.L, upperarm01.L, lowerarm01.L, wrist.L, upperleg01.L, lowerleg01.L, \
         foot.L, toe2-1.L, head",
        "DEF-shoulder.L, DEF-upper_arm.L, DEF-forearm.L, DEF-hand.L, DEF-thigh.L, \
         DEF-shin.L, DEF-foot.L, DEF-toe.L, DEF-head",
        "Bip01 L Clavicle, Bip01 L UpperArm, Bip01 L Forearm, Bip01 L Hand, Bip01 L Thigh, \
         Bip01 L Calf, Bip01 L Foot, Bip01 L Toe0, Bip01 Head",
        "lCollar, lShldr, lForeArm, lHand, lThigh, lShin, lFoot, lToe, head",
        "clavicle_l, upperarm_l, lowerarm_l, hand_l, thigh_l, calf_l, foot_l, ball_l, head",
        "lclavicle, lhumerus, lradius, lwrist, lfemur, ltibia, lfoot, ltoes, head",
        "LeftCollar, LeftShoulder, LeftElbow, LeftWrist, LeftHip, LeftKnee, LeftAnkle, \
         LeftToe, Head",
    ];

    fn roles(side: Side) -> [Role; 9] {
        [
            Role::Collar(side),
            Role::Shoulder(side),
            Role::Elbow(side),
            Role::Wrist(side),
            Role::Hip(side),
            Role::Knee(side),
            Role::Ankle(side),
            Role::Foot(side),
            Role::Head,
        ]
    }

    #[test]
    fn the_joints_of_ten_kinds_of_rigs_are_found() {
        for rig in RIGS {
            let rig: Vec<&str> = rig.split(", ").collect();
            let found = find_roles(rig.iter().copied());
            for (joint, role) in roles(Side::Left).into_iter().enumerate() {
                assert_eq!(found[role.index()], Some(joint), "{}", rig[joint]);
            }
            assert_eq!(found[Role::Knee(Side::Right).index()], None);
        }
    }

    #[test]
    fn fingers_and_helper_joints_are_no_limbs() {
        let names = [
            "LHipJoint",
            "LeftHandIndex1",
            "LThumb",
            "HeadTop_End",
            "finger2-1.L",
            "upperarm02.L",
        ];
        assert_eq!(find_roles(names.into_iter()), [None; NUM_ROLES]);
    }

    #[test]
    fn every_role_stands_at_its_index() {
        for (index, role) in Role::ALL.into_iter().enumerate() {
            assert_eq!(role.index(), index);
        }
    }
}
