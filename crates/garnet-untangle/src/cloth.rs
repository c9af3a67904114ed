//! The cloth while it is being moved.

use garnet_knn::{ClosestPoint, Surface};
use garnet_mesh::{Point3, Vector3};
use garnet_skin::BoundGarment;
use rayon::prelude::*;

use crate::contact::{Contact, ContactFinder};
use crate::crossing::{crossing_faces, raise_clearances};
use crate::region::{Region, rings_of};
use crate::rescue::free_places;
use crate::sweep::{Sweeper, projected};
use crate::way_out::{find_ways_out, way_out};
use crate::{UntangleError, UntangleOptions};

/// Nodes that one task handles. Results do not depend on it, nor on the number of threads.
const CHUNK: usize = 256;

/// Sweeps between two searches for contacts.
const SWEEPS: usize = 8;

/// Searches for contacts while crossing faces are lifted once.
const LIFT_SEARCHES: usize = 2;

/// Cloth this far from a crossing face may move while the face is lifted, in metres.
const LIFT_RADIUS: f32 = 0.03;

/// What is aimed at beyond the clearance asked for, in metres: rounding must not eat into it.
const CLEARANCE_MARGIN: f32 = 5e-5;

/// Skin this far from a node is no contact yet, beyond the clearance, in metres.
const REACH: f32 = 0.012;

/// A node that moved less than this keeps its contacts, in metres.
const KEEP_DISTANCE: f32 = 5e-4;

/// A search for contacts is the last one if no node moved farther than this since, in metres.
const REST_DISTANCE: f32 = 3e-4;

/// Projections at the end, each onto contacts found anew.
const POLISH_ROUNDS: usize = 12;

/// Edges stretched more than this count as torn apart.
const TORN_STRETCH: f32 = 2.0;

/// Lifting must not add more than this to the stretch beyond that, summed over torn edges.
const MAX_ADDED_EXCESS: f32 = 0.5;

/// Cloth this far from a torn edge is mended, in metres.
const MEND_RADIUS: f32 = 0.04;

/// How much longer a way out of a part of the body may be that leads to the side the cloth belongs
/// to. The first is used, the others to mend what it tears.
const HOME_PREFERENCES: [f32; 3] = [4.0, 1.0, 0.25];

/// Sweeps that bring torn cloth together.
const MEND_SWEEPS: usize = 24;

/// Searches for contacts after that.
const MEND_SEARCHES: usize = 4;

/// Lifting ends when this many rounds did not lessen the number of crossing faces.
const IDLE_ROUNDS: usize = 2;

/// Triangles that cross the skin are lifted by at most this, in metres.
const MAX_LIFT: f32 = 0.015;

/// Which contacts are found anew.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Refresh {
    /// Those of nodes that moved far enough to have other ones.
    Moved,
    /// All.
    All,
}

/// Edges that are torn apart.
#[derive(Debug, Default)]
struct Tears {
    /// Their ends.
    nodes: Vec<u32>,
    /// The sum of their stretch beyond what counts as torn.
    excess: f32,
}

/// Positions and contacts of all nodes.
#[derive(Debug)]
pub(crate) struct Cloth<'a> {
    garment: &'a BoundGarment,
    finder: &'a ContactFinder<'a>,
    sweeper: &'a Sweeper<'a>,
    pub(crate) options: &'a UntangleOptions,
    pub(crate) positions: Vec<Point3>,
    pub(crate) contacts: Vec<Contact>,
    /// How many nodes were inside the body at the anchors, and how deep the deepest, in metres.
    pub(crate) inside_before: (usize, f32),
    pub(crate) contact_rounds: usize,
    pub(crate) crossing_rounds: usize,
    /// What each node keeps from the skin: more than asked for where triangles would cross it.
    clearances: Vec<f32>,
    /// How each node leaves parts of the body that it does not belong to.
    ways_out: Vec<Option<Vector3>>,
    /// Nodes that are not lifted because that tears the cloth.
    is_left: Vec<bool>,
    /// How much the side that cloth belongs to is preferred.
    home_preference: f32,
}

impl<'a> Cloth<'a> {
    /// The cloth at the sweeper's anchors, with its contacts.
    pub(crate) fn new(
        garment: &'a BoundGarment,
        finder: &'a ContactFinder<'a>,
        sweeper: &'a Sweeper<'a>,
        options: &'a UntangleOptions,
    ) -> Self {
        let num_nodes = sweeper.anchors.len();
        let mut cloth = Self {
            garment,
            finder,
            sweeper,
            options,
            positions: sweeper.anchors.to_vec(),
            contacts: Vec::new(),
            inside_before: (0, 0.0),
            contact_rounds: 1,
            crossing_rounds: 0,
            clearances: vec![options.clearance + CLEARANCE_MARGIN; num_nodes],
            ways_out: vec![None; num_nodes],
            is_left: vec![false; num_nodes],
            home_preference: HOME_PREFERENCES[0],
        };
        let all = Region::all(num_nodes);
        let normals = cloth.normals(&all);
        let find = |(node, normal): (usize, &Vector3)| {
            let hint = garment.skin()[node].face;
            let reach = cloth.clearances[node] + REACH;
            finder.find(node, cloth.positions[node], *normal, reach, hint)
        };
        let nodes = normals.par_iter().with_min_len(CHUNK).enumerate();
        cloth.contacts = nodes.map(|(node, normal)| find((node, normal))).collect();
        let depths = cloth.contacts.iter().map(|contact| -contact.distance);
        let inside = depths.filter(|&depth| depth > 0.0);
        cloth.inside_before = inside.fold((0, 0.0), |(count, deepest), depth| {
            (count + 1, depth.max(deepest))
        });
        cloth.find_ways_out(all.nodes());
        cloth
    }

    /// Pushes all nodes in front of the skin, drawing the cloth around them along.
    pub(crate) fn push_out(&mut self) {
        let graph = self.garment.graph();
        let lacks = |node: &u32| {
            let contact = &self.contacts[*node as usize];
            contact.foreign_parts > 0 || contact.distance < self.clearances[*node as usize]
        };
        let lacking = (0..self.positions.len() as u32).filter(lacks);
        let rings = rings_of(graph, self.options.push_length);
        let region = Region::around(graph, lacking, rings);
        for round in 0..self.options.contact_rounds {
            if round > 0 && !self.find_contacts(&region, Refresh::Moved) {
                break;
            }
            self.sweep(SWEEPS, &region);
        }
        self.polish(&region);
    }

    /// Starts again where the cloth was torn apart: nodes that went round a part of the body on
    /// different sides come together without regard to the skin, and leave it on one side. False if
    /// there is nothing to mend or it does not help.
    pub(crate) fn mend(&mut self) -> bool {
        let mut tears = self.tears();
        let mut is_mended = false;
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
                is_mended = true;
            } else {
                (self.positions, self.contacts) = kept;
            }
        }
        self.home_preference = HOME_PREFERENCES[0];
        is_mended
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
    fn tears(&self) -> Tears {
        let graph = self.garment.graph();
        let edges = graph.edges()[..graph.num_cloth_edges()].iter();
        let mut tears = Tears::default();
        for (&[a, b], rest_length) in edges.zip(graph.rest_lengths()) {
            let edge = self.positions[b as usize] - self.positions[a as usize];
            let is_torn = edge.norm_squared() > (TORN_STRETCH * rest_length).powi(2);
            if is_torn && !self.is_trapped(a as usize) && !self.is_trapped(b as usize) {
                let rest_length = rest_length.max(f32::MIN_POSITIVE);
                tears.excess += edge.norm() / rest_length - TORN_STRETCH;
                tears.nodes.extend([a, b]);
            }
        }
        tears.nodes.sort_unstable();
        tears.nodes.dedup();
        tears
    }

    /// Lifts cloth whose triangles cross the skin; returns the faces that still do.
    pub(crate) fn lift_crossing_faces(&mut self) -> Result<Vec<u32>, UntangleError> {
        let mut surface = self.finder.binding.surface.moved(self.positions.clone())?;
        let mut crossing = crossing_faces(&surface, self.finder.skin);
        let mut fewest = usize::MAX;
        let mut idle_rounds = 0;
        for _ in 0..self.options.crossing_rounds {
            let free = self.free_faces(&crossing);
            idle_rounds = if free.len() < fewest {
                0
            } else {
                idle_rounds + 1
            };
            fewest = fewest.min(free.len());
            if free.is_empty() || idle_rounds == IDLE_ROUNDS {
                break;
            }
            if let Some(region) = self.lift_or_leave(&free) {
                crossing = self.crossing_near(&mut surface, region.nodes(), crossing)?;
            }
        }
        let moved = self.rescue();
        if !moved.is_empty() {
            crossing = self.crossing_near(&mut surface, &moved, crossing)?;
        }
        Ok(crossing)
    }

    /// The faces that cross the skin, after `moved` nodes were moved: tests their faces and those
    /// that crossed before.
    fn crossing_near(
        &self,
        surface: &mut Surface,
        moved: &[u32],
        mut candidates: Vec<u32>,
    ) -> Result<Vec<u32>, UntangleError> {
        surface.refit(&self.positions)?;
        let topology = self.garment.topology();
        for &node in moved {
            candidates.extend_from_slice(topology.vertex_faces(node as usize));
        }
        candidates.sort_unstable();
        candidates.dedup();
        let pairs = surface.faces_crossing(self.finder.skin, &candidates);
        let mut crossing: Vec<u32> = pairs.into_iter().map(|[face, _]| face).collect();
        crossing.dedup();
        Ok(crossing)
    }

    /// Moves single nodes that are left inside the body or too near to it to the nearest free
    /// place; returns those that found one.
    fn rescue(&mut self) -> Vec<u32> {
        let lacks = |&node: &u32| {
            let node = node as usize;
            let position = self.positions[node];
            let contact = &self.contacts[node];
            let moved = (position - contact.position).norm();
            if moved < contact.distance - self.options.clearance || self.is_trapped(node) {
                return false;
            }
            let closest = self
                .finder
                .skin
                .closest_from(position, contact.closest.face);
            closest.distance_squared < self.options.clearance.powi(2)
                || self.finder.winding(position) > 0
        };
        let nodes = 0..self.positions.len() as u32;
        let lacking: Vec<u32> = nodes.filter(lacks).collect();
        let goal = self.options.clearance + 0.5 * CLEARANCE_MARGIN;
        let places = free_places(
            self.finder,
            self.garment.graph(),
            &lacking,
            &self.positions,
            &self.contacts,
            goal,
        );
        let mut moved = Vec::new();
        for (node, place) in lacking.into_iter().zip(places) {
            if let Some(place) = place {
                let normal = self.contacts[node as usize].home;
                self.positions[node as usize] = place;
                self.contacts[node as usize] = self.found_on_the_way(node as usize, place, normal);
                moved.push(node);
            }
        }
        moved
    }

    /// The corners of those faces that have no corner that is trapped or left as it is.
    fn free_faces(&self, crossing: &[u32]) -> Vec<[u32; 3]> {
        let faces = self.garment.faces();
        let is_stuck = |&node: &u32| self.is_trapped(node as usize) || self.is_left[node as usize];
        let corners = crossing.iter().map(|&face| faces[face as usize]);
        corners
            .filter(|corners| !corners.iter().any(is_stuck))
            .collect()
    }

    /// Lifts the corners of crossing faces, unless that tears the cloth: then it stays as it was, and
    /// is not lifted there again.
    fn lift_or_leave(&mut self, free: &[[u32; 3]]) -> Option<Region> {
        let before = self.tears();
        let kept = (
            self.positions.clone(),
            self.contacts.clone(),
            self.clearances.clone(),
        );
        let region = self.lift(free);
        let after = self.tears();
        if after.excess <= before.excess + MAX_ADDED_EXCESS {
            return Some(region);
        }
        (self.positions, self.contacts, self.clearances) = kept;
        let graph = self.garment.graph();
        let rings = rings_of(graph, LIFT_RADIUS).max(2);
        for &node in Region::around(graph, after.nodes, rings).nodes() {
            self.is_left[node as usize] = true;
        }
        None
    }

    /// Lifts the corners of crossing faces; returns the part of the cloth that may have moved.
    fn lift(&mut self, free: &[[u32; 3]]) -> Region {
        self.crossing_rounds += 1;
        let graph = self.garment.graph();
        let rings = rings_of(graph, LIFT_RADIUS).max(2);
        let region = Region::around(graph, free.iter().flatten().copied(), rings);
        let normals = self.normals(&region);
        raise_clearances(
            self.finder,
            free,
            &self.positions,
            |node| normals[region.index_of(node)],
            &self.contacts,
            &mut self.clearances,
            self.options.clearance + MAX_LIFT,
        );
        for _ in 0..LIFT_SEARCHES {
            self.find_contacts(&region, Refresh::Moved);
            self.sweep(SWEEPS / 2, &region);
        }
        self.polish(&region);
        region
    }

    /// Normals of the cloth, to its outer side, at the nodes of a region.
    fn normals(&self, region: &Region) -> Vec<Vector3> {
        let faces = self.garment.faces();
        let topology = self.garment.topology();
        let normal = |&node: &u32| {
            let mut sum = Vector3::zeros();
            for &face in topology.vertex_faces(node as usize) {
                let [a, b, c] = faces[face as usize].map(|n| self.positions[n as usize]);
                sum += (b - a).cross(&(c - a));
            }
            let sign = self.finder.binding.orientation[node as usize];
            sign * sum.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
        };
        let nodes = region.nodes().par_iter().with_min_len(CHUNK);
        nodes.map(normal).collect()
    }

    /// Finds the contacts of the nodes of a region anew; false if nothing has moved.
    fn find_contacts(&mut self, region: &Region, refresh: Refresh) -> bool {
        self.contact_rounds += 1;
        let normals = self.normals(region);
        let find = |(&node, &normal): (&u32, &Vector3)| {
            let node = node as usize;
            let position = self.positions[node];
            let contact = &self.contacts[node];
            let moved = (position - contact.position).norm();
            let spare = contact.distance - self.clearances[node] - REACH;
            if refresh == Refresh::Moved && (moved < KEEP_DISTANCE || moved < spare) {
                return (moved, None);
            }
            let reach = self.clearances[node] + REACH;
            let hint = contact.closest.face;
            (
                moved,
                Some(self.finder.find(node, position, normal, reach, hint)),
            )
        };
        let nodes = region.nodes().par_iter().zip(&normals).with_min_len(CHUNK);
        let results: Vec<(f32, Option<Contact>)> = nodes.map(find).collect();
        let mut farthest = 0.0_f32;
        let mut found = Vec::new();
        for (&node, (moved, contact)) in region.nodes().iter().zip(results) {
            farthest = farthest.max(moved);
            if let Some(contact) = contact {
                self.contacts[node as usize] = contact;
                found.push(node);
            }
        }
        self.find_ways_out(&found);
        farthest > REST_DISTANCE
    }

    fn find_ways_out(&mut self, found: &[u32]) {
        find_ways_out(
            self.finder,
            self.garment.graph(),
            found,
            &mut self.contacts,
            &self.positions,
            &mut self.ways_out,
            self.home_preference,
        );
    }

    fn sweep(&mut self, times: usize, region: &Region) {
        for _ in 0..times {
            self.positions = self.sweeper.sweep(
                &self.positions,
                &self.contacts,
                &self.clearances,
                region.mask(),
            );
        }
    }

    /// Projects the nodes of a region that lack clearance until none does, or as often as allowed.
    fn polish(&mut self, region: &Region) {
        let normals = self.normals(region);
        let limit = self.options.clearance + 0.5 * CLEARANCE_MARGIN;
        let goal = self.options.clearance + CLEARANCE_MARGIN;
        for _ in 0..POLISH_ROUNDS {
            let polished = |(&node, &normal): (&u32, &Vector3)| {
                let node = node as usize;
                let contact = &self.contacts[node];
                let position = self.positions[node];
                let moved = (position - contact.position).norm();
                if moved < contact.distance - limit {
                    return None;
                }
                let contact = if moved > 0.0 {
                    self.found_on_the_way(node, position, normal)
                } else {
                    *contact
                };
                let projected = projected(position, &contact, goal);
                (moved > 0.0 || projected != position).then_some((contact, projected))
            };
            let nodes = region.nodes().par_iter().zip(&normals).with_min_len(CHUNK);
            let results: Vec<Option<(Contact, Point3)>> = nodes.map(polished).collect();
            let mut largest = 0.0_f32;
            for (&node, result) in region.nodes().iter().zip(results) {
                if let Some((contact, position)) = result {
                    let node = node as usize;
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

    /// The contacts of one node, which leaves foreign parts as its patch did before.
    fn found_on_the_way(&self, node: usize, position: Point3, normal: Vector3) -> Contact {
        let reach = self.clearances[node] + REACH;
        let hint = self.contacts[node].closest.face;
        let mut contact = self.finder.find(node, position, normal, reach, hint);
        if contact.foreign_parts > 0 {
            let direction = self.ways_out[node].unwrap_or(contact.home);
            contact.foreign = way_out(self.finder, position, direction, &contact);
        }
        contact
    }

    /// The closest skin of a node and its distance. Where the node's last contacts prove that it
    /// keeps the clearance, the distance is a lower bound.
    pub(crate) fn closest(&self, node: usize) -> (ClosestPoint, f32) {
        let contact = &self.contacts[node];
        let moved = (self.positions[node] - contact.position).norm();
        let bound = contact.distance - moved;
        if bound >= self.options.clearance {
            return (contact.closest, bound);
        }
        let hint = contact.closest.face;
        let closest = self.finder.skin.closest_from(self.positions[node], hint);
        (closest, closest.distance_squared.sqrt())
    }

    /// Whether a node is caught where the body runs through itself.
    fn is_trapped(&self, node: usize) -> bool {
        let closest = &self.contacts[node].closest;
        self.finder.embedded.is_trap(closest.face, closest.point)
    }
}
