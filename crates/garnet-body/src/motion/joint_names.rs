//! Which joint is which: the names that rigs give to the joints of limbs and head.
//!
//! How a name is read and what is done where names tell nothing stands in `joint_search`; the words
//! for each joint are in [`role_names`].
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
    /// Both sides, the left one first.
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
    /// All roles that a joint may have.
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
        // SMPL, classic BVH, DAZ | MakeHuman, Unreal | 3ds Max biped | AdvancedSkeleton | CMU BVH,
        // Mixamo, Rigify
        Role::Collar(_) => &["collar", "clavicle", "clav", "scapula", "shoulder"],
        // MakeHuman | Unreal, Rigify, VRM, 3ds Max | others | OptiTrack | DAZ, Poser | Acclaim |
        // Auto-Rig Pro | CMU BVH, Mixamo | SMPL, classic BVH
        Role::Shoulder(_) => &[
            "upperarm01",
            "upperarm",
            "uparm",
            "uarm",
            "armupper",
            "armup",
            "shldrbend",
            "shldr",
            "humerus",
            "bicep",
            "armstretch",
            "arm",
            "shoulder",
        ],
        // SMPL, classic BVH | CMU BVH, Mixamo, Rigify, biped, Poser | DAZ | MakeHuman | Unreal, VRM
        // | others | OptiTrack | Acclaim
        Role::Elbow(_) => &[
            "elbow",
            "forearm",
            "forearmbend",
            "forearmstretch",
            "lowerarm01",
            "lowerarm",
            "lowarm",
            "armlower",
            "armlow",
            "farm",
            "radius",
        ],
        // SMPL, classic BVH, MakeHuman, Acclaim | all others
        Role::Wrist(_) => &["wrist", "hand"],
        // Unreal, Rigify, biped, Poser | DAZ | CMU BVH, Mixamo | MakeHuman | VRM | Acclaim | SMPL,
        // classic BVH | VRChat, beside a knee
        Role::Hip(_) => &[
            "thigh",
            "thighbend",
            "thighstretch",
            "upleg",
            "upperleg01",
            "upperleg",
            "uleg",
            "legupper",
            "legup",
            "femur",
            "hip",
            "leg",
        ],
        // SMPL, classic BVH | Rigify, Poser | Unreal, biped | MakeHuman | VRM | others | Acclaim |
        // CMU BVH, Mixamo
        Role::Knee(_) => &[
            "knee",
            "shin",
            "calf",
            "shank",
            "legstretch",
            "lowerleg01",
            "lowerleg",
            "lowleg",
            "leglower",
            "leglow",
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
