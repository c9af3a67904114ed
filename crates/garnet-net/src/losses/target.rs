//! What a scene contributes to the loss: the teacher's drape, and the body.

use garnet_knn::VertexTree;
use garnet_mesh::{Point3, TriMesh, Vector3, vertex_normals};

use super::bending::pair_lengths;
use super::gradient::{Place, unit_normal};
use super::mean_curvature::TargetCurvature;
use super::penetration::Front;
use super::rayleigh::{Extremes, rayleigh_quotients};
use super::uniform_curvature::uniform_curvatures;
use super::{Losses, in_units};
use crate::{NetError, UNIT};

/// The teacher's drape of a scene, measured once.
#[derive(Debug, Clone)]
pub struct LossTarget {
    pub(super) places: Vec<Place>,
    pub(super) normals: Vec<Option<Place>>,
    pub(super) lengths: Vec<f64>,
    pub(super) mean_curvature: TargetCurvature,
    pub(super) uniform_curvature: Vec<Place>,
    pub(super) quotients: [Vec<Extremes>; 3],
}

impl LossTarget {
    pub(super) fn new(losses: &Losses, draped: &[Point3]) -> Self {
        let places = in_units(draped);
        let topology = &losses.topology;
        let normal = |&face: &[u32; 3]| unit_normal(&places, face).map(|(normal, _)| normal);
        let max_cotangent = losses.config.max_cotangent;
        Self {
            normals: topology.faces().iter().map(normal).collect(),
            lengths: pair_lengths(&places, &losses.pairs),
            mean_curvature: TargetCurvature::new(&places, topology, max_cotangent),
            uniform_curvature: uniform_curvatures(&places, topology),
            quotients: (losses.neighborhoods.each_ref())
                .map(|hoods| rayleigh_quotients(&places, hoods)),
            places,
        }
    }
}

/// The posed body of a scene, as the penetration term sees it.
#[derive(Debug)]
pub struct LossBody {
    tree: VertexTree,
    points: Vec<Point3>,
    pub(super) normals: Vec<Vector3>,
    pub(super) mean_edge_length: f32,
}

impl LossBody {
    /// Of a posed body mesh.
    ///
    /// # Errors
    ///
    /// [`NetError::Knn`] for more vertices than can be numbered.
    pub fn new(body: &TriMesh) -> Result<Self, NetError> {
        let points = body.positions().to_vec();
        let length = |a: u32, b: u32| f64::from((points[a as usize] - points[b as usize]).norm());
        // Every edge of a closed skin is that of two faces: its mean needs no list of edges.
        let around = |&[a, b, c]: &[u32; 3]| length(a, b) + length(b, c) + length(c, a);
        let sum: f64 = body.faces().iter().map(around).sum();
        Ok(Self {
            tree: VertexTree::new(&points)?,
            normals: vertex_normals(&points, body.faces()),
            mean_edge_length: (sum / (3 * body.num_faces()).max(1) as f64) as f32,
            points,
        })
    }

    /// For each predicted vertex the nearest body point, moved out along its normal.
    pub(super) fn fronts(&self, predicted: &[Point3], offset: f32) -> Vec<Front> {
        let nearest = self.tree.k_nearest_all(predicted, 1);
        let front = |&index: &u32| {
            let normal = self.normals[index as usize].cast::<f64>();
            let point = self.points[index as usize].coords.cast::<f64>();
            let moved = point + normal * f64::from(offset * self.mean_edge_length);
            (moved / f64::from(UNIT), normal)
        };
        nearest.indices().iter().map(front).collect()
    }
}
