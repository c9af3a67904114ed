//! What a scene contributes to the loss: the teacher's drape, and the body.

use std::sync::OnceLock;

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

/// The teacher's drape of a scene, measured once: when a term first asks for it.
#[derive(Debug, Clone)]
pub struct LossTarget {
    pub(super) places: Vec<Place>,
    normals: OnceLock<Vec<Option<Place>>>,
    lengths: OnceLock<Vec<f64>>,
    mean_curvature: OnceLock<TargetCurvature>,
    uniform_curvature: OnceLock<Vec<Place>>,
    quotients: [OnceLock<Vec<Extremes>>; 3],
}

impl LossTarget {
    pub(super) fn new(draped: &[Point3]) -> Self {
        Self {
            places: in_units(draped),
            normals: OnceLock::new(),
            lengths: OnceLock::new(),
            mean_curvature: OnceLock::new(),
            uniform_curvature: OnceLock::new(),
            quotients: Default::default(),
        }
    }

    /// Unit normals of the faces.
    pub(super) fn normals(&self, losses: &Losses) -> &[Option<Place>] {
        let normal = |&face: &[u32; 3]| unit_normal(&self.places, face).map(|(normal, _)| normal);
        let faces = losses.topology.faces();
        (self.normals).get_or_init(|| faces.iter().map(normal).collect())
    }

    /// Distances of two-ring pairs.
    pub(super) fn lengths(&self, losses: &Losses) -> &[f64] {
        (self.lengths).get_or_init(|| pair_lengths(&self.places, &losses.pairs))
    }

    pub(super) fn mean_curvature(&self, losses: &Losses) -> &TargetCurvature {
        let (topology, max_cotangent) = (&losses.topology, losses.config.max_cotangent);
        (self.mean_curvature)
            .get_or_init(|| TargetCurvature::new(&self.places, topology, max_cotangent))
    }

    pub(super) fn uniform_curvature(&self, losses: &Losses) -> &[Place] {
        (self.uniform_curvature).get_or_init(|| uniform_curvatures(&self.places, &losses.topology))
    }

    /// Rayleigh quotients of the neighborhoods of a size.
    pub(super) fn quotients(&self, losses: &Losses, size: usize) -> &[Extremes] {
        let hoods = &losses.neighborhoods[size];
        self.quotients[size].get_or_init(|| rayleigh_quotients(&self.places, hoods))
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
