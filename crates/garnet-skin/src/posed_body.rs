//! A body that garments are draped on: posed skin, the transforms that posed it, its shape.

use garnet_knn::Surface;
use garnet_mesh::{Point3, Vector3, vertex_normals};
use nalgebra::Isometry3;

use crate::shape::shape_offsets;
use crate::{Body, Method, Pose, SkinError, recover_pose};

/// A target closer than this to the posed rest shape has the rest shape, in metres.
const SAME_SHAPE: f32 = 5e-4;

/// A body in a pose, ready for proximity queries.
#[derive(Debug, Clone)]
pub struct PosedBody {
    skin: Surface,
    posed_from_rest: Vec<Isometry3<f32>>,
    shape_offsets: Option<Vec<Vector3>>,
    max_residual: f32,
}

impl PosedBody {
    /// The skin in the pose, as a surface to ask.
    pub fn skin(&self) -> &Surface {
        &self.skin
    }

    /// Unit normals of the posed skin `[body vertex]`.
    pub fn vertex_normals(&self) -> Vec<Vector3> {
        vertex_normals(self.skin.positions(), self.skin.faces())
    }

    /// The rigid transform of each joint from rest to pose.
    pub fn posed_from_rest(&self) -> &[Isometry3<f32>] {
        &self.posed_from_rest
    }

    /// Rest-space offset of each skin vertex from the rest shape, if the shape is another one.
    pub fn shape_offsets(&self) -> Option<&[Vector3]> {
        self.shape_offsets.as_deref()
    }

    /// How far the posed rest shape lies from this body's skin at most, in metres.
    pub fn max_residual(&self) -> f32 {
        self.max_residual
    }

    /// The same body moved rigidly: its skin and its joints elsewhere.
    pub(crate) fn moved(
        &self,
        positions: Vec<Point3>,
        posed_from_rest: Vec<Isometry3<f32>>,
    ) -> Result<Self, SkinError> {
        Ok(Self {
            skin: self.skin.moved(positions)?,
            posed_from_rest,
            shape_offsets: self.shape_offsets.clone(),
            max_residual: self.max_residual,
        })
    }
}

impl Body {
    /// This body in a pose, its skin moved by dual-quaternion skinning.
    ///
    /// # Errors
    ///
    /// Those of [`Skeleton::transforms`](crate::Skeleton::transforms).
    pub fn posed(&self, pose: &Pose) -> Result<PosedBody, SkinError> {
        let positions = self.posed_positions(pose, Method::DualQuaternion)?;
        Ok(PosedBody {
            skin: self.skin().moved(positions)?,
            posed_from_rest: self.skeleton().transforms(pose)?,
            shape_offsets: None,
            max_residual: 0.0,
        })
    }

    /// A target given as positions `[vertex]` of the same topology, in another pose and perhaps
    /// another shape: the pose is recovered, what it does not explain is the shape.
    ///
    /// # Errors
    ///
    /// Those of [`recover_pose`].
    pub fn fitted(&self, target: &[Point3]) -> Result<PosedBody, SkinError> {
        let recovered = recover_pose(self, target)?;
        self.fitted_by(target, recovered.transforms)
    }

    /// [`Body::fitted`] with the rigid transform of each joint from rest to target given.
    ///
    /// # Errors
    ///
    /// [`SkinError::TargetCount`], [`SkinError::TransformCount`] or
    /// [`SkinError::NonFiniteTarget`].
    pub fn fitted_by(
        &self,
        target: &[Point3],
        posed_from_rest: Vec<Isometry3<f32>>,
    ) -> Result<PosedBody, SkinError> {
        let expected = self.rest().num_vertices();
        if target.len() != expected {
            return Err(SkinError::TargetCount {
                found: target.len(),
                expected,
            });
        }
        let joints = self.skeleton().num_joints();
        if posed_from_rest.len() != joints {
            return Err(SkinError::TransformCount {
                found: posed_from_rest.len(),
                expected: joints,
            });
        }
        let skin = self.skin().moved(target.to_vec())?;
        let residual = |method| {
            let posed = self.transformed_positions(&posed_from_rest, method);
            max_distance(self, &posed, target)
        };
        let residuals = [Method::Linear, Method::DualQuaternion].map(residual);
        let (shape_offsets, max_residual) = if residuals[0].min(residuals[1]) > SAME_SHAPE {
            let (offsets, method) = self.smoothest_offsets(target, &posed_from_rest);
            (Some(offsets), residuals[method])
        } else {
            (None, residuals[0].min(residuals[1]))
        };
        Ok(PosedBody {
            skin,
            posed_from_rest,
            shape_offsets,
            max_residual,
        })
    }

    /// The shape offsets `[vertex]` at rest of a target, in metres, as linear or dual-quaternion
    /// skinning carries them there, and which of the two: 0 or 1.
    ///
    /// How a target was skinned is not known. The other method would need ridges and dents in the
    /// skin where joints bend, and so a larger sum of differences along the edges.
    fn smoothest_offsets(
        &self,
        target: &[Point3],
        posed_from_rest: &[Isometry3<f32>],
    ) -> (Vec<Vector3>, usize) {
        let (rest, faces) = (self.rest().positions(), self.rest().faces());
        let offsets = |method| shape_offsets(rest, target, self.weights(), posed_from_rest, method);
        let [linear, dual] = [Method::Linear, Method::DualQuaternion].map(offsets);
        let variation = |offsets: &[Vector3]| -> f64 {
            let edges = faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            let apart = edges.map(|edge| edge.map(|vertex| offsets[vertex as usize]));
            apart.map(|[a, b]| f64::from((a - b).norm())).sum()
        };
        if variation(&dual) < variation(&linear) {
            (dual, 1)
        } else {
            (linear, 0)
        }
    }
}

/// The largest distance between two places of the skin of a body.
fn max_distance(body: &Body, a: &[Point3], b: &[Point3]) -> f32 {
    let distances = body.of_skin(a).zip(body.of_skin(b));
    let distances = distances.map(|(a, b)| (a - b).norm());
    distances.fold(0.0, f32::max)
}
