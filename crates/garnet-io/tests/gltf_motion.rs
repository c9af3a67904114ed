//! Motions out of the animations of GLB files.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::{fs, path::Path};

use garnet_body::{
    motion::{FrameRange, ReadOptions, RetargetOptions, world_rotations},
    shape::JOINT_NAMES,
};
use garnet_io::{MotionError, Take};
use garnet_skin::{Joint, Point3, Pose, Skeleton, Vector3};
use nalgebra::{Unit, UnitQuaternion};
use serde_json::{Value, json};

/// Parents and offsets of the 22 joints, in metres: a T-pose.
const JOINTS: [(Option<usize>, [f32; 3]); 22] = [
    (None, [0.0, 0.93, 0.0]),
    (Some(0), [0.09, -0.03, 0.0]),
    (Some(0), [-0.09, -0.03, 0.0]),
    (Some(0), [0.0, 0.11, 0.0]),
    (Some(1), [0.0, -0.4, 0.0]),
    (Some(2), [0.0, -0.4, 0.0]),
    (Some(3), [0.0, 0.13, 0.0]),
    (Some(4), [0.0, -0.4, 0.0]),
    (Some(5), [0.0, -0.4, 0.0]),
    (Some(6), [0.0, 0.06, 0.0]),
    (Some(7), [0.02, -0.05, 0.13]),
    (Some(8), [-0.02, -0.05, 0.13]),
    (Some(9), [0.0, 0.21, 0.0]),
    (Some(9), [0.06, 0.12, 0.0]),
    (Some(9), [-0.06, 0.12, 0.0]),
    (Some(12), [0.0, 0.1, 0.02]),
    (Some(13), [0.11, 0.03, 0.0]),
    (Some(14), [-0.11, 0.03, 0.0]),
    (Some(16), [0.29, 0.0, 0.0]),
    (Some(17), [-0.29, 0.0, 0.0]),
    (Some(18), [0.25, 0.0, 0.0]),
    (Some(19), [-0.25, 0.0, 0.0]),
];

const ELBOW: usize = 18;

fn skeleton() -> Skeleton {
    let mut joints: Vec<Joint> = Vec::new();
    for ((parent, offset), name) in JOINTS.into_iter().zip(JOINT_NAMES) {
        let start = parent.map_or(Point3::origin(), |parent| joints[parent].rest_position);
        joints.push(Joint {
            name: name.to_owned(),
            parent,
            rest_position: start + Vector3::from(offset),
        });
    }
    Skeleton::new(joints).unwrap()
}

/// The local frame that a joint's node has at rest: what exporters give bones.
fn rest_turn(joint: usize) -> UnitQuaternion<f32> {
    let axis = Vector3::new(1.0, 0.3 * joint as f32, -0.5);
    UnitQuaternion::from_axis_angle(&Unit::new_normalize(axis), 0.2 * joint as f32)
}

/// Adds floats to the buffer, and an accessor of them.
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    fn add(&mut self, kind: &str, width: usize, values: &[f32]) -> usize {
        let start = self.bytes.len();
        self.bytes
            .extend(values.iter().flat_map(|value| value.to_le_bytes()));
        let length = self.bytes.len() - start;
        self.views
            .push(json!({"buffer": 0, "byteOffset": start, "byteLength": length}));
        self.accessors.push(json!({
            "bufferView": self.views.len() - 1, "componentType": 5126,
            "count": values.len() / width, "type": kind,
        }));
        self.accessors.len() - 1
    }
}

fn quaternion(rotation: &UnitQuaternion<f32>) -> [f32; 4] {
    rotation.coords.into()
}

/// A GLB of the skeleton under a node that turns and scales it, whose nodes have frames of their
/// own; its clips are `Still`, and `Wave` with the elbow's rotation as `interpolation` says and the
/// pelvis's place.
#[expect(clippy::too_many_lines, reason = "a file in one piece")]
fn file(interpolation: &str, elbow: &[(f32, UnitQuaternion<f32>)], shift: Vector3) -> Vec<u8> {
    let mut buffer = Buffer {
        bytes: Vec::new(),
        views: Vec::new(),
        accessors: Vec::new(),
    };
    let skeleton = skeleton();
    // The armature: z up, in centimetres.
    let up = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -std::f32::consts::FRAC_PI_2);
    let frame = |joint: Option<usize>| joint.map_or(up, rest_turn);
    let place = |joint: Option<usize>| {
        joint.map_or(Point3::origin(), |joint| {
            skeleton.joints()[joint].rest_position
        })
    };
    let mut nodes = vec![json!({
        "name": "armature", "children": [1], "rotation": quaternion(&up), "scale": [0.01, 0.01, 0.01],
    })];
    let mut binds = Vec::new();
    for joint in 0..22 {
        let parent = JOINTS[joint].0;
        let local = frame(parent).inverse() * rest_turn(joint);
        let offset = frame(parent).inverse() * (place(Some(joint)) - place(parent)) * 100.0;
        let children: Vec<usize> = (0..22)
            .filter(|&child| JOINTS[child].0 == Some(joint))
            .map(|child| child + 1)
            .collect();
        let mut node = json!({
            "name": JOINT_NAMES[joint], "rotation": quaternion(&local),
            "translation": [offset.x, offset.y, offset.z],
        });
        if !children.is_empty() {
            node["children"] = json!(children);
        }
        nodes.push(node);
        let bind = nalgebra::Translation3::from(place(Some(joint)).coords).to_homogeneous()
            * rest_turn(joint).to_homogeneous()
            * nalgebra::Matrix4::new_scaling(0.01);
        binds.extend_from_slice(bind.try_inverse().unwrap().as_slice());
    }
    let binds = buffer.add("MAT4", 16, &binds);
    let times: Vec<f32> = elbow.iter().map(|(time, _)| *time).collect();
    let parent = JOINTS[ELBOW].0;
    let turns = elbow.iter().flat_map(|(_, turn)| {
        let local = quaternion(&(frame(parent).inverse() * turn * rest_turn(ELBOW)));
        match interpolation {
            "CUBICSPLINE" => [[0.0; 4], local, [0.0; 4]].concat(),
            _ => local.to_vec(),
        }
    });
    let turns: Vec<f32> = turns.collect();
    let times = buffer.add("SCALAR", 1, &times);
    let turns = buffer.add("VEC4", 4, &turns);
    let moved = up.inverse() * (place(Some(0)).coords + shift) * 100.0;
    let one = buffer.add("SCALAR", 1, &[0.0]);
    let places = buffer.add("VEC3", 3, &[moved.x, moved.y, moved.z]);
    let json = json!({
        "asset": {"version": "2.0"},
        "nodes": nodes,
        "skins": [{"joints": (1..23).collect::<Vec<usize>>(), "inverseBindMatrices": binds}],
        "animations": [
            {"name": "Still", "samplers": [{"input": one, "output": places}],
             "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}]},
            {"name": "Wave", "samplers": [
                {"input": times, "output": turns, "interpolation": interpolation},
                {"input": one, "output": places},
             ],
             "channels": [
                {"sampler": 0, "target": {"node": ELBOW + 1, "path": "rotation"}},
                {"sampler": 1, "target": {"node": 1, "path": "translation"}},
             ]},
        ],
        "buffers": [{"byteLength": buffer.bytes.len()}],
        "bufferViews": buffer.views, "accessors": buffer.accessors,
    });
    let mut text = serde_json::to_vec(&json).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    let total = 12 + 8 + text.len() + 8 + buffer.bytes.len();
    glb.extend((total as u32).to_le_bytes());
    glb.extend((text.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(text);
    glb.extend((buffer.bytes.len() as u32).to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(buffer.bytes);
    glb
}

fn take(folder: &Path, bytes: &[u8], clip: Option<&str>) -> Result<Take, MotionError> {
    let path = folder.join("character.glb");
    fs::write(&path, bytes).unwrap();
    Take::read_clip(&path, clip, &ReadOptions::default())
}

/// The elbow's turn in the world, frame by frame, and the last pose.
fn elbows(take: &Take) -> (Vec<UnitQuaternion<f64>>, Pose) {
    let skeleton = skeleton();
    let options = RetargetOptions::default();
    let poses = take.poses(&skeleton, FrameRange::ALL, &options).unwrap();
    let turns = poses
        .iter()
        .map(|pose| world_rotations(&skeleton, pose)[ELBOW]);
    (turns.collect(), poses[poses.len() - 1].clone())
}

#[test]
fn clips_are_played_on_their_own_skeleton_whatever_frames_their_bones_have() {
    let folder = tempfile::tempdir().unwrap();
    let bend = |angle: f32| UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -angle);
    // Keys of 30 frames a second, so that frames are keys but for the one in between.
    let keys = [
        (0.0, bend(0.0)),
        (1.0 / 30.0, bend(0.4)),
        (3.0 / 30.0, bend(1.2)),
    ];
    let shift = Vector3::new(1.5, 0.1, -2.0);
    for (interpolation, between) in [("LINEAR", 0.8), ("STEP", 0.4), ("CUBICSPLINE", 0.8)] {
        let bytes = file(interpolation, &keys, shift);
        let take = take(folder.path(), &bytes, Some("Wave")).unwrap();
        assert_eq!(take.num_frames(), 4, "{interpolation}");
        assert!((take.frame_time().unwrap() - 1.0 / 30.0).abs() < 1e-9);
        let (turns, last) = elbows(&take);
        for (turn, expected) in turns.iter().zip([0.0, 0.4, between, 1.2]) {
            let off = turn.angle_to(&bend(expected).cast());
            assert!(off < 1e-3, "{interpolation}: {off}");
        }
        assert!((last.root_translation - shift).norm() < 1e-4, "{last:?}");
        for (joint, rotation) in last.rotations.iter().enumerate() {
            assert!(
                joint == ELBOW || rotation.angle() < 1e-3,
                "{joint}: {rotation}"
            );
        }
    }
}

#[test]
fn the_first_clip_is_taken_and_others_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = file(
        "LINEAR",
        &[(0.0, UnitQuaternion::identity())],
        Vector3::zeros(),
    );
    let first = take(folder.path(), &bytes, None).unwrap();
    let notes = first
        .notes(&skeleton(), &RetargetOptions::default())
        .join("; ");
    assert!(notes.contains("of the clips `Still`, `Wave`"), "{notes}");
    assert_eq!(first.num_frames(), 1);
    let error = take(folder.path(), &bytes, Some("wave")).unwrap_err();
    let text = error.problem.to_string();
    assert!(
        text.contains("no clip `wave`; its clips are `Still`, `Wave`"),
        "{text}"
    );
    for length in [13, 40, bytes.len() / 2, bytes.len() - 1] {
        assert!(take(folder.path(), &bytes[..length], None).is_err());
    }
}

#[test]
fn keys_that_are_no_rotation_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let none = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(0.0, 0.0, 0.0, 0.0));
    let keys = [(0.0, UnitQuaternion::identity()), (0.1, none)];
    for interpolation in ["LINEAR", "STEP", "CUBICSPLINE"] {
        let bytes = file(interpolation, &keys, Vector3::zeros());
        let error = take(folder.path(), &bytes, Some("Wave")).unwrap_err();
        let text = error.problem.to_string();
        assert!(text.contains("quaternion of length zero"), "{text}");
    }
}
