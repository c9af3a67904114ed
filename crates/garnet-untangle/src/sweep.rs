//! Moving the cloth: each node to where its neighbours want it, then in front of the skin.
//!
//! A sweep is one step of projected Gauss-Seidel for: least squared deviation of the edges from
//! those of the relaxed warp, held by a screening, under the half spaces of the contacts. Small
//! regions are swept in place. Of large ones, blocks of nodes are, and see the other blocks as they
//! were before the sweep, so that the result does not depend on the number of threads.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use garnet_mesh::{Point3, Vector3};
use garnet_skin::{ClothGraph, HalfEdge};
use rayon::prelude::*;

use crate::UntangleOptions;
use crate::contact::{Contact, OPPOSED_COSINE};
use crate::layers::Layers;
use crate::passes::{StretchRange, clamped_edges};
use crate::region::Region;

/// Nodes of a block.
const BLOCK: usize = 1024;

/// Nodes that one task prepares.
const CHUNK: usize = 1024;

/// Edges stretched beyond this are pulled together instead of kept as in the warp.
const OVER_STRETCH: f32 = 1.2;

/// Overstretched edges pull the harder the longer they are, up to this many times.
const MAX_STIFFENING: f32 = 4.0;

/// A node rests while neither it nor a neighbour moves farther than this in a sweep, in metres.
const REST_STEP: f32 = 1e-5;

/// The part of the problem that stays while the nodes move.
#[derive(Debug)]
pub(crate) struct Sweeper<'a> {
    graph: &'a ClothGraph,
    /// Where each node is drawn to `[node]`.
    anchors: &'a [Point3],
    /// How strongly `[node]`.
    screening: Vec<f32>,
    /// The half edges of the graph `[half edge]`.
    pulls: Vec<Pull>,
    /// Largest stretch that edges are pulled back to, over what counts as overstretched.
    stretch_back: f32,
}

/// How one neighbour pulls a node.
#[derive(Debug, Clone, Copy)]
struct Pull {
    node: u32,
    weight: f32,
    /// Length beyond which the edge is overstretched, in metres.
    limit: f32,
    /// The edge to the neighbour that the cloth wants.
    edge: Vector3,
}

impl<'a> Sweeper<'a> {
    /// Draws nodes to `anchors`, each by its area over the square of the length over which pushes
    /// die out, and keeps the edges at the anchors, brought into the range of stretch; edges that
    /// are overstretched are pulled back to its upper end.
    pub(crate) fn new(
        graph: &'a ClothGraph,
        anchors: &'a [Point3],
        options: &UntangleOptions,
    ) -> Self {
        let edges = clamped_edges(graph, anchors, StretchRange::of(options));
        let strength = 1.0 / (options.push_length * options.push_length);
        let pull = |half: &HalfEdge| Pull {
            node: half.node,
            weight: half.weight,
            limit: OVER_STRETCH * half.rest_length,
            edge: half.sign * edges[half.edge as usize],
        };
        let halves = graph.all_half_edges().par_iter().with_min_len(CHUNK);
        Self {
            graph,
            anchors,
            screening: graph.node_areas().iter().map(|a| a * strength).collect(),
            pulls: halves.map(pull).collect(),
            stretch_back: options.max_stretch / OVER_STRETCH,
        }
    }

    /// Where each node is drawn to `[node]`.
    pub(crate) fn anchors(&self) -> &'a [Point3] {
        self.anchors
    }

    /// Sweeps over the nodes of a region; after the first sweep over those that have not come to
    /// rest.
    pub(crate) fn sweep(
        &self,
        times: usize,
        positions: &mut [Point3],
        contacts: &[Contact],
        clearances: &[f32],
        region: &Region,
        layers: &Layers,
    ) {
        let flags = || positions.iter().map(|_| AtomicBool::new(false)).collect();
        let is_awake: [Vec<AtomicBool>; 2] = [flags(), flags()];
        for &node in region.nodes() {
            is_awake[0][node as usize].store(true, Relaxed);
        }
        for time in 0..times {
            let (now, next) = (&is_awake[time % 2], &is_awake[(time + 1) % 2]);
            let settle = |node: usize, from: Point3, wanted: Point3| {
                now[node].store(false, Relaxed);
                if contacts[node].is_held || layers.is_follower(node) {
                    return from;
                }
                let to = projected(wanted, &contacts[node], clearances[node]);
                if (to - from).norm_squared() > REST_STEP * REST_STEP {
                    next[node].store(true, Relaxed);
                    for half in self.graph.half_edges(node) {
                        next[half.node as usize].store(true, Relaxed);
                    }
                }
                to
            };
            if region.nodes().len() <= BLOCK {
                for &node in region.nodes() {
                    let node = node as usize;
                    if now[node].load(Relaxed) {
                        let from = positions[node];
                        let wanted = self.wanted(node, from, |other| positions[other as usize]);
                        positions[node] = settle(node, from, wanted);
                    }
                }
                continue;
            }
            let before = positions.to_vec();
            let blocks = positions.par_chunks_mut(BLOCK).enumerate();
            blocks.for_each(|(block, own)| {
                let first = block * BLOCK;
                for index in 0..own.len() {
                    let node = first + index;
                    if now[node].load(Relaxed) && region.mask()[node] {
                        let position_of = |other: u32| {
                            let in_block = (other as usize).wrapping_sub(first);
                            *own.get(in_block).unwrap_or(&before[other as usize])
                        };
                        let wanted = self.wanted(node, own[index], position_of);
                        own[index] = settle(node, own[index], wanted);
                    }
                }
            });
        }
    }

    /// Where the neighbours and the anchor want a node.
    pub(crate) fn wanted_of(&self, node: usize, positions: &[Point3]) -> Point3 {
        self.wanted(node, positions[node], |other| positions[other as usize])
    }

    #[inline]
    fn wanted(&self, node: usize, position: Point3, position_of: impl Fn(u32) -> Point3) -> Point3 {
        let mut sum = self.screening[node] * self.anchors[node].coords;
        let mut total = self.screening[node];
        let [start, end] = [node, node + 1].map(|index| self.graph.starts()[index] as usize);
        for pull in &self.pulls[start..end] {
            let other = position_of(pull.node);
            let towards = other - position;
            let length_squared = towards.norm_squared();
            let limit_squared = pull.limit * pull.limit;
            if length_squared > limit_squared {
                let excess_squared = length_squared / limit_squared.max(f32::MIN_POSITIVE);
                let weight = pull.weight * excess_squared.min(MAX_STIFFENING);
                let length = self.stretch_back * pull.limit;
                let edge = towards * (length / length_squared.sqrt());
                sum += weight * (other.coords - edge);
                total += weight;
            } else {
                sum += pull.weight * (other.coords - pull.edge);
                total += pull.weight;
            }
        }
        if total > 0.0 {
            (sum / total).into()
        } else {
            position
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
