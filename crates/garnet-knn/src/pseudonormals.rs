//! Normals at faces, edges and vertices that tell inside from outside.
//!
//! Bærentzen and Aanæs 2005, "Signed distance computation using the angle weighted pseudonormal":
//! the sum of the *unit* normals around the closest point, weighted by the angle of each face
//! there, points outward for every point whose closest point it is. That holds for closed surfaces
//! that do not run through themselves; elsewhere ask [`Surface::contains`].

use crate::closest::ClosestPoint;
use crate::closest_on_triangle::{Feature, Projection};
use crate::surface::Surface;
use garnet_mesh::{Point3, Vector3};

type Vector3d = nalgebra::Vector3<f64>;

/// How far a point is from a surface, and on which side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignedDistance {
    /// The nearest point of the surface.
    pub closest: ClosestPoint,
    /// Metres, negative inside.
    pub distance: f32,
    /// The pseudonormal at the nearest point: unit length, or zero where all faces have no area.
    pub normal: Vector3,
}

impl Surface {
    /// The unit normal of a face, by its counter-clockwise order; zero if it has no area or does
    /// not exist.
    pub fn face_normal(&self, face: u32) -> Vector3 {
        self.face_normal_f64(face).cast()
    }

    /// The angle-weighted pseudonormal of a vertex: unit length, or zero where no face with an area
    /// is.
    ///
    /// # Panics
    ///
    /// If there is no such vertex.
    pub fn vertex_normal(&self, vertex: u32) -> Vector3 {
        self.vertex_normal_f64(vertex).cast()
    }

    /// The pseudonormal of the face, edge or vertex on which a closest point lies: unit length, or
    /// zero where no face with an area is. Zero too for a face that does not exist.
    pub fn pseudonormal(&self, closest: &ClosestPoint) -> Vector3 {
        self.feature_normal(closest.face, closest.feature).cast()
    }

    /// The pseudonormals of the three corners interpolated at a closest point: it turns smoothly
    /// from face to face, but does not tell inside from outside. Unit length or zero.
    pub fn smooth_normal(&self, closest: &ClosestPoint) -> Vector3 {
        let Some(corners) = self.faces().get(closest.face as usize) else {
            return Vector3::zeros();
        };
        let mut normal = Vector3d::zeros();
        for (&vertex, &weight) in corners.iter().zip(&closest.barycentric) {
            normal += f64::from(weight) * self.vertex_normal_f64(vertex);
        }
        unit(normal).cast()
    }

    /// The distance to the surface, negative inside.
    ///
    /// The side is that of the pseudonormal: right for closed surfaces that do not run through
    /// themselves. Where all faces have no area it is counted as outside. For a `point` that is
    /// not finite the distance is infinite.
    pub fn signed_distance(&self, point: Point3) -> SignedDistance {
        let (closest, projection) = self.nearest(point, u32::MAX);
        self.with_sign(closest, &projection)
    }

    /// [`Surface::signed_distance`] of many points `[point]` at once, on all threads.
    pub fn signed_distance_all(&self, points: &[Point3]) -> Vec<SignedDistance> {
        self.nearest_all(points, |closest, projection| {
            self.with_sign(closest, &projection)
        })
    }

    fn with_sign(&self, closest: ClosestPoint, projection: &Projection) -> SignedDistance {
        let normal = self.feature_normal(closest.face, closest.feature);
        let distance = projection.distance_squared.sqrt() as f32;
        let is_inside = normal.dot(&projection.offset) < 0.0;
        SignedDistance {
            closest,
            distance: if is_inside { -distance } else { distance },
            normal: normal.cast(),
        }
    }

    fn feature_normal(&self, face: u32, feature: Feature) -> Vector3d {
        let Some(corners) = self.faces().get(face as usize) else {
            return Vector3d::zeros();
        };
        match feature {
            Feature::Face => self.face_normal_f64(face),
            Feature::Edge(corner) => {
                let start = usize::from(corner % 3);
                let (a, b) = (corners[start], corners[(start + 1) % 3]);
                let faces = self.adjacency().edge_faces(a, b);
                unit(faces.map(|face| self.face_normal_f64(face)).sum())
            }
            Feature::Vertex(corner) => self.vertex_normal_f64(corners[usize::from(corner % 3)]),
        }
    }

    fn vertex_normal_f64(&self, vertex: u32) -> Vector3d {
        let mut sum = Vector3d::zeros();
        for &face in self.adjacency().vertex_faces(vertex) {
            let Some([a, b, c]) = self.triangle_f64(face) else {
                continue;
            };
            let vertices = self.faces()[face as usize];
            let (from, to) = match vertices.iter().position(|&v| v == vertex) {
                Some(0) => (b - a, c - a),
                Some(1) => (c - b, a - b),
                _ => (a - c, b - c),
            };
            let cross = from.cross(&to);
            let sine = cross.norm();
            if sine > 0.0 {
                sum += cross * (sine.atan2(from.dot(&to)) / sine);
            }
        }
        unit(sum)
    }

    fn face_normal_f64(&self, face: u32) -> Vector3d {
        match self.triangle_f64(face) {
            Some([a, b, c]) => unit((b - a).cross(&(c - a))),
            None => Vector3d::zeros(),
        }
    }
}

fn unit(vector: Vector3d) -> Vector3d {
    let length = vector.norm();
    if length > 0.0 {
        vector / length
    } else {
        Vector3d::zeros()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{cube, grid, soup, sphere, surface, torus};
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    /// Relative rounding of closed forms in `f32`.
    const ROUNDING: f32 = 1e-5;

    #[test]
    fn the_normal_of_a_box_corner_is_its_diagonal_however_its_sides_are_split() {
        let (positions, faces) = cube(-1.0, 1.0, 1);
        let surface = surface((positions.clone(), faces));
        for (vertex, position) in (0..).zip(positions.iter()) {
            let normal = surface.vertex_normal(vertex);
            assert_relative_eq!(normal, position.coords.normalize(), epsilon = ROUNDING);
        }
    }

    #[test]
    fn an_edge_normal_is_halfway_between_its_faces() {
        let surface = surface(cube(-1.0, 1.0, 1));
        let signed = surface.signed_distance(Point3::new(2.0, 2.0, 0.3));
        assert!(matches!(signed.closest.feature, Feature::Edge(_)));
        let expected = Vector3::new(1.0, 1.0, 0.0).normalize();
        assert_relative_eq!(signed.normal, expected, epsilon = ROUNDING);
        assert_relative_eq!(signed.distance, 2.0_f32.sqrt(), epsilon = ROUNDING);
    }

    #[test]
    fn the_sign_agrees_with_the_winding_number() {
        for shape in [
            torus(20, 11),
            sphere([0.0; 3], 1.0, 7, 9),
            cube(-1.0, 1.0, 3),
        ] {
            let surface = surface(shape);
            let points: Vec<Point3> = (1..20)
                .flat_map(|i| sphere([0.02, 0.01, 0.03], 0.1 * i as f32, 9, 13).0)
                .collect();
            let signed = surface.signed_distance_all(&points);
            for ((point, signed), inside) in
                points.iter().zip(signed).zip(surface.contains_all(&points))
            {
                assert_eq!(signed.distance < 0.0, inside, "{point}");
                assert_eq!(signed, surface.signed_distance(*point));
            }
        }
    }

    #[test]
    fn an_acute_wedge_is_not_turned_inside_out() {
        // A thin wedge with faces of very different areas at its edge.
        let positions = [
            [0.0, 0.0, 0.0],
            [0.0, 0.0, 1.0],
            [9.0, 0.2, 0.5],
            [0.5, -0.2, 0.5],
        ];
        let faces = vec![[0, 1, 2], [1, 0, 3], [0, 2, 3], [2, 1, 3]];
        let surface = surface((positions.map(Point3::from).to_vec(), faces));
        for i in 0..100 {
            let angle = 0.0628 * i as f32;
            let point = Point3::new(0.1 * angle.cos(), 0.1 * angle.sin(), 0.5);
            let distance = surface.signed_distance(point).distance;
            assert_eq!(
                distance < 0.0,
                surface.winding_number(point) != 0,
                "{point}"
            );
        }
    }

    #[test]
    fn faces_without_area_have_no_normal_and_do_no_harm() {
        let flat = [
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [3.0; 3],
            [3.0; 3],
            [3.0; 3],
        ];
        let surface = surface(soup(&flat));
        assert_eq!(surface.face_normal(0), Vector3::zeros());
        assert_eq!(surface.face_normal(99), Vector3::zeros());
        let signed = surface.signed_distance(Point3::new(1.0, 1.0, 0.0));
        assert_eq!((signed.distance, signed.normal), (1.0, Vector3::zeros()));
        assert_eq!(surface.smooth_normal(&signed.closest), Vector3::zeros());
    }

    #[test]
    fn a_closest_point_of_another_surface_is_harmless() {
        let closest = surface(grid(9)).closest(Point3::new(8.9, 8.9, 1.0));
        let small = surface(grid(1));
        assert_eq!(small.pseudonormal(&closest), Vector3::zeros());
        assert_eq!(small.smooth_normal(&closest), Vector3::zeros());
    }

    proptest! {
        #[test]
        fn smooth_normals_of_a_sphere_point_from_its_center(
            direction in prop::array::uniform3(-1.0_f32..1.0),
        ) {
            let direction = Vector3::from(direction);
            prop_assume!(direction.norm() > 0.1);
            let surface = surface(sphere([0.0; 3], 1.0, 40, 60));
            let closest = surface.closest(Point3::from(2.0 * direction.normalize()));
            let normal = surface.smooth_normal(&closest);
            // Faces span 0.1 radians.
            prop_assert!(normal.dot(&direction.normalize()) > 0.1_f32.cos());
        }
    }
}
