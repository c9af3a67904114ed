//! Pose recovery: the joint transforms that carry a rest body to a target body.
//!
//! Each joint starts at the weighted rigid fit of its own vertices. Gauss-Newton steps on the rigid
//! transforms of all joints together then make the *skinned* vertices meet the target, which the
//! separate fits do not where weights blend. Joints are free bodies that are softly tied to their
//! parents, because a target of another shape has other bone lengths.

mod equations;
mod refine;
mod start;

use nalgebra::{Isometry3, Point3 as NaPoint3};

use crate::{Body, Method, Point3, Pose, PoseFit, SkinError};

/// Recovered joint transforms, and how well they reproduce the target.
#[derive(Debug, Clone, PartialEq)]
pub struct RecoveredPose {
    /// Rigid transforms `posed_from_rest` `[joint]`.
    pub transforms: Vec<Isometry3<f32>>,
    /// The skinning that reproduces the target better with its best transforms.
    pub method: Method,
    /// Largest distance between a skinned rest vertex and its target, in metres.
    pub max_residual_m: f32,
    /// Root mean square of these distances, in metres.
    pub rms_residual_m: f32,
    /// Gauss-Newton steps that were taken.
    pub iterations: usize,
}

impl RecoveredPose {
    /// The pose of the recovered rotations; see [`Pose::from_transforms`].
    ///
    /// # Errors
    ///
    /// [`SkinError::TransformCount`] if `body` is not the one of the recovery.
    pub fn pose(&self, body: &Body) -> Result<PoseFit, SkinError> {
        Pose::from_transforms(body.skeleton(), &self.transforms)
    }
}

/// A linear fit whose largest residual is below this is exact, and no other method is tried, in
/// metres. It is the rounding of an OBJ with five digits and a wide margin.
const EXACT: f64 = 1e-4;

/// Recovers the joint transforms that carry the rest body to `target` `[vertex]`, in metres.
///
/// The target has the topology of the body. If it is the posed body itself, linear or
/// dual-quaternion skinned, the transforms reproduce it; if it has another shape, they are the
/// least-squares fit, and the residuals tell how different it is. Joints without vertices follow
/// their parents.
///
/// # Errors
///
/// [`SkinError::TargetCount`] or [`SkinError::NonFiniteTarget`].
pub fn recover_pose(body: &Body, target: &[Point3]) -> Result<RecoveredPose, SkinError> {
    if target.len() != body.rest().num_vertices() {
        return Err(SkinError::TargetCount {
            found: target.len(),
            expected: body.rest().num_vertices(),
        });
    }
    let is_bad = |point: &Point3| !point.iter().all(|value| value.is_finite());
    if let Some(vertex) = target.iter().position(is_bad) {
        return Err(SkinError::NonFiniteTarget { vertex });
    }
    // Vertices that no face names may lie anywhere, and tell nothing of the pose.
    if let Some(skin) = body.without_strays() {
        let target: Vec<Point3> = body.of_skin(target).copied().collect();
        return recover_pose(skin, &target);
    }
    let rest: Vec<NaPoint3<f64>> = body
        .rest()
        .positions()
        .iter()
        .map(|point| point.cast())
        .collect();
    let target: Vec<NaPoint3<f64>> = target.iter().map(|point| point.cast()).collect();
    let start = start::rigid_fits(body, &rest, &target);
    let problem = refine::Problem::new(body, &rest, &target);
    let linear = problem.solve(Method::Linear, &start);
    let best = if linear.max_residual < EXACT {
        linear
    } else {
        let dual = problem.solve(Method::DualQuaternion, &start);
        if dual.rms_residual < linear.rms_residual {
            dual
        } else {
            linear
        }
    };
    Ok(RecoveredPose {
        transforms: best
            .transforms
            .iter()
            .map(|transform| transform.cast())
            .collect(),
        method: best.method,
        max_residual_m: best.max_residual as f32,
        rms_residual_m: best.rms_residual as f32,
        iterations: best.iterations,
    })
}

#[cfg(test)]
mod tests;
