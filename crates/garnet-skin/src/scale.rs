//! How large the limbs are that a garment lies on.
//!
//! The lengths of draping are a person's: over how much cloth weights are smoothed, how far own
//! skin reaches, how deep cloth may be in a limb and come out again. Fingers, dolls and giants have
//! other ones, by the thickness of what the cloth lies on.

use garnet_knn::{ClosestPoint, Surface};
use garnet_mesh::Point3;

use crate::Body;

/// Lengths are a person's for limbs of a thickness in this range, in metres: from wrists to trunks.
const PERSON: [f32; 2] = [0.06, 0.6];

/// Whole figures that are shorter than this have lengths by their height, in metres: the trunk of a
/// doll is as thick as a limb of a person. Sleeves of a T-shirt are lost up to 0.7 with a person's
/// lengths.
const SMALLEST_PERSON: f32 = 0.8;

/// Whole figures that are taller than this have lengths by their height, too, in metres: the limbs
/// of a giant are as thick as the trunk of a person. People and most characters are smaller.
const LARGEST_PERSON: f32 = 2.6;

/// Skeletons with as many joints are those of whole figures, and not of an arm alone.
const FIGURE_JOINTS: usize = 12;

/// The height that a person's lengths are for, in metres.
const STATURE: f32 = 1.7;

/// The thickness that a person's lengths are for, in metres: between an arm and a trunk.
const THICKNESS: f32 = 0.15;

/// Places where the body is measured.
const SAMPLES: usize = 256;

/// Rays start this share of the body's size below the skin.
const START: f32 = 1e-5;

/// What lengths of a person are to be multiplied by for cloth that lies on `places` of the skin: 1
/// for limbs as thick as a person's, else the thickness of the body below the cloth over a
/// person's.
///
/// The thickness is the median over the cloth of the way through the body, along the normal.
pub fn scale_of(skin: &Surface, places: &[ClosestPoint]) -> f32 {
    let (low, high) = skin.bounds();
    let size = (high - low).norm();
    let thickness = |place: &ClosestPoint| {
        let corners = skin.faces()[place.face as usize];
        let [a, b, c] = corners.map(|vertex| skin.positions()[vertex as usize]);
        let inwards = -(b - a).cross(&(c - a)).try_normalize(f32::MIN_POSITIVE)?;
        let start: Point3 = place.point + START * size * inwards;
        let passages = skin.passages(start, inwards, size);
        let out = passages.iter().find(|passage| passage.turn > 0)?;
        Some(out.length + START * size)
    };
    let step = places.len().div_ceil(SAMPLES).max(1);
    let sampled = places.iter().step_by(step);
    let count = sampled.len();
    let mut found: Vec<f32> = sampled.filter_map(thickness).collect();
    // Through a body with holes few rays find a way.
    if found.is_empty() || 2 * found.len() < count {
        return 1.0;
    }
    found.sort_by(f32::total_cmp);
    let median = found[found.len() / 2];
    if (PERSON[0]..=PERSON[1]).contains(&median) {
        1.0
    } else {
        median / THICKNESS
    }
}

/// The same for cloth on a body, which may be a small or a large figure.
pub(crate) fn scale_on(body: &Body, places: &[ClosestPoint]) -> f32 {
    let skin = body.skin();
    let scale = scale_of(skin, places);
    let (low, high) = skin.bounds();
    let extent = (high - low).max();
    let is_person = (scale - 1.0).abs() < f32::EPSILON;
    let is_figure = body.skeleton().num_joints() >= FIGURE_JOINTS;
    let has_height_of_person = (SMALLEST_PERSON..=LARGEST_PERSON).contains(&extent);
    if is_person && is_figure && !has_height_of_person {
        extent / STATURE
    } else {
        scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Joint, Skeleton, SkinWeights};
    use garnet_mesh::primitives::capsule;

    fn scale(radius: f32, length: f32) -> f32 {
        let limb = capsule(radius, length, 48, 24);
        let places: Vec<Point3> = limb.positions().iter().map(|p| p * 1.02).collect();
        let skin = Surface::new(&limb);
        scale_of(&skin, &skin.closest_all(&places))
    }

    #[test]
    fn limbs_of_persons_have_their_lengths() {
        for radius in [0.035, 0.05, 0.1, 0.2] {
            assert_eq!(scale(radius, 0.8).to_bits(), 1.0_f32.to_bits());
        }
    }

    #[test]
    fn small_and_large_figures_have_lengths_by_their_height_and_arms_alone_do_not() {
        let (small, large) = ([0.035, 0.43], [0.2, 3.0]);
        for (num_joints, [radius, length], expected) in [
            (2, small, 1.0),
            (FIGURE_JOINTS, small, 0.5 / STATURE),
            (2, large, 1.0),
            (FIGURE_JOINTS, large, 3.4 / STATURE),
        ] {
            let limb = capsule(radius, length, 48, 24);
            let places: Vec<Point3> = limb.positions().iter().map(|p| p * 1.02).collect();
            let joint = |number: usize| Joint {
                name: number.to_string(),
                parent: number.checked_sub(1),
                rest_position: Point3::new(0.0, 0.01 * number as f32, 0.0),
            };
            let skeleton = Skeleton::new((0..num_joints).map(joint).collect()).unwrap();
            let weights = (0..limb.num_vertices())
                .flat_map(|_| (0..num_joints).map(|joint| if joint == 0 { 1.0 } else { 0.0 }));
            let weights: Vec<f32> = weights.collect();
            let weights = SkinWeights::from_dense(num_joints, &weights).unwrap();
            let body = Body::new(limb.clone(), skeleton, weights).unwrap();
            let found = scale_on(&body, &body.skin().closest_all(&places));
            assert!((found - expected).abs() < 1e-3, "{num_joints}: {found}");
        }
    }

    #[test]
    fn fingers_and_giants_have_lengths_by_their_thickness() {
        for radius in [0.001, 0.009, 1.0] {
            let ratio = scale(radius, 8.0 * radius) / (2.0 * radius / THICKNESS);
            // Rays from the half spheres at the ends go through more of the limb.
            assert!((0.97..1.1).contains(&ratio), "{radius} {ratio}");
        }
    }
}
