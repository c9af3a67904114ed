//! Cloth at the rim of a contact between two parts of the body.
//!
//! Where an arm is pressed into the trunk, projection sends neighbours at the rim to both sides of
//! the arm, and the edge between them round it. Cloth does not do that: it stays in the contact,
//! caught between the two. Such nodes go back to where their neighbours want them, if that is where
//! the body leaves no room.

use garnet_knn::TORN_STRETCH;
use garnet_mesh::{Point3, Vector3};

use crate::cloth::{CLEARANCE_MARGIN, Cloth};

/// Edges stretched more than this are let into the contact: they are torn beyond what mending and
/// easing can leave of one that goes round a wrist. A lower one lets in cloth that has a way round.
const RIM_STRETCH: f32 = 1.25 * TORN_STRETCH;

/// How often ends of such edges are looked for.
const ROUNDS: usize = 4;

/// A contact farther than this from the edge is not what it goes round, in metres: the thickness of
/// an arm.
const CONTACT_REACH: f32 = 0.04;

/// Where along an edge its ends may meet, and along the way from there into the contact.
const SHARES: [f32; 3] = [0.25, 0.5, 0.75];

/// Lets the ends of overstretched edges into contacts that the edges go round; returns the nodes
/// that were moved.
pub(crate) fn give_in(cloth: &mut Cloth<'_>) -> Vec<u32> {
    let mut moved = Vec::new();
    for _ in 0..ROUNDS {
        let mut any = false;
        for edge in cloth.edges_beyond(RIM_STRETCH) {
            // An end that was moved for another edge may have mended this one.
            let is_free = |&node: &u32| !cloth.is_trapped(node as usize);
            if cloth.stretch(&edge) <= RIM_STRETCH || !edge.ends.iter().all(is_free) {
                continue;
            }
            if let Some((node, place)) = place_in_contact(cloth, edge.ends) {
                let normal = Vector3::zeros();
                cloth.positions[node as usize] = place;
                cloth.contacts[node as usize] =
                    cloth.found_on_the_way(node as usize, place, normal);
                moved.push(node);
                any = true;
            }
        }
        if !any {
            break;
        }
    }
    moved.sort_unstable();
    moved.dedup();
    moved
}

/// The end of an edge that moves less far into the contact that the edge goes round, and its
/// place there, in front of its own skin where there is room.
fn place_in_contact(cloth: &Cloth<'_>, [a, b]: [u32; 2]) -> Option<(u32, Point3)> {
    let [from, to] = [a, b].map(|node| cloth.positions[node as usize]);
    let mut nearest: Option<(f32, u32, Point3)> = None;
    for node in [a, b] {
        let wanted = cloth
            .scene
            .sweeper
            .wanted_of(node as usize, &cloth.positions);
        let along = SHARES.map(|share| from + share * (to - from));
        let starts = along.into_iter().chain([wanted]);
        let places = starts.flat_map(|place| towards_contact(cloth, place));
        for place in places {
            let place = before_own_skin(cloth, node as usize, place);
            let distance = (place - cloth.positions[node as usize]).norm();
            if is_caught(cloth, node as usize, place)
                && nearest.is_none_or(|(least, ..)| distance < least)
            {
                nearest = Some((distance, node, place));
            }
        }
    }
    nearest.map(|(_, node, place)| (node, place))
}

/// The place, and places on the way from it to the skin in the nearest contact.
fn towards_contact(cloth: &Cloth<'_>, place: Point3) -> impl Iterator<Item = Point3> {
    let contact = cloth
        .scene
        .finder
        .traps
        .nearest(place, cloth.scale() * CONTACT_REACH);
    let ways = contact
        .into_iter()
        .flat_map(move |contact| SHARES.map(move |share| place + share * (contact - place)));
    std::iter::once(place).chain(ways)
}

/// The place, moved in front of the node's own skin if it is behind it.
fn before_own_skin(cloth: &Cloth<'_>, node: usize, place: Point3) -> Point3 {
    let contact = cloth.found_on_the_way(node, place, Vector3::zeros());
    let goal = cloth.scene.options.clearance + CLEARANCE_MARGIN;
    match contact.own {
        Some(own) if own.height(place) < goal => place + (goal - own.height(place)) * own.normal,
        _ => place,
    }
}

/// Whether a node would be trapped at a place.
fn is_caught(cloth: &Cloth<'_>, node: usize, place: Point3) -> bool {
    let hint = cloth.contacts[node].closest.face;
    let closest = cloth.scene.finder.skin.closest_from(place, hint);
    cloth.scene.finder.traps.holds(&closest)
}
