//! Normals and areas of faces, and normals of vertices.
//!
//! Faces are computed in parallel and vertex sums run in the order of the faces, so the result
//! does not depend on the number of threads.

use rayon::prelude::*;

use crate::{Point3, Vector3};

/// Faces per unit of parallel work.
const CHUNK: usize = 2048;

type Vector = nalgebra::Vector3<f64>;

/// Unit normals `[face]`, counter-clockwise; zero for a face without area.
///
/// # Panics
///
/// If a face names a missing vertex.
pub fn face_normals(positions: &[Point3], faces: &[[u32; 3]]) -> Vec<Vector3> {
    per_face(faces, |corners| {
        unit(area_vector(positions, corners)).cast()
    })
}

/// Areas `[face]`, in m².
///
/// # Panics
///
/// If a face names a missing vertex.
pub fn face_areas(positions: &[Point3], faces: &[[u32; 3]]) -> Vec<f32> {
    per_face(faces, |corners| {
        area_vector(positions, corners).norm() as f32
    })
}

/// Unit normals `[vertex]`: the face normals around a vertex, weighted with the angles there.
///
/// Zero for a vertex that no face with area names, or whose faces cancel out.
///
/// Source: *Thürmer and Wüthrich 1998, Computing vertex normals from polygonal facets*.
///
/// # Panics
///
/// If a face names a missing vertex.
pub fn vertex_normals(positions: &[Point3], faces: &[[u32; 3]]) -> Vec<Vector3> {
    let weighted = per_face(faces, |corners| {
        let normal = unit(area_vector(positions, corners));
        corner_angles(positions, corners).map(|angle| angle * normal)
    });
    let mut sums = vec![Vector::zeros(); positions.len()];
    for (corners, normals) in faces.iter().zip(weighted) {
        for (&vertex, normal) in corners.iter().zip(normals) {
            sums[vertex as usize] += normal;
        }
    }
    sums.into_par_iter()
        .with_min_len(CHUNK)
        .map(|sum| {
            // A sum far below the rounding of one unit normal has cancelled out.
            let mean = sum.try_normalize(1e-12);
            mean.map_or_else(Vector3::zeros, Vector::cast)
        })
        .collect()
}

/// The angles at the three corners of a face, in radians; 0 where a side has no length.
pub(crate) fn corner_angles(positions: &[Point3], corners: [u32; 3]) -> [f64; 3] {
    let [a, b, c] = corners.map(|vertex| wide(positions, vertex));
    [
        angle(b - a, c - a),
        angle(c - b, a - b),
        angle(a - c, b - c),
    ]
}

/// Half the cross product of two sides: the normal, as long as the area.
pub(crate) fn area_vector(positions: &[Point3], corners: [u32; 3]) -> Vector {
    let [a, b, c] = corners.map(|vertex| wide(positions, vertex));
    0.5 * (b - a).cross(&(c - a))
}

pub(crate) fn wide(positions: &[Point3], vertex: u32) -> Vector {
    positions[vertex as usize].coords.cast()
}

pub(crate) fn per_face<T: Send>(
    faces: &[[u32; 3]],
    value: impl Fn([u32; 3]) -> T + Sync,
) -> Vec<T> {
    faces
        .par_iter()
        .with_min_len(CHUNK)
        .map(|&corners| value(corners))
        .collect()
}

/// Exact for small and for flat angles, unlike the arc cosine.
fn angle(u: Vector, v: Vector) -> f64 {
    u.cross(&v).norm().atan2(u.dot(&v))
}

fn unit(vector: Vector) -> Vector {
    vector
        .try_normalize(f64::MIN_POSITIVE)
        .unwrap_or_else(Vector::zeros)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::primitives::{cuboid, icosphere};

    /// Bound on closed forms in `f32`.
    const ROUNDING: f32 = 1e-5;

    #[test]
    fn areas_of_a_box_add_up_to_its_surface() {
        let mesh = cuboid([1.0, 2.0, 3.0]);
        let area: f32 = face_areas(mesh.positions(), mesh.faces()).iter().sum();
        approx::assert_relative_eq!(area, 22.0, max_relative = ROUNDING);
    }

    #[test]
    fn the_corner_of_a_box_looks_along_its_diagonal_whatever_the_triangles() {
        let mesh = cuboid([1.0, 2.0, 3.0]);
        let normals = vertex_normals(mesh.positions(), mesh.faces());
        for (position, normal) in mesh.positions().iter().zip(normals) {
            let diagonal = position.coords.map(f32::signum).normalize();
            approx::assert_abs_diff_eq!(normal, diagonal, epsilon = ROUNDING);
        }
    }

    #[test]
    fn an_unused_vertex_and_a_face_without_area_have_zero_normals() {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [5.0; 3]].map(Point3::from);
        let faces = [[0, 1, 2], [0, 0, 1]];
        assert_eq!(face_normals(&positions, &faces), [Vector3::zeros(); 2]);
        assert_eq!(vertex_normals(&positions, &faces), [Vector3::zeros(); 4]);
    }

    #[test]
    fn tiny_faces_have_normals_too() {
        let positions = [[0.0; 3], [1e-20, 0.0, 0.0], [0.0, 1e-20, 0.0]].map(Point3::from);
        assert_eq!(face_normals(&positions, &[[0, 1, 2]]), [Vector3::z()]);
    }

    proptest! {
        #[test]
        fn normals_turn_with_the_mesh(angles in prop::array::uniform3(-3.0_f32..3.0)) {
            let mesh = icosphere(1, 0.7);
            let turn = nalgebra::Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
            let turned: Vec<Point3> = mesh.positions().iter().map(|p| turn * p).collect();
            let before = vertex_normals(mesh.positions(), mesh.faces());
            let after = vertex_normals(&turned, mesh.faces());
            for (before, after) in before.iter().zip(after) {
                approx::assert_abs_diff_eq!(turn * before, after, epsilon = ROUNDING);
            }
        }
    }
}
