//! The last resort for single nodes that projection left inside the body or too near to it.
//!
//! Where two parts of the body meet, the half spaces of their skins may have no point in common
//! near the node though there is room a little farther on. The nodes left, a handful if any, look
//! around for the nearest free place.

use garnet_mesh::{Point3, Vector3};
use garnet_skin::ClothGraph;
use rayon::prelude::*;

use crate::cloth::{CLEARANCE_MARGIN, Cloth};
use crate::contact::{Contact, ContactFinder};
use crate::crossing::Crossing;
use crate::directions::all_round;
use crate::passes::verify::inside;

/// A node inside the body moves by at most this, in metres. Farther ones find more places, among
/// them such on the wrong side of a limb.
const INSIDE_RADIUS: f32 = 0.06;

/// A node outside, but too near to the skin, moves by at most this, in metres: it is better too
/// near than far from its neighbours.
const NEAR_RADIUS: f32 = 0.012;

/// Steps along each direction are no shorter than this, in metres. Longer ones are faster and step
/// over narrow gaps.
const MIN_STEP: f32 = 5e-4;

/// Edges may be stretched this much by the move before it counts as longer than it is.
const FREE_STRETCH: f32 = 1.5;

/// A place that stretches an edge by its rest length more than that counts as this much farther, in
/// metres. Higher keeps nodes nearer to their neighbours than to where they were.
const STRETCH_COST: f32 = 0.03;

/// Moves single nodes that are left inside the body or too near to it to the nearest free
/// place, of those that may move; returns those that found one.
pub(crate) fn rescue(
    cloth: &mut Cloth<'_>,
    crossing: &Crossing,
    may_move: impl Fn(usize) -> bool,
) -> Vec<u32> {
    let is_inside = inside(
        cloth.scene.garment,
        cloth.scene.finder.skin,
        &cloth.positions,
        &crossing.faces,
    );
    let layers = &cloth.scene.finder.binding.layers;
    let lacks = |&node: &u32| {
        let node = node as usize;
        let position = cloth.positions[node];
        let contact = &cloth.contacts[node];
        let moved = (position - contact.position).norm();
        let is_clear = moved < contact.distance - cloth.scene.options.clearance;
        // Cloth that a simulation has put between two walls stays there.
        let is_squeezed = cloth.scene.options.keeps_sides && contact.is_between();
        if (is_clear || is_squeezed) && !is_inside[node] {
            return false;
        }
        let hint = contact.closest.face;
        let closest = cloth.scene.finder.skin.closest_from(position, hint);
        // What lies on other cloth is as near as that lets it.
        let is_near = !layers.is_follower(node)
            && closest.distance_squared < cloth.scene.options.clearance.powi(2);
        let is_trapped = cloth.scene.finder.traps.holds(&closest);
        (is_inside[node] || is_near) && !is_trapped
    };
    let nodes = 0..cloth.positions.len() as u32;
    let nodes = nodes.filter(|&node| may_move(node as usize));
    let lacking: Vec<u32> = nodes.filter(lacks).collect();
    let goal = cloth.scene.options.clearance + 0.5 * CLEARANCE_MARGIN;
    let places = free_places(
        cloth.scene.finder,
        cloth.scene.garment.graph(),
        &lacking,
        &cloth.positions,
        &cloth.contacts,
        goal,
    );
    let mut moved = Vec::new();
    for (node, place) in lacking.into_iter().zip(places) {
        if let Some(place) = place {
            let normal = cloth.contacts[node as usize].home;
            cloth.positions[node as usize] = place;
            cloth.contacts[node as usize] = cloth.found_on_the_way(node as usize, place, normal);
            moved.push(node);
        }
    }
    moved
}

/// The nearest place around each of `nodes` that is outside the body and keeps `clearance`, if
/// there is one in reach.
fn free_places(
    finder: &ContactFinder<'_>,
    graph: &ClothGraph,
    nodes: &[u32],
    positions: &[Point3],
    contacts: &[Contact],
    clearance: f32,
) -> Vec<Option<Point3>> {
    let search = |&node: &u32| {
        let node = node as usize;
        let contact = &contacts[node];
        let planes = [contact.own, contact.foreign].into_iter().flatten();
        let normals = planes.map(|plane| plane.normal);
        // Where a neighbour is free, there is a free place on the way to it.
        let neighbours = graph.half_edges(node).iter().filter_map(|half| {
            let way = positions[half.node as usize] - positions[node];
            way.try_normalize(f32::MIN_POSITIVE)
        });
        let likely: Vec<Vector3> = normals.chain(neighbours).collect();
        let radius = if finder.winding(positions[node]) > 0 {
            finder.binding.scale * INSIDE_RADIUS
        } else {
            finder.binding.scale * NEAR_RADIUS
        };
        let mut best: Option<(f32, Point3)> = None;
        for direction in likely.into_iter().chain(all_round()) {
            let limit = best.map_or(radius, |(cost, _)| cost.min(radius));
            let place_at = |length: f32| positions[node] + length * direction;
            let hint = contact.closest.face;
            if let Some(length) = free_length(finder, place_at, clearance, limit, hint) {
                let cost = length
                    + finder.binding.scale * stretch_cost(graph, positions, node, place_at(length));
                if best.is_none_or(|(lowest, _)| cost < lowest) {
                    best = Some((cost, place_at(length)));
                }
            }
        }
        best.map(|(_, place)| place)
    };
    nodes.par_iter().map(search).collect()
}

/// The first length, no longer than `limit`, whose place is outside and keeps the clearance.
fn free_length(
    finder: &ContactFinder<'_>,
    place_at: impl Fn(f32) -> Point3,
    clearance: f32,
    limit: f32,
    hint: u32,
) -> Option<f32> {
    let mut length = 0.0;
    while let Some(step) = step_to_free(finder, place_at(length), clearance, hint) {
        length += step.max(finder.binding.scale * MIN_STEP);
        if length > limit {
            return None;
        }
    }
    Some(length)
}

/// `None` if a place is outside and keeps the clearance; else a distance within which no place
/// does.
fn step_to_free(
    finder: &ContactFinder<'_>,
    place: Point3,
    clearance: f32,
    hint: u32,
) -> Option<f32> {
    let distance = finder
        .skin
        .closest_from(place, hint)
        .distance_squared
        .sqrt();
    if finder.winding(place) > 0 {
        Some(distance + clearance)
    } else if distance < clearance {
        Some(clearance - distance)
    } else {
        None
    }
}

/// How much farther a place counts for the edges that it stretches.
fn stretch_cost(graph: &ClothGraph, positions: &[Point3], node: usize, place: Point3) -> f32 {
    let stretch = graph.half_edges(node).iter().map(|half| {
        let length = (positions[half.node as usize] - place).norm();
        length / half.rest_length.max(f32::MIN_POSITIVE)
    });
    STRETCH_COST * (stretch.fold(0.0, f32::max) - FREE_STRETCH).max(0.0)
}
