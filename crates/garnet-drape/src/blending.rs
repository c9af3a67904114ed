//! A drape that settling has made better but for a few places: these go back to where they were,
//! and the cloth around them bends from one to the other.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use garnet_mesh::Point3;
use garnet_skin::PosedBody;
use garnet_untangle::{Untangled, free_crossing_faces};

use crate::{BoundGarment, Error};

/// How far around such places cloth goes back, in metres of a person, the first that helps; it
/// bends over as much again. Larger ones leave little of what has settled.
pub(crate) const REACHES: [f32; 3] = [0.05, 0.1, 0.2];

/// Nodes `[node]` of cloth that has settled, where it was before within `reach` of what is worse
/// after it, in metres of a person; and how much of the cloth that is, from 0 to 1.
pub(crate) fn blended(
    garment: &BoundGarment,
    [before, after]: [&Untangled; 2],
    is_worse: &[bool],
    reach: f32,
) -> (Vec<Point3>, f32) {
    let cloth = garment.cloth();
    let reach = cloth.scale() * reach;
    let distances = distances(garment, is_worse, 2.0 * reach);
    let shares = distances.iter().map(|distance| {
        let far = (distance / reach - 1.0).clamp(0.0, 1.0);
        1.0 - far * far * (3.0 - 2.0 * far)
    });
    let shares: Vec<f32> = shares.collect();
    let places = before.positions_nodes.iter().zip(&after.positions_nodes);
    let places = places.zip(&shares);
    let nodes = places.map(|((before, after), &share)| after + share * (before - after));
    let areas = cloth.graph().node_areas();
    let back: f32 = areas
        .iter()
        .zip(&shares)
        .map(|(area, share)| area * share)
        .sum();
    let all: f32 = areas.iter().sum();
    (nodes.collect(), back / all.max(f32::MIN_POSITIVE))
}

/// Where cloth that has settled is worse `[node]`: faces that cross the skin of `body`, nodes in
/// it, and edges of more than `max_stretch` of their length at rest.
pub(crate) fn worse(
    garment: &BoundGarment,
    body: &PosedBody,
    settled: &Untangled,
    max_stretch: f32,
) -> Result<Vec<bool>, Error> {
    let (cloth, places) = (garment.cloth(), &settled.positions_nodes);
    let surface = garment.binding().surface_at(places.clone())?;
    let mut is_worse = body.skin().contains_all(places);
    for face in free_crossing_faces(&surface, body.skin()) {
        for node in cloth.faces()[face as usize] {
            is_worse[node as usize] = true;
        }
    }
    let length =
        |places: &[Point3], [a, b]: [u32; 2]| (places[a as usize] - places[b as usize]).norm();
    for &edge in cloth.topology().edges() {
        if length(places, edge) > max_stretch * length(cloth.rest_nodes(), edge) {
            for node in edge {
                is_worse[node as usize] = true;
            }
        }
    }
    for (is_worse, is_trapped) in is_worse.iter_mut().zip(&settled.is_trapped) {
        *is_worse &= !is_trapped;
    }
    Ok(is_worse)
}

/// How far each node is along the cloth from the nearest of those given `[node]`, in metres at
/// rest; infinite beyond `most`.
fn distances(garment: &BoundGarment, is_start: &[bool], most: f32) -> Vec<f32> {
    let (topology, rest) = (garment.cloth().topology(), garment.cloth().rest_nodes());
    let mut distances = vec![f32::INFINITY; rest.len()];
    let mut queue = BinaryHeap::new();
    for node in (0..rest.len()).filter(|&node| is_start[node]) {
        distances[node] = 0.0;
        queue.push(Reverse((0_u32, node as u32)));
    }
    while let Some(Reverse((bits, node))) = queue.pop() {
        // Bits of positive numbers are in their order.
        let distance = f32::from_bits(bits);
        if distance > distances[node as usize] {
            continue;
        }
        for &other in topology.neighbors(node as usize) {
            let way = (rest[other as usize] - rest[node as usize]).norm();
            let found = distance + way;
            if found <= most && found < distances[other as usize] {
                distances[other as usize] = found;
                queue.push(Reverse((found.to_bits(), other)));
            }
        }
    }
    distances
}

#[cfg(test)]
mod tests {
    use garnet_mesh::primitives::{capsule, tube};
    use garnet_skin::{Body, Joint, Pose, Skeleton, SkinWeights, Vector3};
    use garnet_untangle::UntangleReport;

    use super::*;
    use crate::Garment;

    #[test]
    fn cloth_goes_back_around_what_is_worse_and_nowhere_else() {
        let limb = capsule(0.1, 1.0, 24, 16);
        let joint = Joint {
            name: "limb".to_owned(),
            parent: None,
            rest_position: Point3::origin(),
        };
        let weights = SkinWeights::from_dense(1, &vec![1.0; limb.num_vertices()]).unwrap();
        let body = Body::new(limb, Skeleton::new(vec![joint]).unwrap(), weights).unwrap();
        let garment = Garment::new(tube(0.12, 0.8, 32, 40)).bind(&body).unwrap();
        let posed = body.posed(&Pose::rest(1)).unwrap();
        let rest = garment.cloth().rest_nodes().to_vec();
        let untangled = |nodes: Vec<Point3>| Untangled {
            is_trapped: vec![false; nodes.len()],
            positions_nodes: nodes,
            report: UntangleReport::default(),
        };
        // All of it has moved by a millimetre; one place is in the limb.
        let deep = rest.iter().position(|place| place.y.abs() < 0.02).unwrap();
        let moved = rest.iter().enumerate().map(|(node, place)| {
            let inwards = Vector3::new(-place.x, 0.0, -place.z).normalize();
            place + inwards * if node == deep { 0.06 } else { 0.001 }
        });
        let [before, after] = [rest.clone(), moved.collect()].map(untangled);
        let is_worse = worse(&garment, &posed, &after, 9.0).unwrap();
        let (nodes, share) = blended(&garment, [&before, &after], &is_worse, 0.05);
        assert!((0.01..0.2).contains(&share), "{share}");
        assert_eq!(nodes[deep], rest[deep]);
        for (node, place) in nodes.iter().enumerate() {
            if (rest[node] - rest[deep]).norm() > 0.16 {
                assert_eq!(*place, after.positions_nodes[node]);
            }
        }
    }
}
