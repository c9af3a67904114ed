//! Leaving a part of the body that cloth does not belong to.
//!
//! Where an arm reaches through a skirt, the nearest skin would send one node to the front of the
//! arm and its neighbour to the back, and tear the cloth. So nodes that hang together leave
//! together, in one direction. Where the arm is pressed into the skin that the cloth belongs to, a
//! way ends at that skin, inside the arm: cloth caught between two parts of the body stays between
//! them.

use garnet_knn::Passage;
use garnet_mesh::{Point3, Vector3};
use garnet_skin::ClothGraph;
use rayon::prelude::*;

use crate::contact::{Contact, ContactFinder, Plane};
use crate::directions::all_round;
use crate::lengths::DEEPEST;

/// No way out is longer than this, in metres.
const MAX_LENGTH: f32 = DEEPEST;

/// Room between two parts of the body that counts as outside, in metres: less than twice the
/// default clearance, so that cloth between an arm and the trunk is squeezed and not sent through
/// both.
const MIN_GAP: f32 = 0.003;

/// Steps in which a way out of a body with holes is probed, in metres. Parts thinner than this may
/// be stepped over.
const STEP: f32 = 0.005;

/// Cloth that is caught between its own skin and another part is no farther from its own than this,
/// less the clearance, in metres.
const CAUGHT_HEIGHT: f32 = 0.007;

/// Halvings of the step in which such a way out ends.
const HALVINGS: usize = 4;

/// A node that finds no way out in a direction counts as if it had this way, in metres: longer than
/// any, but so that a direction by which most of a patch gets out is better than a long one for
/// all.
const NO_WAY_LENGTH: f32 = 2.0 * MAX_LENGTH;

/// At most this many nodes of a patch are asked for the direction. More take longer, and change the
/// direction of large patches alone.
const MAX_SAMPLES: usize = 12;

/// The skin at the end of the way is left along its own normal if that deviates from the way by no
/// less than this cosine, else along the way.
const MIN_COSINE: f32 = 0.2;

/// Gives the nodes among `found` that are inside foreign parts a direction to leave them by, one
/// for each connected patch of such nodes, and their half spaces. `directions` `[node]` are kept
/// from round to round. A way that leads straight to the side the cloth belongs to may be
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
                    way_out(finder, node, positions[node], direction, contact)
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
    let samples = patch.iter().step_by(stride);
    let samples: Vec<Start> = samples
        .map(|&node| Start::new(finder, node, positions[node], &contacts[node]))
        .collect();
    let mut shortest = (f32::INFINITY, home);
    for direction in std::iter::once(home).chain(all_round()) {
        let away = 0.5 * (1.0 - direction.dot(&home));
        let factor = (1.0 + (home_preference - 1.0) * away).powi(2);
        let mut cost = 0.0;
        for start in &samples {
            let length = start.exit(finder, direction).map(|exit| exit.length);
            cost += factor
                * length
                    .unwrap_or(finder.binding.scale * NO_WAY_LENGTH)
                    .powi(2);
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

/// The half space that a node inside foreign parts reaches along `direction`.
pub(crate) fn way_out(
    finder: &ContactFinder<'_>,
    node: usize,
    position: Point3,
    direction: Vector3,
    contact: &Contact,
) -> Option<Plane> {
    let exit = Start::new(finder, node, position, contact).exit(finder, direction)?;
    let place = position + exit.length * direction;
    let skin_normal = finder
        .normals
        .smooth_at(finder.skin, exit.face, exit.barycentric);
    if exit.is_caught {
        let normal = -skin_normal;
        return Some(Plane {
            normal,
            offset: normal.dot(&place.coords) - finder.binding.scale * CAUGHT_HEIGHT,
        });
    }
    let normal = if skin_normal.dot(&direction) > MIN_COSINE {
        skin_normal
    } else {
        direction
    };
    Some(Plane {
        normal,
        offset: normal.dot(&place.coords),
    })
}

/// Where a node starts that has to leave foreign parts.
#[derive(Debug, Clone, Copy)]
struct Start {
    node: usize,
    position: Point3,
    /// Inside how many parts of the body it is.
    parts: i32,
    /// Inside how many it may stay.
    own_parts: i32,
}

/// Where a way out ends.
#[derive(Debug, Clone, Copy)]
struct Exit {
    length: f32,
    face: u32,
    barycentric: [f32; 3],
    /// Whether it ends at the node's own skin, where that lies inside another part.
    is_caught: bool,
}

impl Start {
    fn new(finder: &ContactFinder<'_>, node: usize, position: Point3, contact: &Contact) -> Self {
        Self {
            node,
            position,
            parts: finder.winding(position),
            own_parts: contact.own_parts,
        }
    }

    /// The first place along `direction` that is in no more parts of the body than it may be, or at
    /// the node's own skin.
    fn exit(&self, finder: &ContactFinder<'_>, direction: Vector3) -> Option<Exit> {
        if self.parts <= self.own_parts {
            return Some(exit_near(finder, self.position, 0.0));
        }
        if !finder.skin.is_closed() {
            return self.probed_exit(finder, direction);
        }
        let mut parts = self.parts;
        let scale = finder.binding.scale;
        let (longest, gap) = (scale * MAX_LENGTH, scale * MIN_GAP);
        let reach = longest + gap;
        let passages = finder.skin.passages(self.position, direction, reach);
        for (index, passage) in passages.iter().enumerate() {
            parts -= passage.turn;
            let place = self.position + passage.length * direction;
            let is_caught = self.is_caught_at(finder, passage, place);
            let next = passages.get(index + 1).map_or(f32::INFINITY, |p| p.length);
            let is_out = parts <= self.own_parts && next - passage.length >= gap;
            if passage.length <= longest && (is_out || is_caught) {
                return Some(Exit {
                    length: passage.length,
                    face: passage.face,
                    barycentric: passage.barycentric,
                    is_caught,
                });
            }
        }
        None
    }

    /// Whether a way comes upon the node's own skin from in front of it, where another part lies on
    /// it.
    fn is_caught_at(&self, finder: &ContactFinder<'_>, passage: &Passage, place: Point3) -> bool {
        passage.turn < 0
            && finder.binding.is_own(self.node, passage.face)
            && finder.traps.holds_at(passage.face, place)
    }

    /// The same on a body with holes, which no count of passages makes sense of.
    fn probed_exit(&self, finder: &ContactFinder<'_>, direction: Vector3) -> Option<Exit> {
        let place = |length: f32| self.position + length * direction;
        let is_out = |length: f32| finder.winding(place(length)) <= self.own_parts;
        let step = finder.binding.scale * STEP;
        let num_steps = (MAX_LENGTH / STEP) as usize;
        let mut steps = (1..=num_steps).map(|count| count as f32 * step);
        let mut outside = steps.find(|&length| is_out(length))?;
        let mut inside = outside - step;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            if is_out(middle) {
                outside = middle;
            } else {
                inside = middle;
            }
        }
        Some(exit_near(finder, place(outside), outside))
    }
}

/// The exit after `length` at the skin nearest to `place`.
fn exit_near(finder: &ContactFinder<'_>, place: Point3, length: f32) -> Exit {
    let closest = finder.skin.closest(place);
    Exit {
        length,
        face: closest.face,
        barycentric: closest.barycentric,
        is_caught: false,
    }
}
