//! The 22 joints in the order and with the names of SMPL.

use garnet_skin::{Joint, Point3};

use super::anatomy::Joints;
use super::primitives::Vec3;

/// The number of joints.
pub const NUM_JOINTS: usize = 22;

/// The names of the joints: the first 22 of SMPL, in its order.
pub const JOINT_NAMES: [&str; NUM_JOINTS] = [
    "pelvis",
    "left_hip",
    "right_hip",
    "spine1",
    "left_knee",
    "right_knee",
    "spine2",
    "left_ankle",
    "right_ankle",
    "spine3",
    "left_foot",
    "right_foot",
    "neck",
    "left_collar",
    "right_collar",
    "head",
    "left_shoulder",
    "right_shoulder",
    "left_elbow",
    "right_elbow",
    "left_wrist",
    "right_wrist",
];

/// The parent of each joint.
pub const JOINT_PARENTS: [Option<usize>; NUM_JOINTS] = [
    None,
    Some(0),
    Some(0),
    Some(0),
    Some(1),
    Some(2),
    Some(3),
    Some(4),
    Some(5),
    Some(6),
    Some(7),
    Some(8),
    Some(9),
    Some(9),
    Some(9),
    Some(12),
    Some(13),
    Some(14),
    Some(16),
    Some(17),
    Some(18),
    Some(19),
];

/// The joint on the other side of the body; joints of the middle are their own.
pub(crate) fn mirrored(joint: usize) -> usize {
    match joint {
        1 | 4 | 7 | 10 | 13 | 16 | 18 | 20 => joint + 1,
        2 | 5 | 8 | 11 | 14 | 17 | 19 | 21 => joint - 1,
        _ => joint,
    }
}

/// The joints of a body at rest.
pub(crate) fn joints(at: &Joints) -> Vec<Joint> {
    let mirror = |v: Vec3| Vec3::new(-v.x, v.y, v.z);
    let positions = [
        at.pelvis,
        at.hip,
        mirror(at.hip),
        at.spine[0],
        at.knee,
        mirror(at.knee),
        at.spine[1],
        at.ankle,
        mirror(at.ankle),
        at.spine[2],
        at.foot,
        mirror(at.foot),
        at.neck,
        at.collar,
        mirror(at.collar),
        at.head,
        at.shoulder,
        mirror(at.shoulder),
        at.elbow,
        mirror(at.elbow),
        at.wrist,
        mirror(at.wrist),
    ];
    let named = JOINT_NAMES.iter().zip(JOINT_PARENTS).zip(positions);
    named
        .map(|((name, parent), position)| Joint {
            name: (*name).to_owned(),
            parent,
            rest_position: Point3::from(position.cast::<f32>()),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mirror_image_of_a_joint_has_the_other_sides_name() {
        for (joint, name) in JOINT_NAMES.iter().enumerate() {
            let other = mirrored(joint);
            assert_eq!(mirrored(other), joint);
            let expected = name.replace("left", "right");
            if other > joint {
                assert_eq!(JOINT_NAMES[other], expected);
            }
        }
    }
}
