//! Generated meshes, as inputs of tests and benches.
//!
//! Closed ones face outward. All are centered on the origin, with the axis along y.

use std::collections::HashMap;
use std::f32::consts::{PI, TAU};

use crate::{Point3, TriMesh};

/// A flat sheet in the plane z = 0 that faces +z, `size` wide (x) and high (y), in metres.
///
/// `[row * (nx + 1) + column]` numbers its vertices from the lower left corner; `nx` by `ny`
/// squares of two triangles each. Zero squares count as one.
///
/// # Panics
///
/// If a size is not finite.
pub fn grid(nx: usize, ny: usize, size: [f32; 2]) -> TriMesh {
    let (nx, ny) = (nx.max(1), ny.max(1));
    let mut positions = Vec::with_capacity((nx + 1) * (ny + 1));
    for row in 0..=ny {
        for column in 0..=nx {
            let x = size[0] * (column as f32 / nx as f32 - 0.5);
            let y = size[1] * (row as f32 / ny as f32 - 0.5);
            positions.push(Point3::new(x, y, 0.0));
        }
    }
    let mut faces = Vec::with_capacity(2 * nx * ny);
    for row in 0..ny {
        for column in 0..nx {
            let lower = (row * (nx + 1) + column) as u32;
            let upper = lower + nx as u32 + 1;
            faces.extend(square([lower, lower + 1, upper + 1, upper]));
        }
    }
    built(positions, faces)
}

/// A box of the given size along x, y and z, in metres: 8 vertices, 12 triangles.
///
/// # Panics
///
/// If a size is not finite.
pub fn cuboid(size: [f32; 3]) -> TriMesh {
    let corner = |index: usize| {
        let side = |axis: usize| size[axis] * ((index >> axis & 1) as f32 - 0.5);
        Point3::new(side(0), side(1), side(2))
    };
    let sides = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    built(
        (0..8).map(corner).collect(),
        sides.into_iter().flat_map(square).collect(),
    )
}

/// A sphere of `level` times subdivided icosahedron faces: `10 * 4^level + 2` vertices.
///
/// Radius in metres.
///
/// # Panics
///
/// If a size is not finite.
pub fn icosphere(level: u32, radius: f32) -> TriMesh {
    let (mut positions, mut faces) = icosahedron();
    for _ in 0..level {
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                let sum = positions[a as usize].coords + positions[b as usize].coords;
                positions.push(sum.normalize().into());
                positions.len() as u32 - 1
            })
        };
        let mut finer = Vec::with_capacity(4 * faces.len());
        for [a, b, c] in faces {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        faces = finer;
    }
    built(positions.into_iter().map(|p| p * radius).collect(), faces)
}

/// A sphere of meridians and parallels with a vertex at each pole, radius in metres.
///
/// At least 3 meridians and 2 bands.
///
/// # Panics
///
/// If a size is not finite.
pub fn uv_sphere(meridians: usize, bands: usize, radius: f32) -> TriMesh {
    let bands = bands.max(2);
    let profile: Vec<[f32; 2]> = (0..=bands)
        .map(|band| {
            let (sin, cos) = (PI * band as f32 / bands as f32).sin_cos();
            [radius * sin, -radius * cos]
        })
        .collect();
    lathe(&profile, meridians)
}

/// A cylinder with a half sphere at each end; `length` is that of the cylinder alone, in metres.
///
/// `bands` in each half sphere and in the cylinder; at least 3 meridians and 1 band.
///
/// # Panics
///
/// If a size is not finite.
pub fn capsule(radius: f32, length: f32, meridians: usize, bands: usize) -> TriMesh {
    let bands = bands.max(1);
    let turn = |band: usize| (PI / 2.0 * band as f32 / bands as f32).sin_cos();
    let mut profile = Vec::with_capacity(3 * bands + 1);
    for band in 0..=bands {
        let (sin, cos) = turn(band);
        profile.push([radius * sin, -length / 2.0 - radius * cos]);
    }
    for band in 1..bands {
        profile.push([radius, length * (band as f32 / bands as f32 - 0.5)]);
    }
    for band in 0..=bands {
        let (sin, cos) = turn(band);
        profile.push([radius * cos, length / 2.0 + radius * sin]);
    }
    lathe(&profile, meridians)
}

/// An open cylinder, in metres: `rings` bands of `segments` squares, two triangles each.
///
/// `[ring * segments + segment]` numbers its vertices from the lower rim, `rings + 1` rims in all.
///
/// # Panics
///
/// If a size is not finite.
pub fn tube(radius: f32, height: f32, segments: usize, rings: usize) -> TriMesh {
    cone_skirt([radius, radius], height, segments, rings)
}

/// An open cone like a skirt, in metres: `radii` of the lower and the upper rim.
///
/// Numbered like [`tube`].
///
/// # Panics
///
/// If a size is not finite.
pub fn cone_skirt(radii: [f32; 2], height: f32, segments: usize, rings: usize) -> TriMesh {
    let rings = rings.max(1);
    let profile: Vec<[f32; 2]> = (0..=rings)
        .map(|ring| {
            let share = ring as f32 / rings as f32;
            let radius = radii[0] + share * (radii[1] - radii[0]);
            [radius, height * (share - 0.5)]
        })
        .collect();
    revolved(&profile, segments.max(3), Ends::Open)
}

/// Turns a profile that starts and ends on the axis; the ends become single vertices.
fn lathe(profile: &[[f32; 2]], segments: usize) -> TriMesh {
    revolved(profile, segments.max(3), Ends::Poles)
}

#[derive(Clone, Copy, PartialEq)]
enum Ends {
    Open,
    Poles,
}

/// Turns a profile `[radius, y]`, from below to above, around the y axis.
fn revolved(profile: &[[f32; 2]], segments: usize, ends: Ends) -> TriMesh {
    let rims = match ends {
        Ends::Open => profile,
        Ends::Poles => &profile[1..profile.len() - 1],
    };
    let mut positions = Vec::with_capacity(rims.len() * segments + 2);
    for &[radius, y] in rims {
        for segment in 0..segments {
            let (sin, cos) = (TAU * segment as f32 / segments as f32).sin_cos();
            positions.push(Point3::new(radius * sin, y, radius * cos));
        }
    }
    let at = |rim: usize, segment: usize| (rim * segments + segment % segments) as u32;
    let mut faces = Vec::with_capacity(2 * profile.len() * segments);
    for rim in 1..rims.len() {
        for segment in 0..segments {
            faces.extend(square([
                at(rim - 1, segment),
                at(rim - 1, segment + 1),
                at(rim, segment + 1),
                at(rim, segment),
            ]));
        }
    }
    if ends == Ends::Poles {
        let (bottom, last_rim) = (positions.len() as u32, rims.len() - 1);
        positions.push(Point3::new(0.0, profile[0][1], 0.0));
        positions.push(Point3::new(0.0, profile[profile.len() - 1][1], 0.0));
        for segment in 0..segments {
            faces.push([bottom, at(0, segment + 1), at(0, segment)]);
            faces.push([bottom + 1, at(last_rim, segment), at(last_rim, segment + 1)]);
        }
    }
    built(positions, faces)
}

/// The two triangles of a square.
fn square([a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// The unit icosahedron.
fn icosahedron() -> (Vec<Point3>, Vec<[u32; 3]>) {
    let golden = f32::midpoint(1.0, 5_f32.sqrt());
    let mut positions = Vec::with_capacity(12);
    for [a, b] in [
        [-1.0, golden],
        [1.0, golden],
        [-1.0, -golden],
        [1.0, -golden],
    ] {
        positions.push(Point3::new(a, b, 0.0));
    }
    for [a, b] in [
        [-1.0, golden],
        [1.0, golden],
        [-1.0, -golden],
        [1.0, -golden],
    ] {
        positions.push(Point3::new(0.0, a, b));
    }
    for [a, b] in [
        [-1.0, golden],
        [1.0, golden],
        [-1.0, -golden],
        [1.0, -golden],
    ] {
        positions.push(Point3::new(b, 0.0, a));
    }
    for position in &mut positions {
        *position = position.coords.normalize().into();
    }
    let faces = [
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    (positions, faces.to_vec())
}

fn built(positions: Vec<Point3>, faces: Vec<[u32; 3]>) -> TriMesh {
    TriMesh::new(positions, faces).expect("generated faces name generated vertices of finite sizes")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Topology;

    /// Bound on areas and volumes of closed forms in `f32`, relative.
    const ROUNDING: f64 = 1e-5;

    fn volume(mesh: &TriMesh) -> f64 {
        let wedge = |face| {
            let [a, b, c] = mesh.corners(face).map(|corner| corner.coords.cast::<f64>());
            a.dot(&b.cross(&c)) / 6.0
        };
        (0..mesh.num_faces()).map(wedge).sum()
    }

    #[test]
    fn closed_primitives_are_closed_oriented_and_face_outward() {
        let meshes = [
            cuboid([1.0, 2.0, 3.0]),
            icosphere(0, 1.0),
            icosphere(2, 0.5),
            uv_sphere(3, 2, 1.0),
            uv_sphere(16, 8, 1.0),
            capsule(0.1, 0.5, 3, 1),
            capsule(0.1, 0.5, 12, 4),
        ];
        for mesh in meshes {
            let topology = Topology::new(mesh.num_vertices(), mesh.faces());
            assert!(topology.boundary_loops().is_empty());
            assert!(topology.non_manifold_edges().is_empty());
            assert!(topology.inconsistent_edges().is_empty());
            assert_eq!(topology.num_components(), 1);
            let euler = mesh.num_vertices() + mesh.num_faces() - topology.edges().len();
            assert_eq!(euler, 2);
            assert!(volume(&mesh) > 0.0);
        }
    }

    #[test]
    fn a_box_has_its_volume() {
        let volume = volume(&cuboid([1.0, 2.0, 3.0]));
        approx::assert_relative_eq!(volume, 6.0, max_relative = ROUNDING);
    }

    #[test]
    fn open_primitives_have_their_rims() {
        let loops = |mesh: TriMesh| {
            let topology = Topology::new(mesh.num_vertices(), mesh.faces());
            assert!(topology.inconsistent_edges().is_empty());
            topology.boundary_loops().len()
        };
        assert_eq!(loops(grid(4, 3, [1.0, 1.0])), 1);
        assert_eq!(loops(tube(0.1, 1.0, 8, 5)), 2);
        assert_eq!(loops(cone_skirt([0.5, 0.2], 0.6, 8, 5)), 2);
    }

    #[test]
    fn a_grid_faces_the_front() {
        let mesh = grid(2, 2, [1.0, 1.0]);
        let normals = crate::face_normals(mesh.positions(), mesh.faces());
        assert_eq!(normals, vec![crate::Vector3::z(); 8]);
    }

    #[test]
    fn a_tube_faces_outward() {
        let mesh = tube(1.0, 1.0, 16, 2);
        let normals = crate::vertex_normals(mesh.positions(), mesh.faces());
        for (position, normal) in mesh.positions().iter().zip(normals) {
            assert!(normal.dot(&position.coords) > 0.0);
        }
    }
}
