//! A figure of capsules: a part of the body is a closed capsule that follows one joint.

#![allow(dead_code, reason = "not every test uses every helper")]
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

pub(crate) mod bent;

use std::error::Error;

use garnet_body::motion::{Figure, Role};
use garnet_body::shape::{JOINT_NAMES, JOINT_PARENTS};
use garnet_mesh::TriMesh;
use garnet_skin::{Body, Joint, Point3, Pose, Skeleton, SkinWeights, Vector3};
use nalgebra::UnitQuaternion;

pub(crate) const UPPER_ARM: f32 = 0.28;
pub(crate) const FOREARM: f32 = 0.25;
pub(crate) const THIGH: f32 = 0.42;
pub(crate) const SHANK: f32 = 0.41;

/// A skeleton in the order of the built-in one, with arms that far below the horizontal and legs
/// that far off the vertical, in degrees.
pub(crate) fn skeleton(arms_below: f32, legs_out: f32) -> Skeleton {
    let (arm, leg) = (arms_below.to_radians(), legs_out.to_radians());
    let mut positions = [Point3::origin(); 22];
    positions[0] = Point3::new(0.0, 0.95, 0.0);
    for joint in 1..22 {
        let side = if JOINT_NAMES[joint].starts_with("left") {
            1.0
        } else {
            -1.0
        };
        let arm = Vector3::new(side * arm.cos(), -arm.sin(), 0.0);
        let leg = Vector3::new(side * leg.sin(), -leg.cos(), 0.0);
        let name = JOINT_NAMES[joint]
            .trim_start_matches("left_")
            .trim_start_matches("right_");
        let offset = match name {
            "hip" => Vector3::new(side * 0.1, -0.03, 0.0),
            // A bone without length, as in MakeHuman.
            "spine1" => Vector3::zeros(),
            "spine2" => Vector3::new(0.0, 0.2, 0.0),
            "spine3" => Vector3::new(0.0, 0.12, 0.0),
            "neck" => Vector3::new(0.0, 0.22, 0.0),
            "head" => Vector3::new(0.0, 0.1, 0.01),
            "collar" => Vector3::new(side * 0.03, 0.16, 0.0),
            "shoulder" => Vector3::new(side * 0.15, 0.01, 0.0),
            "elbow" => UPPER_ARM * arm,
            "wrist" => FOREARM * arm,
            "knee" => THIGH * leg,
            "ankle" => SHANK * leg,
            _ => Vector3::new(side * 0.02, -0.05, 0.13),
        };
        let parent = JOINT_PARENTS[joint].unwrap();
        positions[joint] = positions[parent] + offset;
    }
    let joints = JOINT_NAMES.iter().zip(JOINT_PARENTS).zip(positions);
    let joints = joints.map(|((name, parent), rest_position)| Joint {
        name: (*name).to_owned(),
        parent,
        rest_position,
    });
    Skeleton::new(joints.collect()).unwrap()
}

/// The same skeleton without joints and all that hang on them.
pub(crate) fn without_limbs(skeleton: &Skeleton, names: &[&str]) -> Skeleton {
    let mut number = vec![None; skeleton.num_joints()];
    let mut kept: Vec<Joint> = Vec::new();
    for &joint in skeleton.parents_first() {
        let found = &skeleton.joints()[joint];
        let parent = found.parent.map(|parent| number[parent]);
        if names.contains(&found.name.as_str()) || parent == Some(None) {
            continue;
        }
        number[joint] = Some(kept.len());
        kept.push(Joint {
            parent: parent.flatten(),
            ..found.clone()
        });
    }
    Skeleton::new(kept).unwrap()
}

/// Radii of forearm and trunk.
pub(crate) const ARM_RADIUS: f32 = 0.035;
pub(crate) const TRUNK_RADIUS: f32 = 0.11;

/// Capsules around the bones of [`skeleton`].
pub(crate) fn body(arms_below: f32, legs_out: f32) -> Body {
    let skeleton = skeleton(arms_below, legs_out);
    let at = |name: &str| skeleton.joints()[skeleton.find(name).unwrap()].rest_position;
    let mut mesh = (Vec::new(), Vec::new());
    let mut joint_of = Vec::new();
    let mut add = |joint: &str, from: Point3, to: Point3, radius: f32| {
        let first = mesh.0.len() as u32;
        capsule(&mut mesh, from, to, radius);
        let joint = skeleton.find(joint).unwrap() as u32;
        joint_of.extend((first..mesh.0.len() as u32).map(|_| joint));
    };
    let top = at("head") + Vector3::new(0.0, 0.12, 0.0);
    add(
        "spine2",
        at("pelvis") + Vector3::new(0.0, 0.02, 0.0),
        at("spine3"),
        TRUNK_RADIUS,
    );
    add("head", at("head") + Vector3::new(0.0, 0.04, 0.0), top, 0.08);
    for side in ["left", "right"] {
        let joint = |name: &str| format!("{side}_{name}");
        let at = |name: &str| at(&joint(name));
        let along = (at("wrist") - at("elbow")).normalize();
        add(&joint("shoulder"), at("shoulder"), at("elbow"), ARM_RADIUS);
        add(
            &joint("elbow"),
            at("elbow"),
            at("wrist") + 0.12 * along,
            ARM_RADIUS,
        );
        add(&joint("hip"), at("hip"), at("knee"), 0.06);
        add(&joint("knee"), at("knee"), at("ankle"), 0.04);
        add(&joint("ankle"), at("ankle"), at("foot"), 0.03);
    }
    let weights = joint_of.iter().map(|&joint| [(joint as usize, 1.0_f32)]);
    let weights = SkinWeights::from_influences(22, weights).unwrap();
    Body::new(
        TriMesh::new(mesh.0, mesh.1).unwrap(),
        skeleton.clone(),
        weights,
    )
    .unwrap()
}

/// Adds a closed capsule: rings around the bone and half spheres at its ends.
fn capsule(mesh: &mut (Vec<Point3>, Vec<[u32; 3]>), from: Point3, to: Point3, radius: f32) {
    const AROUND: u32 = 24;
    const CAP: u32 = 6;
    const ALONG: u32 = 24;
    let axis = (to - from).normalize();
    let across = if axis.x.abs() < 0.7 {
        Vector3::x()
    } else {
        Vector3::y()
    };
    let u = axis.cross(&across).normalize();
    let v = axis.cross(&u);
    let mut rings = Vec::new();
    for step in 1..=CAP {
        let angle = std::f32::consts::FRAC_PI_2 * step as f32 / CAP as f32;
        rings.push((from - axis * radius * angle.cos(), radius * angle.sin()));
    }
    for step in 1..ALONG {
        rings.push((from + (to - from) * (step as f32 / ALONG as f32), radius));
    }
    for step in (1..=CAP).rev() {
        let angle = std::f32::consts::FRAC_PI_2 * step as f32 / CAP as f32;
        rings.push((to + axis * radius * angle.cos(), radius * angle.sin()));
    }
    let (positions, faces) = mesh;
    let start = positions.len() as u32;
    positions.push(from - axis * radius);
    for &(center, radius) in &rings {
        for step in 0..AROUND {
            let angle = std::f32::consts::TAU * step as f32 / AROUND as f32;
            positions.push(center + radius * (angle.cos() * u + angle.sin() * v));
        }
    }
    positions.push(to + axis * radius);
    let vertex = |ring: u32, step: u32| start + 1 + ring * AROUND + step % AROUND;
    let last = start + 1 + rings.len() as u32 * AROUND;
    for step in 0..AROUND {
        faces.push([start, vertex(0, step + 1), vertex(0, step)]);
        let end = rings.len() as u32 - 1;
        faces.push([last, vertex(end, step), vertex(end, step + 1)]);
        for ring in 0..end {
            let [a, b] = [vertex(ring, step), vertex(ring, step + 1)];
            let [c, d] = [vertex(ring + 1, step), vertex(ring + 1, step + 1)];
            faces.push([a, b, d]);
            faces.push([a, d, c]);
        }
    }
}

pub(crate) const CMU: [&str; 22] = [
    "Hips",
    "LeftUpLeg",
    "RightUpLeg",
    "LowerBack",
    "LeftLeg",
    "RightLeg",
    "Spine",
    "LeftFoot",
    "RightFoot",
    "Spine1",
    "LeftToeBase",
    "RightToeBase",
    "Neck1",
    "LeftShoulder",
    "RightShoulder",
    "Head",
    "LeftArm",
    "RightArm",
    "LeftForeArm",
    "RightForeArm",
    "LeftHand",
    "RightHand",
];

pub(crate) fn renamed(skeleton: &Skeleton, names: &[&str]) -> Skeleton {
    let joints = skeleton.joints().iter().zip(names);
    let joints = joints.map(|(joint, name)| Joint {
        name: (*name).to_owned(),
        ..joint.clone()
    });
    Skeleton::new(joints.collect()).unwrap()
}

/// A pose of small turns.
pub(crate) fn pose(num_joints: usize, seed: f32) -> Pose {
    let angle = |index: usize, axis: f32| 0.35 * (seed + 1.7 * index as f32 + axis).sin();
    Pose {
        root_translation: Vector3::new(0.2, 0.1, -0.4) * seed,
        rotations: (0..num_joints)
            .map(|index| {
                let vector = Vector3::new(angle(index, 0.0), angle(index, 2.0), angle(index, 4.0));
                UnitQuaternion::from_scaled_axis(vector)
            })
            .collect(),
    }
}

pub(crate) fn bone(skeleton: &Skeleton, pose: &Pose, role: Role, next: Role) -> Vector3 {
    let figure = Figure::new(skeleton, "the body").unwrap();
    let transforms = skeleton.transforms(pose).unwrap();
    let at = |role: Role| {
        let joint = figure.joint(role).unwrap();
        transforms[joint] * skeleton.joints()[joint].rest_position
    };
    (at(next) - at(role)).normalize()
}

/// An error and its causes in one line.
pub(crate) fn chain(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(next) = cause {
        text = format!("{text}: {next}");
        cause = next.source();
    }
    text
}
