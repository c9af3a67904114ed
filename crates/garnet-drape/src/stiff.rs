//! Buttons, beads and buckles: small loose pieces are no cloth, and keep their shape.

use garnet_knn::Surface;
use garnet_mesh::{Bounds, Point3, TriMesh, Vector3};
use garnet_skin::BoundGarment;
use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion};

/// Loose pieces that are larger than this, from corner to corner, may bend, as pockets do; in
/// metres. More keeps patches and zips stiff.
const LARGEST: f32 = 0.045;

/// A piece that is in the skin is lifted out of it so often, each time to this height in metres.
/// Where the body runs through itself there may be no room.
const LIFTS: usize = 4;
const LIFTED_TO: f32 = 5e-4;

/// A loose piece that keeps its shape.
struct Piece {
    nodes: Vec<u32>,
    /// Between its own nodes.
    faces: Vec<[u32; 3]>,
}

/// The small loose pieces of a garment.
pub(crate) struct StiffPieces(Vec<Piece>);

impl StiffPieces {
    /// Finds them; most garments have none.
    pub(crate) fn of(cloth: &BoundGarment) -> Self {
        if !cloth.is_piece().contains(&true) {
            return Self(Vec::new());
        }
        let components = cloth.topology().components();
        let mut nodes_of = vec![Vec::new(); cloth.topology().num_components()];
        let mut own_of_node = vec![0_u32; components.len()];
        for (node, &component) in components.iter().enumerate() {
            let nodes: &mut Vec<u32> = &mut nodes_of[component as usize];
            if cloth.is_piece()[node] {
                own_of_node[node] = nodes.len() as u32;
                nodes.push(node as u32);
            }
        }
        let largest = cloth.scale() * LARGEST;
        let is_small = |nodes: &[u32]| {
            let places: Vec<Point3> = places(cloth.rest_nodes(), nodes);
            Bounds::of(&places).is_some_and(|bounds| bounds.diagonal() <= largest)
        };
        let pieces = nodes_of.into_iter().enumerate();
        let pieces = pieces.filter(|(_, nodes)| nodes.len() > 3 && is_small(nodes));
        let pieces = pieces.map(|(component, nodes)| {
            let faces = cloth.faces().iter();
            let own = faces.filter(|face| components[face[0] as usize] as usize == component);
            let faces = own.map(|face| face.map(|node| own_of_node[node as usize]));
            Piece {
                faces: faces.collect(),
                nodes,
            }
        });
        Self(pieces.collect())
    }

    /// Gives each piece its shape at rest back, where it is now.
    pub(crate) fn stiffen(&self, cloth: &BoundGarment, nodes: &mut [Point3]) {
        for piece in &self.0 {
            piece.put(nodes, &piece.stiff(cloth, nodes));
        }
    }

    /// The same for pieces that come to lie outside of `skin` so.
    pub(crate) fn stiffen_outside(
        &self,
        cloth: &BoundGarment,
        nodes: &mut [Point3],
        skin: &Surface,
    ) {
        for piece in &self.0 {
            let mut stiff = piece.stiff(cloth, nodes);
            for _ in 0..LIFTS {
                let Some(deepest) = deepest(&stiff, skin) else {
                    break;
                };
                let lift = deepest + LIFTED_TO * cloth.scale() * deepest.normalize();
                for place in &mut stiff {
                    *place += lift;
                }
            }
            let mesh = TriMesh::new(stiff.clone(), piece.faces.clone());
            let crosses = mesh.map(|mesh| !Surface::new(&mesh).intersections(skin).is_empty());
            if deepest(&stiff, skin).is_none() && crosses == Ok(false) {
                piece.put(nodes, &stiff);
            }
        }
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

/// From the deepest of the points inside to the skin; none if all are outside.
fn deepest(points: &[Point3], skin: &Surface) -> Option<Vector3> {
    let inside = points.iter().zip(skin.contains_all(points));
    let ways = inside.filter(|(_, inside)| *inside);
    let ways = ways.map(|(point, _)| skin.closest(*point).point - point);
    let ways = ways.filter(|way| way.norm() > f32::EPSILON);
    ways.max_by(|a, b| a.norm().total_cmp(&b.norm()))
}

fn places(positions: &[Point3], nodes: &[u32]) -> Vec<Point3> {
    let nodes = nodes.iter();
    nodes.map(|&node| positions[node as usize]).collect()
}

/// The rigid motion that brings points nearest to others, in the mean of squares (Kabsch 1976).
fn rigid(from: &[Point3], to: &[Point3]) -> Isometry3<f32> {
    let middle = |points: &[Point3]| -> Vector3 {
        points.iter().map(|point| point.coords).sum::<Vector3>() / points.len() as f32
    };
    let (start, end) = (middle(from), middle(to));
    let mut covariance = Matrix3::zeros();
    for (a, b) in from.iter().zip(to) {
        covariance += (b.coords - end) * (a.coords - start).transpose();
    }
    let found = covariance.svd(true, true);
    let turn = match (found.u, found.v_t) {
        (Some(u), Some(v_t)) => {
            // A mirror image is no turn.
            let sign = (u * v_t).determinant().signum();
            let flip = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign));
            Rotation3::from_matrix_unchecked(u * flip * v_t)
        }
        _ => Rotation3::identity(),
    };
    let turn = UnitQuaternion::from_rotation_matrix(&turn);
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
