//! A triangle mesh made ready for proximity queries.

use crate::aabb::Aabb;
use crate::adjacency::Adjacency;
use crate::bvh::Bvh;
use crate::error::KnnError;
use crate::solid_angle::FarField;
use garnet_mesh::{Point3, TriMesh, stray_coordinate};
use nalgebra::Vector3;
use std::sync::{Arc, OnceLock};

/// A triangle mesh with a hierarchy of boxes over its faces, ready for closest points, signed
/// distances, winding numbers and intersections.
///
/// All lengths are in the unit of the positions (metres). A query never changes the surface, and
/// its answer depends on nothing but surface and arguments, however many threads ask.
///
/// # Examples
///
/// ```
/// use garnet_knn::Surface;
/// use garnet_mesh::{Point3, TriMesh};
///
/// let corners = vec![Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)];
/// let surface = Surface::new(&TriMesh::new(corners, vec![[0, 1, 2]])?);
/// let closest = surface.closest(Point3::new(0.25, 0.25, 2.0));
/// assert_eq!(closest.point, Point3::new(0.25, 0.25, 0.0));
/// assert_eq!(closest.distance_squared, 4.0);
/// # Ok::<(), garnet_mesh::MeshError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Surface {
    connectivity: Arc<Connectivity>,
    positions: Vec<Point3>,
    bvh: Bvh,
    /// Made when a winding number of a surface that is not closed is asked for: the others count
    /// crossings.
    far_field: OnceLock<FarField>,
}

/// What moving the vertices leaves alone.
#[derive(Debug)]
struct Connectivity {
    faces: Vec<[u32; 3]>,
    adjacency: Adjacency,
    /// How many of the faces, the last ones, close holes.
    num_caps: usize,
}

impl Surface {
    /// Builds the hierarchy over the faces of `mesh`.
    pub fn new(mesh: &TriMesh) -> Self {
        Self::with_caps(mesh, 0)
    }

    /// The same of a mesh of which the last `num_caps` faces close holes: they are counted where it
    /// is asked what is inside, and are no skin that cloth could run through.
    pub fn with_caps(mesh: &TriMesh, num_caps: usize) -> Self {
        let faces = mesh.faces().to_vec();
        let positions = mesh.positions().to_vec();
        let (bvh, adjacency) = rayon::join(
            || Bvh::new(&positions, &faces),
            || Adjacency::new(positions.len(), &faces),
        );
        Self {
            connectivity: Arc::new(Connectivity {
                faces,
                adjacency,
                num_caps,
            }),
            positions,
            bvh,
            far_field: OnceLock::new(),
        }
    }

    /// Whether a face closes a hole.
    pub fn is_cap(&self, face: u32) -> bool {
        face as usize + self.connectivity.num_caps >= self.connectivity.faces.len()
    }

    /// Whether any face closes a hole.
    pub fn has_caps(&self) -> bool {
        self.connectivity.num_caps > 0
    }

    /// The same faces at other positions `[vertex]`: the hierarchy keeps its shape and is fitted
    /// to them, several times faster than building it. It stays exact; it loses speed when the
    /// new shape has little to do with the first.
    ///
    /// # Errors
    ///
    /// [`KnnError::PositionCount`] or [`KnnError::CoordinateOutOfRange`].
    pub fn moved(&self, positions: Vec<Point3>) -> Result<Self, KnnError> {
        self.check_positions(&positions)?;
        let mut moved = Self {
            connectivity: Arc::clone(&self.connectivity),
            positions,
            bvh: self.bvh.clone(),
            far_field: OnceLock::new(),
        };
        moved.fit();
        Ok(moved)
    }

    /// Like [`Surface::moved`], in place; after an error the surface is as before.
    ///
    /// # Errors
    ///
    /// [`KnnError::PositionCount`] or [`KnnError::CoordinateOutOfRange`].
    pub fn refit(&mut self, positions: &[Point3]) -> Result<(), KnnError> {
        self.check_positions(positions)?;
        self.positions.copy_from_slice(positions);
        self.fit();
        Ok(())
    }

    fn check_positions(&self, positions: &[Point3]) -> Result<(), KnnError> {
        let (found, expected) = (positions.len(), self.positions.len());
        if found != expected {
            return Err(KnnError::PositionCount { found, expected });
        }
        match stray_coordinate(positions) {
            Some((index, value)) => Err(KnnError::CoordinateOutOfRange { index, value }),
            None => Ok(()),
        }
    }

    fn fit(&mut self) {
        self.bvh.refit(&self.positions, &self.connectivity.faces);
        self.far_field = OnceLock::new();
    }

    /// Positions `[vertex]`, in metres.
    pub fn positions(&self) -> &[Point3] {
        &self.positions
    }

    /// Vertex numbers `[face][corner]`, from 0.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.connectivity.faces
    }

    /// The smallest and largest coordinates of any face.
    pub fn bounds(&self) -> (Point3, Point3) {
        let Aabb { min, max } = self.bvh.bounds;
        (min.into(), max.into())
    }

    /// Whether the faces close up: every edge is run through as often one way as the other.
    ///
    /// That allows several shells and surfaces that run through themselves; it forbids holes and
    /// neighbors of opposite orientation. Vertices at the same place with different numbers are
    /// different.
    pub fn is_closed(&self) -> bool {
        self.connectivity.adjacency.is_closed()
    }

    pub(crate) fn adjacency(&self) -> &Adjacency {
        &self.connectivity.adjacency
    }

    pub(crate) fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// The dipoles of a surface that is not closed. Making them uses one thread, so that threads
    /// that wait for them cannot wait for each other.
    pub(crate) fn far_field(&self) -> Option<&FarField> {
        let make = || FarField::new(&self.bvh);
        (!self.is_closed()).then(|| self.far_field.get_or_init(make))
    }

    /// The corners of a face in double precision; `None` if there is no such face.
    pub(crate) fn triangle_f64(&self, face: u32) -> Option<[Vector3<f64>; 3]> {
        let corners = self.connectivity.faces.get(face as usize)?;
        Some(corners.map(|vertex| self.positions[vertex as usize].coords.cast()))
    }

    /// The corners of a face `[corner][axis]`; `None` if there is no such face.
    pub(crate) fn triangle(&self, face: u32) -> Option<[[f32; 3]; 3]> {
        let corners = self.connectivity.faces.get(face as usize)?;
        Some(corners.map(|vertex| self.positions[vertex as usize].coords.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{cube, grid, soup, sphere, surface, torus};
    use crate::vertex_tree::VertexTree;

    #[test]
    fn surfaces_and_trees_may_be_shared_by_threads() {
        fn is_shared<T: Send + Sync>() {}
        is_shared::<Surface>();
        is_shared::<VertexTree>();
    }

    #[test]
    fn closed_shapes_are_closed_and_open_ones_are_not() {
        assert!(surface(sphere([0.0; 3], 1.0, 5, 6)).is_closed());
        assert!(surface(torus(7, 5)).is_closed());
        assert!(surface(cube(0.0, 1.0, 3)).is_closed());
        assert!(!surface(grid(3)).is_closed());
        let (positions, mut faces) = cube(0.0, 1.0, 2);
        faces[0].swap(0, 1);
        assert!(!surface((positions, faces)).is_closed());
    }

    #[test]
    fn a_moved_surface_answers_like_a_new_one() {
        let (positions, faces) = torus(40, 20);
        let first = surface((positions.clone(), faces.clone()));
        let elsewhere: Vec<Point3> = positions
            .iter()
            .map(|p| Point3::new(p.x + p.y * p.y, p.z, 2.0 * p.y - 1.0))
            .collect();
        let moved = first.moved(elsewhere.clone()).unwrap();
        let mut refitted = first.clone();
        refitted.refit(&elsewhere).unwrap();
        let built = surface((elsewhere, faces));
        for point in sphere([0.5, 0.0, -1.0], 1.0, 8, 9).0 {
            assert_eq!(moved.closest(point), built.closest(point));
            assert_eq!(refitted.closest(point), built.closest(point));
            assert_eq!(moved.winding_number(point), built.winding_number(point));
        }
        assert_eq!(moved.bounds(), built.bounds());
    }

    #[test]
    fn positions_that_do_not_fit_are_refused() {
        let mut surface = surface(grid(1));
        let before = surface.positions().to_vec();
        let error = surface.moved(Vec::new()).unwrap_err();
        assert_eq!(
            error,
            KnnError::PositionCount {
                found: 0,
                expected: 4
            }
        );
        let error = surface
            .refit(&[Point3::new(f32::INFINITY, 0.0, 0.0); 4])
            .unwrap_err();
        assert!(matches!(
            error,
            KnnError::CoordinateOutOfRange { index: 0, .. }
        ));
        assert_eq!(surface.positions(), before);
    }

    #[test]
    fn many_triangles_at_one_place_make_a_tree_of_bounded_depth() {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].repeat(5000);
        let surface = surface(soup(&corners));
        assert_eq!(surface.closest(Point3::new(0.2, 0.2, 1.0)).face, 0);
        assert_eq!(surface.faces_crossing(&surface, &[7]).len(), 5000);
    }

    #[test]
    fn triangles_of_sizes_that_double_make_a_tree_of_bounded_depth() {
        let corners: Vec<[f32; 3]> = (-100..20)
            .flat_map(|power| {
                let x = 2.0_f32.powi(power);
                [[x, 0.0, 0.0], [x, x, 0.0], [x, 0.0, x]]
            })
            .collect();
        let surface = surface(soup(&corners));
        assert_eq!(surface.closest(Point3::new(4.1, 0.5, 0.5)).face, 102);
    }
}
