//! Drawing the cloth along to nodes that were moved on their own.
//!
//! A node that found a free place far from where projection left it stretches the edges to its
//! neighbours. They follow it as far as they stay in front of the skin: a move is made only to a
//! free place, so nothing that was solved is undone.

use garnet_mesh::Point3;

use crate::cloth::{CLEARANCE_MARGIN, Cloth};
use crate::region::{Region, rings_of};

/// Edges stretched more than this are eased.
const EASE_STRETCH: f32 = 2.0;

/// Cloth this far from such an edge follows, in metres.
const EASE_RADIUS: f32 = 0.02;

/// Sweeps over that cloth, at most.
const EASE_SWEEPS: usize = 16;

/// Shares of its way that a node tries to go.
const SHARES: [f32; 3] = [1.0, 0.5, 0.2];

/// Easing ends when no node moved farther than this in a sweep, in metres.
const REST_STEP: f32 = 5e-5;

impl Cloth<'_> {
    /// Shortens overstretched edges by moves from free place to free place; returns the nodes that
    /// may have moved.
    pub(crate) fn ease(&mut self) -> Vec<u32> {
        let tears = self.tears_beyond(EASE_STRETCH);
        if tears.nodes.is_empty() {
            return Vec::new();
        }
        let graph = self.garment.graph();
        let rings = rings_of(graph, EASE_RADIUS).max(2);
        let region = Region::around(graph, tears.nodes, rings);
        for _ in 0..EASE_SWEEPS {
            let mut farthest = 0.0_f32;
            for &node in region.nodes() {
                let node = node as usize;
                let position = self.positions[node];
                if let Some(place) = self.eased_place(node) {
                    farthest = farthest.max((place - position).norm());
                    self.positions[node] = place;
                }
            }
            if farthest < REST_STEP {
                break;
            }
        }
        region.nodes().to_vec()
    }

    /// A free place on the way to where the neighbours want a node.
    fn eased_place(&self, node: usize) -> Option<Point3> {
        let position = self.positions[node];
        let way = self.sweeper.wanted_of(node, &self.positions) - position;
        if way.norm() < 0.2 * REST_STEP || self.is_trapped(node) {
            return None;
        }
        let mut places = SHARES.iter().map(|share| position + *share * way);
        places.find_map(|place| self.free_place_at(node, place))
    }

    /// The place itself, or the one in front of the skin that it is too near to, if that is free.
    fn free_place_at(&self, node: usize, mut place: Point3) -> Option<Point3> {
        let contact = &self.contacts[node];
        // Nodes that keep more than was asked for do so for the triangles around them.
        let limit = self.clearances[node] - CLEARANCE_MARGIN;
        let moved = (place - contact.position).norm();
        if contact.distance - moved > limit {
            return Some(place);
        }
        let goal = limit + CLEARANCE_MARGIN;
        for is_last in [false, true] {
            let closest = self.finder.skin.closest_from(place, contact.closest.face);
            let offset = place - closest.point;
            let distance = offset.norm();
            if distance >= limit {
                return (self.finder.winding(place) == 0).then_some(place);
            }
            if is_last {
                break;
            }
            let normal = self.finder.normals.smooth(self.finder.skin, &closest);
            let outwards = if offset.dot(&normal) > 0.0 && distance > 0.5 * limit {
                offset / distance
            } else {
                normal
            };
            place = closest.point + goal * outwards;
        }
        None
    }
}
