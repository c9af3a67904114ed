//! From the warp to cloth that lies outside the skin.

use garnet_mesh::{Point3, Vector3};
use garnet_skin::{BoundGarment, PosedBody};
use rayon::prelude::*;

use crate::contact::{Contact, ContactFinder};
use crate::crossing::{crossing_faces, raise_clearances};
use crate::embedded::EmbeddedSkin;
use crate::relax::{StretchRange, clamped_edges, relaxed, worst_stretch};
use crate::skin_normals::SkinNormals;
use crate::sweep::{Sweeper, projected};
use crate::verify::verified;
use crate::way_out::{find_ways_out, way_out};
use crate::{Binding, UntangleError, UntangleOptions, UntangleReport};

/// Nodes that one task handles. Results do not depend on it, nor on the number of threads.
const CHUNK: usize = 256;

/// The warp is relaxed if an edge is stretched by more than this beyond the largest stretch.
const RELAX_FROM: f32 = 1.05;

/// Steps of relaxation.
const RELAX_STEPS: usize = 3;

/// Sweeps between two searches for contacts.
const SWEEPS: usize = 12;

/// What is aimed at beyond the clearance asked for, in metres: rounding must not eat into it.
const CLEARANCE_MARGIN: f32 = 5e-5;

/// Skin this far from a node is no contact yet, beyond the clearance, in metres.
const REACH: f32 = 0.012;

/// A node that moved less than this keeps its contacts, in metres.
const KEEP_DISTANCE: f32 = 5e-4;

/// Searches for contacts at the end, each followed by a projection.
const POLISH_ROUNDS: usize = 12;

/// Triangles that cross the skin are lifted by at most this, in metres.
const MAX_LIFT: f32 = 0.015;

/// What untangling gives.
#[derive(Debug, Clone)]
pub struct Untangled {
    /// Positions `[node]`, in metres.
    pub positions: Vec<Point3>,
    /// What was found and what is left.
    pub report: UntangleReport,
}

/// Frees a warped garment of penetrations.
///
/// The strain of the warp is relaxed; then nodes are pushed in front of the skin and their
/// neighbours drawn along, so that the displacement is smooth; triangles that still cross the skin
/// are lifted. The result is verified by exact tests.
///
/// # Errors
///
/// [`UntangleError::BodyFaces`] or [`UntangleError::PositionCount`] if the parts do not belong
/// together.
pub fn untangle(
    garment: &BoundGarment,
    binding: &Binding,
    body: &PosedBody,
    warped: &[Point3],
    options: &UntangleOptions,
) -> Result<Untangled, UntangleError> {
    let (found, expected) = (body.skin().faces().len(), garment.rest_skin().faces().len());
    if found != expected {
        return Err(UntangleError::BodyFaces { found, expected });
    }
    let (found, expected) = (warped.len(), garment.rest().len());
    if found != expected {
        return Err(UntangleError::PositionCount { found, expected });
    }
    let embedded = EmbeddedSkin::new(body.skin(), warped)?;
    let skin_normals = SkinNormals::new(body.skin());
    let finder = ContactFinder {
        binding,
        skin: body.skin(),
        embedded: &embedded,
        normals: &skin_normals,
    };
    let anchors = relaxed_warp(garment, binding, warped, options);
    let graph = garment.graph();
    let range = StretchRange {
        min: options.min_stretch,
        max: options.max_stretch,
    };
    let edges = clamped_edges(graph, &anchors, range);
    let strength = 1.0 / (options.push_length * options.push_length);
    let screening: Vec<f32> = graph.node_areas().iter().map(|a| a * strength).collect();
    let sweeper = Sweeper {
        graph,
        anchors: &anchors,
        screening: &screening,
        edges: &edges,
        max_stretch: options.max_stretch,
    };
    let mut cloth = Cloth::new(garment, &finder, &sweeper, options);
    for _ in 0..options.contact_rounds {
        cloth.find_contacts();
        cloth.sweep(SWEEPS);
    }
    cloth.polish();
    let mut garment_surface = binding.surface.moved(cloth.positions.clone())?;
    let mut crossing = crossing_faces(&garment_surface, body.skin());
    for _ in 0..options.crossing_rounds {
        if !cloth.lift(&crossing) {
            break;
        }
        cloth.polish();
        garment_surface.refit(&cloth.positions)?;
        crossing = crossing_faces(&garment_surface, body.skin());
    }
    let report = verified(garment, &finder, warped, &cloth, &crossing);
    Ok(Untangled {
        positions: cloth.positions,
        report,
    })
}

/// The warp, with its strain relaxed if it has too much.
fn relaxed_warp(
    garment: &BoundGarment,
    binding: &Binding,
    warped: &[Point3],
    options: &UntangleOptions,
) -> Vec<Point3> {
    let mut positions = warped.to_vec();
    if worst_stretch(garment.graph(), warped) < RELAX_FROM * options.max_stretch {
        return positions;
    }
    let range = StretchRange {
        min: options.min_stretch,
        max: options.max_stretch,
    };
    for _ in 0..RELAX_STEPS {
        let system = &binding.relax_system;
        positions = relaxed(garment.graph(), system, warped, &positions, range);
    }
    positions
}

/// The cloth while it is being moved.
pub(crate) struct Cloth<'a> {
    garment: &'a BoundGarment,
    finder: &'a ContactFinder<'a>,
    sweeper: &'a Sweeper<'a>,
    pub(crate) options: &'a UntangleOptions,
    pub(crate) positions: Vec<Point3>,
    pub(crate) contacts: Vec<Contact>,
    pub(crate) contact_rounds: usize,
    pub(crate) crossing_rounds: usize,
    clearances: Vec<f32>,
    is_free: Vec<bool>,
    ways_out: Vec<Option<Vector3>>,
}

impl<'a> Cloth<'a> {
    fn new(
        garment: &'a BoundGarment,
        finder: &'a ContactFinder<'a>,
        sweeper: &'a Sweeper<'a>,
        options: &'a UntangleOptions,
    ) -> Self {
        let num_nodes = sweeper.anchors.len();
        Self {
            garment,
            finder,
            sweeper,
            options,
            positions: sweeper.anchors.to_vec(),
            contacts: Vec::new(),
            contact_rounds: 0,
            crossing_rounds: 0,
            clearances: vec![options.clearance + CLEARANCE_MARGIN; num_nodes],
            is_free: vec![true; num_nodes],
            ways_out: vec![None; num_nodes],
        }
    }

    fn normals(&self) -> Vec<Vector3> {
        let faces = self.garment.faces();
        let topology = self.garment.topology();
        let normal = |node: usize| {
            let mut sum = Vector3::zeros();
            for &face in topology.vertex_faces(node) {
                let [a, b, c] = faces[face as usize].map(|n| self.positions[n as usize]);
                sum += (b - a).cross(&(c - a));
            }
            let sign = self.finder.binding.orientation[node];
            sign * sum.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
        };
        let nodes = 0..self.positions.len();
        nodes.into_par_iter().with_min_len(CHUNK).map(normal).collect()
    }

    /// Finds the contacts anew of all nodes that may have other ones.
    fn find_contacts(&mut self) {
        self.contact_rounds += 1;
        let normals = self.normals();
        let contacts = &self.contacts;
        let found = |node: usize| {
            let position = self.positions[node];
            let hint = match contacts.get(node) {
                Some(contact) => {
                    let moved = (position - contact.position).norm();
                    let spare = contact.distance - self.clearances[node] - REACH;
                    if moved < KEEP_DISTANCE || moved < spare {
                        return *contact;
                    }
                    contact.closest.face
                }
                None => self.garment.skin()[node].face,
            };
            let reach = self.clearances[node] + REACH;
            self.finder.find(node, position, normals[node], reach, hint)
        };
        self.contacts = (0..self.positions.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(found)
            .collect();
        find_ways_out(
            self.finder,
            self.garment.graph(),
            &mut self.contacts,
            &self.positions,
            &mut self.ways_out,
        );
    }

    fn sweep(&mut self, times: usize) {
        for _ in 0..times {
            self.positions = self.sweeper.sweep(
                &self.positions,
                &self.contacts,
                &self.clearances,
                &self.is_free,
            );
        }
    }

    /// Projects the nodes that lack clearance until none does, or as often as allowed.
    fn polish(&mut self) {
        for _ in 0..POLISH_ROUNDS {
            let normals = self.normals();
            let limit = self.options.clearance + 0.5 * CLEARANCE_MARGIN;
            let polished = |node: usize| {
                let contact = &self.contacts[node];
                let position = self.positions[node];
                let moved = (position - contact.position).norm();
                if moved < contact.distance - limit {
                    return None;
                }
                let reach = self.clearances[node] + REACH;
                let hint = contact.closest.face;
                let mut contact = self.finder.find(node, position, normals[node], reach, hint);
                if contact.foreign_parts > 0 {
                    let direction = self.ways_out[node].unwrap_or(contact.home);
                    contact.foreign = way_out(self.finder, position, direction, contact.own_parts);
                }
                let goal = self.options.clearance + CLEARANCE_MARGIN;
                Some((contact, projected(position, &contact, goal)))
            };
            let results: Vec<Option<(Contact, Point3)>> = (0..self.positions.len())
                .into_par_iter()
                .with_min_len(CHUNK)
                .map(polished)
                .collect();
            let mut largest = 0.0_f32;
            for (node, result) in results.into_iter().enumerate() {
                if let Some((contact, position)) = result {
                    largest = largest.max((position - self.positions[node]).norm());
                    self.contacts[node] = contact;
                    self.positions[node] = position;
                }
            }
            if largest < 0.2 * CLEARANCE_MARGIN {
                break;
            }
        }
    }

    /// Lifts the corners of crossing faces that are not trapped; false if there are none.
    fn lift(&mut self, crossing: &[u32]) -> bool {
        let faces = self.garment.faces();
        let is_trapped = |&node: &u32| self.is_trapped(node as usize);
        let free: Vec<[u32; 3]> = crossing
            .iter()
            .map(|&face| faces[face as usize])
            .filter(|corners| !corners.iter().any(is_trapped))
            .collect();
        if free.is_empty() {
            return false;
        }
        self.crossing_rounds += 1;
        let normals = self.normals();
        let limit = self.options.clearance + MAX_LIFT;
        raise_clearances(
            self.finder,
            &free,
            &self.positions,
            &normals,
            &self.contacts,
            &mut self.clearances,
            limit,
        );
        for _ in 0..2 {
            self.find_contacts();
            self.sweep(SWEEPS / 2);
        }
        true
    }

    /// Whether a node is caught where the body runs through itself.
    pub(crate) fn is_trapped(&self, node: usize) -> bool {
        let closest = &self.contacts[node].closest;
        self.finder.embedded.is_trap(closest.face, closest.point)
    }
}
