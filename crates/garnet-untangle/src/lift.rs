//! Lifting cloth whose triangles cross the skin though their corners are outside.

use garnet_knn::Surface;

use crate::UntangleError;
use crate::cloth::{CLEARANCE_MARGIN, Cloth, Refresh, SWEEPS};
use crate::crossing::{crossing_faces, raise_clearances};
use crate::region::{Region, rings_of};
use crate::rescue::free_places;
use crate::verify::inside;

/// Searches for contacts while crossing faces are lifted once.
const LIFT_SEARCHES: usize = 2;

/// Cloth this far from a crossing face may move while the face is lifted, in metres.
const LIFT_RADIUS: f32 = 0.03;

/// Lifting must not add more than this to the stretch beyond that, summed over torn edges.
const MAX_ADDED_EXCESS: f32 = 0.5;

/// Triangles that cross the skin are lifted by at most this, in metres.
const MAX_LIFT: f32 = 0.015;

impl Cloth<'_> {
    /// Lifts cloth whose triangles cross the skin; returns the faces that still do, and the
    /// surface of the cloth.
    pub(crate) fn lift_crossing_faces(&mut self) -> Result<(Surface, Vec<u32>), UntangleError> {
        let mut surface = self.finder.binding.surface.moved(self.positions.clone())?;
        let mut crossing = crossing_faces(&surface, self.finder.skin);
        let mut fewest = usize::MAX;
        for _ in 0..self.options.crossing_rounds {
            let free = self.free_faces(&crossing);
            // None are left, or the last round did not lessen them.
            if free.is_empty() || free.len() >= fewest {
                break;
            }
            fewest = free.len();
            if let Some(region) = self.lift_or_leave(&free) {
                crossing = self.crossing_near(&mut surface, region.nodes(), crossing)?;
            }
        }
        Ok((surface, crossing))
    }

    /// Moves single nodes that are left inside the body or too near to it to free places, and draws
    /// the cloth along; returns the faces that cross the skin after that.
    pub(crate) fn rescue_lacking(
        &mut self,
        mut surface: Surface,
        crossing: Vec<u32>,
    ) -> Result<Vec<u32>, UntangleError> {
        let mut moved = self.rescue(&crossing);
        moved.extend(self.ease());
        moved.extend(self.give_in());
        if moved.is_empty() {
            return Ok(crossing);
        }
        self.crossing_near(&mut surface, &moved, crossing)
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
    fn rescue(&mut self, crossing: &[u32]) -> Vec<u32> {
        let is_inside = inside(self.garment, self.finder.skin, &self.positions, crossing);
        let lacks = |&node: &u32| {
            let node = node as usize;
            let position = self.positions[node];
            let contact = &self.contacts[node];
            let moved = (position - contact.position).norm();
            let is_clear = moved < contact.distance - self.options.clearance;
            // Cloth that a simulation has put between two walls stays there.
            let is_squeezed = self.options.keeps_sides && contact.is_between();
            if (is_clear || is_squeezed) && !is_inside[node] {
                return false;
            }
            let hint = contact.closest.face;
            let closest = self.finder.skin.closest_from(position, hint);
            let is_near = closest.distance_squared < self.options.clearance.powi(2);
            let is_trapped = self.finder.embedded.is_trap(&closest);
            (is_inside[node] || is_near) && !is_trapped
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
}
