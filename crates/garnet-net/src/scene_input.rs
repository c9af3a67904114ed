//! What a scene brings.

use garnet_mesh::{Point3, Vector3};
use nalgebra::{Isometry3, UnitQuaternion};

/// What a scene brings: the skinned garment M and the target body B.
#[derive(Debug, Clone, Copy)]
pub struct SceneInput<'a> {
    /// The warped garment `[vertex]`, in metres.
    pub warped: &'a [Point3],
    /// The target body `[point]`, in metres.
    pub body: &'a [Point3],
    /// Unit normals `[point]`; may be empty where the configuration does not ask for them.
    pub body_normals: &'a [Vector3],
    /// Where the root joint (the pelvis) is.
    pub world_from_root: Isometry3<f32>,
    /// The blended skinning rotation of each garment vertex, from the template to the scene; may
    /// be empty where the configuration does not ask for it.
    pub rotations: &'a [UnitQuaternion<f32>],
    /// Parameters of shape and pose; may be empty where the configuration does not ask for them.
    pub parameters: &'a [f32],
}
