//! Buttons, beads and buckles: small loose pieces are no cloth, and keep their shape.

use garnet_knn::Surface;
use garnet_mesh::{Point3, TriMesh, Vector3};
use garnet_skin::{BoundGarment, nearest_rotation};
use nalgebra::{Isometry3, Matrix3};

/// Loose pieces of a larger diameter than this may bend, as pockets do; in metres. More keeps
/// patches and zips stiff.
const LARGEST: f32 = 0.045;

/// How often a piece is lifted that is too near to the skin or in the cloth, and by how much off
/// cloth, in metres. More lifts, and longer ones, keep more pieces stiff, and leave them farther
/// off.
const LIFTS: usize = 6;
const STEP: f32 = 5e-4;

/// A piece keeps the clearance if less than this share of it is missing.
const ROUNDING: f32 = 0.01;

/// A loose piece that keeps its shape.
#[derive(Debug, Clone)]
struct Piece {
    nodes: Vec<u32>,
    /// Between its own nodes.
    faces: Vec<[u32; 3]>,
}

/// The small loose pieces of a garment.
#[derive(Debug, Clone)]
pub(crate) struct StiffPieces(Vec<Piece>);

impl StiffPieces {
    /// Finds them; most garments have none.
    pub(crate) fn of(cloth: &BoundGarment) -> Self {
        if !cloth.is_piece().contains(&true) {
            return Self(Vec::new());
        }
        let components = cloth.topology().components();
        let num_components = cloth.topology().num_components();
        let mut nodes_of: Vec<Vec<u32>> = vec![Vec::new(); num_components];
        let mut own_of_node = vec![0_u32; components.len()];
        for (node, &component) in components.iter().enumerate() {
            let nodes = &mut nodes_of[component as usize];
            if cloth.is_piece()[node] {
                own_of_node[node] = nodes.len() as u32;
                nodes.push(node as u32);
            }
        }
        let mut faces_of: Vec<Vec<[u32; 3]>> = vec![Vec::new(); num_components];
        for face in cloth.faces() {
            if cloth.is_piece()[face[0] as usize] {
                let own = face.map(|node| own_of_node[node as usize]);
                faces_of[components[face[0] as usize] as usize].push(own);
            }
        }
        let largest = cloth.scale() * LARGEST;
        let is_small = |nodes: &[u32]| {
            let places = places(cloth.rest_nodes(), nodes);
            let middle = middle(&places);
            let reach = places.iter().map(|place| (place - middle).norm());
            2.0 * reach.fold(0.0, f32::max) <= largest
        };
        let pieces = nodes_of.into_iter().zip(faces_of);
        let pieces = pieces.filter(|(nodes, _)| nodes.len() > 3 && is_small(nodes));
        let pieces = pieces.map(|(nodes, faces)| Piece { nodes, faces });
        Self(pieces.collect())
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Gives each piece its shape at rest back, where it is now.
    pub(crate) fn stiffen(&self, cloth: &BoundGarment, nodes: &mut [Point3]) {
        for piece in &self.0 {
            piece.put(nodes, &piece.stiff(cloth, nodes));
        }
    }

    /// The same where it lies `clearance` outside of `skin`, which it is lifted to, and runs
    /// through the cloth no more than before; whether any piece was moved. Others are left as they
    /// are: where the body runs through itself there may be no room.
    pub(crate) fn stiffen_outside(
        &self,
        cloth: &BoundGarment,
        nodes: &mut [Point3],
        (skin, clearance): (&Surface, f32),
    ) -> bool {
        let rest = cloth.faces().iter();
        let rest = rest.filter(|face| !cloth.is_piece()[face[0] as usize]);
        let Ok(mesh) = TriMesh::new(nodes.to_vec(), rest.copied().collect()) else {
            return false;
        };
        let around = Surface::new(&mesh);
        let mut is_moved = false;
        for piece in &self.0 {
            let crossing = |places: &[Point3], other: &Surface| {
                let mesh = TriMesh::new(places.to_vec(), piece.faces.clone());
                mesh.map_or(usize::MAX, |mesh| {
                    Surface::new(&mesh).intersections(other).len()
                })
            };
            let most = crossing(&places(nodes, &piece.nodes), &around);
            let mut stiff = piece.stiff(cloth, nodes);
            for _ in 0..LIFTS {
                let lift = lift(&stiff, (skin, clearance));
                let is_free = lift.is_none() && crossing(&stiff, skin) == 0;
                if is_free && crossing(&stiff, &around) <= most {
                    piece.put(nodes, &stiff);
                    is_moved = true;
                    break;
                }
                let lift = lift.unwrap_or_else(|| {
                    let middle = middle(&stiff);
                    let near = skin.closest(middle).point;
                    STEP * cloth.scale() * (middle - near).normalize()
                });
                for place in &mut stiff {
                    *place += lift;
                }
            }
        }
        is_moved
    }
}

impl Piece {
    /// The piece as it is at rest, moved to where its nodes are.
    fn stiff(&self, cloth: &BoundGarment, nodes: &[Point3]) -> Vec<Point3> {
        let rest = places(cloth.rest_nodes(), &self.nodes);
        let moved = rigid(&rest, &places(nodes, &self.nodes));
        rest.iter().map(|place| moved * place).collect()
    }

    fn put(&self, nodes: &mut [Point3], places: &[Point3]) {
        for (&node, place) in self.nodes.iter().zip(places) {
            nodes[node as usize] = *place;
        }
    }
}

/// What brings the points, moved together, to a clearance from the skin: that of the one that needs
/// most; none if all keep it.
fn lift(points: &[Point3], (skin, clearance): (&Surface, f32)) -> Option<Vector3> {
    let signed = points.iter().zip(skin.contains_all(points));
    let needs = signed.filter_map(|(point, is_inside)| {
        let way = point - skin.closest(*point).point;
        let distance = way.norm();
        let (outward, missing) = if is_inside {
            (-way, clearance + distance)
        } else {
            (way, clearance - distance)
        };
        let outward = outward.try_normalize(f32::EPSILON)?;
        (missing > ROUNDING * clearance).then_some(missing * outward)
    });
    needs.max_by(|a, b| a.norm().total_cmp(&b.norm()))
}

fn middle(points: &[Point3]) -> Point3 {
    let sum: Vector3 = points.iter().map(|point| point.coords).sum();
    Point3::from(sum / points.len().max(1) as f32)
}

fn places(positions: &[Point3], nodes: &[u32]) -> Vec<Point3> {
    let nodes = nodes.iter();
    nodes.map(|&node| positions[node as usize]).collect()
}

/// The rigid motion that brings points nearest to others, in the mean of squares (Kabsch 1976).
fn rigid(from: &[Point3], to: &[Point3]) -> Isometry3<f32> {
    let [start, end] = [from, to].map(|points| middle(points).coords);
    let mut covariance = Matrix3::zeros();
    for (a, b) in from.iter().zip(to) {
        let product = (b.coords - end) * (a.coords - start).transpose();
        covariance += product.cast::<f64>();
    }
    let turn = nearest_rotation(&covariance).unwrap_or_default().cast();
    Isometry3::from_parts((end - turn * start).into(), turn)
}

#[cfg(test)]
mod tests {
    use garnet_mesh::primitives::icosphere;

    use super::*;

    #[test]
    fn a_turn_is_found_again_whatever_was_crushed() {
        let ball = icosphere(1, 0.01);
        let moved = Isometry3::new(Vector3::new(0.1, 0.2, -0.3), Vector3::new(0.4, -1.2, 2.0));
        let turned: Vec<Point3> = ball.positions().iter().map(|p| moved * p).collect();
        let found = rigid(ball.positions(), &turned);
        for (a, b) in ball.positions().iter().zip(&turned) {
            assert!((found * a - b).norm() < 1e-6);
        }
        // Crushed to half its height, a ball lies where it lay.
        let crushed = ball.positions().iter();
        let crushed: Vec<Point3> = crushed
            .map(|p| moved * Point3::new(p.x, 0.5 * p.y, p.z))
            .collect();
        let found = rigid(ball.positions(), &crushed);
        assert!((found.translation.vector - moved.translation.vector).norm() < 1e-6);
    }
}
