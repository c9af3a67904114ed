//! The last word: exact tests on the result.

use garnet_knn::Surface;
use garnet_mesh::Point3;
use garnet_skin::BoundGarment;
use rayon::prelude::*;

use crate::UntangleReport;
use crate::cloth::{Cloth, Scene};
use crate::crossing::Crossing;

/// Nodes that one task measures.
const CHUNK: usize = 256;

/// A vertex that moved farther than this counts as moved, in metres.
const MOVED: f32 = 1e-4;

/// Tests every node by winding number and distance, and counts what is left; tells which nodes are
/// trapped `[node]`.
pub(crate) fn verify(
    cloth: &Cloth<'_>,
    warped: &[Point3],
    crossing: &Crossing,
) -> (UntangleReport, Vec<bool>) {
    let Scene {
        garment, finder, ..
    } = cloth.scene;
    let mut report = UntangleReport {
        min_distance: f32::INFINITY,
        ..cloth.report.clone()
    };
    let is_inside = inside(garment, finder.skin, &cloth.positions, &crossing.faces);
    let mut is_trapped = vec![false; cloth.positions.len()];
    let measured = |node: usize| {
        let (closest, distance) = if is_inside[node] {
            cloth.closest(node)
        } else {
            cloth.closest_outside(node)
        };
        (distance, finder.traps.holds(&closest))
    };
    let nodes = (0..cloth.positions.len())
        .into_par_iter()
        .with_min_len(CHUNK);
    let measured: Vec<(f32, bool)> = nodes.map(measured).collect();
    for (node, (inside, (distance, trapped))) in is_inside.into_iter().zip(measured).enumerate() {
        let displacement = (cloth.positions[node] - warped[node]).norm();
        report.moved += usize::from(displacement > MOVED);
        report.max_displacement = report.max_displacement.max(displacement);
        let contact = &cloth.contacts[node];
        is_trapped[node] = trapped;
        if is_trapped[node] {
            report.trapped += 1;
            report.trapped_inside += usize::from(inside);
        } else if inside {
            report.inside += 1;
            report.deepest = report.deepest.max(distance);
        } else {
            report.min_distance = report.min_distance.min(distance);
            if distance < cloth.scene.options.clearance {
                report.below_clearance += 1;
                report.squeezed += usize::from(contact.is_between());
            }
        }
    }
    for face in crossing.of_skin(finder.skin) {
        let corners = garment.faces()[face as usize];
        if corners.iter().any(|&node| is_trapped[node as usize]) {
            report.crossing_faces_trapped += 1;
        } else {
            report.crossing_faces += 1;
        }
    }
    (report, is_trapped)
}

/// Whether each node is inside the body.
///
/// Nodes of a face that does not cross a closed skin are on the same side of it: one node of each
/// patch of such faces is tested. On a body with holes every node is.
pub(crate) fn inside(
    garment: &BoundGarment,
    skin: &Surface,
    positions: &[Point3],
    crossing: &[u32],
) -> Vec<bool> {
    if !skin.is_closed() {
        return skin.contains_all(positions);
    }
    let mut is_crossing = vec![false; garment.faces().len()];
    for &face in crossing {
        is_crossing[face as usize] = true;
    }
    let mut is_inside: Vec<Option<bool>> = vec![None; positions.len()];
    let mut stack = Vec::new();
    for start in 0..positions.len() as u32 {
        if is_inside[start as usize].is_some() {
            continue;
        }
        let side = Some(skin.contains(positions[start as usize]));
        is_inside[start as usize] = side;
        stack.push(start);
        while let Some(node) = stack.pop() {
            for &face in garment.topology().vertex_faces(node as usize) {
                if is_crossing[face as usize] {
                    continue;
                }
                for corner in garment.faces()[face as usize] {
                    if is_inside[corner as usize].is_none() {
                        is_inside[corner as usize] = side;
                        stack.push(corner);
                    }
                }
            }
        }
    }
    is_inside
        .into_iter()
        .map(|side| side == Some(true))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Binding;
    use crate::crossing::crossing_faces;
    use garnet_mesh::primitives::icosphere;
    use garnet_skin::{Body, Garment, Joint, Skeleton, SkinWeights};

    #[test]
    fn patches_between_crossing_faces_are_on_the_sides_that_their_nodes_are_on() {
        let mesh = icosphere(3, 0.2);
        let joint = Joint {
            name: "root".to_owned(),
            parent: None,
            rest_position: Point3::origin(),
        };
        let weights = SkinWeights::from_dense(1, &vec![1.0; mesh.num_vertices()]).unwrap();
        let body = Body::new(mesh, Skeleton::new(vec![joint]).unwrap(), weights).unwrap();
        let bound = Garment::new(icosphere(3, 0.21)).bind(&body).unwrap();
        let moved = |p: &Point3| Point3::new(p.x + 0.13, 0.7 * p.y + 0.013, p.z);
        let positions: Vec<Point3> = bound.rest_nodes().iter().map(moved).collect();
        let surface = Binding::new(&bound).unwrap().surface;
        let crossing = crossing_faces(&surface.moved(positions.clone()).unwrap(), body.skin());
        let is_inside = inside(&bound, body.skin(), &positions, &crossing);
        assert_eq!(is_inside, body.skin().contains_all(&positions));
        assert!(is_inside.contains(&true) && is_inside.contains(&false));
    }
}
