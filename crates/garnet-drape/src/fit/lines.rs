//! The lines round a garment at which it is measured.

use garnet_body::shape::{Tape, Tube};
use garnet_mesh::Point3;
use garnet_sim::RestShape;

use super::section::{Cut, Line};
use super::{NoFit, Region, RegionFit};
use crate::BoundGarment;
use crate::simulator::is_one;

/// Steps in which a line is moved until it goes round one part of the body alone, in metres of the
/// trunk and in shares of a bone.
const STEP: f64 = 0.005;
const SHARE_STEP: f64 = 0.02;

/// A garment is measured this far below the chest girth at most, in metres: below armholes that are
/// cut deep.
const DEEPEST_ARMHOLE: f64 = 0.15;

/// Lines that are looked at below the first one. More find the end of deeper armholes and larger
/// folds, and take longer.
const NEIGHBORS: usize = 12;

/// A line goes along a fold, or into a sleeve of a garment whose pieces are not known, if the next
/// one, [`STEP`] below, has less than this share of its length. More takes the taper of a dress for
/// a fold.
const SUDDENLY_SHORTER: f64 = 0.98;

/// Lines longer than so many times the girth of the body that the garment lies on go round more
/// than one limb, or along a fold. The sleeves of the largest sizes are 2.1 times as wide as the
/// arms of a mean body; a higher value takes folds at the armhole for sleeves.
const LONGEST: f64 = 2.25;

/// Sleeves and legs are measured no farther along the bone than these shares.
const LOWEST_ON_ARM: f64 = 0.9;
const LOWEST_ON_LEG: f64 = 0.6;

/// Lines round a garment: found once, followed into each drape.
#[derive(Debug, Clone)]
pub struct FitLines {
    /// Faces between nodes.
    faces: Vec<[u32; 3]>,
    lines: Vec<RegionLine>,
    /// Girths that its pattern tells.
    finished: Vec<FinishedGirth>,
}

/// The lines of a region: one, or left and right.
#[derive(Debug, Clone)]
struct RegionLine {
    region: Region,
    place: Place,
    lines: Vec<Line>,
}

/// Where the wearer is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    /// Where that measure is always taken.
    Usual,
    /// At this share of the way from the hip up to the waist.
    AboveHip(f64),
    /// At this share of the bone.
    OnBone(f64),
}

impl FitLines {
    /// Finds the lines round a garment, bound to a built-in body that it lies on. `rest` is the
    /// shape that it was cut in; without one that is how it lies there. `finished` are girths that
    /// its pattern tells: they stand for the lengths of lines, which lie aslant where a garment is
    /// too large for its body.
    ///
    /// # Errors
    ///
    /// [`NoFit`] for garments on other bodies, and those that go round no region.
    pub fn new(
        garment: &BoundGarment,
        rest: Option<&RestShape>,
        finished: Vec<FinishedGirth>,
    ) -> Result<Self, NoFit> {
        let tape = Tape::around(garment.body()).ok_or(NoFit::Stranger)?;
        let scale = garment.cloth().scale();
        if !is_one(scale) {
            return Err(NoFit::OtherSize(scale));
        }
        let cut = Cut::new(garment, rest, &tape);
        let found = Region::ALL.into_iter();
        let lines: Vec<RegionLine> = found
            .filter_map(|region| line_of(&cut, &tape, region))
            .collect();
        if lines.is_empty() && finished.is_empty() {
            return Err(NoFit::NoRegion);
        }
        Ok(Self {
            faces: cut.into_faces(),
            lines,
            finished,
        })
    }

    /// The regions that the garment goes round on a wearer.
    pub fn regions(&self, wearer: &Tape) -> impl Iterator<Item = Region> {
        let of = |region: &Region| {
            let line = self.lines.iter().find(|line| line.region == *region);
            let finished = self.finished.iter().find(|girth| girth.region == *region);
            line.is_some() || finished.is_some_and(|girth| girth.is_reached(wearer))
        };
        let regions: Vec<Region> = Region::ALL.into_iter().filter(of).collect();
        regions.into_iter()
    }

    /// How the garment fits who has these girths, draped with its nodes at `nodes` `[node]`, in
    /// metres.
    ///
    /// Of left and right, the smaller girth and the larger strain count.
    ///
    /// # Panics
    ///
    /// If there are fewer positions than nodes.
    pub fn fit(&self, wearer: &Tape, nodes: &[Point3]) -> Vec<RegionFit> {
        let fit = |region: Region| {
            let found = self.lines.iter().find(|line| line.region == region);
            let finished = self.finished.iter().find(|girth| girth.region == region);
            let strain = found.map(|found| self.strain(found, nodes));
            let (body, garment) = match (finished, found) {
                (Some(finished), _) => {
                    let of_line = found.map_or(Place::Usual, |found| found.place);
                    (finished.of_wearer(wearer, of_line), finished.girth)
                }
                (None, found) => {
                    let found = found?;
                    let girths = found.lines.iter().map(|line| line.girth);
                    let body = girth_of(wearer, region, found.place);
                    (body, girths.fold(f64::INFINITY, f64::min))
                }
            };
            Some(RegionFit {
                region,
                body,
                garment,
                strain,
            })
        };
        self.regions(wearer).filter_map(fit).collect()
    }

    /// How much longer the longest of the lines of a region is than as it was cut, as a share.
    fn strain(&self, found: &RegionLine, nodes: &[Point3]) -> f64 {
        let strains = found.lines.iter().map(|line| {
            let corners = |face: u32| {
                self.faces[face as usize].map(|node| nodes[node as usize].coords.cast())
            };
            line.curve.length(corners) / line.girth - 1.0
        });
        strains.fold(f64::NEG_INFINITY, f64::max)
    }
}

/// A girth of a garment that its pattern tells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinishedGirth {
    /// Where it goes round the body.
    pub region: Region,
    /// In metres, without stretch.
    pub girth: f64,
    /// How far below the neck the garment ends, in metres, where it goes round the region of some
    /// wearers alone: the hip in a shirt.
    pub from_neck: Option<f64>,
    /// Of a waistband: its share of the way from the hip up to the waist, and the share of the hip
    /// that it is cut for at most.
    pub band: Option<[f64; 2]>,
}

impl FinishedGirth {
    /// Whether the garment goes round the region of a wearer.
    fn is_reached(&self, wearer: &Tape) -> bool {
        let height = wearer.height(self.region.measure());
        match (self.from_neck, height) {
            (Some(length), Some(height)) => wearer.neck_height() - length < height,
            _ => true,
        }
    }

    /// The girth of the wearer that it is held against.
    fn of_wearer(&self, wearer: &Tape, of_line: Place) -> f64 {
        if let Some([above_hip, widest]) = self.band {
            let under_belly = widest * girth_of(wearer, Region::Hip, Place::Usual);
            let there = girth_of(wearer, self.region, Place::AboveHip(above_hip));
            return there.min(under_belly);
        }
        // A hem above the hip is held against the body there.
        let place = match (self.region, of_line) {
            (Region::Hip, place) => place,
            _ => Place::Usual,
        };
        girth_of(wearer, self.region, place)
    }
}

/// The girth of the wearer where a garment is measured.
fn girth_of(wearer: &Tape, region: Region, place: Place) -> f64 {
    let measure = region.measure();
    let plane = match place {
        Place::Usual => wearer.plane(measure),
        Place::AboveHip(share) => {
            let [hip, waist] = hip_and_waist(wearer);
            wearer.trunk_plane(measure, hip + share * (waist - hip))
        }
        Place::OnBone(share) => {
            // Farther along a plane may meet the trunk or the other bone, too; limbs grow thinner.
            let usual = wearer.girth(&wearer.plane(measure));
            return wearer.girth(&wearer.bone_plane(measure, share)).min(usual);
        }
    };
    wearer.girth(&plane)
}

fn hip_and_waist(tape: &Tape) -> [f64; 2] {
    [Region::Hip, Region::Waist].map(|region| height(tape, region))
}

fn height(tape: &Tape, region: Region) -> f64 {
    let height = tape.height(region.measure());
    height.expect("a girth of the trunk has a height")
}

/// The line of a region, where the garment goes round it and round nothing else.
fn line_of(cut: &Cut<'_>, tape: &Tape, region: Region) -> Option<RegionLine> {
    match region {
        Region::Chest => {
            // Below the armholes, as garments are measured that lie on a table.
            let top = height(tape, region);
            let waist = height(tape, Region::Waist);
            if cut.top() < f64::midpoint(waist, top) {
                // The waistband of trousers.
                return None;
            }
            let low = (top - DEEPEST_ARMHOLE).max(waist);
            let (_, line) = highest(cut, tape, [low, top])?;
            Some(RegionLine {
                region,
                place: Place::Usual,
                lines: vec![line],
            })
        }
        Region::Waist => {
            let [hip, waist] = hip_and_waist(tape);
            let (found, line) = highest(cut, tape, [hip, waist])?;
            // One that begins at the hip is no waist.
            let share = (found - hip) / (waist - hip);
            (share > LOWEST_BAND).then_some(RegionLine {
                region,
                place: Place::Usual,
                lines: vec![line],
            })
        }
        Region::Hip => {
            let [hip, waist] = hip_and_waist(tape);
            let steps = (ON_HIP / STEP).round() as usize;
            let mut heights = (0..=steps).map(|step| hip + STEP * step as f64);
            let found = heights.find_map(|at| Some((at, cut.round_trunk(tape, at)?)));
            let (at, line) = found?;
            let place = if at > hip {
                Place::AboveHip((at - hip) / (waist - hip))
            } else {
                Place::Usual
            };
            Some(RegionLine {
                region,
                place,
                lines: vec![line],
            })
        }
        Region::UpperArm => on_limb(
            cut,
            tape,
            region,
            [Tube::LeftArm, Tube::RightArm],
            LOWEST_ON_ARM,
        ),
        Region::Thigh => on_limb(
            cut,
            tape,
            region,
            [Tube::LeftLeg, Tube::RightLeg],
            LOWEST_ON_LEG,
        ),
    }
}

/// A hem that ends as little as this above the hip girth goes round the hip, and is measured there,
/// in metres: that of a T-shirt.
const ON_HIP: f64 = 0.05;

/// A waistband lies this share of the way from the hip up to the waist at least: lower, there is
/// none.
const LOWEST_BAND: f64 = 0.2;

/// The highest line round the trunk and through no sleeve between two heights, or the one below it
/// at which lines become shorter all at once, and the height of the highest.
fn highest(cut: &Cut<'_>, tape: &Tape, [low, top]: [f64; 2]) -> Option<(f64, Line)> {
    let steps = ((top - low) / STEP).floor().max(0.0) as usize;
    let heights = (0..=steps).map(|step| top - STEP * step as f64);
    let lines = heights.filter_map(|height| Some((height, cut.round_trunk(tape, height)?)));
    let mut lines: Vec<(f64, Line)> = lines.collect();
    // Else a garment is sewn together at the waist, or of one piece with its sleeves.
    let first = lines.iter().position(|(_, line)| cut.is_of_trunk(line));
    let mut lines = lines.drain(first.unwrap_or(0)..);
    let (height, first) = lines.next()?;
    let below = lines.take(NEIGHBORS).map(|(_, line)| line);
    Some((height, below_folds(first, below)))
}

/// The first line, or one of those below it: where cloth lies in folds, and where a sleeve begins,
/// a plane meets it more than once, and the line is longer than the garment is wide.
fn below_folds(first: Line, others: impl Iterator<Item = Line>) -> Line {
    let mut above = first.girth;
    let mut best = first;
    for line in others {
        let is_shorter = line.girth < best.girth.min(SUDDENLY_SHORTER * above);
        above = line.girth;
        if is_shorter {
            best = line;
        }
    }
    best
}

/// Lines on both sides at the highest share of the bone where both go round their limb alone.
fn on_limb(
    cut: &Cut<'_>,
    tape: &Tape,
    region: Region,
    sides: [Tube; 2],
    lowest: f64,
) -> Option<RegionLine> {
    let usual = Tape::share(region.measure());
    let steps = ((lowest - usual) / SHARE_STEP).floor() as usize;
    let mut shares = (0..=steps).map(|step| usual + SHARE_STEP * step as f64);
    shares.find_map(|share| {
        let left = tape.bone_plane(region.measure(), share);
        let most = LONGEST * tape.girth(&left);
        let planes = [left, left.mirrored()];
        let lines = planes.iter().zip(sides);
        let lines = lines.map(|(plane, side)| cut.line_round(tape, plane, side, &[Tube::Trunk]));
        let lines: Vec<Line> = lines.flatten().filter(|line| line.girth < most).collect();
        (!lines.is_empty()).then_some(RegionLine {
            region,
            place: Place::OnBone(share),
            lines,
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Garment;
    use garnet_body::shape::{BodyParameters, Measure, ParametricBody};
    use garnet_mesh::{TriMesh, primitives::tube};
    use garnet_skin::Pose;

    /// What a tube of known girth may be measured wrong by, in metres.
    const MAX_ERROR: f64 = 1e-3;

    const RADIUS: f32 = 0.22;
    const SIDES: usize = 256;

    fn polygon() -> f64 {
        let sides = SIDES as f64;
        2.0 * sides * f64::from(RADIUS) * (std::f64::consts::PI / sides).sin()
    }

    fn shifted(mesh: &TriMesh, way: [f32; 3]) -> TriMesh {
        let moved = mesh.positions().iter();
        let moved = moved.map(|p| Point3::new(p.x + way[0], p.y + way[1], p.z + way[2]));
        mesh.with_positions(moved.collect()).unwrap()
    }

    /// A tube round the trunk of a body from hip to waist and a little beyond.
    fn worn(built: &ParametricBody) -> BoundGarment {
        let tape = Tape::around(built.body()).unwrap();
        let [hip, waist] = hip_and_waist(&tape);
        let middle = tape.trunk_plane(Measure::Waist, f64::midpoint(hip, waist));
        let around = tube(RADIUS, (waist - hip) as f32 + 0.06, SIDES, 30);
        let center = middle.center();
        let around = shifted(&around, [0.0, center.y as f32, center.z as f32]);
        Garment::new(around).bind(built.body()).unwrap()
    }

    fn fit_of(found: &[RegionFit], region: Region) -> RegionFit {
        *found.iter().find(|fit| fit.region == region).unwrap()
    }

    #[test]
    fn a_tube_round_a_body_of_known_girths_has_its_ease_and_strain() {
        let built = ParametricBody::build(&BodyParameters::new(0.5)).unwrap();
        let garment = worn(&built);
        let lines = FitLines::new(&garment, None, Vec::new()).unwrap();
        let tape = Tape::around(built.body()).unwrap();
        assert_eq!(
            lines.regions(&tape).collect::<Vec<_>>(),
            [Region::Waist, Region::Hip]
        );
        for stretch in [1.0_f32, 1.05] {
            let nodes = garment.cloth().rest_nodes().iter();
            let nodes = nodes.map(|p| Point3::new(stretch * p.x, p.y, stretch * p.z));
            let found = lines.fit(&tape, &nodes.collect::<Vec<_>>());
            for (region, measure) in [(Region::Waist, Measure::Waist), (Region::Hip, Measure::Hip)]
            {
                let fit = fit_of(&found, region);
                let body = built.measures()[measure];
                assert!((fit.body - body).abs() < 1e-6, "{region}");
                assert!(
                    (fit.garment - polygon()).abs() < MAX_ERROR,
                    "{region} {fit:?}"
                );
                assert!(
                    (fit.ease() - (polygon() - body)).abs() < MAX_ERROR,
                    "{region}"
                );
                let longer =
                    fit.strain.unwrap() * fit.garment - f64::from(stretch - 1.0) * polygon();
                assert!(longer.abs() < MAX_ERROR, "{region} {fit:?}");
            }
        }
    }

    #[test]
    fn the_ease_is_that_of_the_pattern_and_of_the_wearer_in_any_pose() {
        let built = ParametricBody::build(&BodyParameters::new(0.5)).unwrap();
        let garment = worn(&built);
        // The pattern is a tenth wider than the garment lies.
        let wider = |p: &Point3| Point3::new(1.1 * p.x, p.y, 1.1 * p.z);
        let cut = garment.mesh().positions().iter().map(wider).collect();
        let lines = FitLines::new(&garment, Some(&RestShape::Worn(cut)), Vec::new()).unwrap();
        let other = BodyParameters::new(0.2).with_bmi(27.0);
        let other = ParametricBody::build(&other).unwrap();
        let mut pose = Pose::rest(other.body().skeleton().num_joints());
        pose.rotations[0] =
            nalgebra::UnitQuaternion::from_axis_angle(&nalgebra::Vector3::y_axis(), 0.7);
        let posed = other.body().posed(&pose).unwrap();
        let fitted = built.body().fitted(posed.skin().positions()).unwrap();
        let wearer = crate::fit::wearer_tape(built.body(), &fitted).unwrap();
        let found = lines.fit(&wearer, garment.cloth().rest_nodes());
        let waist = fit_of(&found, Region::Waist);
        assert!((waist.garment - 1.1 * polygon()).abs() < MAX_ERROR);
        assert!((waist.strain.unwrap() - (1.0 / 1.1 - 1.0)).abs() < MAX_ERROR);
        let truth = other.measures()[Measure::Waist];
        assert!(
            (waist.body / truth - 1.0).abs() < 0.01,
            "{} {truth}",
            waist.body
        );
    }

    #[test]
    fn trousers_below_the_waist_are_measured_under_their_waistband() {
        let built = ParametricBody::build(&BodyParameters::new(0.5)).unwrap();
        let tape = Tape::around(built.body()).unwrap();
        let [hip, waist] = hip_and_waist(&tape);
        let top = f64::midpoint(hip, waist);
        let middle = tape.trunk_plane(Measure::Waist, hip);
        let center = middle.center();
        let height = 2.0 * (top - hip);
        let around = tube(RADIUS, height as f32, SIDES, 30);
        let around = shifted(&around, [0.0, hip as f32, center.z as f32]);
        let garment = Garment::new(around).bind(built.body()).unwrap();
        let lines = FitLines::new(&garment, None, Vec::new()).unwrap();
        let found = lines.fit(&tape, garment.cloth().rest_nodes());
        let fit = fit_of(&found, Region::Waist);
        assert!((fit.garment - polygon()).abs() < MAX_ERROR, "{fit:?}");
        // As the sizes of trousers go.
        let waist = built.measures()[Measure::Waist];
        assert!((fit.body - waist).abs() < 1e-6, "{fit:?}");
    }

    #[test]
    fn trousers_of_a_small_person_have_no_chest() {
        let parameters = BodyParameters::new(0.0).with(Measure::Stature, 1.5);
        let built = ParametricBody::build(&parameters).unwrap();
        let tape = Tape::around(built.body()).unwrap();
        let [hip, waist] = hip_and_waist(&tape);
        let chest = height(&tape, Region::Chest);
        let center = tape.trunk_plane(Measure::Waist, waist).center();
        // As high as the chest of shirts with deep armholes is looked for.
        let low = waist.max(chest - DEEPEST_ARMHOLE) + 0.02;
        for (top, has_chest) in [(low, false), (chest, true)] {
            let around = tube(RADIUS, (top - hip) as f32, SIDES, 60);
            let middle = f64::midpoint(top, hip);
            let around = shifted(&around, [0.0, middle as f32, center.z as f32]);
            let garment = Garment::new(around).bind(built.body()).unwrap();
            let lines = FitLines::new(&garment, None, Vec::new()).unwrap();
            let found = lines.regions(&tape).any(|region| region == Region::Chest);
            assert_eq!(found, has_chest);
        }
    }

    #[test]
    fn a_sleeve_is_measured_round_the_arm() {
        let built = ParametricBody::build(&BodyParameters::new(0.5)).unwrap();
        let tape = Tape::around(built.body()).unwrap();
        let plane = tape.plane(Measure::UpperArm);
        let along = plane.normal().cast::<f32>();
        let turn = nalgebra::UnitQuaternion::rotation_between(&nalgebra::Vector3::y(), &along);
        let turn = turn.unwrap();
        let center = plane.center().cast::<f32>();
        let sleeve = tube(0.07, 0.12, SIDES, 12);
        let places = sleeve.positions().iter().map(|p| center + turn * p.coords);
        let sleeve = sleeve.with_positions(places.collect()).unwrap();
        let garment = Garment::new(sleeve).bind(built.body()).unwrap();
        let lines = FitLines::new(&garment, None, Vec::new()).unwrap();
        assert_eq!(lines.regions(&tape).collect::<Vec<_>>(), [Region::UpperArm]);
        let fit = lines.fit(&tape, garment.cloth().rest_nodes())[0];
        let arm = built.measures()[Measure::UpperArm];
        assert!((fit.body - arm).abs() < 1e-6);
        let round = std::f64::consts::TAU * 0.07;
        assert!((fit.garment - round).abs() < MAX_ERROR, "{fit:?}");
        assert!(fit.strain.unwrap().abs() < 1e-6);
    }
}
