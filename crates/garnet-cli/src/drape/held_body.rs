//! Garments of which a part is the body that they lie on: files that hold both.

use garnet::{Body, BoundGarment, Point3, TriMesh, knn::VertexTree};

use super::warning::Problem;

/// A vertex of the garment within this distance of one of the body is the same, in metres.
const SAME_VERTEX: f32 = 1e-4;

/// A garment that has this share of the body's vertices holds the body.
const HELD_SHARE: f64 = 0.5;

/// A part of the garment that is the body has this share of its area.
const LEAST_AREA: f64 = 0.25;

/// Vertices of a part that is the body, cut in another way or shrunk, lie this far from its skin at
/// most, in metres of a person; a few of a hundred may lie elsewhere.
const FARTHEST: f32 = 0.01;

/// The same share of them.
const LEAST_NEAR: f64 = 0.95;

/// Such a part lies no farther outside of the skin in the mean, in metres of a person. A higher
/// value takes tight suits for bodies.
const MEAN_HEIGHT: f64 = 0.001;

/// Whether one part of a garment is the body that it lies on.
pub(super) fn of_body_in(garment: &BoundGarment) -> Option<Problem> {
    let held = same_vertices(garment.mesh(), garment.body());
    let held = held.or_else(|| like_skin(garment));
    held.map(Problem::HoldsBody)
}

/// How many vertices of the body the garment has, if it has most of them.
fn same_vertices(garment: &TriMesh, body: &Body) -> Option<usize> {
    let tree = VertexTree::new(garment.positions()).ok()?;
    let own = || body.of_skin(body.rest().positions());
    let is_held = |place: &&Point3| {
        let near = tree.nearest(**place);
        near.is_some_and(|near| {
            (garment.positions()[near.index as usize] - **place).norm() < SAME_VERTEX
        })
    };
    let held = own().filter(is_held).count();
    (held as f64 >= HELD_SHARE * own().count() as f64).then_some(held)
}

/// How many nodes are of large parts that lie on the skin or below it.
fn like_skin(garment: &BoundGarment) -> Option<usize> {
    let (cloth, body) = (garment.cloth(), garment.body());
    let topology = cloth.topology();
    let places = body.rest().positions();
    let areas = body.rest().faces().iter().map(|corners| {
        let [a, b, c] = corners.map(|corner| places[corner as usize]);
        f64::from(0.5 * (b - a).cross(&(c - a)).norm())
    });
    let area: f64 = areas.sum();
    let mut areas = vec![0.0_f64; topology.num_components()];
    let mut nodes = vec![Vec::new(); topology.num_components()];
    for (node, &component) in topology.components().iter().enumerate() {
        areas[component as usize] += f64::from(cloth.graph().node_areas()[node]);
        nodes[component as usize].push(node);
    }
    let height = |node: usize| cloth.skin()[node].distance_squared.sqrt();
    let farthest = cloth.scale() * FARTHEST;
    let is_like_skin = |nodes: &Vec<usize>| {
        let near = nodes.iter().filter(|&&node| height(node) < farthest);
        if (near.count() as f64) < LEAST_NEAR * nodes.len() as f64 {
            return false;
        }
        let places: Vec<Point3> = nodes.iter().map(|&node| cloth.rest_nodes()[node]).collect();
        let is_inside = cloth.rest_skin().contains_all(&places);
        let heights = nodes.iter().zip(is_inside).map(|(&node, is_inside)| {
            let height = f64::from(height(node));
            if is_inside { -height } else { height }
        });
        heights.sum::<f64>() < f64::from(cloth.scale()) * MEAN_HEIGHT * nodes.len() as f64
    };
    let large = nodes
        .iter()
        .zip(&areas)
        .filter(|(_, part)| **part >= LEAST_AREA * area);
    let held: usize = large
        .filter(|(nodes, _)| is_like_skin(nodes))
        .map(|(nodes, _)| nodes.len())
        .sum();
    (held > 0).then_some(held)
}
