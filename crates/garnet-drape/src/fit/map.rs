//! How a garment fits everywhere, to be looked at.

use garnet_body::shape::{JOINT_NAMES, Measure, Tape, Tube};
use garnet_mesh::Point3;
use garnet_sim::RestShape;

use super::section::Cut;
use super::{NoFit, Region};
use crate::BoundGarment;

/// The trunk is measured at heights that are so far apart, in metres.
const HEIGHT_STEP: f64 = 0.01;

/// Limbs are measured at places that are so far apart, in shares of a bone.
const SHARE_STEP: f64 = 0.05;

/// An ease that is smaller by this than that of close cloth is at the lower end of the scale, as a
/// share of the girth of the body. A larger one shows how tight the tightest is.
const TIGHTEST: f64 = 0.1;

/// How often the level of a node is blended with those of its neighbours: where a sleeve begins,
/// one tape ends and another begins. More blends farther.
const BLENDING: usize = 12;

/// How a garment fits a wearer at each vertex `[vertex]`, on the scale of
/// [`FitWord::ALL`](super::FitWord::ALL): 0 to 1 is tight, 1 to 2 close, 2 to 3 regular, 3 to 4
/// loose. Each vertex has the level of the line round the garment that runs through it.
///
/// Between shoulder and armhole, where no line goes round one part of the body alone, vertices have
/// the level of the nearest line. `garment` and `rest` are those of [`FitLines`](super::FitLines).
///
/// # Errors
///
/// As [`FitLines::new`](super::FitLines::new).
pub fn fit_map(
    garment: &BoundGarment,
    rest: Option<&RestShape>,
    wearer: &Tape,
) -> Result<Vec<f32>, NoFit> {
    let own = Tape::around(garment.body()).ok_or(NoFit::Stranger)?;
    let cut = Cut::new(garment, rest, &own);
    let trunk = of_trunk(&cut, &own, wearer);
    let limbs = Limb::ALL.map(|limb| limb.levels(&cut, &own, wearer));
    if trunk.is_empty() && limbs.iter().all(Vec::is_empty) {
        return Err(NoFit::NoRegion);
    }
    let cloth = garment.cloth();
    let nodes = cut.nodes().iter().enumerate();
    let levels = nodes.map(|(node, place)| {
        let joint = cloth.weights().heaviest(node);
        let limb = Limb::ALL.iter().position(|limb| limb.has(joint));
        let of_limb = limb.and_then(|limb| {
            let along = Limb::ALL[limb].along(&own, place);
            let (&(first, _), levels) = (limbs[limb].first()?, &limbs[limb]);
            // Above the first line round a leg lies the trunk.
            let is_trunk = Limb::ALL[limb].is_leg() && along < first;
            (!is_trunk || trunk.is_empty()).then(|| at(levels, along))
        });
        let of_trunk = || {
            let depth = -f64::from(place.y);
            (!trunk.is_empty()).then(|| at(&trunk, depth))
        };
        of_limb.or_else(of_trunk).unwrap_or(f64::NAN)
    });
    let mut found: Vec<f64> = levels.collect();
    for _ in 0..BLENDING {
        found = blended(garment, &found);
    }
    let found: Vec<f32> = found.into_iter().map(|level| level as f32).collect();
    Ok(cloth.weld().scatter(&found))
}

/// Each value with the mean of those around it; what is not known is left out.
fn blended(garment: &BoundGarment, levels: &[f64]) -> Vec<f64> {
    let topology = garment.cloth().topology();
    let of_node = |node: usize| {
        let around = topology.neighbors(node).iter();
        let around = around.map(|&other| levels[other as usize]);
        let known = around
            .chain([levels[node]])
            .filter(|level| level.is_finite());
        let (sum, count) = known.fold((0.0, 0.0), |(sum, count), level| (sum + level, count + 1.0));
        if count > 0.0 { sum / count } else { f64::NAN }
    };
    (0..levels.len()).map(of_node).collect()
}

/// A value between those of levels `(place, value)` in rising order; at the ends the last one.
fn at(levels: &[(f64, f64)], place: f64) -> f64 {
    let above = levels.partition_point(|level| level.0 <= place);
    match (above.checked_sub(1), levels.get(above)) {
        (Some(below), Some(&(high, of_high))) => {
            let (low, of_low) = levels[below];
            of_low + (of_high - of_low) * (place - low) / (high - low)
        }
        (Some(below), None) => levels[below].1,
        (None, Some(level)) => level.1,
        (None, None) => f64::NAN,
    }
}

/// The level of an ease, between the bounds of the words.
fn level(ease: f64, [close, regular, loose]: [f64; 3]) -> f64 {
    let scale = [
        (close - TIGHTEST, 0.0),
        (close, 1.0),
        (regular, 2.0),
        (loose, 3.0),
        (loose + (loose - close), 4.0),
    ];
    at(&scale, ease)
}

/// The bounds of the words at a height of the trunk: between chest, waist and hip those in between.
fn bounds_at(height: f64, [chest, waist, hip]: [f64; 3]) -> [f64; 3] {
    let marks = [
        (hip, Region::Hip),
        (waist, Region::Waist),
        (chest, Region::Chest),
    ];
    std::array::from_fn(|word| {
        let levels = marks.map(|(mark, region)| (mark, region.bounds()[word]));
        at(&levels, height)
    })
}

/// The levels of lines round the trunk, from above: by how far they lie below the origin.
fn of_trunk(cut: &Cut<'_>, own: &Tape, wearer: &Tape) -> Vec<(f64, f64)> {
    let height = |tape: &Tape, region: Region| tape.height(region.measure()).unwrap_or_default();
    let marks = |tape: &Tape| {
        [Region::Chest, Region::Waist, Region::Hip].map(|region| height(tape, region))
    };
    let [of_own, of_wearer] = [own, wearer].map(marks);
    let heights = cut.nodes().iter();
    let lowest = heights
        .map(|place| f64::from(place.y))
        .fold(f64::MAX, f64::min);
    let steps = ((of_own[0] - lowest) / HEIGHT_STEP).floor().max(0.0) as usize;
    let levels = (0..=steps).filter_map(|step| {
        let height = of_own[0] - HEIGHT_STEP * step as f64;
        let line = cut.round_trunk(own, height)?;
        let plane = wearer.trunk_plane(Measure::Waist, corresponding(height, of_own, of_wearer));
        let body = wearer.girth(&plane);
        let ease = || line.girth / body - 1.0;
        (body > 0.0).then(|| (-height, level(ease(), bounds_at(height, of_own))))
    });
    levels.collect()
}

/// The height on another body, of chest, waist and hip of both. Below the hip heights go by that
/// of the hip.
fn corresponding(height: f64, own: [f64; 3], other: [f64; 3]) -> f64 {
    let [chest, waist, hip] = own;
    let between = |low: f64, high: f64| (height - low) / (high - low);
    if height >= waist {
        other[1] + between(waist, chest) * (other[0] - other[1])
    } else if height >= hip {
        other[2] + between(hip, waist) * (other[1] - other[2])
    } else {
        other[2] * height / hip
    }
}

/// An arm or a leg: two bones, one after the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Limb {
    tube: Tube,
    bones: [Measure; 2],
    is_right: bool,
    /// The names of its joints end with these.
    joints: [&'static str; 4],
}

impl Limb {
    const ALL: [Self; 4] = [
        Self::arm(Tube::LeftArm, false),
        Self::arm(Tube::RightArm, true),
        Self::leg(Tube::LeftLeg, false),
        Self::leg(Tube::RightLeg, true),
    ];

    const fn arm(tube: Tube, is_right: bool) -> Self {
        Self {
            tube,
            bones: [Measure::UpperArm, Measure::Forearm],
            is_right,
            joints: ["shoulder", "elbow", "wrist", "hand"],
        }
    }

    const fn leg(tube: Tube, is_right: bool) -> Self {
        Self {
            tube,
            bones: [Measure::Thigh, Measure::Calf],
            is_right,
            joints: ["hip", "knee", "ankle", "foot"],
        }
    }

    fn is_leg(self) -> bool {
        matches!(self.tube, Tube::LeftLeg | Tube::RightLeg)
    }

    fn bounds(self) -> [f64; 3] {
        let region = if self.is_leg() {
            Region::Thigh
        } else {
            Region::UpperArm
        };
        region.bounds()
    }

    /// Whether a joint of the built-in skeleton is one of its own.
    fn has(self, joint: usize) -> bool {
        let side = if self.is_right { "right_" } else { "left_" };
        let name = JOINT_NAMES
            .get(joint)
            .and_then(|name| name.strip_prefix(side));
        name.is_some_and(|name| self.joints.contains(&name))
    }

    /// How far along the limb a place is: 0 to 1 along the first bone, 1 to 2 along the second.
    fn along(self, tape: &Tape, place: &Point3) -> f64 {
        let shares = self.bones.map(|bone| {
            let ends = [0.0, 1.0].map(|share| {
                let plane = tape.bone_plane(bone, share);
                let plane = if self.is_right {
                    plane.mirrored()
                } else {
                    plane
                };
                plane.center()
            });
            let way = ends[1] - ends[0];
            (place.cast::<f64>() - ends[0]).dot(&way) / way.norm_squared()
        });
        if shares[0] < 1.0 {
            shares[0]
        } else {
            1.0 + shares[1].clamp(0.0, 1.0)
        }
    }

    /// The levels of lines round the limb, by how far along it they are.
    fn levels(self, cut: &Cut<'_>, own: &Tape, wearer: &Tape) -> Vec<(f64, f64)> {
        let steps = (1.0 / SHARE_STEP).round() as usize;
        let places = (0..2).flat_map(|bone| (0..steps).map(move |step| (bone, step)));
        let levels = places.filter_map(|(bone, step)| {
            let (measure, share) = (self.bones[bone], SHARE_STEP * step as f64);
            let left = own.bone_plane(measure, share);
            let plane = if self.is_right { left.mirrored() } else { left };
            let line = cut.line_round(own, &plane, self.tube, &[Tube::Trunk])?;
            let body = wearer.girth(&wearer.bone_plane(measure, share));
            let ease = || line.girth / body - 1.0;
            (body > 0.0).then(|| (bone as f64 + share, level(ease(), self.bounds())))
        });
        levels.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Garment;
    use garnet_body::shape::{BodyParameters, ParametricBody};
    use garnet_mesh::primitives::tube;

    #[test]
    fn between_two_levels_lies_what_is_between_them() {
        let levels = [(1.0, 0.2), (2.0, 0.4)];
        for (place, expected) in [(0.0, 0.2), (1.0, 0.2), (1.5, 0.3), (2.0, 0.4), (9.0, 0.4)] {
            assert!((at(&levels, place) - expected).abs() < 1e-12, "{place}");
        }
    }

    #[test]
    fn heights_go_from_mark_to_mark() {
        let [own, other] = [[1.2, 1.0, 0.8], [1.5, 1.2, 0.9]];
        for (own_height, other_height) in own.into_iter().zip(other) {
            assert!((corresponding(own_height, own, other) - other_height).abs() < 1e-12);
        }
        assert!((corresponding(0.4, own, other) - 0.45).abs() < 1e-12);
    }

    #[test]
    fn a_straight_tube_has_most_ease_where_the_body_is_thinnest() {
        let built = ParametricBody::build(&BodyParameters::new(0.0)).unwrap();
        let own = Tape::around(built.body()).unwrap();
        let [hip, waist] = [Measure::Hip, Measure::Waist].map(|it| own.height(it).unwrap());
        let center = own.trunk_plane(Measure::Waist, hip).center();
        let around = tube(0.165, 2.0 * (waist - hip) as f32, 128, 60);
        let places = around.positions().iter();
        let places = places.map(|p| Point3::new(p.x, p.y + waist as f32, p.z + center.z as f32));
        let around = around.with_positions(places.collect()).unwrap();
        let garment = Garment::new(around).bind(built.body()).unwrap();
        let levels = fit_map(&garment, None, &own).unwrap();
        let places = garment.mesh().positions();
        let level_at = |height: f64| {
            let away = |vertex: usize| (f64::from(places[vertex].y) - height).abs();
            let near = (0..places.len()).min_by(|&a, &b| away(a).total_cmp(&away(b)));
            f64::from(levels[near.unwrap()])
        };
        let round = std::f64::consts::TAU * 0.165;
        let ease = round / built.measures()[Measure::Waist] - 1.0;
        let expected = level(ease, Region::Waist.bounds());
        assert!((level_at(waist) - expected).abs() < 0.1, "{expected}");
        assert!(level_at(hip + 0.02) < level_at(waist));
    }

    #[test]
    fn levels_and_words_are_one_scale() {
        for region in Region::ALL {
            for percent in -20..60 {
                let ease = f64::from(percent) / 100.0 + 1e-9;
                let word = region.word(ease);
                let level = level(ease, region.bounds());
                let number = crate::FitWord::ALL.iter().position(|&other| other == word);
                let number = number.unwrap() as f64;
                assert!(
                    (number..=number + 1.0).contains(&level),
                    "{region} {ease} {level}"
                );
            }
        }
    }
}
