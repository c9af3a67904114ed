//! The start shape of a shirt or dress: two layers that hang apart around the wearer.
//!
//! Both layers lie over the same figure in the frontal plane, whose border runs along the sides,
//! under and over the arms and over the shoulders, outside the body; one bulges to the front, the
//! other to the back, far enough to clear it. Two layers over one figure cannot cross each other.

use crate::Wearer;
use crate::curve::{
    Point2, Polyline, along, bezier, distance, inside_of, interpolated, lerp, line, resampled,
    smoothstep,
};
use crate::draft::Layer;
use crate::wearer::Landmark;

/// Clearance of trunk and arms, in metres.
const CLEARANCE: f64 = 0.028;
/// And more of it over the shoulder joint.
const SHOULDER_CLEARANCE: f64 = 0.012;
/// How far the shoulders are lifted, in metres.
const LIFT: f64 = 0.055;
/// The half width of a trunk is below this share of its girth.
const HALF_BREADTH: f64 = 0.207;
/// Its half depth is below this share of its girth.
const HALF_DEPTH: f64 = 0.158;
/// The tip of the shoulder lies outside the joint by this, in metres.
const TIP_OUTSIDE: f64 = 0.012;
/// The layers close over the shoulders within this distance, in metres.
const SHOULDER_CLOSING: f64 = 0.13;
/// Thickness of the arm over that of the convex girth.
const ARM_FACTOR: f64 = 1.12;

/// Across the trunk a layer bulges by 1 - u^p, u from the middle (0) to the side (1).
const TRUNK_POWER: f64 = 3.0;
/// A layer bulges at least by this share of its half width.
const LEAST_DEPTH: f64 = 0.5;

/// A length at places in increasing order, `(place, length)`, in metres.
pub(crate) type Rows = Vec<(f64, f64)>;

/// Lengths of the flat pattern that the start shape follows, in metres.
#[derive(Debug, Clone)]
pub(crate) struct Sizes {
    /// Half width of the neckline.
    pub(crate) neck: f64,
    /// Depth of the neckline, front and back.
    pub(crate) neck_depth: [f64; 2],
    /// Length of the side seam above a rib.
    pub(crate) side: f64,
    /// Half widths of the flat pattern by distance below the underarm.
    pub(crate) rows: Rows,
    /// Lengths of the top and of the underarm seam of the sleeve.
    pub(crate) sleeve: Option<(f64, f64)>,
    /// Height of the rib or skirt below the bodice.
    pub(crate) below: f64,
    /// Height of the rib at the cuffs.
    pub(crate) cuff_rib: f64,
    /// Height of the rib at the neck.
    pub(crate) neck_rib: f64,
}

/// The figure and the bulge of its layers.
#[derive(Debug, Clone)]
pub(crate) struct TopStart {
    shoulder: Landmark,
    neck_joint: Landmark,
    arm_middle: Rows,
    trunk_middle: Rows,
    /// Unit vectors along the arm and across it, upwards.
    along: Point2,
    across: Point2,
    /// Half width of the sleeve by distance along the arm from the shoulder joint.
    arm_rows: Rows,
    arm_bulge: Rows,
    /// Half width and bulge of the trunk by height.
    width_rows: Rows,
    bulge_rows: Rows,
    neck: Point2,
    collar: Point2,
    tip: Point2,
    underarm: Point2,
    neck_low: [f64; 2],
    hem: f64,
    below: f64,
    /// Along the arm: where sleeve and rib end.
    cuff: [f64; 2],
}

impl TopStart {
    pub(crate) fn new(wearer: &Wearer, sizes: &Sizes) -> Self {
        let (measures, marks) = (&wearer.measures, &wearer.landmarks);
        let s = marks.shoulder;
        let reach = [marks.wrist[0] - s[0], marks.wrist[1] - s[1]];
        let arm = reach[0].hypot(reach[1]);
        let along = [reach[0] / arm, reach[1] / arm];
        let across = [-along[1], along[0]];
        let to_elbow = distance([s[0], s[1]], [marks.elbow[0], marks.elbow[1]]);
        let radius = |girth: f64| ARM_FACTOR * girth / std::f64::consts::TAU;
        let arm_radii = [
            (0.0, radius(measures.upper_arm)),
            (0.75 * to_elbow, radius(measures.upper_arm)),
            (to_elbow, radius(measures.forearm)),
            (to_elbow + 0.4 * (arm - to_elbow), radius(measures.forearm)),
            (arm, radius(measures.wrist).max(0.032)),
        ];
        let mut arm_rows: Vec<_> = arm_radii.iter().map(|&(t, r)| (t, r + CLEARANCE)).collect();
        arm_rows[0].1 += SHOULDER_CLEARANCE;
        let mut arm_bulge: Vec<_> = arm_radii
            .iter()
            .map(|&(t, r)| (t, r + 1.3 * CLEARANCE))
            .collect();
        arm_bulge[0].1 += SHOULDER_CLEARANCE;

        let (width_rows, bulge_rows) = trunk_rows(wearer);
        let mut start = Self {
            shoulder: s,
            neck_joint: marks.neck,
            arm_middle: vec![
                (0.0, s[2]),
                (to_elbow, marks.elbow[2]),
                (arm, marks.wrist[2]),
            ],
            trunk_middle: trunk_middle(wearer),
            along,
            across,
            arm_rows,
            arm_bulge,
            width_rows,
            bulge_rows,
            neck: [0.0; 2],
            collar: [0.0; 2],
            tip: [0.0; 2],
            underarm: [0.0; 2],
            neck_low: [0.0; 2],
            hem: 0.0,
            below: sizes.below,
            cuff: [0.0; 2],
        };
        start.place_neck(wearer, sizes);
        start.place_sleeve(sizes, arm);
        start.widen(sizes);
        start
    }

    fn place_neck(&mut self, wearer: &Wearer, sizes: &Sizes) {
        let neck_radius = wearer.measures.neck / std::f64::consts::TAU;
        let base = self.neck_joint[1];
        let collar_x = (1.45 * neck_radius + 0.012).max(sizes.neck - sizes.neck_rib);
        self.collar = [collar_x, base + LIFT];
        // The tip lies where the top of the sleeve passes the shoulder joint.
        let width = interpolated(&self.arm_rows, 0.0);
        let t = (TIP_OUTSIDE - width * self.across[0]) / self.along[0].max(0.2);
        self.tip = [
            self.shoulder[0] + TIP_OUTSIDE,
            self.shoulder[1] + t * self.along[1] + width * self.across[1],
        ];
        let share = (sizes.neck_rib.max(1e-3) / distance(self.collar, self.tip)).min(0.45);
        self.neck = lerp(self.collar, self.tip, share);
        let [front, back] = sizes.neck_depth;
        self.neck_low = [base - front, base - back.max(0.025)];
    }

    fn place_sleeve(&mut self, sizes: &Sizes, arm: f64) {
        // The underarm: where the lower line of the sleeve meets the side of the trunk.
        let mut t = 0.15;
        for _ in 0..30 {
            let point = self.on_arm(t, -1.0);
            let side = interpolated(&self.width_rows, point[1]) + 0.004;
            t += (side - point[0]) / self.along[0].max(0.2) * 0.7;
        }
        self.underarm = self.on_arm(t, -1.0);
        self.hem = self.underarm[1] - sizes.side;
        let top_from = self.arm_coordinates(self.tip)[0];
        let (top, under) = sizes.sleeve.unwrap_or((0.0, 0.0));
        let wanted = (top_from + top).max(t + (0.6 * under).max(0.05));
        // A sleeve that is longer than the arm is pushed together above the hand.
        let end = wanted.min(arm - 0.005).max(t + 0.04);
        self.cuff = [end - sizes.cuff_rib.min(0.3 * (end - t)), end];
    }

    /// A garment that is much wider than its wearer starts wider.
    fn widen(&mut self, sizes: &Sizes) {
        let bottom = self.hem - sizes.below;
        let top = self.underarm[1];
        let mut rows = Vec::new();
        let mut bulges = Vec::new();
        for step in 0..=40 {
            let y = bottom - 0.05 + (top - bottom + 0.05) * f64::from(step) / 40.0;
            let body = interpolated(&self.width_rows, y);
            let cloth = 0.80 * interpolated(&sizes.rows, (top - y).max(0.0));
            // Nothing is widened at the underarm.
            let share = smoothstep(0.0, 0.26, top - y);
            let width = body + share * (cloth - body).max(0.0);
            rows.push((y, width));
            let bulge = interpolated(&self.bulge_rows, y);
            bulges.push((y, bulge.max(LEAST_DEPTH * width)));
        }
        rows.extend(self.width_rows.iter().filter(|row| row.0 > top).copied());
        bulges.extend(self.bulge_rows.iter().filter(|row| row.0 > top).copied());
        self.width_rows = rows;
        self.bulge_rows = bulges;
    }

    /// The point at a distance along the arm, on its axis (0) or on the border (1 and -1).
    fn on_arm(&self, t: f64, side: f64) -> Point2 {
        let width = side * interpolated(&self.arm_rows, t);
        [
            self.shoulder[0] + t * self.along[0] + width * self.across[0],
            self.shoulder[1] + t * self.along[1] + width * self.across[1],
        ]
    }

    fn arm_coordinates(&self, [x, y]: Point2) -> [f64; 2] {
        let d = [x - self.shoulder[0], y - self.shoulder[1]];
        [
            d[0] * self.along[0] + d[1] * self.along[1],
            d[0] * self.across[0] + d[1] * self.across[1],
        ]
    }

    pub(crate) fn hem(&self) -> f64 {
        self.hem
    }

    pub(crate) fn bottom(&self) -> Point2 {
        [interpolated(&self.width_rows, self.hem), self.hem]
    }

    /// The lower corner of what hangs below the bodice.
    pub(crate) fn lowest(&self) -> Point2 {
        let low = self.hem - self.below;
        [interpolated(&self.width_rows, low), low]
    }

    /// From the bottom to the underarm.
    pub(crate) fn side(&self) -> Polyline {
        let mut side = self.border(self.hem, self.underarm[1]);
        side.pop();
        side.push(self.underarm);
        side
    }

    /// From the lower corner to the bottom of the bodice.
    pub(crate) fn side_below(&self) -> Polyline {
        self.border(self.hem - self.below, self.hem)
    }

    fn border(&self, low: f64, high: f64) -> Polyline {
        let at = |step: i32| {
            let y = low + (high - low) * f64::from(step) / 48.0;
            [interpolated(&self.width_rows, y), y]
        };
        (0..=48).map(at).collect()
    }

    pub(crate) fn tip(&self) -> Point2 {
        self.tip
    }

    pub(crate) fn neck(&self) -> Point2 {
        self.neck
    }

    pub(crate) fn collar(&self) -> Point2 {
        self.collar
    }

    pub(crate) fn neck_low(&self, layer: Layer) -> f64 {
        self.neck_low[layer as usize]
    }

    pub(crate) fn collar_low(&self, layer: Layer) -> f64 {
        self.neck_low(layer) + distance(self.collar, self.neck)
    }

    pub(crate) fn neckline(&self, layer: Layer) -> Polyline {
        hole(self.neck, self.neck_low(layer))
    }

    pub(crate) fn collar_line(&self, layer: Layer) -> Polyline {
        inside_of(
            &self.neckline(layer),
            self.tip,
            distance(self.collar, self.neck),
        )
    }

    /// From the underarm to the tip.
    pub(crate) fn armhole(&self) -> Polyline {
        line(self.underarm, self.tip)
    }

    /// From the underarm to the cuff's lower corner.
    pub(crate) fn under_sleeve(&self) -> Polyline {
        let from = self.arm_coordinates(self.underarm)[0];
        self.along_arm(from, self.cuff[0], -1.0)
    }

    /// From the cuff to the tip.
    pub(crate) fn sleeve_top(&self) -> Polyline {
        let to = self.arm_coordinates(self.tip)[0];
        self.along_arm(self.cuff[0], to, 1.0)
    }

    fn along_arm(&self, from: f64, to: f64, side: f64) -> Polyline {
        let at = |step: i32| self.on_arm(from + (to - from) * f64::from(step) / 32.0, side);
        (0..=32).map(at).collect()
    }

    /// From the lower to the upper corner of the sleeve's end (0) or of its rib's end (1).
    pub(crate) fn cuff(&self, end: f64) -> Polyline {
        let t = self.cuff[0] + end * (self.cuff[1] - self.cuff[0]);
        line(self.on_arm(t, -1.0), self.on_arm(t, 1.0))
    }

    /// Where a point of the figure lies in space; points of the border close both layers.
    pub(crate) fn at(&self, layer: Layer, [x, y]: Point2, closes: bool) -> Landmark {
        let x = x + self.trunk_only(y) * (self.spread([x, y]) - x);
        let middle = self.middle([x, y]);
        let bulge = if closes { 0.0 } else { self.bulge([x, y]) };
        match layer {
            Layer::Front => [x, y, middle + bulge],
            Layer::Back => [x, y, middle - bulge],
        }
    }

    /// 1 below the sleeves, 0 beside them.
    fn trunk_only(&self, y: f64) -> f64 {
        1.0 - smoothstep(self.underarm[1] - 0.10, self.underarm[1], y)
    }

    /// Moves a point sideways, so that shares of the figure's width become shares of the length
    /// across the bulging layer: cloth is spread evenly, not stretched at the sides.
    fn spread(&self, [x, y]: Point2) -> f64 {
        const STEPS: usize = 48;
        let width = interpolated(&self.width_rows, y);
        let bulge = interpolated(&self.bulge_rows, y);
        let at = |step: usize| {
            let u = step as f64 / STEPS as f64;
            [u * width, bulge * trunk_lens(u)]
        };
        let curve: Polyline = (0..=STEPS).map(at).collect();
        if x >= width {
            return x;
        }
        let share = (x / width).max(0.0);
        along(&curve, share)[0]
    }

    fn middle(&self, point: Point2) -> f64 {
        let [t, c] = self.arm_coordinates(point);
        let width = interpolated(&self.arm_rows, t);
        let on_arm = smoothstep(-0.05, 0.15, t) * (1.0 - smoothstep(1.0, 2.2, c.abs() / width));
        let trunk = interpolated(&self.trunk_middle, point[1]);
        trunk + on_arm * (interpolated(&self.arm_middle, t) - trunk)
    }

    fn bulge(&self, point: Point2) -> f64 {
        let [t, c] = self.arm_coordinates(point);
        let lens = |share: f64| (1.0 - share * share).max(0.0);
        let closing = |distance: f64| {
            let open = (distance / SHOULDER_CLOSING).clamp(0.0, 1.0);
            1.0 - (1.0 - open) * (1.0 - open)
        };
        let width = interpolated(&self.width_rows, point[1]);
        // Distance below the line from neck to shoulder, and below the top of the arm.
        let [dx, dy] = [self.tip[0] - self.neck[0], self.tip[1] - self.neck[1]];
        let size = dx.hypot(dy);
        let roof = ((point[0] - self.neck[0]) * dy - (point[1] - self.neck[1]) * dx) / size;
        let arm_width = interpolated(&self.arm_rows, t);
        let below = roof.min(arm_width - c);
        let trunk = interpolated(&self.bulge_rows, point[1])
            * trunk_lens(point[0] / width)
            * closing(below);
        let fade = smoothstep(0.0, 0.06, roof);
        let arm = if t > -0.1 {
            interpolated(&self.arm_bulge, t) * lens(c / arm_width) * fade
        } else {
            0.0
        };
        trunk.max(arm)
    }
}

fn trunk_lens(share: f64) -> f64 {
    (1.0 - share.abs().powf(TRUNK_POWER)).max(0.0)
}

/// From the neck's side to the middle.
fn hole(side: Point2, low: f64) -> Polyline {
    let drop = side[1] - low;
    let curve = bezier(
        side,
        [side[0] * 0.98, side[1] - 0.62 * drop],
        [side[0] * 0.62, low],
        [0.0, low],
    );
    resampled(&curve, 96)
}

/// Half width and bulge of the trunk by height, from the feet up.
pub(crate) fn trunk_rows(wearer: &Wearer) -> (Rows, Rows) {
    let (measures, marks) = (&wearer.measures, &wearer.landmarks);
    let leg = |joint: Landmark, girth: f64| joint[0] + 1.4 * girth / std::f64::consts::TAU;
    // A low bust is as wide and deep as the chest.
    let bust = (measures.chest_height - 0.075 * measures.stature)
        .max(0.6 * measures.waist_height + 0.4 * measures.chest_height);
    let widths = [
        (marks.ankle[1], leg(marks.ankle, measures.calf)),
        (marks.knee[1], leg(marks.knee, measures.knee)),
        (
            measures.inseam - 0.08,
            (HALF_BREADTH * measures.hip).max(0.012 + leg(marks.hip, measures.thigh)),
        ),
        (measures.hip_height, HALF_BREADTH * measures.hip),
        (measures.waist_height, HALF_BREADTH * measures.waist),
        (bust, HALF_BREADTH * measures.chest),
        (
            marks.shoulder[1],
            (HALF_BREADTH * measures.chest).max(marks.shoulder[0] + 0.04),
        ),
    ];
    let deepest = measures.hip.max(measures.waist);
    let depths = [
        (marks.knee[1], HALF_DEPTH * measures.hip),
        (
            measures.hip_height,
            HALF_DEPTH * (0.7 * measures.hip + 0.3 * deepest),
        ),
        (measures.waist_height, HALF_DEPTH * measures.waist),
        (bust, 1.05 * HALF_DEPTH * measures.chest),
        (marks.shoulder[1], HALF_DEPTH * measures.chest),
    ];
    let widths = widths.map(|(y, half)| (y, half + CLEARANCE)).to_vec();
    let bulges = depths.map(|(y, half)| (y, half + 1.3 * CLEARANCE)).to_vec();
    (widths, bulges)
}

/// The depth of the middle of the trunk by height.
pub(crate) fn trunk_middle(wearer: &Wearer) -> Rows {
    let (measures, marks) = (&wearer.measures, &wearer.landmarks);
    let scale = measures.stature / 1.75;
    vec![
        (marks.knee[1], 0.0),
        (measures.hip_height, marks.pelvis[2] - 0.012 * scale),
        (measures.waist_height, marks.spine[0][2] + 0.036 * scale),
        (measures.chest_height, marks.spine[2][2] + 0.040 * scale),
        (marks.shoulder[1], marks.shoulder[2]),
        (marks.neck[1], marks.neck[2]),
    ]
}
