//! The last word: exact tests on the result.

use garnet_mesh::Point3;
use garnet_skin::BoundGarment;

use crate::UntangleReport;
use crate::cloth::Cloth;
use crate::contact::ContactFinder;

/// A vertex that moved farther than this counts as moved, in metres.
const MOVED: f32 = 1e-4;

/// Tests every node by winding number and distance, and counts what is left; tells which nodes are
/// trapped.
pub(crate) fn verified(
    garment: &BoundGarment,
    finder: &ContactFinder<'_>,
    warped: &[Point3],
    cloth: &Cloth<'_>,
    crossing: &[u32],
) -> (UntangleReport, Vec<bool>) {
    let skin = finder.skin;
    let mut report = UntangleReport {
        inside_before: cloth.inside_before.0,
        deepest_before: cloth.inside_before.1,
        contact_rounds: cloth.contact_rounds,
        crossing_rounds: cloth.crossing_rounds,
        min_distance: f32::INFINITY,
        ..UntangleReport::default()
    };
    let is_inside = skin.contains_all(&cloth.positions);
    let mut is_trapped = vec![false; cloth.positions.len()];
    for (node, inside) in is_inside.into_iter().enumerate() {
        let displacement = (cloth.positions[node] - warped[node]).norm();
        report.moved += usize::from(displacement > MOVED);
        report.max_displacement = report.max_displacement.max(displacement);
        let contact = &cloth.contacts[node];
        let (closest, distance) = cloth.closest(node);
        is_trapped[node] = finder.embedded.is_trap(closest.face, closest.point);
        if is_trapped[node] {
            report.trapped += 1;
            report.trapped_inside += usize::from(inside);
        } else if inside {
            report.inside += 1;
            report.deepest = report.deepest.max(distance);
        } else {
            report.min_distance = report.min_distance.min(distance);
            if distance < cloth.options.clearance {
                report.below_clearance += 1;
                let between = contact.own.is_some() && contact.foreign.is_some();
                report.squeezed += usize::from(between);
            }
        }
    }
    for &face in crossing {
        let corners = garment.faces()[face as usize];
        if corners.iter().any(|&node| is_trapped[node as usize]) {
            report.crossing_faces_trapped += 1;
        } else {
            report.crossing_faces += 1;
        }
    }
    (report, is_trapped)
}
