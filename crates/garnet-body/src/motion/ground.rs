//! Standing on the ground.

use garnet_mesh::Point3;
use garnet_skin::{Body, Method, Pose, SkinError};
use rayon::prelude::*;

use super::{Figure, Role, Side};

/// What is put on the ground, y = 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ground {
    /// The lowest vertex of every pose: nothing ever jumps.
    #[default]
    EachPose,
    /// The lowest vertex of all poses: the height above it stays as it is.
    Clip,
    /// Nothing.
    AsGiven,
}

/// Soles are this far below the ankles, over the way from there to the head.
const SOLES: f32 = 0.05;

/// A body has feet if its skin reaches so far below the ankles, over the way to the soles.
const REACHES_SOLES: f32 = 0.3;

/// Points of the soles of a body whose feet are missing at rest, each with the joint that it
/// follows and in metres: skin that was deleted under shoes, or legs under trousers. None of
/// others.
fn missing_soles(body: &Body) -> Vec<(usize, Point3)> {
    let skeleton = body.skeleton();
    let Ok(figure) = Figure::new(skeleton, "the body") else {
        return Vec::new();
    };
    let place = |joint: usize| skeleton.joints()[joint].rest_position;
    let joints = |role: fn(Side) -> Role| Side::BOTH.map(|side| figure.joint(role(side)));
    let ankles = joints(Role::Ankle);
    let lowest = body.of_skin(body.rest().positions()).map(|point| point.y);
    let lowest = lowest.fold(f32::INFINITY, f32::min);
    let Some(head) = figure.joint(Role::Head) else {
        return Vec::new();
    };
    let below = |ankle: usize| SOLES * (place(head).y - place(ankle).y);
    let is_there = |ankle: usize| lowest < place(ankle).y - REACHES_SOLES * below(ankle);
    if ankles.into_iter().flatten().any(is_there) {
        return Vec::new();
    }
    let pairs = ankles.into_iter().zip(joints(Role::Foot));
    let soles = pairs.filter_map(|(ankle, foot)| {
        let ankle = ankle?;
        let ground = place(ankle).y - below(ankle);
        let sole = |joint: usize| {
            let place = place(joint);
            (joint, Point3::new(place.x, ground, place.z))
        };
        Some([Some(ankle), foot].map(|joint| joint.map(sole)))
    });
    soles.flatten().flatten().collect()
}

/// The height of the lowest vertex of the skin in each pose `[pose]`, in metres. Of a body without
/// feet it is that of its soles, if it had them.
///
/// # Errors
///
/// Those of [`garnet_skin::Skeleton::transforms`].
pub fn lowest_points(body: &Body, poses: &[Pose]) -> Result<Vec<f32>, SkinError> {
    let soles = missing_soles(body);
    let lowest = |pose: &Pose| {
        let positions = body.posed_positions(pose, Method::DualQuaternion)?;
        let heights = body.of_skin(&positions).map(|position| position.y);
        let of_skin = heights.fold(f32::INFINITY, f32::min);
        if soles.is_empty() {
            return Ok(of_skin);
        }
        let transforms = body.skeleton().transforms(pose)?;
        let heights = soles
            .iter()
            .map(|&(joint, sole)| (transforms[joint] * sole).y);
        Ok(heights.fold(of_skin, f32::min))
    };
    poses.par_iter().map(lowest).collect()
}

/// Moves poses up or down until they stand on the ground.
///
/// # Errors
///
/// Those of [`garnet_skin::Skeleton::transforms`].
pub fn put_on_ground(body: &Body, poses: &mut [Pose], ground: Ground) -> Result<(), SkinError> {
    if ground == Ground::AsGiven || body.rest().num_vertices() == 0 {
        return Ok(());
    }
    let lowest = lowest_points(body, poses)?;
    let least = lowest.iter().copied().fold(f32::INFINITY, f32::min);
    for (pose, lowest) in poses.iter_mut().zip(lowest) {
        pose.root_translation.y -= match ground {
            Ground::Clip => least,
            Ground::EachPose | Ground::AsGiven => lowest,
        };
    }
    Ok(())
}
