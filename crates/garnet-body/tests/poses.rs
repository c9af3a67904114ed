//! Poses on figures of capsules.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

mod common;

use common::bent::{Hinge, bent_ring};
use common::{ARM_RADIUS, TRUNK_RADIUS, body, skeleton, without_limbs};
use garnet_body::{
    motion::{Figure, Ground, Side, lowest_points, put_on_ground},
    poses::{
        BodyAngles, GaitCycle, Outcome, Part, PoseSampler, Poser, SelfContact, SeparationOptions,
        key_pose, key_poses, parts_of_vertices, turn,
    },
    shape::{BodyParameters, JOINT_NAMES, ParametricBody},
};
use garnet_mesh::TriMesh;
use garnet_skin::{Body, Joint, Method, Point3, Pose, Skeleton, SkinWeights, Vector3};

/// Rounding of rotations in `f32` along a chain of joints, in metres.
const ROUNDING: f32 = 1e-5;

/// Distance of the facets of a capsule with 24 sides from its round form, in metres.
const FACETS: f32 = 2e-3;

fn joint(skeleton: &Skeleton, pose: &Pose, name: &str) -> Point3 {
    let joint = JOINT_NAMES.iter().position(|other| *other == name).unwrap();
    skeleton.transforms(pose).unwrap()[joint] * skeleton.joints()[joint].rest_position
}

fn bone(skeleton: &Skeleton, pose: &Pose, from: &str, to: &str) -> Vector3 {
    (joint(skeleton, pose, to) - joint(skeleton, pose, from)).normalize()
}

/// Rest poses: arms half down, a T-pose, legs spread.
fn skeletons() -> [Skeleton; 3] {
    [
        skeleton(45.0, 3.0),
        skeleton(0.0, 0.0),
        skeleton(30.0, 20.0),
    ]
}

#[test]
fn at_zero_arms_and_legs_hang_straight_down_whatever_the_rest_pose() {
    for skeleton in skeletons() {
        let pose = Poser::new(&skeleton).unwrap().pose(&BodyAngles::default());
        for side in ["left", "right"] {
            for (from, to) in [
                ("shoulder", "elbow"),
                ("elbow", "wrist"),
                ("hip", "knee"),
                ("knee", "ankle"),
            ] {
                let found = bone(
                    &skeleton,
                    &pose,
                    &format!("{side}_{from}"),
                    &format!("{side}_{to}"),
                );
                assert!(
                    (found + Vector3::y()).norm() < ROUNDING,
                    "{side} {from}: {found}"
                );
            }
        }
    }
}

/// One angle of the left side, the joints of a bone, and where the bone then points.
type Sign = (fn(&mut BodyAngles), &'static str, &'static str, Vector3);

/// What an angle does, one by one.
fn signs() -> [Sign; 15] {
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
    [
        (
            |body| body.legs[0].flexion = 90.0,
            "left_hip",
            "left_knee",
            z,
        ),
        (
            |body| body.legs[0].abduction = 90.0,
            "left_hip",
            "left_knee",
            x,
        ),
        (
            |body| body.legs[1].abduction = 90.0,
            "right_hip",
            "right_knee",
            -x,
        ),
        (
            |body| body.legs[0].knee = 90.0,
            "left_knee",
            "left_ankle",
            -z,
        ),
        (
            |body| body.arms[0].flexion = 90.0,
            "left_shoulder",
            "left_elbow",
            z,
        ),
        (
            |body| body.arms[0].abduction = 90.0,
            "left_shoulder",
            "left_elbow",
            x,
        ),
        (
            |body| body.arms[1].abduction = 90.0,
            "right_shoulder",
            "right_elbow",
            -x,
        ),
        (
            |body| body.arms[0].elbow = 90.0,
            "left_elbow",
            "left_wrist",
            z,
        ),
        (
            |body| (body.arms[0].rotation, body.arms[0].elbow) = (90.0, 90.0),
            "left_elbow",
            "left_wrist",
            x,
        ),
        (
            |body| (body.arms[1].rotation, body.arms[1].elbow) = (90.0, 90.0),
            "right_elbow",
            "right_wrist",
            -x,
        ),
        (|body| body.spine.flexion = 90.0, "spine3", "neck", z),
        (|body| body.spine.side = 90.0, "spine3", "neck", x),
        (|body| body.pelvis.flexion = 90.0, "spine2", "spine3", z),
        (|body| body.pelvis.side = 90.0, "spine2", "spine3", x),
        (
            |body| body.arms[0].flexion = 180.0,
            "left_shoulder",
            "left_elbow",
            y,
        ),
    ]
}

#[test]
fn every_angle_turns_the_way_its_name_says() {
    for skeleton in skeletons() {
        let poser = Poser::new(&skeleton).unwrap();
        for (index, (set, from, to, expected)) in signs().into_iter().enumerate() {
            let mut angles = BodyAngles::default();
            set(&mut angles);
            let found = bone(&skeleton, &poser.pose(&angles), from, to);
            assert!(
                (found - expected).norm() < ROUNDING,
                "{index}, {from}: {found}"
            );
        }
    }
}

#[test]
fn turns_go_to_the_left_and_feet_outwards_and_upwards() {
    let skeleton = skeleton(45.0, 3.0);
    let poser = Poser::new(&skeleton).unwrap();
    let posed = |set: fn(&mut BodyAngles)| {
        let mut angles = BodyAngles::default();
        set(&mut angles);
        poser.pose(&angles)
    };
    let pose = posed(|body| body.spine.turn = 40.0);
    let shoulders = bone(&skeleton, &pose, "right_shoulder", "left_shoulder");
    assert!(
        shoulders.z < -0.5,
        "the left shoulder goes back: {shoulders}"
    );
    let pose = posed(|body| body.neck.turn = 60.0);
    assert!(
        bone(&skeleton, &pose, "neck", "head").x > 0.0,
        "the head's joint lies before the neck"
    );
    let pose = posed(|body| body.legs[0].rotation = 60.0);
    assert!(bone(&skeleton, &pose, "left_ankle", "left_foot").x > 0.6);
    let foot = |degrees: f64| {
        let mut angles = BodyAngles::default();
        angles.legs[1].ankle = degrees;
        bone(&skeleton, &poser.pose(&angles), "right_ankle", "right_foot").y
    };
    assert!(foot(20.0) > foot(0.0) && foot(0.0) > foot(-40.0));
}

#[test]
fn a_mirrored_pose_is_the_mirror_image() {
    let skeleton = skeleton(45.0, 3.0);
    let poser = Poser::new(&skeleton).unwrap();
    for key in key_poses() {
        let [pose, mirrored] =
            [key.angles, key.angles.mirrored()].map(|angles| poser.pose(&angles));
        for name in JOINT_NAMES {
            let other = match name.split_once('_') {
                Some(("left", rest)) => format!("right_{rest}"),
                Some(("right", rest)) => format!("left_{rest}"),
                _ => name.to_owned(),
            };
            let mut found = joint(&skeleton, &mirrored, &other);
            found.x = -found.x;
            let expected = joint(&skeleton, &pose, name);
            assert!(
                (found - expected).norm() < 10.0 * ROUNDING,
                "{}: {name}",
                key.name
            );
        }
    }
}

#[test]
fn vertices_that_no_face_names_stand_on_no_ground() {
    let body = body(45.0, 3.0);
    let (mut positions, faces) = body.rest().clone().into_parts();
    let rows = (0..positions.len()).map(|vertex| body.weights().vertex(vertex).collect::<Vec<_>>());
    let rows = rows.chain([vec![(0, 1.0)]]);
    let weights = SkinWeights::from_influences(body.skeleton().num_joints(), rows).unwrap();
    positions.push(Point3::new(0.0, -80.0, 0.0));
    let mesh = TriMesh::new(positions, faces).unwrap();
    let with_stray = Body::new(mesh, body.skeleton().clone(), weights).unwrap();
    let poses = [Pose::rest(body.skeleton().num_joints())];
    assert_eq!(
        lowest_points(&with_stray, &poses).unwrap(),
        lowest_points(&body, &poses).unwrap()
    );
}

/// Largest difference of the height of a body whose feet were deleted, in metres.
const SOLE: f32 = 0.02;

#[test]
fn a_body_without_feet_or_legs_stands_where_it_stood() {
    let built = ParametricBody::build(&BodyParameters::new(0.5)).unwrap();
    let body = built.into_body();
    let height = |name: &str| {
        let joint = body.skeleton().find(name).unwrap();
        body.skeleton().joints()[joint].rest_position.y
    };
    let faces = body.rest().faces();
    let above = |least: f32| -> Body {
        let positions = body.rest().positions();
        let is_kept = |face: &&[u32; 3]| face.iter().all(|&v| positions[v as usize].y > least);
        let kept = faces.iter().filter(is_kept).copied().collect();
        let mesh = TriMesh::new(positions.to_vec(), kept).unwrap();
        Body::new(mesh, body.skeleton().clone(), body.weights().clone()).unwrap()
    };
    let poser = Poser::new(body.skeleton()).unwrap();
    for least in [height("left_ankle"), height("left_hip")] {
        let cut = above(least);
        for name in ["stand", "squat", "throw"] {
            let pose = poser.pose(&key_pose(name).unwrap().angles);
            let [mut whole, mut missing] = [[pose.clone()], [pose]];
            put_on_ground(&body, &mut whole, Ground::EachPose).unwrap();
            put_on_ground(&cut, &mut missing, Ground::EachPose).unwrap();
            let [whole, missing] = [whole, missing].map(|[pose]| pose.root_translation.y);
            assert!((whole - missing).abs() < SOLE, "{name}: {whole}, {missing}");
        }
    }
}

#[test]
fn sides_are_those_of_the_toes_where_names_are_exchanged() {
    let built = ParametricBody::build(&BodyParameters::new(0.5)).unwrap();
    let body = built.into_body();
    let exchanged = |name: &str| match name.split_once('_') {
        Some(("left", rest)) => format!("right_{rest}"),
        Some(("right", rest)) => format!("left_{rest}"),
        _ => name.to_owned(),
    };
    let joints = body.skeleton().joints().iter().cloned();
    let joints = joints.map(|joint| Joint {
        name: exchanged(&joint.name),
        ..joint
    });
    let other = Skeleton::new(joints.collect()).unwrap();
    assert!(Figure::new(&other, "the body").unwrap().has_other_sides());
    let usual = Figure::new(body.skeleton(), "the body").unwrap();
    assert!(!usual.has_other_sides());
    for key in key_poses() {
        let [found, expected] = [&other, body.skeleton()]
            .map(|skeleton| Poser::new(skeleton).unwrap().pose(&key.angles));
        assert_eq!(found.rotations, expected.rotations, "{}", key.name);
    }
}

#[test]
fn both_feet_stand_on_the_ground_where_a_pose_plants_them() {
    let body = body(45.0, 3.0);
    let poser = Poser::new(body.skeleton()).unwrap();
    for key in key_poses() {
        let mut poses = [poser.pose(&key.angles)];
        put_on_ground(&body, &mut poses, Ground::EachPose).unwrap();
        let lowest = lowest_points(&body, &poses).unwrap()[0];
        assert!(lowest.abs() < ROUNDING, "{}: {lowest}", key.name);
        let legs = key.angles.legs;
        if legs.iter().all(|leg| leg.is_planted && leg.sole > 0.99) && !key.angles.hands_planted {
            let skeleton = body.skeleton();
            let heights =
                ["left_foot", "right_foot"].map(|name| joint(skeleton, &poses[0], name).y);
            assert!(
                (heights[0] - heights[1]).abs() < 5e-3,
                "{}: {heights:?}",
                key.name
            );
            assert!(heights[0] < 0.06, "{}: {heights:?}", key.name);
        }
    }
}

#[test]
fn legs_carry_the_body_through_the_gait_cycle() {
    let skeleton = skeleton(45.0, 3.0);
    let poser = Poser::new(&skeleton).unwrap();
    let gait = GaitCycle::default();
    let step = |phase: f64| {
        let pose = poser.pose(&gait.angles(phase));
        joint(&skeleton, &pose, "left_ankle").z - joint(&skeleton, &pose, "right_ankle").z
    };
    // A step of 0.7 m of a leg of 0.83 m (Perry and Burnfield 2010, chapter 22: 0.7 m).
    assert!((0.5..0.85).contains(&step(0.0)), "{}", step(0.0));
    assert!((step(0.0) + step(0.5)).abs() < 1e-3);
    assert!(step(0.25).abs() < 0.25);
}

#[test]
fn a_forearm_pushed_into_the_trunk_is_as_deep_as_it_was_pushed() {
    let body = body(45.0, 3.0);
    let contact = SelfContact::new(&body).unwrap();
    let poser = Poser::new(body.skeleton()).unwrap();
    let mut angles = BodyAngles::default();
    // The forearms lie across the belly, one above the other.
    for (arm, flexion) in angles.arms.iter_mut().zip([10.0, 28.0]) {
        (arm.flexion, arm.rotation, arm.elbow) = (flexion, -90.0, 90.0);
    }
    angles.arms[1].elbow = 20.0;
    let pose = poser.pose(&angles);
    let report = contact.report(&pose).unwrap();
    let skeleton = body.skeleton();
    let [elbow, wrist] = ["left_elbow", "left_wrist"].map(|name| joint(skeleton, &pose, name));
    let pelvis = joint(skeleton, &pose, "pelvis");
    // Both capsules are straight: the distance of their axes tells the depth.
    let along = (wrist - elbow).normalize();
    let across = along.cross(&Vector3::y()).normalize();
    let apart = (elbow - pelvis).dot(&across).abs();
    let expected = TRUNK_RADIUS + ARM_RADIUS - apart;
    assert!(expected > 0.02, "the scene is made for contact: {expected}");
    let deepest = report
        .contacts
        .iter()
        .filter(|contact| contact.parts == [Part::Forearm(Side::Left), Part::Trunk]);
    let depth = deepest.map(|contact| contact.depth).fold(0.0, f32::max);
    assert!(
        (depth - expected).abs() < FACETS,
        "{depth} is not {expected}"
    );

    let separated = contact
        .separated(&pose, &SeparationOptions::default())
        .unwrap()
        .unwrap();
    assert!(separated.num_steps > 0 && separated.largest_turn < 0.6);
    assert!(separated.depths[0] > 0.02 && separated.depths[1] <= 0.010);
    assert!(separated.depths[1] > 0.0, "light contact stays");
}

/// An arm that swings into the trunk and out again within two seconds, 30 poses a second, by angles
/// in degrees to the side.
fn swing(body: &Body, inwards: f64) -> Vec<Pose> {
    let poser = Poser::new(body.skeleton()).unwrap();
    let pose = |frame: u32| {
        let share = 0.5 - 0.5 * (std::f64::consts::TAU * f64::from(frame) / 60.0).cos();
        let mut angles = BodyAngles::default();
        angles.arms[1].abduction = 30.0;
        angles.arms[0].abduction = 30.0 - (30.0 + inwards) * share;
        poser.pose(&angles)
    };
    (0..=60).map(pose).collect()
}

#[test]
fn a_limb_gives_way_smoothly_through_a_motion() {
    let body = body(45.0, 3.0);
    let contact = SelfContact::new(&body).unwrap();
    let given = swing(&body, 12.0);
    let options = SeparationOptions::default();
    let turns = contact.easing(&given, 1.0 / 30.0, &options).unwrap();
    let mut eased = given.clone();
    for (pose, turns) in eased.iter_mut().zip(&turns) {
        turn(pose, turns);
    }
    let depths = |poses: &[Pose]| {
        let depths = poses
            .iter()
            .map(|pose| contact.report(pose).unwrap().depth());
        depths.fold(0.0, f32::max)
    };
    assert!(depths(&given) > 0.04, "{}", depths(&given));
    assert!(
        depths(&eased) < 1.6 * options.max_depth,
        "{}",
        depths(&eased)
    );
    // The change of the hand's step from one pose to the next, in metres.
    let jerk = |poses: &[Pose]| {
        let hand = |pose: &Pose| joint(body.skeleton(), pose, "left_wrist");
        let hands: Vec<Point3> = poses.iter().map(hand).collect();
        let changes = hands
            .windows(3)
            .map(|hands| ((hands[2] - hands[1]) - (hands[1] - hands[0])).norm());
        changes.fold(0.0, f32::max)
    };
    assert!(
        jerk(&eased) < jerk(&given) + 1e-3,
        "{} {}",
        jerk(&eased),
        jerk(&given)
    );
}

#[test]
fn arms_leave_room_for_cloth_in_a_motion() {
    let body = body(45.0, 3.0);
    let contact = SelfContact::new(&body).unwrap();
    let given = swing(&body, 12.0);
    let parts = parts_of_vertices(&body).unwrap();
    // Between the forearm and the trunk, or thigh, in all poses.
    let smallest = |room: f32| {
        let options = SeparationOptions {
            max_depth: 0.005,
            legs_give_way: false,
            room,
            ..SeparationOptions::default()
        };
        // Slowly, so that smoothing takes nothing away.
        let turns = contact.easing(&given, 0.2, &options).unwrap();
        let mut least = f32::INFINITY;
        for (pose, turns) in given.iter().zip(&turns) {
            let mut pose = pose.clone();
            turn(&mut pose, turns);
            let skin = body.posed(&pose).unwrap().skin().positions().to_vec();
            let of = |wanted: fn(&Part) -> bool| {
                let places = skin.iter().zip(&parts);
                let places = places.filter(move |(_, part)| wanted(part));
                places.map(|(place, _)| *place).collect::<Vec<Point3>>()
            };
            let arm = of(|part| *part == Part::Forearm(Side::Left));
            let beside = of(|part| matches!(part, Part::Trunk | Part::Thigh(_)));
            for place in arm {
                let apart = beside.iter().map(|other| (other - place).norm());
                least = apart.fold(least, f32::min);
            }
        }
        least
    };
    let [none, some, more] = [0.0, 0.02, 0.03].map(smallest);
    assert!(none < 0.005, "{none}");
    // Both sides have facets.
    assert!(some > 0.02 - 0.005 - 2.0 * FACETS, "{none} {some}");
    assert!(more > 0.03 - 0.005 - 2.0 * FACETS, "{more}");
    // Of edges as long as those of the figure, and a little more than two layers.
    assert!((0.015..0.05).contains(&contact.room_for_cloth()));
}

#[test]
fn nothing_is_turned_in_a_motion_whose_parts_stay_apart() {
    let body = body(45.0, 3.0);
    let contact = SelfContact::new(&body).unwrap();
    let given = swing(&body, -15.0);
    let turns = contact
        .easing(&given, 1.0 / 30.0, &SeparationOptions::default())
        .unwrap();
    assert!(turns.iter().flatten().all(|turn| *turn == Vector3::zeros()));
    assert!(
        contact
            .easing(&[], 1.0, &SeparationOptions::default())
            .unwrap()
            .is_empty()
    );
}

#[test]
fn light_contact_is_left_alone() {
    let body = body(45.0, 3.0);
    let contact = SelfContact::new(&body).unwrap();
    let poser = Poser::new(body.skeleton()).unwrap();
    let mut found_light = false;
    for step in 0..120 {
        let mut angles = BodyAngles::default();
        angles.arms[1].abduction = 30.0;
        angles.arms[0].abduction = 15.0 - 0.25 * f64::from(step);
        let pose = poser.pose(&angles);
        let depth = contact.report(&pose).unwrap().depth();
        if (0.001..0.010).contains(&depth) {
            found_light = true;
            let separated = contact
                .separated(&pose, &SeparationOptions::default())
                .unwrap()
                .unwrap();
            assert_eq!((separated.num_steps, &separated.pose), (0, &pose));
        }
    }
    assert!(
        found_light,
        "an arm that comes nearer touches at some angle"
    );
}

#[test]
fn parts_that_cannot_be_parted_are_given_up() {
    let body = body(45.0, 3.0);
    let contact = SelfContact::new(&body).unwrap();
    let poser = Poser::new(body.skeleton()).unwrap();
    let mut angles = BodyAngles::default();
    angles.arms[0].flexion = 20.0;
    angles.arms[0].rotation = -90.0;
    angles.arms[0].elbow = 90.0;
    let options = SeparationOptions {
        max_turn: 0.02,
        ..SeparationOptions::default()
    };
    assert_eq!(
        contact.separated(&poser.pose(&angles), &options).unwrap(),
        None
    );
}

/// The body with vertices that are elsewhere by up to 0.3 mm.
fn shaken(body: &Body) -> Body {
    let shift = |place: u32| {
        let wave = |by: u32| 3e-4 * (f32::from((place % 977) as u16) * by as f32).sin();
        Vector3::new(wave(3), wave(5), wave(7)) / 3.0_f32.sqrt()
    };
    let positions = (0..).zip(body.rest().positions());
    let positions = positions.map(|(place, point)| point + shift(place));
    let mesh = body.rest().with_positions(positions.collect()).unwrap();
    Body::new(mesh, body.skeleton().clone(), body.weights().clone()).unwrap()
}

#[test]
fn bodies_that_hardly_differ_give_way_alike() {
    let heavy = BodyParameters::new(1.0).with_bmi(31.0);
    let body = ParametricBody::build(&heavy).unwrap().into_body();
    let other = shaken(&body);
    let mut largest = 0.0_f32;
    for step in 0..8 {
        let mut angles = BodyAngles::default();
        angles.arms[0].abduction = 6.0 - 2.0 * f64::from(step);
        angles.arms[1].abduction = 30.0;
        let wrists = [&body, &other].map(|body| {
            let contact = SelfContact::new(body).unwrap();
            let pose = Poser::new(body.skeleton()).unwrap().pose(&angles);
            let options = SeparationOptions::least();
            let separated = contact.separated(&pose, &options).unwrap().unwrap();
            assert!(separated.depths[1] <= options.max_depth);
            // No farther than to the allowed depth.
            let is_least =
                separated.num_steps == 0 || separated.depths[1] > 0.9 * options.max_depth;
            assert!(is_least, "{:?}", separated.depths);
            joint(body.skeleton(), &separated.pose, "left_wrist")
        });
        println!("{step}: {:.4} m", (wrists[0] - wrists[1]).norm());
        largest = largest.max((wrists[0] - wrists[1]).norm());
    }
    assert!(largest < 0.008, "{largest}");
}

#[test]
fn dolls_give_way_in_proportion() {
    let grown = body(45.0, 3.0);
    let small = |point: &Point3| Point3::from(0.1 * point.coords);
    let joints = grown
        .skeleton()
        .joints()
        .iter()
        .cloned()
        .map(|joint| Joint {
            rest_position: small(&joint.rest_position),
            ..joint
        });
    let skeleton = Skeleton::new(joints.collect()).unwrap();
    let positions = grown.rest().positions().iter().map(small).collect();
    let mesh = grown.rest().with_positions(positions).unwrap();
    let doll = Body::new(mesh, skeleton, grown.weights().clone()).unwrap();
    let contact = SelfContact::new(&doll).unwrap();
    assert!((SelfContact::new(&grown).unwrap().scale() - 1.0).abs() < 1e-6);
    assert!(
        (0.08..0.2).contains(&contact.scale()),
        "{}",
        contact.scale()
    );
    let mut angles = BodyAngles::default();
    angles.arms[0].abduction = -12.0;
    let pose = Poser::new(doll.skeleton()).unwrap().pose(&angles);
    assert!(contact.report(&pose).unwrap().depth() > 0.003);
    let options = SeparationOptions::default();
    let separated = contact.separated(&pose, &options).unwrap().unwrap();
    assert!(separated.depths[1] <= 0.0021, "{:?}", separated.depths);
}

#[test]
fn drawn_poses_are_sound_and_stand_on_the_ground_with_any_number_of_threads() {
    let body = body(45.0, 3.0);
    let contact = SelfContact::new(&body).unwrap();
    let poser = Poser::new(body.skeleton()).unwrap();
    let sampler = PoseSampler::new(11);
    let draw = || -> Vec<_> {
        let draws = (0..60).map(|index| sampler.sample_for(&poser, &contact, index));
        draws.collect::<Result<_, _>>().unwrap()
    };
    let draws = draw();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    assert_eq!(pool.install(draw), draws);
    let mut num_corrected = 0;
    for sound in &draws {
        let positions = body
            .posed_positions(&sound.pose, Method::DualQuaternion)
            .unwrap();
        let lowest = positions
            .iter()
            .map(|position| position.y)
            .fold(f32::INFINITY, f32::min);
        assert!(lowest.abs() < ROUNDING);
        assert!(
            contact.report_of(&positions).unwrap().depth() <= 0.0101,
            "{}",
            sound.sequence
        );
        num_corrected += u32::from(sound.outcome != Outcome::Sound);
    }
    println!("{num_corrected} of {} corrected", draws.len());
}

#[test]
fn a_skeleton_that_is_no_figure_is_refused_by_name() {
    let no_figure = without_limbs(&skeleton(45.0, 3.0), &["right_knee"]);
    let error = Poser::new(&no_figure).unwrap_err();
    assert!(error.to_string().contains("`right_knee`"), "{error}");
    assert!(key_pose("no such pose").is_none());
}

#[test]
fn the_built_in_body_does_not_run_through_itself_in_drawn_poses() {
    for (sex, bmi) in [(1.0, 20.0), (0.0, 32.0)] {
        let parameters = BodyParameters::new(sex).with_bmi(bmi);
        let body = ParametricBody::build(&parameters).unwrap().into_body();
        let contact = SelfContact::new(&body).unwrap();
        let poser = Poser::new(body.skeleton()).unwrap();
        let rest = contact
            .report(&Pose::rest(body.skeleton().num_joints()))
            .unwrap();
        assert!(
            rest.depth() <= 0.0,
            "the parts do not overlap at rest: {}",
            rest.depth()
        );
        let sampler = PoseSampler::new(3);
        let mut num_rejected = 0;
        for index in 0..60 {
            let sound = sampler.sample_for(&poser, &contact, index).unwrap();
            let report = contact.report(&sound.pose).unwrap();
            assert!(report.depth() <= 0.0101, "{index}: {}", report.depth());
            num_rejected += sound.num_rejected;
        }
        println!("sex {sex}, BMI {bmi}: {num_rejected} draws rejected for 60 poses");
        assert!(num_rejected < 12, "{num_rejected} draws were rejected");
    }
}

/// What networks learn from are drawn poses: where a body stands is taken off no farther than they
/// go.
#[test]
fn drawn_poses_and_those_of_the_library_are_at_home() {
    let built = ParametricBody::build(&BodyParameters::new(0.5)).unwrap();
    let body = built.body();
    let poser = Poser::new(body.skeleton()).unwrap();
    let library = key_poses().map(|pose| poser.pose(&pose.angles));
    let sampler = PoseSampler::new(5);
    let drawn = (0..100).map(|index| poser.pose(&sampler.sample(index).angles));
    for pose in library.chain(drawn) {
        let posed = body.posed(&pose).unwrap();
        let home = posed.at_home(body).unwrap();
        assert_eq!(home.body().skin().positions(), posed.skin().positions());
    }
}

#[test]
fn bent_elbows_and_knees_neither_bulge_nor_collapse() {
    const MAX_BULGE: f32 = 0.15;
    const MAX_COLLAPSE: f32 = 0.25;
    for (sex, bmi) in [(0.0, 20.0), (0.0, 33.0), (1.0, 19.0), (1.0, 31.0)] {
        let built = ParametricBody::build(&BodyParameters::new(sex).with_bmi(bmi)).unwrap();
        for hinge in Hinge::ALL {
            for degrees in [45.0, 90.0, 140.0] {
                let ring = bent_ring(built.body(), hinge, degrees).unwrap();
                let is_sound = ring.bulge < MAX_BULGE
                    && ring.fold_collapse < MAX_COLLAPSE
                    && ring.outer_collapse < MAX_COLLAPSE;
                assert!(is_sound, "{hinge:?} at {degrees}: {ring:?}");
            }
        }
    }
}

#[test]
fn faces_that_are_there_twice_change_no_contact() {
    let built = ParametricBody::build(&BodyParameters::new(0.5)).unwrap();
    let body = built.body();
    let once = body.rest();
    let twice = once
        .faces()
        .iter()
        .flat_map(|&[a, b, c]| [[a, b, c], [a, c, b]]);
    let twice = TriMesh::new(once.positions().to_vec(), twice.collect()).unwrap();
    let (skeleton, weights) = (body.skeleton().clone(), body.weights().clone());
    let doubled = Body::new(twice, skeleton, weights).unwrap();
    let poser = Poser::new(body.skeleton()).unwrap();
    for name in ["hands_on_hips", "arms_crossed", "squat"] {
        let pose = poser.pose(&key_pose(name).unwrap().angles);
        let found = [body, &doubled].map(|body| {
            let report = SelfContact::new(body).unwrap().report(&pose).unwrap();
            let depths = report.contacts.iter().map(|contact| contact.depth);
            depths.collect::<Vec<f32>>()
        });
        assert_eq!(found[0], found[1], "{name}");
    }
}
