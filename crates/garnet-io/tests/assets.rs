//! Checks against the third-party bodies of the asset folder, named by `GARNET_ASSETS`.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

use std::{
    env, fs,
    path::{Path, PathBuf},
    time::Instant,
};

use garnet_io::{ObjFile, SceneJson, read_pose, read_rig};
use garnet_skin::{
    Body, Method, Point3, Pose, RecoveredPose, recover_pose, skin_dual_quaternion, skin_linear,
};

/// Name of a pose, and the body that takes it.
const POSED: [(&str, &str); 5] = [
    ("cmu_walk_a", "male"),
    ("run01", "female"),
    ("cmu_dance_a", "female"),
    ("standing06", "female"),
    ("sit01", "female"),
];

/// The oracle starts from rest positions of full precision, we from five digits.
const DQS_TOLERANCE: f32 = 1e-5;

/// The rounding of both OBJ files and of the matrices.
const LINEAR_TOLERANCE: f32 = 2e-5;

/// The accuracy that is asked of a recovery with known weights, in metres.
const REPRODUCED: f32 = 1e-3;

fn assets() -> Option<PathBuf> {
    let folder = env::var_os("GARNET_ASSETS").map(PathBuf::from);
    if folder.is_none() {
        println!("skipped: GARNET_ASSETS is not set");
    }
    folder
}

fn positions(path: &Path) -> Vec<Point3> {
    ObjFile::read(path).unwrap().positions().to_vec()
}

fn body(assets: &Path, name: &str) -> Body {
    let rig = read_rig(assets.join(format!("body/{name}_rig22.json"))).unwrap();
    rig.into_body().unwrap()
}

fn largest_distance(a: &[Point3], b: &[Point3]) -> f32 {
    assert_eq!(a.len(), b.len());
    let distances = a.iter().zip(b).map(|(a, b)| (a - b).norm());
    distances.fold(0.0, f32::max)
}

#[test]
fn dual_quaternion_and_linear_skinning_equal_the_references() {
    let Some(assets) = assets() else { return };
    for (name, subject) in POSED {
        let body = body(&assets, subject);
        let posed = assets.join("body/posed");
        let pose = read_pose(posed.join(format!("{name}.json")), None, body.skeleton()).unwrap();

        let bytes = fs::read(posed.join(format!("{name}.dqs.f32"))).unwrap();
        let floats = bytes
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        let floats: Vec<f32> = floats.collect();
        let reference = floats
            .chunks_exact(3)
            .map(|p| Point3::new(p[0], p[1], p[2]));
        let reference: Vec<Point3> = reference.collect();
        let moved = body.posed_positions(&pose, Method::DualQuaternion).unwrap();
        let dual = largest_distance(&moved, &reference);

        let reference = positions(&posed.join(format!("{name}.obj")));
        let moved = body.posed_positions(&pose, Method::Linear).unwrap();
        let linear = largest_distance(&moved, &reference);
        println!("{name}: dual quaternion {dual:.1e} m, linear {linear:.1e} m");
        println!("  skinned in {:.2} ms", skinning_milliseconds(&body, &pose));
        assert!(dual < DQS_TOLERANCE, "{name}: {dual}");
        assert!(linear < LINEAR_TOLERANCE, "{name}: {linear}");
    }
}

#[test]
fn poses_of_posed_bodies_are_recovered() {
    let Some(assets) = assets() else { return };
    for (name, subject) in POSED {
        let body = body(&assets, subject);
        let posed = assets.join("body/posed");
        let pose = read_pose(posed.join(format!("{name}.json")), None, body.skeleton()).unwrap();
        for method in [Method::Linear, Method::DualQuaternion] {
            let target = match method {
                Method::Linear => positions(&posed.join(format!("{name}.obj"))),
                Method::DualQuaternion => body.posed_positions(&pose, method).unwrap(),
            };
            let recovered = timed(name, &body, &target);
            assert_eq!(recovered.method, method, "{name}");
            assert!(recovered.max_residual_m < REPRODUCED, "{name}");
            let worst = largest_turn(&body, &recovered, &pose);
            println!("  worst local rotation off by {worst:.2} degrees");
        }
    }
}

#[test]
fn poses_of_scenes_are_recovered() {
    let Some(assets) = assets() else { return };
    let names = [
        "01_tee_walk",
        "03_trousers_knee_up",
        "05_unisex_shirt_run",
        "07_skirt_step",
    ];
    for name in names {
        let scene = SceneJson::read(assets.join(format!("scenes/{name}/scene.json"))).unwrap();
        let body = scene.rig().unwrap().into_body().unwrap();
        let target = positions(&scene.target_body);
        let given = scene.posed_from_rest.as_ref().unwrap();
        let is_same_shape = name != "07_skirt_step";
        if is_same_shape {
            let linear = skin_linear(body.rest().positions(), body.weights(), given);
            assert!(
                largest_distance(&linear, &target) < LINEAR_TOLERANCE,
                "{name}"
            );
        }
        if let Some(pose) = &scene.pose {
            let from_pose = scene
                .target_skeleton
                .as_ref()
                .unwrap()
                .transforms(pose)
                .unwrap();
            let joints = scene.rest_skeleton.joints().iter();
            for ((a, b), joint) in from_pose.iter().zip(given).zip(joints) {
                assert!((a * joint.rest_position - b * joint.rest_position).norm() < 1e-4);
            }
        }
        let recovered = timed(name, &body, &target);
        let fit = Pose::from_transforms(scene.target_skeleton.as_ref().unwrap(), given).unwrap();
        let worst = largest_turn(&body, &recovered, &fit.pose);
        let apart = recovered.pose(&body).unwrap().max_residual_m;
        println!(
            "  worst local rotation off by {worst:.2} degrees, joints apart by {:.1} mm",
            1e3 * apart
        );
        if is_same_shape {
            assert_eq!(recovered.method, Method::Linear, "{name}");
            assert!(recovered.max_residual_m < REPRODUCED, "{name}");
        } else {
            // Another shape: no transforms reproduce it, but the fit must stay near the body.
            assert!(recovered.rms_residual_m < 5e-3, "{name}");
            assert!(worst < 10.0, "{name}");
            assert!(apart < 0.02, "{name}");
        }
    }
}

fn timed(name: &str, body: &Body, target: &[Point3]) -> RecoveredPose {
    let start = Instant::now();
    let recovered = recover_pose(body, target).unwrap();
    let milliseconds = 1e3 * start.elapsed().as_secs_f64();
    let RecoveredPose {
        method,
        max_residual_m,
        rms_residual_m,
        iterations,
        ..
    } = &recovered;
    println!(
        "{name}: {method:?}, max {max_residual_m:.1e} m, rms {rms_residual_m:.1e} m, {iterations} steps, {milliseconds:.1} ms"
    );
    recovered
}

/// Largest angle between recovered and given local rotations, in degrees.
fn largest_turn(body: &Body, recovered: &RecoveredPose, pose: &Pose) -> f32 {
    let fit = recovered.pose(body).unwrap();
    let pairs = fit.pose.rotations.iter().zip(&pose.rotations);
    pairs
        .map(|(a, b)| a.angle_to(b).to_degrees())
        .fold(0.0, f32::max)
}

/// Median time of dual-quaternion skinning.
fn skinning_milliseconds(body: &Body, pose: &Pose) -> f64 {
    let transforms = body.skeleton().transforms(pose).unwrap();
    let mut times: Vec<f64> = (0..51)
        .map(|_| {
            let start = Instant::now();
            let moved = skin_dual_quaternion(body.rest().positions(), body.weights(), &transforms);
            assert_eq!(moved.len(), body.rest().num_vertices());
            1e3 * start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[25]
}
