//! Discrete curvatures of a triangle mesh, on its one-rings.
//!
//! Curvature is counted positive where the surface bulges to the outside: a sphere of radius R
//! has the mean curvature 1/R and the Gaussian curvature 1/R² everywhere, a cylinder 1/(2R) and 0.
//! The formulas hold inside the surface; at a boundary the curvatures are 0.
//!
//! Real meshes have slivers and faces without area, where cotangents and 1/area have no bound.
//! Cotangents are clamped to ±[`MAX_COTANGENT`], and a vertex with less than [`MIN_AREA_SHARE`] of
//! the mean mixed area has the curvature 0, so every result is finite.
//!
//! Source: *Meyer et al. 2003, Discrete differential-geometry operators for triangulated
//! 2-manifolds*.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::normals::{area_vector, corner_angles, per_face, wide};
use crate::{Point3, Topology, Vector3, vertex_normals};

type Vector = nalgebra::Vector3<f64>;

/// Bound on cotangents: that of an angle of 0.06°.
pub const MAX_COTANGENT: f64 = 1e3;

/// A vertex with a smaller share of the mean mixed area counts as flat.
const MIN_AREA_SHARE: f64 = 1e-6;

/// Mixed areas `[vertex]`, in m²: the Voronoi areas where triangles are not obtuse.
///
/// They add up to the area of the mesh. Unused vertices have none.
///
/// Source: *Meyer et al. 2003, section 3.3*.
///
/// # Panics
///
/// If a face of the topology names a missing position.
pub fn mixed_areas(positions: &[Point3], topology: &Topology) -> Vec<f32> {
    let areas = mixed_areas_wide(positions, topology);
    areas.into_iter().map(|area| area as f32).collect()
}

/// Gaussian curvatures `[vertex]`, in 1/m²: what the angles lack to a full turn, by area.
///
/// ```text
/// κ_i = (2π − Σ θ_k) / A_mixed
/// ```
///
/// Source: *Gundogdu et al. 2020, Eq. 8; Meyer et al. 2003, Eq. 9*.
///
/// # Panics
///
/// If a face of the topology names a missing position.
pub fn gaussian_curvatures(positions: &[Point3], topology: &Topology) -> Vec<f32> {
    let faces = topology.faces();
    let angles = per_face(faces, |corners| corner_angles(positions, corners));
    let mut defects = vec![TAU; topology.num_vertices()];
    for (corners, angles) in faces.iter().zip(angles) {
        for (&vertex, angle) in corners.iter().zip(angles) {
            defects[vertex as usize] -= angle;
        }
    }
    let areas = usable_areas(positions, topology);
    let by_area = defects.iter().zip(areas).map(|(defect, area)| match area {
        Some(area) => (defect / area) as f32,
        None => 0.0,
    });
    by_area.collect()
}

/// Mean curvature normals `[vertex]`, in 1/m: outward normals as long as the mean curvature.
///
/// ```text
/// H_i n_i = 1 / (4 A_mixed) Σ_j (cot α_ij + cot β_ij) (x_i − x_j)
/// ```
///
/// The vector of Eq. 9 in *Gundogdu et al. 2020* is −4 times this one.
///
/// Source: *Meyer et al. 2003, Eq. 8*.
///
/// # Panics
///
/// If a face of the topology names a missing position.
pub fn mean_curvature_normals(positions: &[Point3], topology: &Topology) -> Vec<Vector3> {
    let normals = mean_curvature_normals_wide(positions, topology);
    normals.into_iter().map(Vector::cast).collect()
}

/// Mean curvatures `[vertex]`, in 1/m: positive where the surface bulges to the outside.
///
/// The length of [`mean_curvature_normals`], signed by [`vertex_normals`].
///
/// # Panics
///
/// If a face of the topology names a missing position.
pub fn mean_curvatures(positions: &[Point3], topology: &Topology) -> Vec<f32> {
    let outward = vertex_normals(positions, topology.faces());
    let curved = mean_curvature_normals_wide(positions, topology);
    let signed = outward.iter().zip(curved).map(|(outward, curved)| {
        let side = outward.cast::<f64>().dot(&curved);
        curved.norm().copysign(side) as f32
    });
    signed.collect()
}

fn mean_curvature_normals_wide(positions: &[Point3], topology: &Topology) -> Vec<Vector> {
    let faces = topology.faces();
    let weights = per_face(faces, |corners| corner_cotangents(positions, corners));
    let mut sums = vec![Vector::zeros(); topology.num_vertices()];
    for (corners, cotangents) in faces.iter().zip(weights) {
        for corner in 0..3 {
            let [from, to] = [corners[(corner + 1) % 3], corners[(corner + 2) % 3]];
            let side = wide(positions, from) - wide(positions, to);
            sums[from as usize] += cotangents[corner] * side;
            sums[to as usize] -= cotangents[corner] * side;
        }
    }
    let areas = usable_areas(positions, topology);
    let by_area = sums.iter().zip(areas).map(|(sum, area)| match area {
        Some(area) => sum / (4.0 * area),
        None => Vector::zeros(),
    });
    by_area.collect()
}

/// Mixed areas of vertices inside the surface that are large enough to divide by.
fn usable_areas(positions: &[Point3], topology: &Topology) -> Vec<Option<f64>> {
    let areas = mixed_areas_wide(positions, topology);
    let total: f64 = areas.iter().sum();
    let num_used = areas.iter().filter(|&&area| area > 0.0).count();
    let smallest = MIN_AREA_SHARE * total / num_used.max(1) as f64;
    let usable = |(vertex, area): (usize, f64)| {
        (area > smallest && !topology.is_boundary(vertex)).then_some(area)
    };
    areas.into_iter().enumerate().map(usable).collect()
}

fn mixed_areas_wide(positions: &[Point3], topology: &Topology) -> Vec<f64> {
    let faces = topology.faces();
    let shares = per_face(faces, |corners| mixed_shares(positions, corners));
    let mut areas = vec![0.0; topology.num_vertices()];
    for (corners, shares) in faces.iter().zip(shares) {
        for (&vertex, share) in corners.iter().zip(shares) {
            areas[vertex as usize] += share;
        }
    }
    areas
}

/// The parts of a face's area that belong to its corners.
fn mixed_shares(positions: &[Point3], corners: [u32; 3]) -> [f64; 3] {
    let area = area_vector(positions, corners).norm();
    let angles = corner_angles(positions, corners);
    if let Some(obtuse) = angles.iter().position(|&angle| angle >= FRAC_PI_2) {
        let mut shares = [area / 4.0; 3];
        shares[obtuse] = area / 2.0;
        return shares;
    }
    let [a, b, c] = corners.map(|vertex| wide(positions, vertex));
    let sides_squared = [c - b, a - c, b - a].map(|side| side.norm_squared());
    let cotangents = corner_cotangents(positions, corners);
    let voronoi = |corner: usize| {
        let (next, previous) = ((corner + 1) % 3, (corner + 2) % 3);
        let sum =
            cotangents[next] * sides_squared[next] + cotangents[previous] * sides_squared[previous];
        sum / 8.0
    };
    if cotangents.iter().any(|value| value.abs() >= MAX_COTANGENT) {
        // Clamped cotangents do not add up to the area; slivers are shared evenly instead.
        return [area / 3.0; 3];
    }
    [voronoi(0), voronoi(1), voronoi(2)]
}

/// Cotangents of the angles at the corners, clamped; 0 where a side has no length.
fn corner_cotangents(positions: &[Point3], corners: [u32; 3]) -> [f64; 3] {
    let [a, b, c] = corners.map(|vertex| wide(positions, vertex));
    let double_area = (b - a).cross(&(c - a)).norm();
    let cotangent = |u: Vector, v: Vector| match (u.dot(&v), double_area) {
        (0.0, _) => 0.0,
        (cosine, sine) => (cosine / sine).clamp(-MAX_COTANGENT, MAX_COTANGENT),
    };
    [
        cotangent(b - a, c - a),
        cotangent(c - b, a - b),
        cotangent(a - c, b - c),
    ]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::primitives::{capsule, cuboid, grid, icosphere, tube};
    use crate::{TriMesh, face_areas};

    /// Bound on identities that hold exactly.
    const ROUNDING: f32 = 1e-4;

    /// Bound on the relative error of curvatures on icospheres by level, from 1.
    ///
    /// The error falls with the square of the edge length.
    const SPHERE_ERROR: [f32; 4] = [0.12, 0.04, 0.012, 0.006];

    /// Bound on the curvature of a cylinder of 64 facets: (π / 64)² and rounding.
    const FACETS: f32 = 3e-3;

    fn topology_of(mesh: &TriMesh) -> Topology {
        Topology::new(mesh.num_vertices(), mesh.faces())
    }

    #[test]
    fn a_sphere_has_its_curvatures() {
        let radius = 0.25;
        for (level, bound) in (1..=4).zip(SPHERE_ERROR) {
            let mesh = icosphere(level, radius);
            let topology = topology_of(&mesh);
            for mean in mean_curvatures(mesh.positions(), &topology) {
                approx::assert_relative_eq!(mean, 1.0 / radius, max_relative = bound);
            }
            for gaussian in gaussian_curvatures(mesh.positions(), &topology) {
                let expected = 1.0 / (radius * radius);
                approx::assert_relative_eq!(gaussian, expected, max_relative = bound);
            }
        }
    }

    #[test]
    fn a_sphere_turned_inside_out_has_the_opposite_mean_curvature() {
        let mesh = icosphere(2, 1.0);
        let turned: Vec<[u32; 3]> = mesh.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
        let topology = Topology::new(mesh.num_vertices(), &turned);
        for mean in mean_curvatures(mesh.positions(), &topology) {
            assert!(mean < 0.0);
        }
    }

    #[test]
    fn a_cylinder_is_bent_one_way() {
        let mesh = tube(0.5, 1.0, 64, 40);
        let topology = topology_of(&mesh);
        let mean = mean_curvatures(mesh.positions(), &topology);
        let gaussian = gaussian_curvatures(mesh.positions(), &topology);
        for vertex in 0..mesh.num_vertices() {
            let is_inside = !topology.is_boundary(vertex);
            let expected = if is_inside { 1.0 } else { 0.0 };
            approx::assert_abs_diff_eq!(mean[vertex], expected, epsilon = FACETS);
            approx::assert_abs_diff_eq!(gaussian[vertex], 0.0, epsilon = FACETS);
        }
    }

    #[test]
    fn a_plane_is_flat() {
        let mesh = grid(5, 7, [1.0, 1.0]);
        let topology = topology_of(&mesh);
        for mean in mean_curvatures(mesh.positions(), &topology) {
            approx::assert_abs_diff_eq!(mean, 0.0, epsilon = ROUNDING);
        }
        for gaussian in gaussian_curvatures(mesh.positions(), &topology) {
            approx::assert_abs_diff_eq!(gaussian, 0.0, epsilon = ROUNDING);
        }
    }

    #[test]
    fn the_total_curvature_of_a_closed_surface_is_two_full_turns_per_hole_less() {
        for mesh in [
            cuboid([1.0, 2.0, 3.0]),
            icosphere(1, 0.3),
            capsule(0.2, 0.5, 9, 4),
        ] {
            let topology = topology_of(&mesh);
            let gaussian = gaussian_curvatures(mesh.positions(), &topology);
            let areas = mixed_areas(mesh.positions(), &topology);
            let total: f32 = gaussian.iter().zip(areas).map(|(k, area)| k * area).sum();
            approx::assert_relative_eq!(total, 2.0 * TAU as f32, max_relative = ROUNDING);
        }
    }

    #[test]
    fn mixed_areas_add_up_to_the_area() {
        for mesh in [
            cuboid([1.0, 2.0, 3.0]),
            tube(0.1, 3.0, 40, 2),
            grid(2, 9, [5.0, 0.1]),
        ] {
            let mixed: f32 = mixed_areas(mesh.positions(), &topology_of(&mesh))
                .iter()
                .sum();
            let area: f32 = face_areas(mesh.positions(), mesh.faces()).iter().sum();
            approx::assert_relative_eq!(mixed, area, max_relative = ROUNDING);
        }
    }

    proptest! {
        #[test]
        fn curvatures_are_finite_whatever_the_mesh(
            points in proptest::collection::vec(prop::array::uniform3(prop_oneof![
                Just(0.0_f32), Just(1.0), Just(1e-12), Just(-3e7), -1.0_f32..1.0,
            ]), 8),
            faces in proptest::collection::vec(prop::array::uniform3(0_u32..8), 1..30),
        ) {
            let positions: Vec<Point3> = points.into_iter().map(Point3::from).collect();
            let topology = Topology::new(positions.len(), &faces);
            let mean = mean_curvatures(&positions, &topology);
            let gaussian = gaussian_curvatures(&positions, &topology);
            prop_assert!(mean.iter().chain(&gaussian).all(|value| value.is_finite()));
            prop_assert!(mixed_areas(&positions, &topology).iter().all(|&area| area >= 0.0));
        }
    }
}
