//! Motions carried over from one skeleton to another.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod common;

use common::{CMU, bone, pose, renamed, skeleton, without_limbs};
use garnet_body::motion::{
    Motion, ReadOptions, Retarget, RetargetError, RetargetOptions, Role, Side, StartAt, Upward,
    world_rotations,
};
use garnet_body::shape::JOINT_NAMES;
use garnet_skin::{Joint, Point3, Pose, Skeleton, Vector3};
use nalgebra::UnitQuaternion;

const BLENDER: [&str; 22] = [
    "root",
    "upperleg01.L",
    "upperleg01.R",
    "spine05",
    "lowerleg01.L",
    "lowerleg01.R",
    "spine03",
    "foot.L",
    "foot.R",
    "spine01",
    "toe2-1.L",
    "toe2-1.R",
    "neck01",
    "clavicle.L",
    "clavicle.R",
    "head",
    "upperarm01.L",
    "upperarm01.R",
    "lowerarm01.L",
    "lowerarm01.R",
    "wrist.L",
    "wrist.R",
];

/// The motion of one pose of a skeleton.
fn motion(skeleton: &Skeleton, frames: Vec<Pose>) -> Motion {
    Motion {
        skeleton: skeleton.clone(),
        frames,
        frame_time: None,
        notes: Vec::new(),
    }
}

fn limbs() -> impl Iterator<Item = (Role, Role)> {
    Side::BOTH.into_iter().flat_map(|side| {
        [
            (Role::Shoulder(side), Role::Elbow(side)),
            (Role::Elbow(side), Role::Wrist(side)),
            (Role::Hip(side), Role::Knee(side)),
            (Role::Knee(side), Role::Ankle(side)),
            (Role::Ankle(side), Role::Foot(side)),
        ]
    })
}

#[test]
fn a_motion_on_its_own_skeleton_stays_as_it_is() {
    let skeleton = skeleton(45.0, 3.0);
    let motion = motion(&skeleton, vec![pose(22, 1.0), pose(22, 3.0)]);
    let options = RetargetOptions {
        start_at: StartAt::Motion,
        ..RetargetOptions::default()
    };
    let retarget = Retarget::new(&motion, &skeleton, &options).unwrap();
    assert!((retarget.scale() - 1.0).abs() < 1e-9);
    for (frame, expected) in motion.frames.iter().enumerate() {
        let found = retarget.pose(frame).unwrap();
        for (joint, expected) in world_rotations(&skeleton, expected).into_iter().enumerate() {
            let found = world_rotations(&skeleton, &found)[joint];
            assert!(found.angle_to(&expected) < 1e-3, "{}", JOINT_NAMES[joint]);
        }
    }
}

#[test]
fn bones_keep_their_directions_between_rest_poses_names_axes_and_sizes() {
    let target = skeleton(45.0, 3.0);
    for (names, arms, legs) in [
        (CMU, 0.0, 20.0),
        (BLENDER, 50.0, 5.0),
        (JOINT_NAMES, -30.0, 0.0),
    ] {
        let source = renamed(&skeleton(arms, legs), &names);
        // Larger, and facing -x at rest.
        let turn =
            UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -std::f32::consts::FRAC_PI_2);
        let joints = source.joints().iter().map(|joint| Joint {
            rest_position: Point3::from(turn * joint.rest_position.coords * 1.5),
            ..joint.clone()
        });
        let source = Skeleton::new(joints.collect()).unwrap();
        let motion = motion(&source, vec![pose(22, 0.7)]);
        let retarget = Retarget::new(&motion, &target, &RetargetOptions::default()).unwrap();
        let found = retarget.pose(0).unwrap();
        for (role, next) in limbs() {
            let expected = bone(&source, &motion.frames[0], role, next);
            let found = bone(&target, &found, role, next);
            assert!(
                (found - expected).norm() < 1e-3,
                "{}: {found} {expected}",
                role.name()
            );
        }
        let rest = retarget_of_rest(&source, &target);
        let head = bone(&target, &rest, Role::Hip(Side::Left), Role::Head);
        assert!(head.y > 0.9, "an upright rest pose stays upright: {head}");
    }
}

fn retarget_of_rest(source: &Skeleton, target: &Skeleton) -> Pose {
    let motion = motion(source, vec![Pose::rest(source.num_joints())]);
    Retarget::new(&motion, target, &RetargetOptions::default())
        .unwrap()
        .pose(0)
        .unwrap()
}

#[test]
fn the_twist_of_the_source_comes_along() {
    let (source, target) = (renamed(&skeleton(0.0, 0.0), &CMU), skeleton(45.0, 3.0));
    let mut turned = Pose::rest(22);
    let wrist = source.find("LeftHand").unwrap();
    turned.rotations[wrist] = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.8);
    let motion = motion(&source, vec![Pose::rest(22), turned]);
    let retarget = Retarget::new(&motion, &target, &RetargetOptions::default()).unwrap();
    let wrist = target.find("left_wrist").unwrap();
    let [rest, turned] = [0, 1].map(|frame| retarget.pose(frame).unwrap());
    let [rest, turned] = [rest, turned].map(|pose| world_rotations(&target, &pose)[wrist]);
    let twist = (turned * rest.inverse()).scaled_axis();
    assert!(
        (twist - nalgebra::Vector3::new(0.8, 0.0, 0.0)).norm() < 1e-4,
        "{twist}"
    );
}

#[test]
fn the_twist_of_every_bone_about_itself_arrives() {
    // Rest poses agree in all but names and size: a turn of a bone about itself is met.
    let (source, target) = (renamed(&skeleton(45.0, 3.0), &CMU), skeleton(45.0, 3.0));
    for (role, next) in limbs() {
        let figure = garnet_body::motion::Figure::new(&source, "the motion").unwrap();
        let [joint, end] = [role, next].map(|role| figure.joint(role).unwrap());
        let rest = |joint: usize| source.joints()[joint].rest_position;
        let axis = nalgebra::Unit::new_normalize(rest(end) - rest(joint));
        let mut twisted = pose(22, 0.4);
        twisted.rotations[joint] *= UnitQuaternion::from_axis_angle(&axis, 1.1);
        let motion = motion(&source, vec![twisted]);
        let retarget = Retarget::new(&motion, &target, &RetargetOptions::default()).unwrap();
        let found = world_rotations(&target, &retarget.pose(0).unwrap());
        let expected = world_rotations(&source, &motion.frames[0]);
        let found = found[target.find(role.name()).unwrap()];
        let off = found.angle_to(&expected[joint]).to_degrees();
        assert!(off < 0.1, "{}: {off}", role.name());
    }
}

#[test]
fn a_mirrored_motion_gives_the_mirror_image() {
    let (source, target) = (renamed(&skeleton(0.0, 20.0), &CMU), skeleton(45.0, 3.0));
    let given = pose(22, 0.7);
    let side = |name: &str| match name.split_once('_') {
        Some(("left", rest)) => format!("right_{rest}"),
        Some(("right", rest)) => format!("left_{rest}"),
        _ => name.to_owned(),
    };
    let other = |joint: usize| target.find(&side(&target.joints()[joint].name)).unwrap();
    // The mirror image in the plane x = 0 of a rotation keeps what is along x of its axis.
    let mirror = |rotation: UnitQuaternion<f32>| {
        let [x, y, z, w] = rotation.coords.into();
        UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, -y, -z))
    };
    let mut mirrored = Pose::rest(22);
    for joint in 0..22 {
        mirrored.rotations[other(joint)] = mirror(given.rotations[joint]);
    }
    let motion = motion(&source, vec![given, mirrored]);
    let retarget = Retarget::new(&motion, &target, &RetargetOptions::default()).unwrap();
    let [given, mirrored] = [0, 1].map(|frame| retarget.pose(frame).unwrap());
    for joint in 0..22 {
        let off = mirror(given.rotations[joint]).angle_to(&mirrored.rotations[other(joint)]);
        assert!(off < 1e-3, "{}: {off}", target.joints()[joint].name);
    }
}

#[test]
fn hinges_settle_how_limbs_are_turned_where_rest_poses_differ() {
    let target = skeleton(45.0, 3.0);
    // A recording whose arms are level at rest and turned about themselves: elbows bend about an
    // axis that is off by 80 degrees, and straight arms hang.
    let source = renamed(&skeleton(0.0, 0.0), &CMU);
    let [shoulder, elbow] = ["LeftArm", "LeftForeArm"].map(|name| source.find(name).unwrap());
    let down = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -std::f32::consts::FRAC_PI_2);
    let roll = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 1.4);
    let frames = (0..40).map(|frame| {
        let mut pose = Pose::rest(22);
        // Of a level left arm to the side the hinge is -y: the forearm goes to the front.
        let bend = UnitQuaternion::from_axis_angle(&-Vector3::y_axis(), 0.03 * frame as f32);
        pose.rotations[shoulder] = down * roll.inverse();
        pose.rotations[elbow] = roll * bend * roll.inverse();
        pose
    });
    let motion = motion(&source, frames.collect());
    let retarget = Retarget::new(&motion, &target, &RetargetOptions::default()).unwrap();
    let found = retarget.pose(39).unwrap();
    for (role, next) in limbs().take(2) {
        let expected = bone(&source, &motion.frames[39], role, next);
        assert!((bone(&target, &found, role, next) - expected).norm() < 1e-3);
    }
    // The body's own elbow bends about its hinge: the upper arm is not turned about itself.
    let elbow = found.rotations[target.find("left_elbow").unwrap()].scaled_axis();
    let upper = target.joints()[target.find("left_elbow").unwrap()].rest_position
        - target.joints()[target.find("left_shoulder").unwrap()].rest_position;
    let about = elbow.dot(&upper.normalize()).abs() / elbow.norm();
    let across = elbow.cross(&upper.normalize());
    assert!(about < 0.05 && across.norm() > 1.0, "{elbow}");
    let hinge = elbow.normalize();
    let default = -Vector3::y() + upper.normalize() * upper.normalize().y;
    let off = hinge.dot(&default.normalize()).acos().to_degrees();
    assert!(off < 12.0, "the hinge is off by {off} degrees: {hinge}");
}

#[test]
fn fingers_of_the_same_name_come_along() {
    let with_finger = |skeleton: Skeleton| {
        let mut joints = skeleton.joints().to_vec();
        let wrist = skeleton.find("left_wrist").or(skeleton.find("LeftHand"));
        joints.push(Joint {
            name: "finger".to_owned(),
            parent: wrist,
            rest_position: joints[wrist.unwrap()].rest_position + Vector3::x() * 0.1,
        });
        Skeleton::new(joints).unwrap()
    };
    let source = with_finger(renamed(&skeleton(45.0, 3.0), &CMU));
    let target = with_finger(skeleton(45.0, 3.0));
    let motion = motion(&source, vec![pose(23, 0.5)]);
    let retarget = Retarget::new(&motion, &target, &RetargetOptions::default()).unwrap();
    let found = world_rotations(&target, &retarget.pose(0).unwrap())[22];
    let expected = world_rotations(&source, &motion.frames[0])[22];
    assert!(found.angle_to(&expected) < 1e-3);
}

#[test]
fn shifts_scale_with_the_legs_and_start_over_the_origin() {
    let target = skeleton(45.0, 3.0);
    let joints = target.joints().iter().map(|joint| Joint {
        rest_position: joint.rest_position * 2.0,
        ..joint.clone()
    });
    let source = Skeleton::new(joints.collect()).unwrap();
    let mut frames = vec![Pose::rest(22), Pose::rest(22)];
    frames[0].root_translation = Vector3::new(3.0, 0.0, 1.0);
    frames[1].root_translation = Vector3::new(3.0, 0.2, 2.0);
    let motion = motion(&source, frames);
    let shift = |start_at: StartAt, frame: usize| {
        let options = RetargetOptions {
            start_at,
            ..RetargetOptions::default()
        };
        let retarget = Retarget::new(&motion, &target, &options).unwrap();
        retarget.pose(frame).unwrap().root_translation
    };
    for (start_at, frame, expected) in [
        (StartAt::Origin, 0, Vector3::zeros()),
        (StartAt::Origin, 1, Vector3::new(0.0, 0.1, 0.5)),
        (StartAt::OriginAlways, 1, Vector3::new(0.0, 0.1, 0.0)),
        (StartAt::Motion, 1, Vector3::new(1.5, 0.1, 1.0)),
    ] {
        let found = shift(start_at, frame);
        assert!((found - expected).norm() < 1e-4, "{start_at:?}: {found}");
    }
}

#[test]
fn missing_joints_are_named_unless_they_do_no_harm() {
    let target = skeleton(45.0, 3.0);
    let source = skeleton(0.0, 0.0);
    let without = |names: &[&str]| {
        let mut joints = source.joints().to_vec();
        for name in names {
            let index = source.find(name).unwrap();
            joints[index].name = format!("extra{index}");
        }
        motion(&Skeleton::new(joints).unwrap(), vec![Pose::rest(22)])
    };
    let harmless = without(&["left_foot", "right_collar"]);
    let retarget = Retarget::new(&harmless, &target, &RetargetOptions::default()).unwrap();
    // The collarbone is what is between upper arm and trunk.
    assert_eq!(retarget.notes().len(), 1);
    assert!(retarget.pose(0).is_ok());
    assert_eq!(
        retarget.pose(9).unwrap_err(),
        RetargetError::FrameOutOfRange {
            frame: 9,
            num_frames: 1
        }
    );

    // Single joints of unknown names are found by the hierarchy; what is not there is not.
    let unknown = without(&["left_knee", "right_elbow", "head"]);
    assert!(Retarget::new(&unknown, &target, &RetargetOptions::default()).is_ok());
    let broken = without_limbs(&source, &["left_knee", "right_elbow"]);
    let num_joints = broken.num_joints();
    let broken = motion(&broken, vec![Pose::rest(num_joints)]);
    let error = Retarget::new(&broken, &target, &RetargetOptions::default()).unwrap_err();
    let RetargetError::MissingJoints { missing, .. } = &error else {
        panic!("{error}")
    };
    for name in ["right_elbow", "left_knee"] {
        assert!(missing.contains(&name), "{missing:?}");
    }
    assert!(
        error
            .to_string()
            .contains("the motion has no joint that is named like")
    );
}

#[test]
fn a_zero_pose_that_is_no_figure_is_refused() {
    let target = skeleton(45.0, 3.0);
    let options = RetargetOptions::default();
    // All bones lie along one axis, as some recorders have it.
    let standing = skeleton(0.0, 0.0);
    let mut joints = standing.joints().to_vec();
    for joint in 1..joints.len() {
        let parent = joints[joint].parent.unwrap();
        let [from, to] = [parent, joint].map(|joint| standing.joints()[joint].rest_position);
        let along = Vector3::new((to - from).norm(), 0.0, 0.0);
        joints[joint].rest_position = joints[parent].rest_position + along;
    }
    let folded = motion(&Skeleton::new(joints).unwrap(), vec![Pose::rest(22)]);
    let error = Retarget::new(&folded, &target, &options).unwrap_err();
    assert_eq!(error, RetargetError::Folded);
    // Who sits at rest is a figure.
    let sitting = motion(&skeleton(60.0, 85.0), vec![Pose::rest(22)]);
    assert!(Retarget::new(&sitting, &target, &options).is_ok());
}

#[test]
fn a_figure_that_stands_along_another_axis_in_the_frames_is_told() {
    let source = skeleton(20.0, 3.0);
    let lying = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 1.5);
    let mut along_z = Pose::rest(22);
    along_z.rotations[0] = lying;
    let notes = |frames: Vec<Pose>, options: &ReadOptions| {
        let motion = Motion::in_metres(&source, frames, options).unwrap();
        motion
            .notes
            .iter()
            .filter(|note| note.contains("--pose-up"))
            .count()
    };
    let read = ReadOptions::default();
    assert_eq!(notes(vec![Pose::rest(22)], &read), 0);
    assert_eq!(notes(vec![along_z.clone(); 3], &read), 1);
    // Half of the frames each way tell nothing; what is named is not doubted.
    assert_eq!(notes(vec![along_z.clone(), Pose::rest(22)], &read), 0);
    let named = ReadOptions {
        up: Some(Upward::Y),
        ..read
    };
    assert_eq!(notes(vec![along_z], &named), 0);
}

#[test]
fn a_figure_may_stand_along_any_axis() {
    let (source, target) = (skeleton(20.0, 3.0), skeleton(45.0, 3.0));
    let frames = vec![pose(22, 0.5), pose(22, 2.0)];
    let retargeted = |source: &Skeleton, frames: Vec<Pose>| {
        let motion = Motion::in_metres(source, frames, &ReadOptions::default()).unwrap();
        let retarget = Retarget::new(&motion, &target, &RetargetOptions::default()).unwrap();
        (motion.notes.clone(), retarget.pose(1).unwrap())
    };
    let (_, expected) = retargeted(&source, frames.clone());
    for up in Upward::ALL {
        let from_y_up = up.to_y_up().inverse();
        let joints = source.joints().iter().map(|joint| Joint {
            rest_position: from_y_up * joint.rest_position,
            ..joint.clone()
        });
        let turned = Skeleton::new(joints.collect()).unwrap();
        let frames = frames.iter().map(|frame| Pose {
            root_translation: from_y_up * frame.root_translation,
            rotations: frame
                .rotations
                .iter()
                .map(|turn| from_y_up * turn * from_y_up.inverse())
                .collect(),
        });
        let (notes, found) = retargeted(&turned, frames.collect());
        let note = format!("{up} is read as the up axis");
        assert!(notes.contains(&note), "{notes:?}");
        let turns = found.rotations.iter().zip(&expected.rotations);
        let largest = turns.map(|(a, b)| a.angle_to(b)).fold(0.0, f32::max);
        assert!(largest < 2e-3, "{up}: {largest}");
    }
}

#[test]
fn a_rest_pose_that_is_bent_does_not_turn_hinges_over() {
    // The arms of the recording are bent at rest by more than they ever are in it.
    let straight = skeleton(0.0, 0.0);
    let bent = straight.joints().iter().map(|joint| {
        let mut joint = joint.clone();
        if joint.name == "left_wrist" || joint.name == "right_wrist" {
            let elbow = straight
                .find(&joint.name.replace("wrist", "elbow"))
                .unwrap();
            let elbow = straight.joints()[elbow].rest_position;
            let sign = if joint.name.starts_with("left") {
                -1.0
            } else {
                1.0
            };
            let bend = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 1.2 * sign);
            joint.rest_position = elbow + bend * (joint.rest_position - elbow);
        }
        joint
    });
    let source = Skeleton::new(bent.collect()).unwrap();
    let target = skeleton(45.0, 3.0);
    let frames = (0..40).map(|frame| {
        let mut pose = Pose::rest(22);
        for (name, sign) in [("left_elbow", 1.0), ("right_elbow", -1.0)] {
            let open = 0.8 * (0.3 * frame as f32).sin().abs();
            let elbow = source.find(name).unwrap();
            pose.rotations[elbow] =
                UnitQuaternion::from_axis_angle(&Vector3::y_axis(), open * sign);
        }
        pose
    });
    let motion = motion(&source, frames.collect());
    let retarget = Retarget::new(&motion, &target, &RetargetOptions::default()).unwrap();
    let found = world_rotations(&target, &retarget.pose(0).unwrap());
    // The upper arms go from hanging by 45 degrees to level by the shortest way.
    for name in ["left_shoulder", "right_shoulder"] {
        let turn = found[target.find(name).unwrap()].angle().to_degrees();
        assert!((turn - 45.0).abs() < 1.0, "{name}: {turn}");
    }
}
