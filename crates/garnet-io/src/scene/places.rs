//! Matching vertices by their places: exporters split them at seams and number them anew. Where
//! places differ, their faces tell.

use std::sync::Arc;

use garnet_knn::VertexTree;
use garnet_mesh::{Bounds, Kinship, KnownMesh, Point3, TriMesh, Unit, UpAxis, kinship};
use garnet_skin::{Rig, SkinWeights, Weld};

use super::{
    files::BodyFile,
    frame::Frame,
    same_faces::{Faces, same_vertices},
};

/// Vertices at one place are as near as this, over the diagonal of their box: the digits of files.
const SAME_PLACE: f32 = 2e-4;

/// For each of `points` the vertex of `known` at its place, whatever units and up axes both are in;
/// nothing if one has no vertex there.
pub(super) fn same_places(known: &[Point3], points: &[Point3]) -> Option<Vec<u32>> {
    let bounds = Bounds::of(known)?;
    let tolerance = SAME_PLACE * bounds.diagonal();
    let tree = VertexTree::new(known).ok()?;
    let ups = [
        [UpAxis::Y, UpAxis::Y],
        [UpAxis::Z, UpAxis::Y],
        [UpAxis::Y, UpAxis::Z],
    ];
    let frames = ups.into_iter();
    let frames = frames.flat_map(|ups| Unit::METRIC.into_iter().map(move |unit| (ups, unit)));
    let mut seen = Vec::new();
    for ([up, known_up], unit) in frames {
        for known_unit in Unit::METRIC {
            let ratio = (unit.in_metres() / known_unit.in_metres()).log10().round() as i32;
            if seen.contains(&(up, known_up, ratio)) {
                continue;
            }
            seen.push((up, known_up, ratio));
            let to_metres = Frame { unit, up };
            let to_known = Frame {
                unit: known_unit,
                up: known_up,
            };
            let moved = to_known.to_file(to_metres.to_metres(points.to_vec()));
            let is_near = Bounds::of(&moved).is_some_and(|found| {
                let ends = [(found.min, bounds.min), (found.max, bounds.max)];
                ends.iter().all(|(a, b)| (a - b).norm() < 10.0 * tolerance)
            });
            if !is_near {
                continue;
            }
            let near = moved.iter().map(|point| {
                let found = tree.nearest(*point)?;
                let index = found.index;
                ((known[index as usize] - point).norm() <= tolerance).then_some(index)
            });
            if let Some(places) = near.collect() {
                return Some(places);
            }
        }
    }
    None
}

/// A rig with the vertices of an OBJ of its rest mesh, and which of its own vertices they are. A
/// rig that has them already, or whose rest mesh is not that of the OBJ, is given back as it is.
/// The OBJ may be in another pose than the rig, where the faces of both are the same.
pub(super) fn matched_rig(
    rig: Rig,
    rest: &TriMesh,
    edges: impl FnOnce() -> Vec<[u32; 2]>,
) -> (Rig, Option<Vec<u32>>) {
    let Some(own) = &rig.rest else {
        return (rig, None);
    };
    let is_same = own.num_vertices() == rest.num_vertices()
        && kinship(rest.positions(), own.positions(), rest.faces()) != Kinship::Stranger;
    if is_same {
        return (rig, None);
    }
    let by_faces = || {
        let edges = edges();
        same_vertices(&faces_of(own), &with_edges(faces_of(rest), &edges))
    };
    let places = same_places(own.positions(), rest.positions());
    let Some(places) = places.or_else(by_faces) else {
        return (rig, None);
    };
    let positions = places
        .iter()
        .map(|&vertex| own.positions()[vertex as usize]);
    let mesh = TriMesh::new(positions.collect(), rest.faces().to_vec());
    let rows = places
        .iter()
        .map(|&vertex| rig.weights.vertex(vertex as usize));
    let weights = SkinWeights::from_influences(rig.skeleton.num_joints(), rows);
    match (mesh, weights) {
        (Ok(mesh), Ok(weights)) => {
            let rig = Rig {
                rest: Some(mesh),
                weights,
                ..rig
            };
            (rig, Some(places))
        }
        _ => (rig, None),
    }
}

fn faces_of(mesh: &TriMesh) -> Faces<'_> {
    Faces {
        positions: mesh.positions(),
        triangles: mesh.faces(),
        edges: &[],
    }
}

fn with_edges<'a>(faces: Faces<'a>, edges: &'a [[u32; 2]]) -> Faces<'a> {
    Faces { edges, ..faces }
}

/// Gives a body the vertices of the rest mesh, if it has others: by their places at rest, by those
/// of the rig (`places`), by the order in which split vertices come, or by their faces.
pub(super) fn match_body(body: &mut BodyFile, rest: &TriMesh, places: Option<&[u32]>) {
    let found = |positions: &[Point3]| {
        positions.len() == rest.num_vertices()
            && kinship(rest.positions(), positions, rest.faces()) != Kinship::Stranger
    };
    if found(&body.positions) {
        return;
    }
    let gathered = |places: &[u32]| -> Option<Vec<Point3>> {
        let places = places.iter();
        places
            .map(|&vertex| body.positions.get(vertex as usize).copied())
            .collect()
    };
    let at_rest = body.at_rest.as_deref().unwrap_or(&body.positions);
    let by_rig = || {
        places
            .and_then(gathered)
            .filter(|positions| found(positions))
    };
    let by_place = || same_places(at_rest, rest.positions()).and_then(|places| gathered(&places));
    let by_order = || {
        let weld = Weld::new(rest.positions());
        if weld.num_nodes() != body.positions.len() {
            return None;
        }
        let positions = weld.gather(rest.positions());
        let welded = TriMesh::new(positions, weld.faces(rest)).ok()?;
        let known = KnownMesh::of(&welded);
        let checked = known.check_order(&body.positions, &body.edges);
        checked.ok().map(|_| weld.scatter(&body.positions))
    };
    let by_faces = || {
        let of_body = Faces {
            positions: &body.positions,
            triangles: &body.triangles,
            edges: &body.edges,
        };
        gathered(&same_vertices(&of_body, &faces_of(rest))?).filter(|positions| found(positions))
    };
    let by_others = || by_place().or_else(by_order).or_else(by_faces);
    if let Some(positions) = by_rig().or_else(by_others) {
        body.positions = positions;
        body.edges = Arc::default();
        body.triangles = Arc::default();
    }
}

#[cfg(test)]
mod tests {
    use garnet_mesh::primitives::capsule;

    use super::*;

    #[test]
    fn vertices_are_matched_whatever_the_unit_and_the_axis() {
        let body = capsule(0.2, 1.4, 16, 12);
        let count = body.num_vertices();
        let order: Vec<usize> = (0..count).map(|index| index * 7 % count).collect();
        let moved = |index: &usize| {
            let place = body.positions()[*index];
            Point3::new(place.x, -place.z, place.y) * 100.0
        };
        let points: Vec<Point3> = order.iter().map(moved).collect();
        let places = same_places(body.positions(), &points).unwrap();
        let expected: Vec<u32> = order.iter().map(|&index| index as u32).collect();
        assert_eq!(places, expected);
        assert_eq!(same_places(&points[1..], &points), None);
    }
}
