//! The start shape of trousers: horizontal sections around hips and legs.
//!
//! The chart of a panel is a rectangle: across from the middle or the inseam (0) to the outseam
//! (1), and up. At each height the panel lies on an arc of an ellipse. Below the crotch that is
//! half the ellipse around a leg; above, its center moves to the middle of the body and the arc
//! begins where it leaves the plane x = 0, so that the crotch seam runs down in front, under the
//! crotch and up behind.

use crate::Wearer;
use crate::curve::{Point2, Polyline, along, interpolated, resampled, smoothstep};
use crate::draft::Layer;
use crate::top_start::{trunk_middle, trunk_rows};
use crate::wearer::Landmark;

/// Clearance of the legs on the outside, in metres.
const CLEARANCE: f64 = 0.024;
/// How far the crotch of the garment starts below that of the body, on the reference stature.
const CROTCH_DROP: f64 = 0.032;
/// How fast the inseams of the two legs part below the crotch.
const PARTING: f64 = 0.15;
/// Thickness of the leg over that of a circle of its girth.
const LEG_FACTOR: f64 = 1.10;
/// The hem starts at least so far above the ankle joint, in metres.
const ABOVE_ANKLE: f64 = 0.03;
/// Points of a section whose distances give its lengths.
const STEPS: usize = 96;

/// Lengths of the flat pattern that the start shape follows, in metres.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LegSizes {
    pub(crate) inseam: f64,
    /// From the crotch to the upper edge of the waistband.
    pub(crate) rise: f64,
    pub(crate) band: f64,
}

/// The sections of trousers by height.
#[derive(Debug, Clone)]
pub(crate) struct LegStart {
    hem: f64,
    crotch: f64,
    waist: f64,
    top: f64,
    /// Where the section's center reaches the middle.
    hips: f64,
    axis: Vec<(f64, f64)>,
    axis_depth: Vec<(f64, f64)>,
    radius: Vec<(f64, f64)>,
    trunk_width: Vec<(f64, f64)>,
    trunk_bulge: Vec<(f64, f64)>,
    trunk_middle: Vec<(f64, f64)>,
}

impl LegStart {
    pub(crate) fn new(wearer: &Wearer, sizes: &LegSizes) -> Self {
        let (measures, marks) = (&wearer.measures, &wearer.landmarks);
        let scale = measures.stature / 1.75;
        let crotch = measures.inseam - CROTCH_DROP * scale;
        let radius = |girth: f64| LEG_FACTOR * girth / std::f64::consts::TAU;
        let calf = marks.ankle[1] + 0.72 * (marks.knee[1] - marks.ankle[1]);
        let (trunk_width, trunk_bulge) = trunk_rows(wearer);
        let top = measures.inseam + sizes.rise;
        Self {
            hem: (measures.inseam - sizes.inseam)
                .max(marks.ankle[1] + ABOVE_ANKLE)
                .min(crotch - 0.1),
            crotch,
            waist: top - sizes.band,
            top,
            hips: measures.hip_height.max(crotch + 0.08) + 0.025 * scale,
            axis: vec![
                (marks.ankle[1], marks.ankle[0]),
                (marks.knee[1], marks.knee[0]),
                (marks.hip[1], marks.hip[0]),
            ],
            axis_depth: vec![
                (marks.ankle[1], marks.ankle[2]),
                (calf, 0.5 * (marks.knee[2] + marks.ankle[2]) - 0.008 * scale),
                (marks.knee[1], marks.knee[2]),
                (
                    0.5 * (marks.knee[1] + marks.hip[1]),
                    0.5 * (marks.knee[2] + marks.hip[2]),
                ),
                (crotch, marks.hip[2]),
            ],
            radius: vec![
                (
                    marks.ankle[1],
                    radius(measures.ankle).max(radius(measures.calf) * 0.75),
                ),
                (calf, radius(measures.calf)),
                (marks.knee[1], radius(measures.knee)),
                (0.35 * marks.knee[1] + 0.65 * crotch, radius(measures.thigh)),
            ],
            trunk_width,
            trunk_bulge,
            trunk_middle: trunk_middle(wearer),
        }
    }

    /// Heights of the hem, of the crotch and of the waistband's lower edge.
    pub(crate) fn heights(&self) -> [f64; 3] {
        [self.hem, self.crotch, self.waist]
    }

    /// The height of the waistband's upper edge.
    pub(crate) fn top(&self) -> f64 {
        self.top
    }

    /// The crotch seam in the chart, from the waist to the crotch, at equal lengths in space.
    pub(crate) fn crotch_seam(&self) -> Polyline {
        let heights = 400;
        let at = |step: i32| {
            let share = f64::from(step) / f64::from(heights);
            // Finer towards the crotch, where the seam turns level.
            let y = self.crotch + (self.waist - self.crotch) * (1.0 - share) * (1.0 - share);
            [y, self.section(y).at(0.0).1]
        };
        let profile: Polyline = (0..=heights).map(at).collect();
        let seam = resampled(&profile, 96);
        seam.into_iter().map(|[y, _]| [0.0, y]).collect()
    }

    /// Where a chart point `[across, height]` lies in space.
    pub(crate) fn at(&self, layer: Layer, [across, y]: Point2) -> Landmark {
        let section = self.section(y);
        let (x, z) = section.at(across.clamp(0.0, 1.0));
        match layer {
            Layer::Front => [x, y, section.middle + z],
            Layer::Back => [x, y, section.middle - z],
        }
    }

    fn section(&self, y: f64) -> Section {
        let axis = interpolated(&self.axis, y);
        let radius = interpolated(&self.radius, y);
        let on_leg = Section {
            center: axis,
            inner: axis - self.inner(y),
            outer: radius + CLEARANCE,
            bulge: radius + 1.2 * CLEARANCE,
            middle: interpolated(&self.axis_depth, y),
        };
        let width = interpolated(&self.trunk_width, y);
        let bulge = interpolated(&self.trunk_bulge, y);
        let middle = interpolated(&self.trunk_middle, y);
        // From the leg to the trunk: the middle of the section wanders to x = 0.
        let share = ((y - self.crotch) / (self.hips - self.crotch)).clamp(0.0, 1.0);
        let center = axis * (1.0 - share);
        let soft = smoothstep(self.crotch - 0.10, self.crotch + 0.04, y);
        let mix = |leg: f64, trunk: f64| leg + soft * (trunk - leg);
        let outermost = mix(on_leg.center + on_leg.outer, width);
        Section {
            center,
            inner: if y > self.crotch { axis } else { on_leg.inner },
            outer: outermost - center,
            bulge: mix(on_leg.bulge, bulge),
            middle: mix(on_leg.middle, middle),
        }
    }

    /// Where the inseam runs: between the legs, then along the leg.
    fn inner(&self, y: f64) -> f64 {
        let parted = PARTING * (self.crotch - y).max(0.0);
        let leg = interpolated(&self.axis, y) - interpolated(&self.radius, y) - CLEARANCE;
        parted.min(leg.max(0.3 * parted))
    }
}

/// Half an ellipse with two inner and outer half axes, from the inside to the outside.
#[derive(Debug, Clone, Copy)]
struct Section {
    center: f64,
    inner: f64,
    outer: f64,
    bulge: f64,
    middle: f64,
}

impl Section {
    /// Side and depth at a share of the length from the inner end, where x is not negative.
    fn at(&self, share: f64) -> (f64, f64) {
        let first = (self.center / self.inner).clamp(0.0, 1.0).acos();
        let point = |step: usize| {
            let angle = first + (std::f64::consts::PI - first) * step as f64 / STEPS as f64;
            let half = if angle.cos() > 0.0 {
                self.inner
            } else {
                self.outer
            };
            let x = self.center - half * angle.cos();
            [x.max(0.0), self.bulge * angle.sin().max(0.0)]
        };
        let curve: Polyline = (0..=STEPS).map(point).collect();
        let [x, z] = along(&curve, share);
        (x, z)
    }
}
