//! Finer meshes come nearer to each other.

use garnet_knn::Surface;
use garnet_mesh::{Point3, TriMesh};
use garnet_sim::Fabric;
use garnet_sim::reference::{Nothing, Reference, ReferenceOptions};

use super::sheets::{Cut, cloth_of, sheet};

/// A square of 30 cm hung from its corners, which are nearer than they are in the flat cloth.
fn hammock(cells: usize) -> TriMesh {
    let side = 0.3 / cells as f64;
    let mesh = sheet([cells, cells], side, Cut::Alternating);
    let fabric = Fabric {
        bending: 1e-3,
        ..Fabric::cotton()
    };
    let last = mesh.num_vertices() as u32 - 1;
    let across = cells as u32;
    let cloth = cloth_of(&mesh, &fabric, &[0, across, last - across, last]);
    let options = ReferenceOptions::default();
    let mut hung = Reference::new(&cloth, mesh.positions(), &Nothing, options).unwrap();
    let settled = hung.settle().unwrap();
    assert!(settled.is_settled, "{settled:?}");
    let places = hung.positions().iter();
    let positions = places
        .map(|place| Point3::from(place.cast::<f32>()))
        .collect();
    mesh.with_positions(positions).unwrap()
}

/// Mean distance of the vertices of each mesh from the surface of the next finer one, in metres, of
/// squares of `cells` cells a side: even numbers, so that the corners are cut alike.
pub(crate) fn distances(cells: &[usize]) -> Vec<f64> {
    let meshes: Vec<TriMesh> = cells.iter().map(|&cells| hammock(cells)).collect();
    let pairs = meshes.windows(2).map(|pair| {
        let finer = Surface::new(&pair[1]);
        let closest = finer.closest_all(pair[0].positions());
        let sum: f64 = closest
            .iter()
            .map(|closest| f64::from(closest.distance_squared).sqrt())
            .sum();
        sum / closest.len() as f64
    });
    pairs.collect()
}

/// Vertices double from mesh to mesh, and the mean distance of the surfaces falls.
///
/// Here 0.6k, 1.2k, 2.5k and 5k vertices; `garnet-lab physics` goes on to 10k and 20k.
#[test]
fn refinement_converges() {
    let distances = distances(&[24, 34, 50, 70]);
    assert!(distances.is_sorted_by(|a, b| a > b), "{distances:?}");
}
