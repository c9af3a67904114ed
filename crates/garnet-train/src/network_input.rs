//! What a network is told of a scene.

use garnet_mesh::{Point3, Vector3};
use garnet_net::{Model, SceneInput};
use garnet_skin::{Body, PosedBody, WarpedGarment};

use crate::TrainError;

/// A scene as networks take it, from the vertices of the body `[body vertex]`, in metres, and their normals, if it asks for them.
pub(crate) fn input_of<'a>(
    warped: &'a WarpedGarment,
    body: &'a [Point3],
    body_normals: &'a [Vector3],
    parameters: &'a [f32],
) -> SceneInput<'a> {
    SceneInput {
        warped: &warped.positions,
        body,
        body_normals,
        world_from_root: warped.world_from_root,
        rotations: &warped.rotations,
        parameters,
    }
}

/// The normals of a body `[body vertex]`, if they are needed.
pub(crate) fn normals_of(posed: &PosedBody, are_needed: bool) -> Vec<Vector3> {
    if are_needed {
        posed.vertex_normals()
    } else {
        Vec::new()
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
    let normals = normals_of(posed, model.needs_body_normals());
    let input = input_of(warped, posed.skin().positions(), &normals, &parameters);
    Ok(model.predict(&input)?)
}
