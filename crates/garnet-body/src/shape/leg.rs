//! Thigh, shank and foot of the left side.

use super::Measure;
use super::anatomy::Anatomy;
use super::primitives::{
    Bump, Capsule, Loft, Section, Vec3, length, smooth_intersection, smooth_union,
};

/// Where along thigh and shank the girths are taken.
pub(crate) const THIGH_PLACE: f64 = 0.21;
pub(crate) const CALF_PLACE: f64 = 0.28;
pub(crate) const ANKLE_PLACE: f64 = 0.88;

/// How far the thigh reaches above the hip joint, in lengths from hip to knee.
const ABOVE_HIP: f64 = 0.30;

/// Width of the blend of thigh and shank, in metres.
const KNEE_BLEND: f64 = 0.03;

/// A leg and its foot.
#[derive(Debug, Clone)]
pub(crate) struct Leg {
    pub(crate) thigh: Loft,
    pub(crate) shank: Loft,
    pub(crate) foot: Foot,
    bumps: Vec<Bump>,
    size: f64,
}

impl Leg {
    #[expect(clippy::too_many_lines, reason = "tables of sections and bumps")]
    pub(crate) fn new(anatomy: &Anatomy) -> Self {
        let s = anatomy.size;
        let joints = &anatomy.joints;
        let thigh = anatomy.radius(Measure::Thigh);
        let knee = anatomy.radius(Measure::Knee);
        let calf = anatomy.radius(Measure::Calf);
        let ankle = anatomy.radius(Measure::Ankle);

        // Flesh that does not fit between the legs goes to the outer side.
        let lean = joints.knee.x - joints.hip.x;
        let room = joints.hip.x + THIGH_PLACE * lean;
        let outward = soft_excess(0.93 * thigh + 0.014 - room, 0.003);
        // Up there the section is placed by where it ends on the outer side.
        let half_hip = 0.5 * anatomy.hip_breadth * anatomy.corrections[Measure::Hip];
        let waist = anatomy.girth(Measure::Waist);
        let hip = 0.60 * anatomy.radius(Measure::Hip);
        let lateral = |place: f64, outer: f64, side: f64, depth: f64, shift: f64| {
            let axis = joints.hip.x + lean * place;
            let center = outer - side - axis + shift;
            (
                place,
                Section::ellipse(side, depth).centered(center, -0.003),
            )
        };
        let part = |share: f64| knee + share * (thigh - knee);
        // Where both lofts end, their union is thicker by a quarter of its width.
        let joint = knee - 0.25 * KNEE_BLEND * s;
        let thigh_sections = [
            lateral(
                -ABOVE_HIP,
                (0.158 * waist).min(0.88 * half_hip),
                0.56 * hip,
                0.60 * hip,
                0.0,
            ),
            lateral(
                -0.15,
                0.975 * half_hip,
                0.82 * hip,
                0.84 * hip,
                0.3 * outward,
            ),
            lateral(
                0.04,
                1.015 * half_hip,
                0.70 * hip + 0.22 * thigh,
                0.75 * hip + 0.23 * thigh,
                0.6 * outward,
            ),
            (
                0.20,
                Section::ellipse(0.93 * thigh, 1.07 * thigh).centered(outward, 0.0),
            ),
            (
                0.32,
                Section::ellipse(0.95 * part(0.92), 1.04 * part(0.92))
                    .centered(0.85 * outward, 0.004 * s),
            ),
            (
                0.50,
                Section::ellipse(0.95 * part(0.69), 1.05 * part(0.69))
                    .centered(0.5 * outward, 0.007 * s),
            ),
            (
                0.70,
                Section::ellipse(0.96 * part(0.39), 1.05 * part(0.39))
                    .centered(0.2 * outward, 0.006 * s),
            ),
            (
                0.86,
                Section::ellipse(0.98 * part(0.12), 1.02 * part(0.12)).centered(0.0, 0.004 * s),
            ),
            (1.0, Section::ellipse(0.98 * joint, 1.02 * joint)),
        ]
        .map(|(place, section)| ((place + ABOVE_HIP) / (1.0 + ABOVE_HIP), section));
        let lower = |share: f64| ankle + share * (calf - ankle);
        let shank_sections = [
            (0.0, Section::ellipse(0.98 * joint, 1.02 * joint)),
            (
                0.12,
                Section::ellipse(
                    0.94 * (0.5 * knee + 0.5 * calf),
                    0.97 * (0.5 * knee + 0.5 * calf),
                )
                .centered(0.0, -0.006 * s),
            ),
            (
                0.28,
                Section::ellipse(0.98 * calf, 1.02 * calf).centered(0.001 * s, -0.014 * s),
            ),
            (
                0.42,
                Section::ellipse(0.95 * lower(0.88), 1.02 * lower(0.88))
                    .centered(0.001 * s, -0.014 * s),
            ),
            (
                0.62,
                Section::ellipse(0.94 * lower(0.42), 1.02 * lower(0.42)).centered(0.0, -0.008 * s),
            ),
            (
                0.80,
                Section::ellipse(0.95 * lower(0.03), 1.06 * lower(0.03)).centered(0.0, -0.003 * s),
            ),
            (
                0.88,
                Section::ellipse(0.96 * ankle, 1.06 * ankle).centered(0.0, -0.002 * s),
            ),
            (
                1.0,
                Section::ellipse(1.04 * ankle, 1.08 * ankle).centered(0.0, -0.002 * s),
            ),
        ];
        let k = joints.knee;
        let a = joints.ankle;
        let softness = 0.5 + 0.5 * (0.34 / anatomy.waist_aspect.max(0.5)).min(1.0);
        let bumps = vec![
            // Patella, and the hollow behind the knee.
            Bump::new(
                0.006 * s,
                [k.x, k.y + 0.006 * s, k.z + knee],
                [0.026 * s, 0.032 * s, 0.026 * s],
            ),
            Bump::new(
                -0.007 * s,
                [k.x, k.y, k.z - knee],
                [0.022 * s, 0.045 * s, 0.025 * s],
            ),
            // The two heads of the calf muscle, the inner one lower and fuller.
            Bump::new(
                0.004 * s * softness,
                [k.x + 0.008 * s, k.y - 0.125 * s, k.z - calf],
                [0.024 * s, 0.050 * s, 0.04 * s],
            ),
            // Muscle above the knee on the inner side.
            Bump::new(
                0.004 * s * softness,
                [k.x - 0.85 * knee, k.y + 0.065 * s, k.z + 0.5 * knee],
                [0.022 * s, 0.034 * s, 0.03 * s],
            ),
            // Ankle bones: the inner one higher than the outer.
            Bump::new(
                0.006 * s,
                [a.x - ankle, a.y + 0.006 * s, a.z + 0.004],
                [0.012 * s, 0.013 * s, 0.013 * s],
            ),
            Bump::new(
                0.006 * s,
                [a.x + ankle, a.y - 0.006 * s, a.z - 0.004],
                [0.012 * s, 0.013 * s, 0.013 * s],
            ),
            // Hollows beside the heel's tendon.
            Bump::new(
                -0.005 * s,
                [a.x + 0.8 * ankle, a.y + 0.025 * s, a.z - 0.9 * ankle],
                [0.014 * s, 0.03 * s, 0.014 * s],
            ),
            Bump::new(
                -0.005 * s,
                [a.x - 0.8 * ankle, a.y + 0.025 * s, a.z - 0.9 * ankle],
                [0.014 * s, 0.03 * s, 0.014 * s],
            ),
        ];
        Self {
            thigh: Loft::new(
                [
                    joints.hip + ABOVE_HIP * (joints.hip - joints.knee),
                    joints.knee,
                ],
                Vec3::x(),
                &thigh_sections,
                0.04,
            )
            .with_caps([0.5, 1.0]),
            shank: Loft::new(
                [joints.knee, joints.ankle],
                Vec3::x(),
                &shank_sections,
                0.035,
            ),
            foot: Foot::new(anatomy),
            bumps,
            size: s,
        }
    }

    /// Distance to thigh, shank and foot.
    pub(crate) fn distance(&self, point: &Vec3) -> f64 {
        let s = self.size;
        let thigh = self.thigh.distance(point);
        let shank = self.shank.distance(point);
        let mut leg = smooth_union(thigh, shank, KNEE_BLEND * s);
        if point.y < 0.24 * s {
            leg = smooth_union(leg, self.foot.distance(point), 0.03 * s);
        }
        if leg < 0.05 {
            leg -= self.bumps.iter().map(|bump| bump.at(point)).sum::<f64>();
        }
        if point.y < 0.24 * s {
            leg = smooth_intersection(leg, -point.y, 0.010 * s);
        }
        leg
    }
}

/// `max(value, 0)` with a bend of width `softness`.
pub(crate) fn soft_excess(value: f64, softness: f64) -> f64 {
    0.5 * (value + length(value, 2.0 * softness))
}

/// The foot, with its sole on the floor.
#[derive(Debug, Clone)]
pub(crate) struct Foot {
    sole: Loft,
    instep: Capsule,
    heel: Capsule,
    toes: [Capsule; 2],
    grooves: [Bump; 4],
    arch: Bump,
    size: f64,
}

impl Foot {
    #[expect(clippy::too_many_lines, reason = "tables of sections")]
    fn new(anatomy: &Anatomy) -> Self {
        let s = anatomy.size;
        let length = anatomy.foot_length;
        let ankle = anatomy.joints.ankle;
        let forward = Vec3::new(0.14, 0.0, 1.0).normalize();
        let outward = Vec3::new(forward.z, 0.0, -forward.x);
        let w = length * anatomy.mix(1.0, 0.965);
        // Places on the sole: along the foot from the heel's end, and outward from its middle line.
        let floor = Vec3::new(ankle.x, 0.0, ankle.z) - forward * (0.235 * length);
        let place = |along: f64, out: f64, height: f64| {
            floor + forward * (along * length) + outward * (out * w) + Vec3::y() * (height * length)
        };
        // Heights are of the middle of a section and of half of it; the floor cuts below zero.
        let sole_sections = [
            (
                0.0,
                Section::ellipse(0.100 * w, 0.110 * length)
                    .centered(0.0, 0.110 * length)
                    .squared(2.2),
            ),
            (
                0.16,
                Section::ellipse(0.118 * w, 0.120 * length)
                    .centered(0.002 * w, 0.115 * length)
                    .squared(2.2),
            ),
            (
                0.40,
                Section::ellipse(0.125 * w, 0.120 * length)
                    .centered(0.008 * w, 0.110 * length)
                    .squared(2.2),
            ),
            (
                0.62,
                Section::ellipse(0.158 * w, 0.100 * length)
                    .centered(0.010 * w, 0.080 * length)
                    .squared(2.3),
            ),
            (
                0.76,
                Section::ellipse(0.180 * w, 0.078 * length)
                    .centered(0.004 * w, 0.056 * length)
                    .squared(2.4),
            ),
            (
                0.88,
                Section::ellipse(0.168 * w, 0.058 * length)
                    .centered(-0.006 * w, 0.040 * length)
                    .squared(2.6),
            ),
            (
                1.0,
                Section::ellipse(0.130 * w, 0.046 * length)
                    .centered(-0.030 * w, 0.034 * length)
                    .squared(2.6),
            ),
        ];
        let start = place(0.11, 0.0, 0.0);
        let end = place(0.955, 0.0, 0.0);
        let groove = |out: f64, along: f64, depth: f64| {
            Bump::new(
                -depth * length,
                place(along, out, 0.060).into(),
                [0.0055 * s, 0.022 * s, 0.020 * s],
            )
        };
        Self {
            sole: Loft::new([start, end], outward, &sole_sections, 0.05).with_caps([1.0, 0.9]),
            instep: Capsule::new(
                ankle + Vec3::new(0.0, 0.006 * s, 0.012 * s),
                place(0.60, -0.015, 0.130),
                [0.034 * s, 0.020 * s],
            ),
            heel: Capsule::new(
                place(0.125, 0.0, 0.115),
                place(0.150, 0.0, 0.26),
                [0.112 * length, 0.085 * length],
            ),
            toes: [
                Capsule::new(
                    place(0.80, -0.095, 0.055),
                    place(0.948, -0.100, 0.048),
                    [0.052 * length, 0.047 * length],
                ),
                Capsule::new(
                    place(0.78, 0.030, 0.050),
                    place(0.930, -0.020, 0.038),
                    [0.050 * length, 0.036 * length],
                ),
            ],
            grooves: [
                groove(-0.052, 0.945, 0.016),
                groove(0.006, 0.93, 0.012),
                groove(0.052, 0.90, 0.011),
                groove(0.094, 0.865, 0.010),
            ],
            arch: Bump::new(
                -0.012 * s,
                place(0.45, -0.13, 0.0).into(),
                [0.030 * s, 0.022 * s, 0.042 * s],
            ),
            size: s,
        }
    }

    fn distance(&self, point: &Vec3) -> f64 {
        let s = self.size;
        let mut foot = smooth_union(
            self.sole.distance(point),
            self.instep.distance(point),
            0.035 * s,
        );
        foot = smooth_union(foot, self.heel.distance(point), 0.02 * s);
        for toe in &self.toes {
            foot = smooth_union(foot, toe.distance(point), 0.014 * s);
        }
        let grooves: f64 = self.grooves.iter().map(|groove| groove.at(point)).sum();
        foot - self.arch.at(point) - grooves
    }
}
