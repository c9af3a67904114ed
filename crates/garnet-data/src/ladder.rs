//! The same garment with other numbers of vertices, to see how costs grow.

use std::sync::atomic::AtomicBool;

use garnet_drape::{GarmentPackage, Teacher};
use garnet_mesh::{TriMesh, subdivided};
use garnet_sim::{Fabric, RestShape};
use garnet_skin::{BoundGarment, Garment};

use crate::{DataError, Tailor, wearer_of};

/// Garments with more vertices than this are not cut anew: coarser ones are subdivided, because
/// putting them on takes minutes.
const MAX_CUT: usize = 12_500;

/// The garment of a package with another number of vertices, on the body of the package.
#[derive(Debug, Clone)]
pub struct Rung {
    /// The garment, bound.
    pub garment: BoundGarment,
    /// Its simulation.
    pub teacher: Teacher,
}

impl Rung {
    /// A garment with about `num_vertices` vertices.
    ///
    /// Garments from patterns are cut and put on anew; fine ones, and those without a pattern, are
    /// the nearest coarser ones with each triangle split into four. None if the garment has no
    /// pattern, and neither it nor what it is subdivided to has from two thirds to one and a half
    /// as many vertices.
    ///
    /// # Errors
    ///
    /// Those of [`Tailor::dress`] and [`Teacher::of_garment`].
    pub fn new(
        package: &GarmentPackage,
        num_vertices: usize,
        stop: &AtomicBool,
    ) -> Result<Option<Self>, DataError> {
        let fabric = package.manifest.fabric.fabric();
        let Some(tailor) = Tailor::of_package(package)? else {
            let mesh = nearest(&package.mesh, num_vertices)?;
            let rung = mesh.map(|mesh| Self::of_mesh(mesh, package, &fabric));
            return rung.transpose();
        };
        let Some(wearer) = wearer_of(&package.body) else {
            return Ok(None);
        };
        let mut splits = 0;
        while num_vertices >> (2 * splits) > MAX_CUT {
            splits += 1;
        }
        let tailor = tailor.with_vertices(num_vertices >> (2 * splits))?;
        let worn = tailor.dress(&package.body, &wearer?, stop)?;
        let mut mesh = worn
            .sewn
            .start_mesh()
            .with_positions(worn.positions.clone())?;
        if splits == 0 {
            return Ok(Some(Self {
                teacher: tailor.teacher(&worn, &package.body)?,
                garment: Garment::new(mesh).bind(&package.body)?,
            }));
        }
        for _ in 0..splits {
            mesh = subdivided(&mesh)?;
        }
        Self::of_mesh(mesh, package, &fabric).map(Some)
    }

    fn of_mesh(
        mesh: TriMesh,
        package: &GarmentPackage,
        fabric: &Fabric,
    ) -> Result<Self, DataError> {
        let rest = RestShape::Worn(mesh.positions().to_vec());
        let garment = Garment::new(mesh).bind(&package.body)?;
        let teacher = Teacher::of_garment(garment.clone(), &package.body, &rest, fabric)?;
        Ok(Self { garment, teacher })
    }
}

/// A mesh, subdivided until it has about as many vertices.
fn nearest(mesh: &TriMesh, num_vertices: usize) -> Result<Option<TriMesh>, DataError> {
    let mut mesh = mesh.clone();
    while 2 * mesh.num_vertices() <= num_vertices {
        mesh = subdivided(&mesh)?;
    }
    let found = mesh.num_vertices();
    let is_near = 2 * found <= 3 * num_vertices && 2 * num_vertices <= 3 * found;
    Ok(is_near.then_some(mesh))
}

#[cfg(test)]
mod tests {
    use garnet_mesh::primitives::grid;

    use super::*;

    #[test]
    fn a_mesh_is_subdivided_to_about_as_many_vertices() {
        let mesh = grid(9, 9, [1.0, 1.0]); // 100 vertices, then 361
        let found = |count| {
            nearest(&mesh, count)
                .unwrap()
                .map(|mesh| mesh.num_vertices())
        };
        assert_eq!(found(100), Some(100));
        assert_eq!(found(400), Some(361));
        assert_eq!(found(30), None);
        assert_eq!(found(190), None);
    }
}
