//! Mending cloth that was torn apart.
//!
//! Pushed out node by node, cloth can end up on both sides of an arm that reaches through it. Such
//! cloth starts again: it comes together without regard to the skin and leaves it on one side.

use crate::cloth::{Cloth, HOME_PREFERENCES, Refresh, SWEEPS};
use crate::region::{Region, rings_of};

/// Edges stretched more than this count as torn apart.
const TORN_STRETCH: f32 = 2.0;

/// Cloth this far from a torn edge is mended, in metres.
const MEND_RADIUS: f32 = 0.04;

/// Sweeps that bring torn cloth together.
const MEND_SWEEPS: usize = 24;

/// Searches for contacts after that.
const MEND_SEARCHES: usize = 4;

/// Edges that are torn apart.
#[derive(Debug, Default)]
pub(crate) struct Tears {
    /// Their ends.
    pub(crate) nodes: Vec<u32>,
    /// The sum of their stretch beyond what counts as torn.
    pub(crate) excess: f32,
}

/// An edge of the cloth that is longer than it may be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TornEdge {
    pub(crate) ends: [u32; 2],
    /// In metres.
    pub(crate) rest_length: f32,
}

impl Cloth<'_> {
    /// Starts again where the cloth was torn apart: nodes that went round a part of the body on
    /// different sides come together without regard to the skin, and leave it on one side. Returns the
    /// stretch beyond what counts as torn that is left, summed over torn edges.
    pub(crate) fn mend(&mut self) -> f32 {
        let mut tears = self.tears();
        for preference in HOME_PREFERENCES {
            if tears.nodes.is_empty() {
                break;
            }
            let kept = (self.positions.clone(), self.contacts.clone());
            self.home_preference = preference;
            self.close_tears(&tears.nodes);
            let left = self.tears();
            if left.excess < tears.excess {
                tears = left;
            } else {
                (self.positions, self.contacts) = kept;
            }
        }
        self.home_preference = HOME_PREFERENCES[0];
        tears.excess
    }

    fn close_tears(&mut self, nodes: &[u32]) {
        let graph = self.garment.graph();
        let rings = rings_of(graph, MEND_RADIUS).max(2);
        let region = Region::around(graph, nodes.iter().copied(), rings);
        for &node in region.nodes() {
            let contact = &mut self.contacts[node as usize];
            contact.own = None;
            contact.foreign = None;
            self.ways_out[node as usize] = None;
        }
        self.sweep(MEND_SWEEPS, &region);
        for _ in 0..MEND_SEARCHES {
            self.find_contacts(&region, Refresh::All);
            self.sweep(SWEEPS, &region);
        }
        self.polish(&region);
    }

    /// The edges that are torn apart where the body leaves room.
    pub(crate) fn tears(&self) -> Tears {
        self.tears_beyond(TORN_STRETCH)
    }

    /// The edges that are stretched beyond `limit` where the body leaves room.
    pub(crate) fn tears_beyond(&self, limit: f32) -> Tears {
        let mut tears = Tears::default();
        for edge in self.torn_edges(limit) {
            tears.excess += self.stretch(&edge) - limit;
            tears.nodes.extend(edge.ends);
        }
        tears.nodes.sort_unstable();
        tears.nodes.dedup();
        tears
    }

    /// Those edges.
    pub(crate) fn torn_edges(&self, limit: f32) -> Vec<TornEdge> {
        let graph = self.garment.graph();
        let edges = graph.edges()[..graph.num_cloth_edges()].iter();
        let torn = edges.zip(graph.rest_lengths());
        let torn = torn.map(|(&ends, &rest_length)| TornEdge { ends, rest_length });
        let is_free = |edge: &TornEdge| !edge.ends.iter().any(|&n| self.is_trapped(n as usize));
        torn.filter(|edge| self.stretch(edge) > limit && is_free(edge))
            .collect()
    }

    /// Length over rest length of an edge.
    pub(crate) fn stretch(&self, edge: &TornEdge) -> f32 {
        let [a, b] = edge.ends.map(|node| self.positions[node as usize]);
        (b - a).norm() / edge.rest_length.max(f32::MIN_POSITIVE)
    }
}
