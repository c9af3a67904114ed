//! Leaving a part of the body that cloth does not belong to.
//!
//! Where an arm reaches through a skirt, the nearest skin would send one node to the front of the
//! arm and its neighbour to the back, and tear the cloth. So nodes that hang together leave together,
//! in one direction.

use garnet_mesh::{Point3, Vector3};
use garnet_skin::ClothGraph;
use rayon::prelude::*;

use crate::contact::{Contact, ContactFinder, Plane};
use crate::directions::all_round;

/// No way out is longer than this, in metres.
const MAX_LENGTH: f32 = 0.08;

/// Steps in which a way out is probed, in metres.
const STEP: f32 = 0.005;

/// Halvings of the step in which a way out ends.
const HALVINGS: usize = 4;

/// A node that finds no way out in a direction counts as if it had this way, in metres.
const NO_WAY_LENGTH: f32 = 0.16;

/// At most this many nodes of a patch are asked for the direction.
const MAX_SAMPLES: usize = 12;

/// The skin at the end of the way is left along its own normal if that deviates from the way by no
/// less than this cosine, else along the way.
const MIN_COSINE: f32 = 0.2;

/// Gives the nodes among `found` that are inside foreign parts a direction to leave them by, one for
/// each connected patch of such nodes, and their half spaces. `directions` `[node]` are kept from
/// round to round. A way that leads straight to the side the cloth belongs to may be
/// `home_preference` times as long as one that leads straight away from it.
pub(crate) fn find_ways_out(
    finder: &ContactFinder<'_>,
    graph: &ClothGraph,
    found: &[u32],
    contacts: &mut [Contact],
    positions: &[Point3],
    directions: &mut [Option<Vector3>],
    home_preference: f32,
) {
    let is_inside = |&node: &usize| contacts[node].foreign_parts > 0;
    let inside: Vec<usize> = found
        .iter()
        .map(|&node| node as usize)
        .filter(is_inside)
        .collect();
    if inside.is_empty() {
        return;
    }
    let mut is_found = vec![false; contacts.len()];
    for &node in &inside {
        is_found[node] = true;
    }
    let mut is_seen = vec![false; contacts.len()];
    for start in inside {
        if is_seen[start] {
            continue;
        }
        let patch = patch_from(start, graph, contacts, &mut is_seen);
        let direction = kept_direction(&patch, directions).unwrap_or_else(|| {
            shortest_direction(finder, &patch, contacts, positions, home_preference)
        });
        let planes: Vec<Option<Plane>> = patch
            .par_iter()
            .map(|&node| {
                let contact = &contacts[node];
                if is_found[node] {
                    way_out(finder, positions[node], direction, contact)
                } else {
                    contact.foreign
                }
            })
            .collect();
        for (&node, plane) in patch.iter().zip(planes) {
            directions[node] = Some(direction);
            contacts[node].foreign = plane;
        }
    }
}

/// The nodes inside foreign parts that are connected to `start`.
fn patch_from(
    start: usize,
    graph: &ClothGraph,
    contacts: &[Contact],
    is_seen: &mut [bool],
) -> Vec<usize> {
    let mut patch = vec![start];
    is_seen[start] = true;
    let mut next = 0;
    while let Some(&node) = patch.get(next) {
        next += 1;
        for half in graph.half_edges(node) {
            let other = half.node as usize;
            let contact = &contacts[other];
            if !is_seen[other] && contact.foreign_parts > 0 {
                is_seen[other] = true;
                patch.push(other);
            }
        }
    }
    patch
}

/// The direction that the nodes of a patch have from before, if they have one.
fn kept_direction(patch: &[usize], directions: &[Option<Vector3>]) -> Option<Vector3> {
    let kept: Vector3 = patch.iter().filter_map(|&node| directions[node]).sum();
    kept.try_normalize(0.5)
}

/// The direction with the shortest ways out, with a preference for the side that the cloth belongs
/// to.
fn shortest_direction(
    finder: &ContactFinder<'_>,
    patch: &[usize],
    contacts: &[Contact],
    positions: &[Point3],
    home_preference: f32,
) -> Vector3 {
    let home: Vector3 = patch.iter().map(|&node| contacts[node].home).sum();
    let home = home
        .try_normalize(f32::MIN_POSITIVE)
        .unwrap_or_else(Vector3::x);
    let stride = patch.len().div_ceil(MAX_SAMPLES);
    let samples: Vec<usize> = patch.iter().step_by(stride).copied().collect();
    let mut shortest = (f32::INFINITY, home);
    for direction in std::iter::once(home).chain(all_round()) {
        let away = 0.5 * (1.0 - direction.dot(&home));
        let factor = (1.0 + (home_preference - 1.0) * away).powi(2);
        let mut cost = 0.0;
        for &node in &samples {
            let length = way_out_length(finder, positions[node], direction, &contacts[node]);
            cost += factor * length.unwrap_or(NO_WAY_LENGTH).powi(2);
            if cost >= shortest.0 {
                break;
            }
        }
        if cost < shortest.0 {
            shortest = (cost, direction);
        }
    }
    shortest.1
}

/// How far a node must move along `direction` to leave the foreign parts that it is in.
fn way_out_length(
    finder: &ContactFinder<'_>,
    position: Point3,
    direction: Vector3,
    contact: &Contact,
) -> Option<f32> {
    let num_steps = (MAX_LENGTH / STEP) as usize;
    // No skin is nearer than the closest, so no way out is shorter.
    let moved = (position - contact.position).norm();
    let nearest = (contact.closest.distance_squared.sqrt() - moved).max(0.0);
    let first = ((nearest / STEP) as usize).max(1);
    (first..=num_steps)
        .map(|count| count as f32 * STEP)
        .find(|&length| finder.winding(position + length * direction) <= contact.own_parts)
}

/// The half space that a node inside foreign parts reaches along `direction`.
pub(crate) fn way_out(
    finder: &ContactFinder<'_>,
    position: Point3,
    direction: Vector3,
    contact: &Contact,
) -> Option<Plane> {
    let mut outside = way_out_length(finder, position, direction, contact)?;
    let mut inside = outside - STEP;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (inside + outside);
        if finder.winding(position + middle * direction) <= contact.own_parts {
            outside = middle;
        } else {
            inside = middle;
        }
    }
    let exit = finder.skin.closest(position + outside * direction);
    let skin_normal = finder.normals.smooth(finder.skin, &exit);
    let normal = if skin_normal.dot(&direction) > MIN_COSINE {
        skin_normal
    } else {
        direction
    };
    Some(Plane {
        normal,
        offset: normal.dot(&exit.point.coords),
    })
}
