//! Moving the cloth: each node to where its neighbours want it, then in front of the skin.
//!
//! A sweep is one step of projected successive over-relaxation for: least squared deviation of the
//! edges from those of the relaxed warp, held by a screening, under the half spaces of the contacts.
//! Small regions are swept in place. Of large ones, blocks of nodes are, and see the other blocks as
//! they were before the sweep, so that the result does not depend on the number of threads.

use garnet_mesh::{Point3, Vector3};
use garnet_skin::ClothGraph;
use rayon::prelude::*;

use crate::contact::Contact;
use crate::region::Region;

/// Nodes of a block.
const BLOCK: usize = 1024;

/// Over-relaxation; between 1 (Gauss-Seidel) and 2 (divergence).
const OVER_RELAXATION: f32 = 1.0;

/// Edges stretched beyond this are pulled together instead of kept as in the warp.
const OVER_STRETCH: f32 = 1.2;

/// Overstretched edges pull the harder the longer they are, up to this many times.
const MAX_STIFFENING: f32 = 4.0;

/// Own and foreign skin leave too little room if their half spaces are this opposed.
const OPPOSED_COSINE: f32 = -0.5;

/// The part of the problem that stays while the nodes move.
#[derive(Debug)]
pub(crate) struct Sweeper<'a> {
    pub(crate) graph: &'a ClothGraph,
    /// Where each node is drawn to `[node]`.
    pub(crate) anchors: &'a [Point3],
    /// How strongly `[node]`.
    pub(crate) screening: &'a [f32],
    /// The edges that the cloth wants `[edge]`.
    pub(crate) edges: &'a [Vector3],
    /// Largest stretch that edges are pulled back to.
    pub(crate) max_stretch: f32,
}

impl Sweeper<'_> {
    /// Sweeps once over the nodes of a region.
    pub(crate) fn sweep(
        &self,
        positions: &mut [Point3],
        contacts: &[Contact],
        clearances: &[f32],
        region: &Region,
    ) {
        if region.nodes().len() <= BLOCK {
            for &node in region.nodes() {
                let node = node as usize;
                let wanted =
                    self.wanted(node, &positions[node], |other| &positions[other as usize]);
                let relaxed = positions[node] + OVER_RELAXATION * (wanted - positions[node]);
                positions[node] = projected(relaxed, &contacts[node], clearances[node]);
            }
            return;
        }
        let before = positions.to_vec();
        let blocks = positions.par_chunks_mut(BLOCK).enumerate();
        blocks.for_each(|(block, own)| {
            let first = block * BLOCK;
            for index in 0..own.len() {
                let node = first + index;
                if !region.mask()[node] {
                    continue;
                }
                let position_of = |other: u32| {
                    let in_block = (other as usize).wrapping_sub(first);
                    own.get(in_block).unwrap_or(&before[other as usize])
                };
                let wanted = self.wanted(node, &own[index], position_of);
                let relaxed = own[index] + OVER_RELAXATION * (wanted - own[index]);
                own[index] = projected(relaxed, &contacts[node], clearances[node]);
            }
        });
    }

    /// Where the neighbours and the anchor want a node.
    fn wanted<'p>(
        &self,
        node: usize,
        position: &Point3,
        position_of: impl Fn(u32) -> &'p Point3,
    ) -> Point3 {
        let mut sum = self.screening[node] * self.anchors[node].coords;
        let mut total = self.screening[node];
        for half in self.graph.half_edges(node) {
            let other = position_of(half.node);
            let towards = other - position;
            let limit = OVER_STRETCH * half.rest_length;
            let length_squared = towards.norm_squared();
            let excess_squared = length_squared / (limit * limit).max(f32::MIN_POSITIVE);
            if excess_squared > 1.0 {
                let weight = half.weight * excess_squared.min(MAX_STIFFENING);
                let length = self.max_stretch * half.rest_length;
                let edge = towards * (length / length_squared.sqrt());
                sum += weight * (other.coords - edge);
                total += weight;
            } else {
                let edge = half.sign * self.edges[half.edge as usize];
                sum += half.weight * (other.coords - edge);
                total += half.weight;
            }
        }
        if total > 0.0 {
            (sum / total).into()
        } else {
            *position
        }
    }
}

/// The point moved in front of its foreign and then its own skin; between them where they leave
/// too little room.
pub(crate) fn projected(mut point: Point3, contact: &Contact, clearance: f32) -> Point3 {
    if let Some(foreign) = &contact.foreign {
        let lack = clearance - foreign.height(point);
        if lack > 0.0 {
            point += lack * foreign.normal;
        }
    }
    let Some(own) = &contact.own else {
        return point;
    };
    let lack = clearance - own.height(point);
    if lack > 0.0 {
        point += lack * own.normal;
    }
    if let Some(foreign) = &contact.foreign
        && own.normal.dot(&foreign.normal) < OPPOSED_COSINE
    {
        let own_height = own.height(point);
        let foreign_height = foreign.height(point);
        if foreign_height < clearance && own_height < 1.01 * clearance {
            let to_middle = 0.5 * (foreign_height - own_height);
            point += to_middle.max(-0.9 * own_height) * own.normal;
        }
    }
    point
}
