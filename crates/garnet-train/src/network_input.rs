//! What a network is told of a scene.

use garnet_mesh::{Point3, Vector3};
use garnet_net::SceneInput;
use garnet_skin::{PosedBody, WarpedGarment};

/// A scene as networks take it, from the vertices of the body `[body vertex]`, in metres, and their
/// normals, if it asks for them.
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
