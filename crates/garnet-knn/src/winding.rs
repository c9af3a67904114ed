//! Winding numbers: which points a surface encloses, even where it runs through itself.

use crate::crossings::crossing_number;
use crate::surface::Surface;
use garnet_mesh::Point3;
use rayon::prelude::*;

/// Points that one task of a batch tests.
pub(crate) const POINTS_PER_TASK: usize = 256;

impl Surface {
    /// How often a closed surface goes round `point`: 0 outside, 1 inside, 2 where two of its parts
    /// overlap, negative inside a surface that is turned inside out.
    ///
    /// Exact, by counting crossings of one ray. A point on the surface counts to one side or the
    /// other; a point that is not finite is outside. Without [`Surface::is_closed`] the number has
    /// no meaning: ask [`Surface::generalized_winding_number`].
    pub fn winding_number(&self, point: Point3) -> i32 {
        crossing_number(self.bvh(), point.coords.into())
    }

    /// The generalized winding number (Jacobson et al. 2013): the solid angle of the surface seen
    /// from `point`, over 4π.
    ///
    /// Of a closed surface it is the exact [`Surface::winding_number`]. Of one with holes or faces
    /// of opposite orientation it changes smoothly through the holes; far parts are summed as
    /// dipoles (Barill et al. 2018), with an error below 0.03. A point that is not finite is
    /// outside: 0.
    pub fn generalized_winding_number(&self, point: Point3) -> f32 {
        match self.far_field() {
            None => self.winding_number(point) as f32,
            Some(_) if !point.iter().all(|value| value.is_finite()) => 0.0,
            Some(far_field) => far_field.winding_number(self.bvh(), point.coords.into()) as f32,
        }
    }

    /// Whether `point` is inside: the generalized winding number is above 0.5.
    pub fn contains(&self, point: Point3) -> bool {
        if self.is_closed() {
            self.winding_number(point) > 0
        } else {
            self.generalized_winding_number(point) > 0.5
        }
    }

    /// [`Surface::contains`] for many points `[point]` at once, on all threads.
    pub fn contains_all(&self, points: &[Point3]) -> Vec<bool> {
        let points = points.par_iter().with_min_len(POINTS_PER_TASK);
        points.map(|&point| self.contains(point)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{Shape, both, cube, grid, sphere, surface, torus};
    use crate::solid_angle::FarField;
    use proptest::prelude::*;

    /// The promised accuracy of the dipole sum.
    const DIPOLES: f64 = 0.03;

    /// Compares crossing count and solid angles off the surface.
    fn check_agreement(shape: Shape, points: impl IntoIterator<Item = Point3>) {
        let surface = surface(shape);
        let far_field = FarField::new(surface.bvh());
        for point in points {
            let sum = far_field.winding_number(surface.bvh(), point.coords.into());
            let is_on_surface = surface.closest_within(point, 1e-6).is_some();
            if !is_on_surface {
                let crossings = f64::from(surface.winding_number(point));
                assert!(
                    (crossings - sum).abs() < DIPOLES,
                    "{point}: {crossings} is not {sum}"
                );
            }
        }
    }

    fn lattice(num: i16, step: f32) -> impl Iterator<Item = Point3> {
        let axis = move || (-num..=num).map(move |i| step * f32::from(i));
        axis()
            .flat_map(move |x| axis().flat_map(move |y| axis().map(move |z| Point3::new(x, y, z))))
    }

    #[test]
    fn crossings_agree_with_solid_angles() {
        check_agreement(torus(24, 12), lattice(9, 0.17));
        check_agreement(sphere([0.0; 3], 1.0, 8, 12), lattice(9, 0.125));
        let spheres = both(
            sphere([0.0; 3], 1.0, 8, 12),
            sphere([0.5, 0.0, 0.0], 1.0, 9, 11),
        );
        check_agreement(spheres, lattice(9, 0.125));
    }

    #[test]
    fn points_where_two_spheres_overlap_are_inside_twice() {
        let spheres = both(
            sphere([0.0; 3], 1.0, 8, 12),
            sphere([1.0, 0.0, 0.0], 1.0, 8, 12),
        );
        let surface = surface(spheres);
        assert_eq!(surface.winding_number(Point3::new(0.5, 0.01, 0.02)), 2);
        assert_eq!(surface.winding_number(Point3::new(-0.5, 0.01, 0.02)), 1);
        assert_eq!(surface.winding_number(Point3::new(-1.5, 0.01, 0.02)), 0);
        assert!(surface.contains(Point3::new(0.5, 0.01, 0.02)));
    }

    #[test]
    fn rays_through_edges_and_vertices_of_a_box_count_once() {
        // The lattice has the spacing of the box's own vertices.
        let surface = surface(cube(-1.0, 1.0, 4));
        for point in lattice(4, 0.5) {
            let size = point.coords.amax();
            let winding = surface.winding_number(point);
            if size < 1.0 {
                assert_eq!(winding, 1, "{point}");
            } else if size > 1.0 {
                assert_eq!(winding, 0, "{point}");
            }
        }
    }

    #[test]
    fn a_surface_turned_inside_out_winds_the_other_way() {
        let (positions, faces) = cube(-1.0, 1.0, 2);
        let surface = surface((
            positions,
            faces.iter().map(|&[a, b, c]| [a, c, b]).collect(),
        ));
        assert_eq!(surface.winding_number(Point3::new(0.1, 0.2, 0.3)), -1);
        assert!(!surface.contains(Point3::origin()));
    }

    #[test]
    fn a_hole_leaves_the_inside_inside() {
        let (positions, mut faces) = sphere([0.0; 3], 1.0, 20, 30);
        faces.truncate(faces.len() - 10);
        let surface = surface((positions, faces));
        assert!(!surface.is_closed());
        assert!(surface.contains(Point3::new(0.0, 0.1, -0.2)));
        assert!(!surface.contains(Point3::new(0.0, 0.1, 1.2)));
        assert_eq!(surface.contains_all(&[Point3::origin()]), [true]);
    }

    #[test]
    fn dipoles_stay_within_the_promised_error() {
        for shape in [grid(30), both(grid(20), sphere([5.0; 3], 4.0, 20, 30))] {
            let surface = surface(shape);
            let far_field = FarField::new(surface.bvh());
            for point in lattice(6, 3.1) {
                let sum = far_field.winding_number(surface.bvh(), point.coords.into());
                let exact = far_field.exact_winding_number(surface.bvh(), point.coords.into());
                assert!(
                    (sum - exact).abs() < DIPOLES,
                    "{point}: {sum} is not {exact}"
                );
            }
        }
    }

    proptest! {
        #[test]
        fn points_beside_edges_and_vertices_are_told_apart(
            face in 0_usize..576, weights in prop::array::uniform3(0_u8..3), outward in any::<bool>(),
        ) {
            // Weights of 0 put the point over an edge or a vertex.
            prop_assume!(weights != [0; 3]);
            let surface = surface(sphere([0.0; 3], 1.0, 13, 24));
            let total: f32 = weights.iter().map(|&weight| f32::from(weight)).sum();
            let mut point = Point3::origin();
            for (vertex, weight) in surface.faces()[face].into_iter().zip(weights) {
                point += surface.positions()[vertex as usize].coords * (f32::from(weight) / total);
            }
            let scaled = point * if outward { 1.001 } else { 0.999 };
            prop_assert_eq!(surface.winding_number(scaled), i32::from(!outward));
        }

        #[test]
        fn vertices_on_a_coarse_lattice_confuse_no_ray(
            jitter in prop::collection::vec(-1_i8..2, 26 * 3),
            point in prop::array::uniform3(-5_i8..6),
        ) {
            // A box of 26 lattice vertices, bent: many rays meet edges and vertices, many faces are
            // parallel to them, some have no area.
            let (mut positions, faces) = cube(-4.0, 4.0, 2);
            for (position, jitter) in positions.iter_mut().zip(jitter.chunks_exact(3)) {
                for axis in 0..3 {
                    position[axis] += f32::from(jitter[axis]);
                }
            }
            check_agreement((positions, faces), [Point3::from(point.map(f32::from))]);
        }
    }
}
