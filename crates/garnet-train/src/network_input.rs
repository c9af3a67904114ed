//! What a network is told of a scene.

use garnet_mesh::Point3;
use garnet_net::{Model, SceneInput};
use garnet_skin::{Body, PosedBody, WarpedGarment};

use crate::TrainError;

/// A scene as networks take it, from the vertices of the body `[body vertex]`, in metres.
pub(crate) fn input_of<'a>(
    warped: &'a WarpedGarment,
    body: &'a [Point3],
    parameters: &'a [f32],
) -> SceneInput<'a> {
    SceneInput {
        warped: &warped.positions,
        body,
        body_normals: &warped.body_normals,
        world_from_root: warped.world_from_root,
        rotations: &warped.rotations,
        parameters,
    }
}

/// The drape `[vertex]` of a model, in metres.
///
/// Pose and shape are computed for each, as in a drape, which compares them with what was trained on.
pub(crate) fn predicted(
    model: &mut Model,
    warped: &WarpedGarment,
    body: &Body,
    posed: &PosedBody,
) -> Result<Vec<Point3>, TrainError> {
    let parameters = body.pose_and_shape(posed);
    Ok(model.predict(&input_of(warped, posed.skin().positions(), &parameters))?)
}
