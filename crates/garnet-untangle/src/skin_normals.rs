//! Normals of a posed skin, computed once a drape.

use garnet_knn::{ClosestPoint, Surface};
use garnet_mesh::Vector3;
use rayon::prelude::*;

/// Faces or vertices that one task handles.
const CHUNK: usize = 4096;

/// Unit normals of faces, and of vertices by the area of their faces.
///
/// They tell directions. Which side of the skin a point is on is told by pseudonormals.
#[derive(Debug)]
pub(crate) struct SkinNormals {
    faces: Vec<Vector3>,
    vertices: Vec<Vector3>,
}

impl SkinNormals {
    pub(crate) fn new(skin: &Surface) -> Self {
        let positions = skin.positions();
        let area_vector = |&[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|vertex| positions[vertex as usize]);
            (b - a).cross(&(c - a))
        };
        let mut faces: Vec<Vector3> = skin
            .faces()
            .par_iter()
            .with_min_len(CHUNK)
            .map(area_vector)
            .collect();
        let mut vertices = vec![Vector3::zeros(); positions.len()];
        for (corners, normal) in skin.faces().iter().zip(&faces) {
            for &vertex in corners {
                vertices[vertex as usize] += normal;
            }
        }
        let normalize = |normal: &mut Vector3| {
            *normal = normal.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        };
        faces.par_iter_mut().with_min_len(CHUNK).for_each(normalize);
        vertices
            .par_iter_mut()
            .with_min_len(CHUNK)
            .for_each(normalize);
        Self { faces, vertices }
    }

    /// The unit normal of a face, zero if it has no area.
    pub(crate) fn face(&self, face: u32) -> Vector3 {
        self.faces[face as usize]
    }

    /// The corners' normals interpolated at a point of the skin.
    pub(crate) fn smooth(&self, skin: &Surface, point: &ClosestPoint) -> Vector3 {
        let corners = skin.faces()[point.face as usize];
        let normals = corners.map(|vertex| self.vertices[vertex as usize]);
        let parts = normals.iter().zip(point.barycentric);
        let sum: Vector3 = parts.map(|(normal, share)| share * normal).sum();
        sum.try_normalize(0.0)
            .unwrap_or_else(|| self.face(point.face))
    }
}
