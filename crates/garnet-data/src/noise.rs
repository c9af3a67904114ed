//! How repeatable the teacher is.

use std::sync::atomic::AtomicBool;

use garnet_drape::{BodyPath, Quality, Simulator};
use garnet_mesh::vertex_distances;
use garnet_skin::{Body, Pose};
use nalgebra::{UnitQuaternion, Vector3};

use crate::DataError;

/// By how much a joint turns more in the second drape, in radians.
pub const NOISE_TURN: f32 = 0.001;

/// The joint that turns: the first that the body has and that moves the garment; else the last of
/// the body.
const NOISE_JOINTS: [&str; 2] = ["left_shoulder", "left_hip"];

/// How far a drape of `simulator` moves if one shoulder of `body` turns by [`NOISE_TURN`] more, or
/// a hip if shoulders do not move the garment: in metres, in the mean over all vertices.
///
/// The hand moves by 0.7 mm. What cloth moves more is not decided by the body: no network can
/// predict it.
///
/// # Errors
///
/// As [`moved_by_turn`].
pub fn noise_floor(
    simulator: &Simulator,
    body: &Body,
    pose: &Pose,
    quality: Quality,
    stop: &AtomicBool,
) -> Result<f64, DataError> {
    let turn = (noise_joint(simulator, body), NOISE_TURN);
    moved_by_turn(simulator, body, pose, quality, turn, stop)
}

/// The joint that turns in [`noise_floor`].
pub fn noise_joint(simulator: &Simulator, body: &Body) -> usize {
    let joints = NOISE_JOINTS.iter();
    let mut joints = joints.filter_map(|name| body.skeleton().find(name));
    let joint = joints.find(|&joint| simulator.is_moved_by(joint));
    joint.unwrap_or(body.skeleton().num_joints() - 1)
}

/// How far a drape of `simulator` moves if a joint of `body` turns by an angle more, in radians,
/// about its own z axis, as in [`noise_floor`]: in metres, in the mean over all vertices.
///
/// # Errors
///
/// Those of [`Simulator::drape`], and [`DataError::Skin`] for a pose of another body.
///
/// # Panics
///
/// If there is no such joint.
pub fn moved_by_turn(
    simulator: &Simulator,
    body: &Body,
    pose: &Pose,
    quality: Quality,
    (joint, angle): (usize, f32),
    stop: &AtomicBool,
) -> Result<f64, DataError> {
    let drape = |pose: &Pose| {
        let path = BodyPath::to_shape(body, body, pose)?;
        simulator.drape(&path, quality, stop, &mut |_| {})
    };
    let mut turned = pose.clone();
    let first = drape(pose)?;
    turned.rotations[joint] *= UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
    let moved = vertex_distances(&first.positions, &drape(&turned)?.positions)?;
    let sum: f64 = moved.iter().map(|&distance| f64::from(distance)).sum();
    Ok(sum / moved.len().max(1) as f64)
}
