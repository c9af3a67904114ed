//! Flat cloth of known meshes.

use garnet_mesh::{Point3, TriMesh};
use garnet_sim::{Cloth, Fabric, RestShape};

/// Cloth that is free of force as the mesh lies, with `pins` held.
pub(crate) fn cloth_of(mesh: &TriMesh, fabric: &Fabric, pins: &[u32]) -> Cloth {
    let cloth = Cloth::new(mesh.faces(), mesh.num_vertices(), &rest_of(mesh), fabric);
    cloth.unwrap().with_pins(pins).unwrap()
}

/// The shape of the mesh as it lies.
pub(crate) fn rest_of(mesh: &TriMesh) -> RestShape {
    RestShape::Worn(mesh.positions().to_vec())
}

/// Which way the squares of a sheet are cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cut {
    /// Each square the other way than its neighbors.
    Alternating,
    /// All the same way.
    OneWay,
}

/// A sheet in the plane y = 0 that faces up: `cells` squares along x and z, each `side` long (m).
///
/// Vertex `[along * (cells[1] + 1) + across]` lies at `(along, 0, across) * side`.
pub(crate) fn sheet(cells: [usize; 2], side: f64, cut: Cut) -> TriMesh {
    let [nx, nz] = cells;
    let mut positions = Vec::new();
    for i in 0..=nx {
        for j in 0..=nz {
            positions.push(point(i as f64 * side, j as f64 * side));
        }
    }
    let at = |i: usize, j: usize| (i * (nz + 1) + j) as u32;
    let mut faces = Vec::new();
    for i in 0..nx {
        for j in 0..nz {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            if cut == Cut::OneWay || (i + j) % 2 == 0 {
                faces.extend([[a, b, c], [a, c, d]]);
            } else {
                faces.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    TriMesh::new(positions, faces).unwrap()
}

/// The sheet with each inner vertex moved at random, by at most `share` of `side` along each axis.
pub(crate) fn jittered(mesh: &TriMesh, cells: [usize; 2], side: f64, share: f64) -> TriMesh {
    let [nx, nz] = cells;
    let mut positions = mesh.positions().to_vec();
    for (vertex, position) in positions.iter_mut().enumerate() {
        let (i, j) = (vertex / (nz + 1), vertex % (nz + 1));
        if i > 1 && i < nx && j > 0 && j < nz {
            position.x += (share * side * noise(2 * vertex as u64)) as f32;
            position.z += (share * side * noise(2 * vertex as u64 + 1)) as f32;
        }
    }
    mesh.with_positions(positions).unwrap()
}

/// A sheet of equilateral triangles in straight columns across: `cells` columns and triangles a
/// column, the columns `spacing` (m) apart. Vertex `[along * (cells[1] + 1) + across]`; odd columns
/// lie half a side aside.
pub(crate) fn equilateral(cells: [usize; 2], spacing: f64) -> TriMesh {
    let [nx, nz] = cells;
    let side = spacing / 0.75_f64.sqrt();
    let at = |i: usize, j: usize| (i * (nz + 1) + j) as u32;
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for i in 0..=nx {
        for j in 0..=nz {
            let shift = 0.5 * (i % 2) as f64;
            positions.push(point(i as f64 * spacing, (j as f64 + shift) * side));
        }
    }
    for i in 0..nx {
        for j in 0..nz {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            match i % 2 {
                0 => faces.extend([[a, b, d], [b, c, d]]),
                _ => faces.extend([[a, b, c], [a, c, d]]),
            }
        }
    }
    TriMesh::new(positions, faces).unwrap()
}

fn point(x: f64, z: f64) -> Point3 {
    Point3::new(x as f32, 0.0, z as f32)
}

/// A number from -1 to 1 that depends on `seed` alone (`SplitMix64`, Steele et al. 2014).
pub(crate) fn noise(seed: u64) -> f64 {
    let mut z = seed.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^= z >> 31;
    (z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}
