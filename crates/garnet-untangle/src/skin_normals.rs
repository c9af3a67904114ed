//! Normals of a posed skin, each computed once a drape: when it is asked for first.

use std::sync::OnceLock;

use garnet_knn::{ClosestPoint, Feature, Surface};
use garnet_mesh::Vector3;
use rayon::prelude::*;

/// Faces or vertices that one task handles.
const CHUNK: usize = 4096;

/// Unit normals of faces, and angle-weighted pseudonormals of vertices.
#[derive(Debug)]
pub(crate) struct SkinNormals {
    faces: Vec<Vector3>,
    vertices: Vec<OnceLock<Vector3>>,
}

impl SkinNormals {
    pub(crate) fn new(skin: &Surface) -> Self {
        let positions = skin.positions();
        let normal = |&[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|vertex| positions[vertex as usize]);
            let area_vector = (b - a).cross(&(c - a));
            area_vector
                .try_normalize(0.0)
                .unwrap_or_else(Vector3::zeros)
        };
        let faces = skin.faces().par_iter().with_min_len(CHUNK);
        Self {
            faces: faces.map(normal).collect(),
            vertices: vec![OnceLock::new(); skin.positions().len()],
        }
    }

    /// The pseudonormal of a vertex. Those far from the garment are never asked for.
    fn vertex(&self, skin: &Surface, vertex: u32) -> Vector3 {
        *self.vertices[vertex as usize].get_or_init(|| skin.vertex_normal(vertex))
    }

    /// The unit normal of a face, zero if it has no area.
    pub(crate) fn face(&self, face: u32) -> Vector3 {
        self.faces[face as usize]
    }

    /// The pseudonormal at a point of the skin: which side of the skin a point is on whose closest
    /// skin this is (Bærentzen and Aanæs 2005).
    pub(crate) fn pseudonormal(&self, skin: &Surface, point: &ClosestPoint) -> Vector3 {
        match point.feature {
            Feature::Face => self.face(point.face),
            Feature::Edge(_) => skin.pseudonormal(point),
            Feature::Vertex(corner) => {
                let corners = skin.faces()[point.face as usize];
                self.vertex(skin, corners[usize::from(corner) % 3])
            }
        }
    }

    /// The corners' normals interpolated at a point of the skin.
    pub(crate) fn smooth(&self, skin: &Surface, point: &ClosestPoint) -> Vector3 {
        self.smooth_at(skin, point.face, point.barycentric)
    }

    /// The corners' normals interpolated at a place on a face.
    pub(crate) fn smooth_at(&self, skin: &Surface, face: u32, barycentric: [f32; 3]) -> Vector3 {
        let corners = skin.faces()[face as usize];
        let normals = corners.map(|vertex| self.vertex(skin, vertex));
        let parts = normals.iter().zip(barycentric);
        let sum: Vector3 = parts.map(|(normal, share)| share * normal).sum();
        sum.try_normalize(0.0).unwrap_or_else(|| self.face(face))
    }
}
