//! Normals of vertices.

use garnet_mesh::{Point3, TriMesh, Vector3};
use nalgebra as na;

/// Unit normals `[vertex]`: normals of faces weighted by their angle at the vertex (Thürmer and
/// Wüthrich 1998), zero where there are none.
///
/// Vertices at the same place count as one if their normals agree by and large, so that the seams
/// of a texture do not show as creases.
pub(crate) fn vertex_normals(mesh: &TriMesh) -> Vec<Vector3> {
    let mut sums = vec![na::Vector3::<f64>::zeros(); mesh.num_vertices()];
    for face in mesh.faces() {
        let corners = face.map(|vertex| mesh.positions()[vertex as usize].cast::<f64>());
        let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
        let Some(normal) = normal.try_normalize(0.0) else {
            continue;
        };
        for corner in 0..3 {
            let here = corners[corner];
            let next = corners[(corner + 1) % 3] - here;
            let previous = corners[(corner + 2) % 3] - here;
            let angle = next.cross(&previous).norm().atan2(next.dot(&previous));
            sums[face[corner] as usize] += normal * angle;
        }
    }
    let own: Vec<_> = sums.iter().map(unit).collect();
    merge_coincident(mesh.positions(), &own, &mut sums);
    sums.iter()
        .zip(&own)
        .map(|(merged, own)| {
            let merged = unit(merged);
            let agree = merged.dot(own) > 0.5;
            if agree { merged.cast() } else { own.cast() }
        })
        .collect()
}

fn unit(vector: &na::Vector3<f64>) -> na::Vector3<f64> {
    vector.try_normalize(0.0).unwrap_or_default()
}

/// Gives all vertices at one place the sum of their unit normals.
fn merge_coincident(positions: &[Point3], own: &[na::Vector3<f64>], sums: &mut [na::Vector3<f64>]) {
    // Adding zero turns a negative zero into a positive one.
    let place = |vertex: u32| {
        let position = positions[vertex as usize];
        [position.x, position.y, position.z].map(|value| (value + 0.0).to_bits())
    };
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(|&vertex| (place(vertex), vertex));
    for group in order.chunk_by(|&a, &b| place(a) == place(b)) {
        if group.len() > 1 {
            let sum = group.iter().map(|&vertex| own[vertex as usize]).sum();
            for &vertex in group {
                sums[vertex as usize] = sum;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::shapes;

    #[test]
    fn normals_of_a_sphere_point_away_from_its_center() {
        // Half the angle between rings, squared: normals of a discrete sphere are of second order.
        const DISCRETE: f32 = 4.3e-3;
        let sphere = shapes::sphere(24, 48);
        for (normal, position) in vertex_normals(&sphere).iter().zip(sphere.positions()) {
            assert_relative_eq!(*normal, position.coords, epsilon = DISCRETE);
        }
    }

    #[test]
    fn a_seam_does_not_show_but_two_sides_of_a_sheet_stay_apart() {
        let corner = |x, y, z| Point3::new(x, y, z);
        let positions = vec![
            corner(0.0, 0.0, 0.0),
            corner(0.0, 1.0, 0.0),
            corner(-1.0, 0.0, -0.3),
            corner(0.0, 0.0, 0.0),
            corner(1.0, 0.0, -0.3),
            corner(0.0, 1.0, 0.0),
        ];
        let roof = TriMesh::new(positions.clone(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let normals = vertex_normals(&roof);
        assert_eq!(normals[0], normals[3]);
        let sheet = positions[..3].repeat(2);
        let sheet = TriMesh::new(sheet, vec![[0, 1, 2], [3, 5, 4]]).unwrap();
        let normals = vertex_normals(&sheet);
        assert_eq!(normals[0], -normals[3]);
    }
}
