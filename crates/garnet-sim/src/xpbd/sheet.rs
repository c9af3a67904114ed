//! Cloth that tests of constraints work on.

use garnet_mesh::primitives::grid;

use crate::xpbd::particles::{Particles, Places};
use crate::{Cloth, Fabric, Point3, RestShape};

/// A sheet somewhere else than at rest, and the numbers of its vertices.
pub(super) struct Sheet {
    pub(super) cloth: Cloth,
    pub(super) particles: Particles,
    vertices: Vec<u32>,
}

impl Sheet {
    pub(super) fn new(
        cells: [usize; 2],
        fabric: &Fabric,
        moved: impl Fn(&Point3) -> Point3,
    ) -> Self {
        let mesh = grid(cells[0], cells[1], [0.1, 0.1]);
        let rest = RestShape::Worn(mesh.positions().to_vec());
        let cloth = Cloth::new(mesh.faces(), mesh.num_vertices(), &rest, fabric).unwrap();
        let places: Vec<Point3> = mesh.positions().iter().map(moved).collect();
        Self {
            particles: Particles::new(&cloth, &places),
            vertices: (0..cloth.num_vertices() as u32).collect(),
            cloth,
        }
    }

    pub(super) fn places(&self) -> Places<'_> {
        Places {
            by_vertex: &self.vertices,
            number: self.vertices.len(),
        }
    }
}

/// Waves, stretched here and shortened there.
pub(super) fn waves(p: &Point3) -> Point3 {
    p + crate::Vector3::new((70.0 * p.y).sin(), 0.1, p.x * 9.0) * 0.01
}
