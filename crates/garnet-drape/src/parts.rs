//! Which skin cloth may rest on.

use garnet_body::poses::{Part, parts_of_vertices};
use garnet_sim::{Collider, SimError};
use garnet_skin::{Body, SkinWeights};

use crate::simulator::is_one;

/// Weight of a joint above which a vertex of the garment belongs to its part, too.
const MIN_WEIGHT: f32 = 0.05;

/// A body's skin, in a scene that is `scale` times as large, and, if its skeleton is a human
/// figure, the parts of it.
///
/// # Errors
///
/// Those of [`Collider::new`].
pub fn collider(body: &Body, scale: f32) -> Result<Collider, SimError> {
    let rest = body.rest();
    let collider = Collider::new(body.skin().faces(), rest.num_vertices())?;
    let skin = body.skin();
    let scaled = (!is_one(scale)).then(|| skin.positions().iter().map(|place| place * scale));
    let scaled = scaled.and_then(|places| skin.moved(places.collect()).ok());
    let collider = collider.with_surface(scaled.unwrap_or_else(|| skin.clone()))?;
    let Ok(parts) = parts_of_vertices(body) else {
        return Ok(collider);
    };
    let of_faces = body.skin().faces().iter().map(|face| {
        let [a, b, c] = face.map(|vertex| parts[vertex as usize]);
        number(if b == c { b } else { a })
    });
    collider.with_parts(of_faces.collect())
}

/// The parts that each vertex of a garment may touch, one bit a part: all, but for sleeves, which
/// the other arm does not touch.
pub(crate) fn allowed_parts(body: &Body, garment: &SkinWeights) -> Option<Vec<u32>> {
    let parts = parts_of_vertices(body).ok()?;
    let mut part_of_joint = vec![None; body.skeleton().num_joints()];
    for (vertex, &part) in parts.iter().enumerate() {
        part_of_joint[body.weights().heaviest(vertex)] = Some(part);
    }
    let allowed = (0..garment.num_vertices()).map(|vertex| {
        let own = garment
            .vertex(vertex)
            .filter(|&(_, weight)| weight > MIN_WEIGHT)
            .filter_map(|(joint, _)| part_of_joint[joint]);
        own.fold(0, |mask, part| mask | neighbours(part))
    });
    Some(allowed.collect())
}

fn number(part: Part) -> u8 {
    let all = Part::ALL.into_iter();
    all.into_iter().position(|other| other == part).unwrap_or(0) as u8
}

/// The parts that cloth on a part may touch.
fn neighbours(part: Part) -> u32 {
    let may_touch = |other: Part| match part {
        Part::Trunk | Part::Head | Part::Thigh(_) | Part::Shank(_) => true,
        Part::UpperArm(_) | Part::Forearm(_) => {
            !matches!(other, Part::UpperArm(_) | Part::Forearm(_)) || same_side(part, other)
        }
    };
    let all = Part::ALL.into_iter().filter(|&other| may_touch(other));
    all.fold(0, |mask, part| mask | 1 << number(part))
}

fn same_side(a: Part, b: Part) -> bool {
    let side = |part: Part| match part {
        Part::Trunk | Part::Head => None,
        Part::UpperArm(side) | Part::Forearm(side) | Part::Thigh(side) | Part::Shank(side) => {
            Some(side)
        }
    };
    side(a) == side(b)
}
