//! What cloth lies on: a body or any other mesh that moves.

use std::sync::Arc;

use crate::{Point3, SimError};
use garnet_knn::Surface;
use garnet_mesh::{Topology, TriMesh};

/// The faces of a body, and which part of it each belongs to.
///
/// Parts are numbers below 32 that mean nothing here: two arms, a trunk and two legs, say. They
/// tell cloth which skin it may rest on, and where two parts face each other.
#[derive(Debug, Clone)]
pub struct Collider {
    adjacency: Arc<Adjacency>,
    part_of_face: Option<Vec<u8>>,
    /// Where it is at some time, ready for queries: moved from there it is ready sooner.
    somewhere: Option<Surface>,
}

/// How the faces of a collider hang together.
#[derive(Debug)]
pub(crate) struct Adjacency {
    pub(crate) topology: Topology,
    /// The face across each side `[face][side]`, the side from a corner to the next; the face
    /// itself where there is none.
    pub(crate) across: Vec<[u32; 3]>,
}

/// How many parts a collider can have.
pub const MAX_PARTS: u8 = 32;

/// Where the vertices `[vertex]` of a collider are at a time from 0 (the garment's start) to 1 (the
/// target), in metres.
///
/// It is asked at equal steps, 0 first, and has to be continuous. A collider that stands still is
/// `&|_| positions.clone()`.
pub type Motion<'a> = dyn Fn(f32) -> Vec<Point3> + Sync + 'a;

impl Collider {
    /// A collider without parts.
    ///
    /// # Errors
    ///
    /// [`SimError::Collider`] for faces that name missing vertices.
    pub fn new(faces: &[[u32; 3]], num_vertices: usize) -> Result<Self, SimError> {
        let nowhere = vec![Point3::origin(); num_vertices];
        let mesh = TriMesh::new(nowhere, faces.to_vec()).map_err(SimError::Collider)?;
        Ok(Self {
            adjacency: Arc::new(Adjacency::new(num_vertices, mesh.faces())),
            part_of_face: None,
            somewhere: None,
        })
    }

    /// The same collider, that knows where it is at some time: simulations begin sooner.
    ///
    /// # Errors
    ///
    /// [`SimError::Count`] if the surface has other numbers of vertices or faces.
    pub fn with_surface(mut self, surface: Surface) -> Result<Self, SimError> {
        let (found, expected) = (surface.positions().len(), self.num_vertices());
        crate::rest_shape::check_count("positions of the collider", found, expected)?;
        let (found, expected) = (surface.faces().len(), self.faces().len());
        crate::rest_shape::check_count("faces of the collider", found, expected)?;
        self.somewhere = Some(surface);
        Ok(self)
    }

    /// The same collider with the part of each face.
    ///
    /// # Errors
    ///
    /// [`SimError::Count`] if there is not one part a face, [`SimError::PartTooLarge`].
    pub fn with_parts(mut self, part_of_face: Vec<u8>) -> Result<Self, SimError> {
        crate::rest_shape::check_count("parts of faces", part_of_face.len(), self.faces().len())?;
        for (face, &part) in part_of_face.iter().enumerate() {
            if part >= MAX_PARTS {
                return Err(SimError::PartTooLarge { face, part });
            }
        }
        self.part_of_face = Some(part_of_face);
        Ok(self)
    }

    /// Faces of the body `[face][corner]`, as numbers of vertices.
    pub fn faces(&self) -> &[[u32; 3]] {
        self.adjacency.topology.faces()
    }

    /// How many vertices there are.
    pub fn num_vertices(&self) -> usize {
        self.adjacency.topology.num_vertices()
    }

    /// How the faces hang together.
    pub(crate) fn adjacency(&self) -> &Arc<Adjacency> {
        &self.adjacency
    }

    /// The part of each face, if there are parts.
    pub fn part_of_face(&self) -> Option<&[u8]> {
        self.part_of_face.as_deref()
    }

    /// The collider at a place, ready for proximity queries.
    ///
    /// # Errors
    ///
    /// [`SimError::Collider`] for positions that do not fit or are not finite.
    pub fn surface(&self, positions: Vec<Point3>) -> Result<Surface, SimError> {
        let (found, expected) = (positions.len(), self.num_vertices());
        crate::rest_shape::check_count("positions of the collider", found, expected)?;
        if let Some(Ok(surface)) =
            (self.somewhere.as_ref()).map(|surface| surface.moved(positions.clone()))
        {
            return Ok(surface);
        }
        let mesh = TriMesh::new(positions, self.faces().to_vec()).map_err(SimError::Collider)?;
        Ok(Surface::new(&mesh))
    }
}

impl Adjacency {
    fn new(num_vertices: usize, faces: &[[u32; 3]]) -> Self {
        let topology = Topology::new(num_vertices, faces);
        let mut across: Vec<[u32; 3]> = (0..faces.len() as u32).map(|face| [face; 3]).collect();
        for (edge, vertices) in topology.edges().iter().enumerate() {
            let &[first, second] = topology.edge_faces(edge) else {
                continue;
            };
            for (face, other) in [(first, second), (second, first)] {
                let corners = faces[face as usize];
                for side in 0..3 {
                    let ends = [corners[side], corners[(side + 1) % 3]];
                    if vertices.contains(&ends[0]) && vertices.contains(&ends[1]) {
                        across[face as usize][side] = other;
                    }
                }
            }
        }
        Self { topology, across }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_have_to_fit() {
        let collider = Collider::new(&[[0, 1, 2]], 3).unwrap();
        let none = collider.clone().with_parts(Vec::new());
        assert!(matches!(none, Err(SimError::Count { found: 0, .. })));
        let large = collider.clone().with_parts(vec![32]);
        let expected = SimError::PartTooLarge { face: 0, part: 32 };
        assert_eq!(large.err(), Some(expected));
        assert!(collider.with_parts(vec![31]).is_ok());
    }

    #[test]
    fn positions_have_to_fit() {
        let collider = Collider::new(&[[0, 1, 2]], 3).unwrap();
        let error = collider.surface(vec![Point3::origin(); 2]).unwrap_err();
        assert!(matches!(error, SimError::Count { expected: 3, .. }));
        assert!(Collider::new(&[[0, 1, 3]], 3).is_err());
    }

    #[test]
    fn a_collider_that_knows_where_it_is_is_found_where_it_moves() {
        let ball = garnet_mesh::primitives::icosphere(2, 0.1);
        let plain = Collider::new(ball.faces(), ball.num_vertices()).unwrap();
        let known = plain.clone().with_surface(Surface::new(&ball)).unwrap();
        let moved: Vec<Point3> = ball.positions().iter().map(|p| 2.0 * p).collect();
        let point = Point3::new(0.3, 0.1, -0.2);
        let [a, b] = [plain, known.clone()]
            .map(|collider| collider.surface(moved.clone()).unwrap().closest(point));
        assert_eq!(a.distance_squared.to_bits(), b.distance_squared.to_bits());
        // Positions that are not finite are refused as by one that does not.
        let nowhere = vec![Point3::new(f32::NAN, 0.0, 0.0); moved.len()];
        assert!(matches!(known.surface(nowhere), Err(SimError::Collider(_))));
        let other = garnet_mesh::primitives::icosphere(1, 0.1);
        let wrong = known.with_surface(Surface::new(&other));
        assert!(matches!(wrong, Err(SimError::Count { .. })));
    }
}
