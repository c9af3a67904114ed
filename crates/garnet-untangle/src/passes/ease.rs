//! Drawing the cloth along to nodes that were moved on their own.
//!
//! A node that found a free place far from where projection left it stretches the edges to its
//! neighbours. They follow it as far as they stay in front of the skin: a move is made only to a
//! free place, so nothing that was solved is undone.

use garnet_mesh::Point3;

use crate::cloth::{CLEARANCE_MARGIN, Cloth};
use crate::region::{Region, rings_of};

/// Cloth this far from a torn edge follows, in metres.
const EASE_RADIUS: f32 = 0.02;

/// Sweeps over that cloth, at most.
const EASE_SWEEPS: usize = 16;

/// Shares of its way that a node tries to go.
const SHARES: [f32; 3] = [1.0, 0.5, 0.2];

/// Easing ends when no node moved farther than this in a sweep, in metres.
const REST_STEP: f32 = 5e-5;

/// Shortens overstretched edges by moves from free place to free place; returns the nodes that
/// may have moved.
pub(crate) fn ease(cloth: &mut Cloth<'_>) -> Vec<u32> {
    let tears = cloth.tears();
    if tears.nodes.is_empty() {
        return Vec::new();
    }
    let graph = cloth.scene.garment.graph();
    let layers = &cloth.scene.finder.binding.layers;
    let rings = rings_of(graph, cloth.scale() * EASE_RADIUS).max(2);
    let region = Region::around(graph, tears.nodes, rings);
    for _ in 0..EASE_SWEEPS {
        let mut farthest = 0.0_f32;
        for &node in region.nodes() {
            let node = node as usize;
            if layers.is_follower(node) {
                continue;
            }
            let position = cloth.positions[node];
            if let Some(place) = eased_place(cloth, node) {
                farthest = farthest.max((place - position).norm());
                cloth.positions[node] = place;
            }
        }
        if farthest < REST_STEP {
            break;
        }
    }
    let led = |&node: &u32| !layers.is_follower(node as usize);
    region.nodes().iter().copied().filter(led).collect()
}

/// A free place on the way to where the neighbours want a node.
fn eased_place(cloth: &Cloth<'_>, node: usize) -> Option<Point3> {
    let position = cloth.positions[node];
    let way = cloth.scene.sweeper.wanted_of(node, &cloth.positions) - position;
    if way.norm() < 0.2 * REST_STEP || cloth.is_trapped(node) {
        return None;
    }
    let mut places = SHARES.iter().map(|share| position + *share * way);
    places.find_map(|place| free_place_at(cloth, node, place))
}

/// The place itself, or the one in front of the skin that it is too near to, if that is free.
fn free_place_at(cloth: &Cloth<'_>, node: usize, mut place: Point3) -> Option<Point3> {
    let contact = &cloth.contacts[node];
    // Nodes that keep more than was asked for do so for the triangles around them.
    let limit = cloth.clearances[node] - CLEARANCE_MARGIN;
    let moved = (place - contact.position).norm();
    if contact.distance - moved > limit {
        return Some(place);
    }
    let goal = limit + CLEARANCE_MARGIN;
    for is_last in [false, true] {
        let closest = cloth
            .scene
            .finder
            .skin
            .closest_from(place, contact.closest.face);
        let offset = place - closest.point;
        let distance = offset.norm();
        if distance >= limit {
            return (cloth.scene.finder.winding(place) == 0).then_some(place);
        }
        if is_last {
            break;
        }
        let normal = cloth
            .scene
            .finder
            .normals
            .smooth(cloth.scene.finder.skin, &closest);
        let outwards = if offset.dot(&normal) > 0.0 && distance > 0.5 * limit {
            offset / distance
        } else {
            normal
        };
        place = closest.point + goal * outwards;
    }
    None
}
