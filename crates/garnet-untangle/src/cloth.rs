//! The cloth while it is being moved.

use garnet_knn::ClosestPoint;
use garnet_mesh::{Point3, Vector3};
use garnet_skin::BoundGarment;
use rayon::prelude::*;

use crate::contact::{Contact, ContactFinder};
use crate::region::Region;
use crate::sweep::{Sweeper, projected};
use crate::way_out::{find_ways_out, way_out};
use crate::{UntangleOptions, UntangleReport};

/// Nodes that one task handles. Results do not depend on it, nor on the number of threads.
const CHUNK: usize = 256;

/// Sweeps between two searches for contacts.
pub(crate) const SWEEPS: usize = 8;

/// What is aimed at beyond the clearance asked for, in metres: rounding must not eat into it.
pub(crate) const CLEARANCE_MARGIN: f32 = 5e-5;

/// Skin this far from a node is no contact yet, beyond the clearance, in metres.
const REACH: f32 = 0.012;

/// A node that moved less than this keeps its contacts, in metres.
const KEEP_DISTANCE: f32 = 5e-4;

/// A search for contacts is the last one if no node moved farther than this since, in metres.
const REST_DISTANCE: f32 = 3e-4;

/// Projections at the end, each onto contacts found anew.
const POLISH_ROUNDS: usize = 8;

/// How much longer a way out of a part of the body may be that leads to the side the cloth belongs
/// to. The first is used, the others to mend what it tears.
pub(crate) const HOME_PREFERENCES: [f32; 2] = [4.0, 1.0];

/// Which contacts are found anew.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Refresh {
    /// Those of nodes that moved far enough to have other ones.
    Moved,
    /// All.
    All,
}

/// What stays while the cloth is moved.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scene<'a> {
    pub(crate) garment: &'a BoundGarment,
    pub(crate) finder: &'a ContactFinder<'a>,
    pub(crate) sweeper: &'a Sweeper<'a>,
    pub(crate) options: &'a UntangleOptions,
}

/// Positions and contacts of all nodes: what the passes change.
#[derive(Debug)]
pub(crate) struct Cloth<'a> {
    pub(crate) scene: Scene<'a>,
    pub(crate) positions: Vec<Point3>,
    pub(crate) contacts: Vec<Contact>,
    /// What each node keeps from the skin: more than asked for where triangles would cross it.
    pub(crate) clearances: Vec<f32>,
    /// How each node leaves parts of the body that it does not belong to.
    pub(crate) ways_out: Vec<Option<Vector3>>,
    /// Nodes that are not lifted because that tears the cloth.
    pub(crate) is_left: Vec<bool>,
    /// How much the side that cloth belongs to is preferred.
    pub(crate) home_preference: f32,
    /// What is counted on the way.
    pub(crate) report: UntangleReport,
}

impl<'a> Cloth<'a> {
    /// The cloth at the sweeper's anchors, with its contacts.
    pub(crate) fn new(scene: Scene<'a>) -> Self {
        let Scene {
            garment,
            finder,
            sweeper,
            options,
        } = scene;
        let num_nodes = sweeper.anchors().len();
        let mut cloth = Self {
            scene,
            positions: sweeper.anchors().to_vec(),
            contacts: Vec::new(),
            clearances: (0..num_nodes)
                .map(|node| goal(finder, options, node))
                .collect(),
            ways_out: vec![None; num_nodes],
            is_left: vec![false; num_nodes],
            home_preference: HOME_PREFERENCES[0],
            report: UntangleReport {
                contact_rounds: 1,
                ..UntangleReport::default()
            },
        };
        let all = Region::all(num_nodes);
        let normals = cloth.normals(&all);
        let find = |(node, normal): (usize, &Vector3)| {
            let hint = garment.skin()[node].face;
            let reach = cloth.clearances[node] + finder.binding.scale * REACH;
            finder.find(node, cloth.positions[node], *normal, reach, hint)
        };
        let nodes = normals.par_iter().with_min_len(CHUNK).enumerate();
        cloth.contacts = nodes.map(|(node, normal)| find((node, normal))).collect();
        let contacts = cloth.contacts.iter().enumerate();
        let contacts = contacts.filter(|&(node, _)| garment.is_cloth(node));
        let depths = contacts.map(|(_, contact)| -contact.distance);
        for depth in depths.filter(|&depth| depth > 0.0) {
            cloth.report.inside_before += 1;
            cloth.report.deepest_before = cloth.report.deepest_before.max(depth);
        }
        cloth.find_ways_out(all.nodes());
        cloth
    }

    /// Normals of the cloth, to its outer side, at the nodes of a region.
    pub(crate) fn normals(&self, region: &Region) -> Vec<Vector3> {
        let faces = self.scene.garment.faces();
        let topology = self.scene.garment.topology();
        let normal = |&node: &u32| {
            let mut sum = Vector3::zeros();
            for &face in topology.vertex_faces(node as usize) {
                let [a, b, c] = faces[face as usize].map(|n| self.positions[n as usize]);
                sum += (b - a).cross(&(c - a));
            }
            let sign = self.scene.finder.binding.orientation[node as usize];
            sign * sum.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
        };
        let nodes = region.nodes().par_iter().with_min_len(CHUNK);
        nodes.map(normal).collect()
    }

    /// Finds the contacts of the nodes of a region anew; false if nothing has moved.
    pub(crate) fn find_contacts(&mut self, region: &Region, refresh: Refresh) -> bool {
        self.report.contact_rounds += 1;
        let scale = self.scene.finder.binding.scale;
        let normals = self.normals(region);
        let find = |(&node, &normal): (&u32, &Vector3)| {
            let node = node as usize;
            let position = self.positions[node];
            let contact = &self.contacts[node];
            let moved = (position - contact.position).norm();
            let spare = contact.distance - self.clearances[node] - scale * REACH;
            if refresh == Refresh::Moved && (moved < scale * KEEP_DISTANCE || moved < spare) {
                return (moved, None);
            }
            let reach = self.clearances[node] + scale * REACH;
            let hint = contact.closest.face;
            (
                moved,
                Some(self.scene.finder.find(node, position, normal, reach, hint)),
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
        farthest > scale * REST_DISTANCE
    }

    /// Lets the nodes of a region go where skin is, and out of it by another way.
    pub(crate) fn forget_contacts(&mut self, region: &Region) {
        for &node in region.nodes() {
            let contact = &mut self.contacts[node as usize];
            contact.own = None;
            contact.foreign = None;
            self.ways_out[node as usize] = None;
        }
    }

    fn find_ways_out(&mut self, found: &[u32]) {
        find_ways_out(
            self.scene.finder,
            self.scene.garment.graph(),
            found,
            &mut self.contacts,
            &self.positions,
            &mut self.ways_out,
            self.home_preference,
        );
    }

    pub(crate) fn sweep(&mut self, times: usize, region: &Region) {
        let layers = &self.scene.finder.binding.layers;
        self.scene.sweeper.sweep(
            times,
            &mut self.positions,
            &self.contacts,
            &self.clearances,
            region,
            layers,
        );
        self.place_followers();
    }

    /// Moves the nodes of a region between their neighbours, in front of the skin.
    pub(crate) fn smooth(&mut self, region: &Region) {
        let graph = self.scene.garment.graph();
        let layers = &self.scene.finder.binding.layers;
        for &node in region.nodes() {
            let node = node as usize;
            if self.contacts[node].is_held || layers.is_follower(node) {
                continue;
            }
            let mut sum = Vector3::zeros();
            let mut total = 0.0;
            for half in graph.half_edges(node) {
                sum += half.weight * self.positions[half.node as usize].coords;
                total += half.weight;
            }
            if total > 0.0 {
                let smooth = Point3::from(sum / total);
                self.positions[node] =
                    projected(smooth, &self.contacts[node], self.clearances[node]);
            }
        }
        self.place_followers();
    }

    /// Puts cloth that lies on other cloth where that has it.
    pub(crate) fn place_followers(&mut self) {
        let layers = &self.scene.finder.binding.layers;
        layers.place(self.scene.garment.faces(), &mut self.positions);
    }

    /// What lengths of a person are multiplied by.
    pub(crate) fn scale(&self) -> f32 {
        self.scene.finder.binding.scale
    }

    /// What a node is to keep from the skin, in metres.
    pub(crate) fn goal(&self, node: usize) -> f32 {
        goal(self.scene.finder, self.scene.options, node)
    }

    /// Projects the nodes of a region that lack clearance until none does, or as often as allowed.
    pub(crate) fn polish(&mut self, region: &Region) {
        let normals = self.normals(region);
        let layers = &self.scene.finder.binding.layers;
        for _ in 0..POLISH_ROUNDS {
            let polished = |(&node, &normal): (&u32, &Vector3)| {
                let node = node as usize;
                if layers.is_follower(node) {
                    return None;
                }
                let goal = self.goal(node);
                let limit = goal - 0.5 * CLEARANCE_MARGIN;
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
        self.place_followers();
    }

    /// The contacts of one node, which leaves foreign parts as its patch did before.
    pub(crate) fn found_on_the_way(
        &self,
        node: usize,
        position: Point3,
        normal: Vector3,
    ) -> Contact {
        let reach = self.clearances[node] + self.scene.finder.binding.scale * REACH;
        let hint = self.contacts[node].closest.face;
        let mut contact = self.scene.finder.find(node, position, normal, reach, hint);
        if contact.foreign_parts > 0 {
            let direction = self.ways_out[node].unwrap_or(contact.home);
            contact.foreign = way_out(self.scene.finder, node, position, direction, &contact);
        }
        contact
    }

    /// The closest skin of a node that is outside the body and its distance. Where the node's last
    /// contacts prove that it keeps the clearance, the distance is a lower bound.
    pub(crate) fn closest_outside(&self, node: usize) -> (ClosestPoint, f32) {
        let contact = &self.contacts[node];
        let moved = (self.positions[node] - contact.position).norm();
        let bound = contact.distance - moved;
        if bound >= self.scene.options.clearance {
            return (contact.closest, bound);
        }
        self.closest(node)
    }

    /// The closest skin of a node and its distance.
    pub(crate) fn closest(&self, node: usize) -> (ClosestPoint, f32) {
        let hint = self.contacts[node].closest.face;
        let closest = self
            .scene
            .finder
            .skin
            .closest_from(self.positions[node], hint);
        (closest, closest.distance_squared.sqrt())
    }

    /// Whether a node is caught where the body runs through itself.
    pub(crate) fn is_trapped(&self, node: usize) -> bool {
        let closest = &self.contacts[node].closest;
        self.scene.finder.traps.holds(closest)
    }
}

/// What a node is to keep from the skin, with room for layers below it, in metres.
fn goal(finder: &ContactFinder<'_>, options: &UntangleOptions, node: usize) -> f32 {
    options.clearance + CLEARANCE_MARGIN + finder.binding.layers.room(node)
}
