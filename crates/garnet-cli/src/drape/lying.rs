//! Bodies that lie, perhaps because another axis of their file points up, and cloth that falls.

use garnet::mesh::{Bounds, UpAxis};
use garnet::{Point3, PosedBody, Vector3, io::guess_up_axis};

use super::warning::{MOST_FALLING, Problem};

/// Upward directions that are turned with the joints have a mean that is 1 long if all are turned
/// as one, and a shorter one in a body that bends. Lower takes more that bend for bodies that lie.
const LEAST_AGREEMENT: f32 = 0.6;

/// How far upwards that mean may still look, of its length: the sine of 25 degrees.
const MOST_UPRIGHT: f32 = 0.42;

/// The same of a body that is not clearly longer along z than it is high, as of one that lies on
/// its side with its arms stretched out.
const CLEAR_AGREEMENT: f32 = 0.85;

/// Whether a body that stands at rest lies along z: its joints look along z. A file with z up, read
/// with y up, looks like that.
pub(super) fn lies_along_z(posed: &PosedBody) -> bool {
    let extent = Bounds::of(posed.skin().positions())
        .unwrap_or_default()
        .extent();
    let least = match guess_up_axis(extent) {
        Some(UpAxis::Z) => LEAST_AGREEMENT,
        Some(UpAxis::Y) => return false,
        None => CLEAR_AGREEMENT,
    };
    let turns = posed.posed_from_rest();
    let upwards = turns.iter().map(|turn| turn.rotation * Vector3::y());
    let mean = upwards.sum::<Vector3>() / turns.len().max(1) as f32;
    let length = mean.norm();
    length > least && mean.y.abs() < MOST_UPRIGHT * length && mean.z.abs() > mean.x.abs()
}

/// Cloth may hang or lie so much lower than the body, in metres.
const BELOW: f32 = 0.05;

/// That simulated cloth, which has not come to rest, falls: more than a little of it is lower than
/// the body.
pub(super) fn fallen(cloth: &[Point3], posed: &PosedBody) -> Option<Problem> {
    let heights = posed.skin().positions().iter().map(|place| place.y);
    let lowest = heights.fold(f32::INFINITY, f32::min);
    let below = cloth
        .iter()
        .filter(|place| place.y < lowest - BELOW)
        .count();
    let share = below as f32 / cloth.len().max(1) as f32;
    (share > MOST_FALLING).then_some(Problem::Falling(share))
}
