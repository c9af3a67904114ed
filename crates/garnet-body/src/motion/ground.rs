//! Standing on the ground.

use garnet_skin::{Body, Method, Pose, SkinError};
use rayon::prelude::*;

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

/// The height of the lowest vertex of the skin in each pose `[pose]`, in metres.
///
/// # Errors
///
/// Those of [`garnet_skin::Skeleton::transforms`].
pub fn lowest_points(body: &Body, poses: &[Pose]) -> Result<Vec<f32>, SkinError> {
    let lowest = |pose: &Pose| {
        let positions = body.posed_positions(pose, Method::DualQuaternion)?;
        let heights = body.of_skin(&positions).map(|position| position.y);
        Ok(heights.fold(f32::INFINITY, f32::min))
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
