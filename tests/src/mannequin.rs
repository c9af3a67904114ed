//! A mannequin: one smooth, closed body with arms half lowered and feet apart.

use garnet::{Body, Joint, Point3, Pose, Skeleton, SkinWeights, TriMesh, UnitQuaternion, Vector3};
use nalgebra::Quaternion;

use crate::bone::{Bone, smooth_min, union};
use crate::surface_nets::surface_nets;

/// Arms point down by the angle with the sides 3, 4 and 5.
pub(crate) const ARM_DIRECTION: [f32; 3] = [0.8, -0.6, 0.0];

/// The shoulder of the left arm, in metres.
pub(crate) const SHOULDER: [f32; 3] = [0.16, 1.385, -0.01];

/// Over which difference of distances two bones share a vertex, in metres.
const WEIGHT_BAND: f32 = 0.06;

/// Width of the smooth unions within torso, arms and legs, in metres.
const ROUNDING: f32 = 0.06;

/// Name and parent of each joint, and its position; those of the right side follow by reflection.
const JOINTS: [(&str, Option<usize>, [f32; 3]); 16] = [
    ("pelvis", None, [0.0, 0.95, 0.0]),
    ("spine", Some(0), [0.0, 1.06, 0.0]),
    ("chest", Some(1), [0.0, 1.22, -0.01]),
    ("head", Some(2), [0.0, 1.49, 0.0]),
    ("left_shoulder", Some(2), SHOULDER),
    ("left_elbow", Some(4), along_arm(0.28)),
    ("left_wrist", Some(5), along_arm(0.53)),
    ("right_shoulder", Some(2), SHOULDER),
    ("right_elbow", Some(7), along_arm(0.28)),
    ("right_wrist", Some(8), along_arm(0.53)),
    ("left_hip", Some(0), [0.1, 0.9, 0.0]),
    ("left_knee", Some(10), [0.125, 0.49, 0.005]),
    ("left_ankle", Some(11), [0.145, 0.085, -0.02]),
    ("right_hip", Some(0), [0.1, 0.9, 0.0]),
    ("right_knee", Some(13), [0.125, 0.49, 0.005]),
    ("right_ankle", Some(14), [0.145, 0.085, -0.02]),
];

/// Point on the left arm, `length` metres from the shoulder.
const fn along_arm(length: f32) -> [f32; 3] {
    [
        SHOULDER[0] + length * ARM_DIRECTION[0],
        SHOULDER[1] + length * ARM_DIRECTION[1],
        SHOULDER[2],
    ]
}

/// A mannequin of 1.75 m whose vertices are about `spacing` metres apart.
///
/// One closed surface. About 5 600 vertices at 2 cm, 13 000 at 13.2 mm.
///
/// # Panics
///
/// If `spacing` is so large that nothing is left of an arm, above 4 cm.
pub fn mannequin(spacing: f32) -> Body {
    let bounds = [[-0.85, -0.1, -0.35], [0.85, 1.85, 0.35]].map(Point3::from);
    let shape = Shape::new();
    let mesh = surface_nets(|point| shape.distance(point), bounds, spacing);
    let skeleton = Skeleton::new(joints()).expect("the table of joints is a tree");
    let rows = mesh.positions().iter().map(|&point| shape.weights(point));
    let weights = SkinWeights::from_influences(JOINTS.len(), rows)
        .expect("the nearest bone has weight 1 and all bones have joints");
    finished(mesh, skeleton, weights)
}

fn finished(mesh: TriMesh, skeleton: Skeleton, weights: SkinWeights) -> Body {
    Body::new(mesh, skeleton, weights).expect("one row of weights was made for each vertex")
}

fn joints() -> Vec<Joint> {
    let joint = |(name, parent, position): &(&str, Option<usize>, [f32; 3])| {
        let side = if name.starts_with("right") { -1.0 } else { 1.0 };
        Joint {
            name: (*name).to_owned(),
            parent: *parent,
            rest_position: Point3::new(side * position[0], position[1], position[2]),
        }
    };
    JOINTS.iter().map(joint).collect()
}

/// The bones, each with the joint that moves it.
pub(crate) struct Shape {
    trunk: Vec<(usize, Bone)>,
    head: Vec<(usize, Bone)>,
    arm: Vec<(usize, Bone)>,
    leg: Vec<(usize, Bone)>,
}

impl Shape {
    pub(crate) fn new() -> Self {
        let across = |half: f32, y: f32, z: f32| [[-half, y, z], [half, y, z]];
        let bar = |half, y, z, radius: f32, depth| {
            Bone::new(across(half, y, z), [radius; 2]).with_depth(depth)
        };
        let trunk = vec![
            (0, bar(0.065, 0.93, 0.0, 0.105, 0.92)),
            (1, bar(0.045, 1.09, 0.0, 0.092, 0.92)),
            (2, bar(0.07, 1.27, -0.005, 0.105, 0.9)),
            (2, bar(0.11, 1.375, -0.015, 0.062, 1.0)),
            (
                2,
                Bone::new([[0.0, 1.38, -0.015], [0.0, 1.5, 0.0]], [0.06, 0.048]),
            ),
        ];
        let head = vec![
            (
                3,
                Bone::new([[0.0, 1.48, 0.0], [0.0, 1.56, 0.01]], [0.05, 0.048]),
            ),
            (
                3,
                Bone::new([[0.0, 1.575, 0.04], [0.0, 1.64, 0.03]], [0.05, 0.068]),
            ),
            (
                3,
                Bone::new([[0.0, 1.645, 0.0], [0.0, 1.665, 0.0]], [0.08, 0.08]),
            ),
        ];
        let arm = vec![
            (4, Bone::new([SHOULDER, along_arm(0.28)], [0.052, 0.041])),
            (
                5,
                Bone::new([along_arm(0.28), along_arm(0.53)], [0.041, 0.027]),
            ),
            (
                6,
                Bone::new([along_arm(0.53), along_arm(0.66)], [0.03, 0.026]),
            ),
        ];
        let [hip, knee, ankle] = [JOINTS[10].2, JOINTS[11].2, JOINTS[12].2];
        let calf = [knee[0] + 0.005, 0.36, -0.02];
        let toes = [0.165, 0.035, 0.12];
        let leg = vec![
            (10, Bone::new([hip, knee], [0.085, 0.054])),
            (11, Bone::new([knee, calf], [0.052, 0.052])),
            (11, Bone::new([calf, ankle], [0.052, 0.034])),
            (12, Bone::new([ankle, toes], [0.04, 0.034])),
        ];
        Self {
            trunk,
            head,
            arm,
            leg,
        }
    }

    /// About the distance to the skin, negative inside, in metres.
    pub(crate) fn distance(&self, point: Point3) -> f32 {
        // Arms and legs of both sides are one in the mirror: the body is symmetric.
        let mirrored = Point3::new(point.x.abs(), point.y, point.z);
        let part = |bones: &[(usize, Bone)], width, point| {
            let distances = bones.iter().map(|(_, bone)| bone.distance(point));
            distances.fold(10.0, |a, b| smooth_min(a, b, width))
        };
        let trunk = part(&self.trunk, 1.6 * ROUNDING, point);
        let head = part(&self.head, 0.6 * ROUNDING, point);
        let arm = part(&self.arm, 0.2 * ROUNDING, mirrored);
        let leg = part(&self.leg, 0.2 * ROUNDING, mirrored);
        let upper = smooth_min(trunk, head, 0.3 * ROUNDING);
        smooth_min(smooth_min(upper, arm, ROUNDING), leg, 0.7 * ROUNDING)
    }

    /// Joint numbers and weights: bones as near as the nearest share, by how near they are.
    fn weights(&self, point: Point3) -> Vec<(usize, f32)> {
        let mirrored = Point3::new(-point.x, point.y, point.z);
        let trunk = self
            .trunk
            .iter()
            .chain(&self.head)
            .map(|(joint, bone)| (*joint, bone.distance(point)));
        let limbs = || self.arm.iter().chain(&self.leg);
        let left = limbs().map(|(joint, bone)| (*joint, bone.distance(point)));
        let right = limbs().map(|(joint, bone)| (joint + 3, bone.distance(mirrored)));
        let distances: Vec<(usize, f32)> = trunk.chain(left).chain(right).collect();
        let nearest = distances
            .iter()
            .fold(f32::INFINITY, |least, (_, d)| least.min(*d));
        let mut weights = [0.0_f32; JOINTS.len()];
        for (joint, distance) in distances {
            let share = (1.0 - (distance - nearest) / WEIGHT_BAND).max(0.0);
            weights[joint] = weights[joint].max(share * share * (3.0 - 2.0 * share));
        }
        weights.into_iter().enumerate().collect()
    }
}

/// The form that clothes hang over: the body, and a cone from the hips down in place of the legs.
pub(crate) fn form_distance(shape: &Shape, point: Point3) -> f32 {
    let skirt = Bone::new([[0.0, 0.95, 0.0], [0.0, 0.45, 0.0]], [0.14, 0.25]).with_depth(0.85);
    let body = shape.distance(point);
    smooth_min(body, union(&[skirt], ROUNDING, point), ROUNDING)
}

/// A turn by an angle given as the tangent of its quarter: closed under sums and roots, so that the
/// pose is the same on every machine.
fn turn(axis: [f32; 3], quarter_tangent: f32) -> UnitQuaternion<f32> {
    let t = f64::from(quarter_tangent);
    let (sin, cos) = (2.0 * t / (1.0 + t * t), (1.0 - t * t) / (1.0 + t * t));
    let axis = Vector3::from(axis).cast::<f64>().normalize();
    let quaternion = Quaternion::from_parts(cos, sin * axis);
    UnitQuaternion::new_normalize(quaternion).cast()
}

/// Rotations by joint name: axis and the tangent of a quarter of the angle.
fn posed(rotations: &[(&str, [f32; 3], f32)], root_translation: Vector3) -> Pose {
    let mut pose = Pose::rest(JOINTS.len());
    pose.root_translation = root_translation;
    for (name, axis, quarter_tangent) in rotations {
        let joint = JOINTS.iter().position(|(joint, ..)| joint == name);
        let joint = joint.expect("rotations name joints of the table");
        pose.rotations[joint] = turn(*axis, *quarter_tangent);
    }
    pose
}

/// A pose of the [`mannequin`]: the left arm reaches up and forward, the right one hangs, the trunk
/// turns, the right leg steps back.
pub fn reach() -> Pose {
    posed(
        &[
            ("pelvis", [0.0, 1.0, 0.0], 0.06),
            ("spine", [0.0, -0.5, 0.3], 0.06),
            ("chest", [-0.2, -1.0, 0.2], 0.06),
            ("head", [-1.0, 0.4, 0.0], 0.08),
            ("left_shoulder", [-0.3, -0.6, 1.0], 0.25),
            ("left_elbow", [-0.2, -0.8, 0.5], 0.1),
            ("right_shoulder", [-0.3, 0.1, 1.0], 0.16),
            ("right_elbow", [-1.0, 0.3, 0.2], 0.12),
            ("left_hip", [-1.0, 0.0, 0.1], 0.1),
            ("left_knee", [1.0, 0.0, 0.0], 0.09),
            ("right_hip", [1.0, 0.0, -0.1], 0.06),
            ("right_knee", [1.0, 0.0, 0.0], 0.08),
        ],
        Vector3::new(0.0, -0.02, 0.0),
    )
}

/// A pose of the [`mannequin`]: a long step with arms swinging close to the trunk.
pub fn stride() -> Pose {
    posed(
        &[
            ("chest", [0.0, 1.0, 0.0], 0.05),
            ("left_shoulder", [-0.5, 0.0, -1.0], 0.2),
            ("right_shoulder", [0.5, 0.0, 1.0], 0.2),
            ("left_elbow", [-1.0, 0.0, 0.0], 0.1),
            ("right_elbow", [-1.0, 0.0, 0.0], 0.15),
            ("left_hip", [1.0, 0.0, 0.0], 0.1),
            ("left_knee", [1.0, 0.0, 0.0], 0.12),
            ("right_hip", [-1.0, 0.0, 0.0], 0.16),
            ("right_knee", [1.0, 0.0, 0.0], 0.1),
        ],
        Vector3::zeros(),
    )
}
