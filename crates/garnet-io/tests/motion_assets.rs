//! Checks against the third-party motions of the asset folder, named by `GARNET_ASSETS`.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

use std::{env, path::PathBuf};

use garnet_body::motion::{
    Figure, FrameRange, Ground, ReadOptions, RetargetOptions, Role, Side, lowest_points,
    put_on_ground,
};
use garnet_io::{Take, read_pose, read_rig};
use garnet_skin::{Pose, Skeleton, Vector3};

/// Posed body of the assets, its subject, motion and frame.
const POSED: [(&str, &str, &str, usize); 4] = [
    ("cmu_walk_a", "male", "02_01", 160),
    ("run01", "female", "run01", 0),
    ("standing06", "female", "standing06", 0),
    ("sit01", "female", "sit01", 0),
];

/// Angle between a retargeted bone and that of the motion, in degrees: rounding.
const SAME_DEGREES: f32 = 0.1;

/// Angle between a bone as retargeted here and in the assets, in degrees. There each half of upper
/// arm, forearm, thigh and shank follows the source on its own, and the bodies of the MakeHuman
/// motions have other rest directions than the posed ones, whose angles were copied.
const REFERENCE_DEGREES: f32 = 9.0;

fn assets() -> Option<PathBuf> {
    let folder = env::var_os("GARNET_ASSETS").map(PathBuf::from);
    if folder.is_none() {
        println!("skipped: GARNET_ASSETS is not set");
    }
    folder
}

fn bones(skeleton: &Skeleton, pose: &Pose) -> Vec<(&'static str, Vector3)> {
    let figure = Figure::new(skeleton, "the body").unwrap();
    let transforms = skeleton.transforms(pose).unwrap();
    let at = |role: Role| {
        let joint = figure.joint(role).unwrap();
        transforms[joint] * skeleton.joints()[joint].rest_position
    };
    let mut bones = Vec::new();
    for side in Side::BOTH {
        for (from, to) in [
            (Role::Hip(side), Role::Knee(side)),
            (Role::Knee(side), Role::Ankle(side)),
            (Role::Ankle(side), Role::Foot(side)),
            (Role::Shoulder(side), Role::Elbow(side)),
            (Role::Elbow(side), Role::Wrist(side)),
        ] {
            bones.push((from.name(), (at(to) - at(from)).normalize()));
        }
    }
    let pelvis = skeleton.joints()[figure.pelvis()].rest_position;
    bones.push((
        "trunk",
        (at(Role::Head) - transforms[figure.pelvis()] * pelvis).normalize(),
    ));
    bones
}

#[test]
fn bones_point_where_those_of_the_motions_and_of_the_posed_bodies_do() {
    let Some(assets) = assets() else { return };
    for (name, subject, motion, frame) in POSED {
        let rig = read_rig(assets.join(format!("body/{subject}_rig22.json"))).unwrap();
        let body = rig.into_body().unwrap();
        let path = assets.join(format!("poses/{motion}.bvh"));
        let take = Take::read(path, &ReadOptions::default()).unwrap();
        println!(
            "{name}: {:?}",
            take.notes(body.skeleton(), &RetargetOptions::default())
        );
        let options = RetargetOptions::default();
        let poses = take.poses(body.skeleton(), FrameRange::single(frame), &options);
        let mut poses = poses.unwrap();
        put_on_ground(&body, &mut poses, Ground::EachPose).unwrap();
        let found = bones(body.skeleton(), &poses[0]);

        let motion = take.motion().unwrap();
        let source = bones(&motion.skeleton, &motion.frames[frame]);
        let path = assets.join(format!("body/posed/{name}.json"));
        let reference = read_pose(path, None, body.skeleton()).unwrap();
        let reference = bones(body.skeleton(), &reference);
        for (((bone, found), (_, source)), (_, reference)) in
            found.iter().zip(&source).zip(&reference)
        {
            let off = [source, reference].map(|other| found.angle(other).to_degrees());
            println!(
                "{name} {bone}: {:.3} degrees off the motion, {:.1} off the posed body",
                off[0], off[1]
            );
            assert!(
                off[0] < SAME_DEGREES || *bone == "trunk",
                "{name} {bone}: {} degrees",
                off[0]
            );
            assert!(
                off[1] < REFERENCE_DEGREES,
                "{name} {bone}: {} degrees",
                off[1]
            );
        }
    }
}

#[test]
fn all_motions_are_read_and_a_body_stands_on_the_ground_in_them() {
    let Some(assets) = assets() else { return };
    let body = read_rig(assets.join("body/female_rig22.json"))
        .unwrap()
        .into_body()
        .unwrap();
    for name in ["fight01", "gym01", "standing01", "standing04", "02_01"] {
        let path = assets.join(format!("poses/{name}.bvh"));
        let take = Take::read(path, &ReadOptions::default()).unwrap();
        let range = "::40".parse().unwrap();
        let mut poses = take
            .poses(body.skeleton(), range, &RetargetOptions::default())
            .unwrap();
        put_on_ground(&body, &mut poses, Ground::Clip).unwrap();
        let lowest = lowest_points(&body, &poses).unwrap();
        let least = lowest.iter().copied().fold(f32::INFINITY, f32::min);
        println!(
            "{name}: {} of {} frames, lowest {lowest:?}",
            poses.len(),
            take.num_frames()
        );
        assert!(least.abs() < 1e-5);
        // Nobody flies in these motions; the floor of the walk rises by 5 cm along the way.
        assert!(lowest.iter().all(|height| *height < 0.06));
    }
}
