//! Rigs, scenes, weights and poses as JSON.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::{
    fs,
    path::{Path, PathBuf},
};

use garnet_io::{SceneJson, read_pose, read_rig, read_weights, write_obj};
use garnet_skin::{Point3, Pose, Skeleton, Vector3};
use nalgebra::{Isometry3, UnitQuaternion};
use proptest::prelude::*;
use serde_json::{Value, json};

mod common;

use common::{chain, strip};

/// Writes mesh, weights, rig and scene of the strip, in centimetres.
fn folder() -> (tempfile::TempDir, Value, Value) {
    let folder = tempfile::tempdir().unwrap();
    let rig = strip();
    let mesh = rig.rest.unwrap();
    let in_cm = mesh.positions().iter().map(|point| point * 100.0).collect();
    let mesh = mesh.with_positions(in_cm).unwrap();
    for name in ["rest.obj", "target.obj", "shirt.obj"] {
        write_obj(folder.path().join(name), &mesh).unwrap();
    }
    let shares = [0.0, 0.0, 0.25, 0.25, 0.75, 0.75, 1.0, 1.0];
    let weights = json!({
        "joints": 2,
        "influences_per_vertex": 2,
        "joint_index": vec![[0, 1]; 8],
        "weight": shares.map(|share| [1.0 - share, share]),
    });
    fs::write(folder.path().join("weights.json"), weights.to_string()).unwrap();
    let joints = json!([
        {"name": "hip", "parent": -1, "rest_position": [5.0, 0.0, 0.0]},
        {"name": "knee", "parent": 0, "rest_position": [5.0, 40.0, 0.0]},
    ]);
    let rig = json!({"units": "cm", "up": "+Y", "mesh": "rest.obj", "joints": joints, "weights": "weights.json"});
    let turn = UnitQuaternion::from_scaled_axis(nalgebra::Vector3::new(0.0_f64, 0.0, 0.5));
    let center = nalgebra::Point3::new(5.0, 40.0, 0.0);
    let knee = Isometry3::rotation_wrt_point(turn, center)
        .to_homogeneous()
        .transpose();
    let hip = nalgebra::Matrix4::<f64>::identity();
    let scene = json!({
        "schema": "drape-scene/1",
        "name": "strip",
        "units": "cm",
        "up": "+Y",
        "garment": {"mesh": "shirt.obj"},
        "body_rest": {"mesh": "rest.obj", "joints": joints},
        "body_target": {"mesh": "target.obj", "joints": joints, "pose": {
            "local_rotation_xyzw": [[0.0, 0.0, 0.0, 1.0], turn.coords.as_slice()],
            "root_translation": [0.0, 0.0, 0.0],
            "joint_transforms_row_major_4x4": [hip.as_slice(), knee.as_slice()],
        }},
        "weights": "weights.json",
    });
    (folder, rig, scene)
}

fn written(folder: &Path, name: &str, json: &Value) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, serde_json::to_string_pretty(json).unwrap()).unwrap();
    path
}

#[test]
fn a_rig_json_in_centimetres_is_read_in_metres() {
    let (folder, rig, _) = folder();
    let read = read_rig(written(folder.path(), "rig.json", &rig)).unwrap();
    let expected = strip();
    assert_eq!(read.weights, expected.weights);
    assert_eq!(
        read.skeleton.joints()[1].rest_position,
        Point3::new(0.05, 0.4, 0.0)
    );
    let pairs = read.rest.as_ref().unwrap().positions().iter();
    for (found, expected) in pairs.zip(expected.rest.unwrap().positions()) {
        approx::assert_relative_eq!(*found, *expected, epsilon = 1e-6);
    }
    assert!(read.into_body().is_ok());
}

#[test]
fn a_scene_gives_paths_transforms_and_a_rig() {
    let (folder, _, scene) = folder();
    let path = written(folder.path(), "scene.json", &scene);
    let scene = SceneJson::read(&path).unwrap();
    assert_eq!(scene.garment, folder.path().join("shirt.obj"));
    let from_pose = scene
        .rest_skeleton
        .transforms(scene.pose.as_ref().unwrap())
        .unwrap();
    let matrices = scene.posed_from_rest.as_ref().unwrap();
    for (a, b) in from_pose.iter().zip(matrices) {
        let point = Point3::new(0.1, 0.7, 0.0);
        approx::assert_relative_eq!(a * point, b * point, epsilon = 1e-6);
    }
    let rig = read_rig(&path).unwrap();
    assert_eq!(rig, scene.rig().unwrap());
    assert_eq!(rig.weights, strip().weights);
}

#[test]
fn what_is_wrong_with_a_scene_or_rig_is_named() {
    type Change = fn(&mut Value);
    let cases: [(Change, &str); 9] = [
        (
            |scene| scene["garment"]["mesh"] = json!("gone.obj"),
            "gone.obj` is not there",
        ),
        (
            |scene| scene["weights"] = json!("gone.json"),
            "the weights file",
        ),
        (
            |scene| scene["units"] = json!("yd"),
            "`units` is `yd`, expected `m`, `dm`, `cm`, `mm`, `in` or `ft`",
        ),
        (|scene| scene["up"] = json!("+Z"), "`up` is `+Z`"),
        (
            |scene| scene["schema"] = json!("drape-scene/2"),
            "`schema` is `drape-scene/2`",
        ),
        (
            |scene| scene["body_rest"]["joints"][1]["parent"] = json!(1),
            "`knee`) is its own ancestor",
        ),
        (
            |scene| {
                scene["body_target"]["pose"]["joint_transforms_row_major_4x4"][1][0] = json!(1.5);
            },
            "joint `knee` is not rigid",
        ),
        (
            |scene| {
                scene["body_target"]["pose"]["joint_transforms_row_major_4x4"][1] = json!([1.0]);
            },
            "has 1 entries, expected 16",
        ),
        (
            |scene| scene["body_rest"]["joints"][0]["rest_position"] = json!([1, 2]),
            "line ",
        ),
    ];
    let (folder, _, scene) = folder();
    for (change, expected) in cases {
        let mut scene = scene.clone();
        change(&mut scene);
        let text = chain(&read_rig(written(folder.path(), "scene.json", &scene)).unwrap_err());
        assert!(text.contains(expected), "{text}");
        assert!(text.contains("scene.json"), "{text}");
    }
    let path = folder.path().join("notes.txt");
    fs::write(&path, "a shirt").unwrap();
    assert!(chain(&read_rig(&path).unwrap_err()).contains("no rig"));
}

#[test]
fn weights_of_uneven_lists_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let uneven =
        json!({"joints": 2, "joint_index": [[0, 1], [0]], "weight": [[0.5, 0.5], [0.5, 0.5]]});
    let text = chain(&read_weights(written(folder.path(), "w.json", &uneven)).unwrap_err());
    assert!(
        text.contains("`weight[1]` has 2 entries, expected 1"),
        "{text}"
    );
    let unknown = json!({"joints": 2, "joint_index": [[5]], "weight": [[1.0]]});
    let text = chain(&read_weights(written(folder.path(), "w.json", &unknown)).unwrap_err());
    assert!(text.contains("joint 5"), "{text}");
}

fn read_text(text: &str) -> Result<Pose, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pose.json");
    fs::write(&path, text).unwrap();
    read_pose(path, None, &skeleton()).map_err(|error| chain(&error))
}

fn read(json: &Value, frame: Option<usize>) -> Result<Pose, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = written(folder.path(), "pose.json", json);
    read_pose(path, frame, &skeleton()).map_err(|error| chain(&error))
}

fn skeleton() -> Skeleton {
    strip().skeleton
}

const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

#[test]
fn a_pose_by_name_leaves_other_joints_at_rest() {
    let pose = json!({"schema": "garnet.pose/1", "joints": {"knee": [HALF, 0, 0, HALF]}, "root_translation": [0, 1, 0]});
    let pose = read(&pose, None).unwrap();
    assert_eq!(pose.root_translation, Vector3::new(0.0, 1.0, 0.0));
    assert_eq!(pose.rotations[0], UnitQuaternion::identity());
    approx::assert_relative_eq!(
        pose.rotations[1].scaled_axis().x,
        std::f32::consts::FRAC_PI_2,
        epsilon = 1e-6
    );
}

#[test]
fn the_ordered_form_and_matrices_give_the_same_pose() {
    let ordered = json!({"joint_order": ["knee", "hip"], "local_rotation_xyzw": [[HALF, 0, 0, HALF], [0, 0, 0, 1]]});
    let ordered = read(&ordered, None).unwrap();
    let transforms = skeleton().transforms(&ordered).unwrap();
    let rows: Vec<Vec<f32>> = transforms
        .iter()
        .map(|t| t.to_homogeneous().transpose().as_slice().to_vec())
        .collect();
    let matrices = json!({"local_rotation_xyzw": null, "joint_transforms_row_major_4x4": rows});
    let matrices = read(&matrices, None).unwrap();
    let other_rows: Vec<&Vec<f32>> = rows.iter().rev().collect();
    let own = skeleton();
    let names = own.joints().iter().rev();
    let names: Vec<String> = names.map(|joint| joint.name.clone()).collect();
    let by_name = json!({"joint_order": names, "joint_transforms_row_major_4x4": other_rows});
    let by_name = read(&by_name, None).unwrap();
    for ((a, b), c) in (ordered.rotations.iter().zip(&matrices.rotations)).zip(&by_name.rotations) {
        assert!(a.angle_to(b) < 1e-3);
        assert!(b.angle_to(c) < 1e-6);
    }
    let lacking = json!({"joint_order": ["hip", "hip"], "joint_transforms_row_major_4x4": rows});
    let text = read(&lacking, None).unwrap_err();
    assert!(text.contains("hip twice"), "{text}");
}

#[test]
fn a_frame_is_picked_from_a_list() {
    let frames = json!({
        "joint_order": ["hip", "knee"],
        "frames": [{"joints": {}}, {"local_rotation_xyzw": [[0, 0, 0, 1], [0, HALF, 0, HALF]]}],
    });
    assert_eq!(read(&frames, None).unwrap(), Pose::rest(2));
    assert_ne!(read(&frames, Some(1)).unwrap(), Pose::rest(2));
    let text = read(&frames, Some(2)).unwrap_err();
    assert!(
        text.contains("frame 2 was asked for, but there are 2"),
        "{text}"
    );
}

#[test]
fn what_is_wrong_with_a_pose_is_named() {
    let cases = [
        (
            json!({"joints": {"kne": [0, 0, 0, 1]}}),
            "no joint `kne`; near it are `knee`",
        ),
        (
            json!({"joints": {"zzzzzzzz": [0, 0, 0, 1]}}),
            "no joint `zzzzzzzz`",
        ),
        (
            json!({"joints": {"knee": [0, 0, 0, 2]}}),
            "joint `knee` has the norm 2",
        ),
        (json!({"joints": {"knee": [0, 0, 0, 0]}}), "norm 0"),
        (json!({"joints": {"knee": [0, 0, 1]}}), "line "),
        (
            json!({"local_rotation_xyzw": [[0, 0, 0, 1]]}),
            "has 1 entries, expected 2",
        ),
        (
            json!({"frames": []}),
            "frame 0 was asked for, but there are 0",
        ),
        (json!({"schema": "garnet.pose/1"}), "no pose"),
        (
            json!({"schema": "garnet.pose/9", "joints": {}}),
            "`garnet.pose/9`",
        ),
        (
            json!({"joints": {}, "root_translation": [1e300, 0, 0]}),
            "`root_translation` is `1e300`",
        ),
        (json!([1, 2]), "line "),
        (
            json!({"joints": {}, "rotations": {"knee": [0, 0, 0, 1]}}),
            "`rotations` is `something that is not read`",
        ),
        (
            json!({"joints": {"knee": [0, 0, 0, 1]}, "knee": [0, 0, 0, 1]}),
            "`knee` is `something that is not read`",
        ),
        (
            json!({"joint_order": ["knee", "knee"], "local_rotation_xyzw": [[0, 0, 0, 1], [0, 0, 0, 1]]}),
            "knee twice",
        ),
    ];
    for (json, expected) in cases {
        let text = read(&json, None).unwrap_err();
        assert!(text.contains(expected), "{text}");
        assert!(text.contains("pose.json"), "{text}");
    }
    // `json!` would drop the first of them.
    let twice = r#"{"joints": {"knee": [0, 0, 0, 1], "knee": [1, 0, 0, 0]}}"#;
    let text = read_text(twice).unwrap_err();
    assert!(text.contains("knee twice"), "{text}");
    assert!(read(&json!({"joints": {"knee": [0, 0, 0, 1.0005]}}), None).is_ok());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]
    #[test]
    fn no_damage_makes_the_readers_panic(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..5)) {
        let (folder, rig, scene) = folder();
        let pose = json!({"joints": {"knee": [HALF, 0, 0, HALF]}, "root_translation": [0, 1, 0]});
        for (json, is_pose) in [(rig, false), (scene, false), (pose, true)] {
            let mut bytes = json.to_string().into_bytes();
            for (at, value) in &changes {
                let at = at.index(bytes.len());
                bytes[at] = *value;
            }
            let path = folder.path().join("damaged.json");
            fs::write(&path, bytes).unwrap();
            if is_pose {
                let _ = read_pose(&path, None, &skeleton());
            } else {
                let _ = read_rig(&path);
            }
        }
    }

    #[test]
    fn garbage_is_refused_by_every_reader(bytes in prop::collection::vec(any::<u8>(), 0..300), extension in 0_usize..4) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(["a.npz", "a.glb", "a.gltf", "a.json"][extension]);
        fs::write(&path, bytes).unwrap();
        prop_assert!(read_rig(&path).is_err());
        prop_assert!(read_pose(&path, None, &skeleton()).is_err());
        prop_assert!(read_weights(&path).is_err());
        prop_assert!(SceneJson::read(&path).is_err());
    }
}
