//! Finding the joints of a figure in a skeleton: by labels, by names, and by the hierarchy.
//!
//! A name is cut into words at punctuation and where a capital follows a small letter. One word
//! tells the side: `left`, `right`, `l` or `r`. What follows the side is the name of the joint, or
//! what precedes it where nothing follows. What most joints of a skeleton have in common (`J_Bip_`,
//! `CC_Base_`, `_jnt`), words for the middle of the body, and numbers are left out where the name
//! is not known with them. That reads `LeftForeArm`, `left_elbow`, `lowerarm01.L`,
//! `mixamorig:LeftForeArm`, `Bip01 L Forearm`, `J_Bip_L_LowerArm` and `LeftForeArm_19` alike.

use garnet_skin::Skeleton;

use super::{
    joint_names::{NUM_ROLES, Role, Side, role_names},
    joint_tree::Tree,
};

/// The joint of each role.
pub(super) type Roles = [Option<usize>; NUM_ROLES];

/// From so many joints on, what most of their names have in common is no part of them.
const MIN_SHARING: usize = 6;

/// The share of the joints that have something in common.
const SHARE: f64 = 0.6;

/// Forms of a name that are tried one after the other.
const NUM_FORMS: usize = 3;

/// A name, taken apart.
#[derive(Debug, Default)]
struct Name {
    side: Option<Side>,
    /// The word of the joint: as it stands, without what is shared, and without numbers.
    forms: [String; NUM_FORMS],
}

/// The joint of each role `[role]`, by [`Role::index`]: those that [`Skeleton::labels`] tells, then
/// those whose names are known, then those that the hierarchy leaves no doubt of; and whether the
/// sides are those of the toes, and not of the names.
pub(super) fn find_roles(skeleton: &Skeleton) -> (Roles, bool) {
    let joints = skeleton.joints();
    let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    let mut roles = by_names(&names);
    let labels = skeleton.labels();
    for role in Role::ALL {
        if let Some(&joint) = labels.get(role.name()) {
            // What a label tells is nothing else.
            for other in roles.iter_mut().filter(|other| **other == Some(joint)) {
                *other = None;
            }
            roles[role.index()] = Some(joint);
        }
    }
    Tree::new(skeleton).complete(&mut roles);
    let are_swapped = are_swapped(skeleton, &roles);
    if are_swapped {
        swap_sides(&mut roles);
    }
    (roles, are_swapped)
}

/// Toes that point backwards by more than this cosine tell that left and right are exchanged.
/// Lower ones believe feet that are turned aside.
const BACKWARDS: f64 = -0.7;

/// Whether both feet point to the back of who has these sides: rigs that were mirrored, or named
/// as they are seen.
fn are_swapped(skeleton: &Skeleton, roles: &Roles) -> bool {
    let at = |role: Role| {
        let joint = &skeleton.joints()[roles[role.index()]?];
        Some(joint.rest_position.coords.cast::<f64>())
    };
    let is_backwards = |side: Side| {
        let [left_hip, right_hip] = Side::BOTH.map(|side| at(Role::Hip(side)));
        let across = left_hip? - right_hip?;
        let ankle = at(Role::Ankle(side))?;
        let up = at(Role::Head)? - ankle;
        let foot = at(Role::Foot(side))? - ankle;
        let flat = foot - up * (up.dot(&foot) / up.norm_squared());
        let front = across.cross(&up);
        // Feet that hang down point nowhere.
        let is_flat = flat.norm() > 0.5 * foot.norm();
        Some(is_flat && flat.dot(&front) < BACKWARDS * flat.norm() * front.norm())
    };
    Side::BOTH
        .into_iter()
        .all(|side| is_backwards(side) == Some(true))
}

/// Gives the joints of each side to the other.
fn swap_sides(roles: &mut Roles) {
    let of_left: [fn(Side) -> Role; 8] = [
        Role::Collar,
        Role::Shoulder,
        Role::Elbow,
        Role::Wrist,
        Role::Hip,
        Role::Knee,
        Role::Ankle,
        Role::Foot,
    ];
    for role in of_left {
        let [left, right] = Side::BOTH.map(|side| role(side).index());
        roles.swap(left, right);
    }
}

/// The joints whose names are known.
pub(super) fn by_names(names: &[&str]) -> Roles {
    let parsed = parsed(names);
    let find = |side: Option<Side>, word: &str, form: usize| {
        let mut joints = parsed.iter();
        joints.position(|name| name.side == side && name.forms[form] == word)
    };
    let mut roles = [None; NUM_ROLES];
    roles[Role::Head.index()] = (0..NUM_FORMS).find_map(|form| find(None, "head", form));
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
            let tries = (0..NUM_FORMS)
                .flat_map(|form| role_names(role).iter().map(move |word| (form, word)));
            let mut joints = tries.filter_map(|(form, word)| find(Some(side), word, form));
            let joint = joints.find(|joint| !taken.contains(joint));
            taken.extend(joint);
            roles[role.index()] = joint;
        }
    }
    roles
}

fn parsed(names: &[&str]) -> Vec<Name> {
    let short: Vec<&str> = names.iter().map(|name| without_space(name)).collect();
    let short = without_common_start(&short);
    let words: Vec<Vec<String>> = short.iter().map(|name| words(name)).collect();
    let mut core = words.clone();
    strip_shared(
        &mut core,
        |words| (words.len() > 1).then(|| words.remove(0)),
        |words| words.first().cloned(),
    );
    strip_shared(&mut core, Vec::pop, |words| words.last().cloned());
    let names = words.iter().zip(&core);
    names.map(|(words, core)| Name::new(words, core)).collect()
}

/// A name without the namespace before it.
fn without_space(name: &str) -> &str {
    let last = name.rsplit([':', '|']).next().unwrap_or(name);
    if last.is_empty() { name } else { last }
}

/// Names without the letters with which all of them start.
fn without_common_start<'a>(names: &[&'a str]) -> Vec<&'a str> {
    let Some((first, others)) = names.split_first() else {
        return Vec::new();
    };
    let common = |name: &&str| {
        let pairs = first.bytes().zip(name.bytes());
        pairs.take_while(|(a, b)| a == b).count()
    };
    let mut length = others.iter().map(common).min().unwrap_or(0);
    let is_cut = |length: &usize| names.iter().all(|name| name.is_char_boundary(*length));
    while !is_cut(&length) {
        length -= 1;
    }
    // Separated words are cut elsewhere; here it is letters alone, such as `herohead`.
    let is_sharing = names.len() >= MIN_SHARING && length >= 3;
    if !is_sharing || names.iter().any(|name| name.len() == length) {
        return names.to_vec();
    }
    names.iter().map(|name| &name[length..]).collect()
}

/// Takes off words that most names have in one place, one after the other.
fn strip_shared(
    names: &mut [Vec<String>],
    take: impl Fn(&mut Vec<String>) -> Option<String>,
    look: impl Fn(&Vec<String>) -> Option<String>,
) {
    if names.len() < MIN_SHARING {
        return;
    }
    for _ in 0..4 {
        let mut found: Vec<String> = names.iter().filter_map(&look).collect();
        found.sort_unstable();
        let runs = found.chunk_by(|a, b| a == b);
        let Some(run) = runs.max_by_key(|run| run.len()) else {
            return;
        };
        let word = run[0].clone();
        let is_shared = run.len() as f64 >= SHARE * names.len() as f64;
        if !is_shared || side_of(&word).is_some() {
            return;
        }
        for words in names.iter_mut().filter(|words| words.len() > 1) {
            if look(words).is_some_and(|found| found == word) {
                take(words);
            }
        }
    }
}

impl Name {
    /// Takes the words of a name apart: all of them, and those that are not shared.
    fn new(words: &[String], core: &[String]) -> Self {
        let (side, plain) = side_and_words(words);
        let (core_side, core) = side_and_words(core);
        let core: Vec<String> = if core_side == side {
            core
        } else {
            plain.clone()
        };
        let in_middle = |word: &String| MIDDLE.contains(&word.as_str());
        let core: Vec<String> = match side {
            None => core.into_iter().filter(|word| !in_middle(word)).collect(),
            Some(_) => core,
        };
        let is_number = |word: &String| word.bytes().all(|byte| byte.is_ascii_digit());
        let bare: Vec<String> = core
            .iter()
            .filter(|word| !is_number(word))
            .cloned()
            .collect();
        let forms = [
            without_prefix(&plain),
            without_prefix(&core),
            without_prefix(&bare),
        ];
        let forms = forms.map(<[String]>::concat);
        if side.is_some() {
            return Self { side, forms };
        }
        // `lfemur`, as Acclaim files have it, and `lFArm`, as OptiTrack.
        let whole = &forms[0];
        for (letters, side) in [
            ("left", Side::Left),
            ("right", Side::Right),
            ("l", Side::Left),
            ("r", Side::Right),
        ] {
            for form in &forms {
                let Some(rest) = form.strip_prefix(letters) else {
                    continue;
                };
                let is_known = |role: &Role| role_names(*role).contains(&rest);
                if rest != "head" && whole != "leg" && Role::ALL.iter().any(is_known) {
                    let forms = [rest.to_owned(), String::new(), String::new()];
                    let side = Some(side);
                    return Self { side, forms };
                }
            }
        }
        Self { side, forms }
    }
}

/// Words for the middle of the body.
const MIDDLE: [&str; 7] = ["c", "m", "mid", "middle", "center", "centre", "ctr"];

fn side_of(word: &str) -> Option<Side> {
    match word {
        "left" | "l" | "lft" | "lt" => Some(Side::Left),
        "right" | "r" | "rgt" | "rt" => Some(Side::Right),
        _ => None,
    }
}

/// The side of a name and the words after it, or those before it where no word follows.
fn side_and_words(words: &[String]) -> (Option<Side>, Vec<String>) {
    let mut sides = words.iter().enumerate();
    let found = sides.find_map(|(place, word)| side_of(word).map(|side| (place, side)));
    let Some((place, side)) = found else {
        return (None, words.to_vec());
    };
    let after = &words[place + 1..];
    let is_number = |word: &String| word.bytes().all(|byte| byte.is_ascii_digit());
    if after.iter().all(is_number) {
        // A number behind the side is one of several joints: `thigh.L.001`.
        let before = words[..place].iter().chain(after);
        return (Some(side), before.cloned().collect());
    }
    (Some(side), after.to_vec())
}

/// Cuts a name at punctuation and before capitals, and makes the letters small.
fn words(name: &str) -> Vec<String> {
    // Maya's `lf_clavicle`, which is not the `LFArm` of OptiTrack.
    let parts = name.split_inclusive(|letter: char| !letter.is_ascii_alphanumeric());
    let spelled: String = parts
        .map(|part| match part.get(..2) {
            Some(mark) if mark.eq_ignore_ascii_case("lf") && part[2..].chars().count() < 2 => {
                format!("left{}", part[2..].to_ascii_lowercase())
            }
            _ => part.to_owned(),
        })
        .collect();
    let letters: Vec<char> = spelled.chars().take(128).collect();
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
    const PREFIXES: [&str; 7] = [
        "mixamorig",
        "bip",
        "def",
        "org",
        "character",
        "valvebiped",
        "armature",
    ];
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
            let found = by_names(&rig);
            for (joint, role) in roles(Side::Left).into_iter().enumerate() {
                assert_eq!(found[role.index()], Some(joint), "{}", rig[joint]);
            }
            assert_eq!(found[Role::Knee(Side::Right).index()], None);
        }
    }

    /// The same with the pelvis first and the head after it.
    const FAMILIES: [&str; 9] = [
        "J_Bip_C_Hips, J_Bip_C_Head, J_Bip_L_Shoulder, J_Bip_L_UpperArm, J_Bip_L_LowerArm, \
         J_Bip_L_Hand, J_Bip_L_UpperLeg, J_Bip_L_LowerLeg, J_Bip_L_Foot, J_Bip_L_ToeBase",
        "CC_Base_Hip, CC_Base_Head, CC_Base_L_Clavicle, CC_Base_L_Upperarm, CC_Base_L_Forearm, \
         CC_Base_L_Hand, CC_Base_L_Thigh, CC_Base_L_Calf, CC_Base_L_Foot, CC_Base_L_ToeBase",
        "Root_M, Head_M, Scapula_L, Shoulder_L, Elbow_L, Wrist_L, Hip_L, Knee_L, Ankle_L, Toes_L",
        "Hips_01, Head_016, LeftShoulder_014, LeftArm_017, LeftForeArm_019, LeftHand_021, \
         LeftUpLeg_02, LeftLeg_05, LeftFoot_08, LeftToeBase_011",
        "Hips, Head.001, Left shoulder, Left arm, Left elbow, Left wrist, Left leg, Left knee, \
         Left ankle, Left toe",
        "Hip, Head, LShoulder, LUArm, LFArm, LHand, LThigh, LShin, LFoot, LToe",
        "hero_pelvis_jnt, hero_head_jnt, hero_clavicle_l_jnt, hero_upperarm_l_jnt, \
         hero_lowerarm_l_jnt, hero_hand_l_jnt, hero_thigh_l_jnt, hero_calf_l_jnt, \
         hero_foot_l_jnt, hero_ball_l_jnt",
        "jnt_pelvis, jnt_head, jnt_lf_clavicle, jnt_lf_upperarm, jnt_lf_forearm, jnt_lf_hand, \
         jnt_lf_thigh, jnt_lf_shin, jnt_lf_foot, jnt_lf_toe",
        "m_avg_Pelvis, m_avg_Head, m_avg_L_Collar, m_avg_L_Shoulder, m_avg_L_Elbow, \
         m_avg_L_Wrist, m_avg_L_Hip, m_avg_L_Knee, m_avg_L_Ankle, m_avg_L_Foot",
    ];

    #[test]
    fn prefixes_and_suffixes_that_joints_share_are_no_part_of_their_names() {
        let [limbs @ .., head] = roles(Side::Left);
        let full: Vec<Role> = std::iter::once(head).chain(limbs).collect();
        for family in FAMILIES {
            let names: Vec<&str> = family.split(", ").collect();
            let found = by_names(&names);
            for (joint, &role) in full.iter().enumerate() {
                assert_eq!(found[role.index()], Some(joint + 1), "{}", names[joint + 1]);
            }
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
        assert_eq!(by_names(&names), [None; NUM_ROLES]);
    }

    #[test]
    fn every_role_stands_at_its_index() {
        for (index, role) in Role::ALL.into_iter().enumerate() {
            assert_eq!(role.index(), index);
        }
    }
}
