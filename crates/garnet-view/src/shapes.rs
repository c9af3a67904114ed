//! Meshes for the tests.

use garnet_mesh::{Point3, TriMesh};

/// A sphere of radius 1 about the origin, of rings and segments; its poles are on the Y axis.
pub(crate) fn sphere(num_rings: u32, num_segments: u32) -> TriMesh {
    let mut positions = vec![Point3::new(0.0, 1.0, 0.0)];
    for ring in 1..num_rings {
        let (ring_radius, y) = (std::f32::consts::PI * ring as f32 / num_rings as f32).sin_cos();
        for segment in 0..num_segments {
            let (sin, cos) =
                (std::f32::consts::TAU * segment as f32 / num_segments as f32).sin_cos();
            positions.push(Point3::new(ring_radius * sin, y, ring_radius * cos));
        }
    }
    positions.push(Point3::new(0.0, -1.0, 0.0));
    let last = positions.len() as u32 - 1;
    let at = |ring: u32, segment: u32| match ring {
        0 => 0,
        ring if ring == num_rings => last,
        ring => 1 + (ring - 1) * num_segments + segment % num_segments,
    };
    let mut faces = Vec::new();
    for ring in 0..num_rings {
        for segment in 0..num_segments {
            let (a, b) = (at(ring, segment), at(ring, segment + 1));
            let (c, d) = (at(ring + 1, segment), at(ring + 1, segment + 1));
            faces.extend(
                [[a, c, d], [a, d, b]]
                    .into_iter()
                    .filter(|[a, b, c]| a != b && b != c && c != a),
            );
        }
    }
    TriMesh::new(positions, faces).unwrap()
}

/// A square of side 2 about `(0, 0, z)` that faces +Z.
pub(crate) fn square(z: f32) -> TriMesh {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let positions = corners.map(|[x, y]| Point3::new(x, y, z)).to_vec();
    TriMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}
