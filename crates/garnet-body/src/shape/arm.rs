//! Upper arm, forearm and hand of the left side.

use super::Measure;
use super::anatomy::Anatomy;
use super::primitives::{Bump, Capsule, Loft, Section, Vec3, smooth_union};

/// Where along upper arm and forearm the girths are taken.
pub(crate) const UPPER_ARM_PLACE: f64 = 0.5;
pub(crate) const FOREARM_PLACE: f64 = 0.2;
pub(crate) const WRIST_PLACE: f64 = 0.95;

/// Width of the blend of upper arm and forearm, in metres.
const ELBOW_BLEND: f64 = 0.024;

/// An arm and its hand.
#[derive(Debug, Clone)]
pub(crate) struct Arm {
    pub(crate) upper: Loft,
    pub(crate) fore: Loft,
    pub(crate) hand: Hand,
    bumps: Vec<Bump>,
    size: f64,
}

impl Arm {
    pub(crate) fn new(anatomy: &Anatomy) -> Self {
        let s = anatomy.size;
        let joints = &anatomy.joints;
        let upper = anatomy.radius(Measure::UpperArm);
        let fore = anatomy.radius(Measure::Forearm);
        let wrist = anatomy.radius(Measure::Wrist);
        let elbow = 0.5 * (0.86 * upper + 0.94 * fore);
        // Where both lofts end, their union is thicker by a quarter of its width.
        let joint = elbow - 0.25 * ELBOW_BLEND * s;
        let deltoid = 0.5 * upper + 0.5 * 0.052 * s;

        let upper_sections = [
            (
                0.0,
                Section::ellipse(1.12 * deltoid, 1.16 * deltoid).centered(-0.004 * s, 0.0),
            ),
            (
                0.18,
                Section::ellipse(1.08 * deltoid, 1.14 * deltoid).centered(0.003 * s, 0.0),
            ),
            (
                0.36,
                Section::ellipse(0.97 * upper, 1.07 * upper).centered(0.001 * s, 0.001),
            ),
            (
                0.50,
                Section::ellipse(0.95 * upper, 1.05 * upper).centered(0.0, 0.002),
            ),
            (
                0.68,
                Section::ellipse(
                    0.94 * (0.7 * upper + 0.3 * elbow),
                    1.02 * (0.7 * upper + 0.3 * elbow),
                )
                .centered(0.0, 0.002),
            ),
            (0.88, Section::ellipse(0.98 * elbow, 0.98 * elbow)),
            (1.0, Section::ellipse(joint, 0.97 * joint)),
        ];
        let lower = |share: f64| wrist + share * (fore - wrist);
        let fore_sections = [
            (0.0, Section::ellipse(joint, 0.97 * joint)),
            (
                0.20,
                Section::ellipse(1.00 * fore, 1.00 * fore).centered(0.0, 0.002 * s),
            ),
            (
                0.36,
                Section::ellipse(0.97 * lower(0.90), 1.02 * lower(0.90)).centered(0.0, 0.002 * s),
            ),
            (
                0.60,
                Section::ellipse(0.92 * lower(0.54), 1.06 * lower(0.54)),
            ),
            (
                0.82,
                Section::ellipse(0.86 * lower(0.10), 1.12 * lower(0.10)),
            ),
            (0.95, Section::ellipse(0.82 * wrist, 1.16 * wrist)),
            (1.0, Section::ellipse(0.82 * wrist, 1.17 * wrist)),
        ];
        let down = (joints.elbow - joints.shoulder).normalize();
        let side = Vec3::new(-down.y, down.x, 0.0);
        let e = joints.elbow;
        let olecranon = e - Vec3::z() * (0.8 * elbow) + side * (0.3 * elbow);
        let hollow = e + Vec3::z() * elbow;
        let w = joints.wrist + side * wrist - Vec3::z() * (0.8 * wrist);
        let bumps = vec![
            // The point of the elbow, the hollow of the elbow, the knob of the wrist.
            Bump::new(0.003 * s, olecranon.into(), [0.016 * s; 3]),
            Bump::new(-0.003 * s, hollow.into(), [0.022 * s; 3]),
            Bump::new(0.0022 * s, w.into(), [0.011 * s; 3]),
        ];
        Self {
            upper: Loft::new([joints.shoulder, joints.elbow], side, &upper_sections, 0.05),
            fore: Loft::new([joints.elbow, joints.wrist], side, &fore_sections, 0.045),
            hand: Hand::new(anatomy, wrist),
            bumps,
            size: s,
        }
    }

    /// Distance to arm and hand.
    pub(crate) fn distance(&self, point: &Vec3) -> f64 {
        let s = self.size;
        let upper = self.upper.distance(point);
        let fore = self.fore.distance(point);
        let mut arm = smooth_union(upper, fore, ELBOW_BLEND * s);
        if arm < 0.05 {
            arm -= self.bumps.iter().map(|bump| bump.at(point)).sum::<f64>();
        }
        if (point - self.hand.center).norm() < self.hand.reach {
            arm = smooth_union(arm, self.hand.distance(point), 0.014 * s);
        }
        arm
    }
}

/// A hand with its fingers almost together.
#[derive(Debug, Clone)]
pub(crate) struct Hand {
    palm: Loft,
    thumb: [Capsule; 2],
    fingers: Vec<[Capsule; 2]>,
    center: Vec3,
    reach: f64,
    size: f64,
}

impl Hand {
    fn new(anatomy: &Anatomy, wrist: f64) -> Self {
        let length = anatomy.hand_length;
        let along = (anatomy.joints.fingertip - anatomy.joints.wrist).normalize();
        let thumb_side = (Vec3::z() - along * along.z).normalize();
        // Out of the back of the hand.
        let back = thumb_side.cross(&along);
        let back = if back.y < 0.0 { -back } else { back };
        let slim = anatomy.mix(1.0, 0.94);
        let place = |a: f64, t: f64, b: f64| {
            anatomy.joints.wrist + length * (a * along + t * slim * thumb_side + b * back)
        };
        let width = |half: f64| half * length * slim;
        let palm_sections = [
            (0.0, Section::ellipse(0.84 * wrist, 1.12 * wrist)),
            (
                0.30,
                Section::ellipse(0.088 * length, width(0.185))
                    .centered(-0.004 * length, 0.012 * length)
                    .squared(2.4),
            ),
            (
                0.62,
                Section::ellipse(0.080 * length, width(0.220))
                    .centered(-0.004 * length, 0.004 * length)
                    .squared(2.6),
            ),
            (
                1.0,
                Section::ellipse(0.062 * length, width(0.208))
                    .centered(0.0, 0.0)
                    .squared(2.6),
            ),
        ];
        let finger = |offset: f64, tip: f64, thick: f64| {
            let knuckle = place(0.44, offset, 0.004);
            let middle = place(0.44 + 0.52 * (tip - 0.44), 1.10 * offset, -0.004);
            let end = place(tip - 0.035, 1.14 * offset, -0.038);
            let r = thick * length * slim;
            [
                Capsule::new(knuckle, middle, [1.10 * r, r]),
                Capsule::new(middle, end, [r, 0.80 * r]),
            ]
        };
        let thumb_root = place(0.12, 0.115, -0.02);
        let thumb_middle = place(0.36, 0.270, -0.045);
        let thumb_tip = place(0.545, 0.315, -0.06);
        Self {
            palm: Loft::new(
                [anatomy.joints.wrist, place(0.47, 0.0, 0.0)],
                back,
                &palm_sections,
                0.06,
            )
            .with_caps([1.0, 0.8]),
            thumb: [
                Capsule::new(
                    thumb_root,
                    thumb_middle,
                    [0.076 * length, 0.056 * length * slim],
                ),
                Capsule::new(
                    thumb_middle,
                    thumb_tip,
                    [0.056 * length * slim, 0.044 * length * slim],
                ),
            ],
            fingers: vec![
                finger(0.158, 0.955, 0.0485),
                finger(0.054, 1.0, 0.0500),
                finger(-0.050, 0.97, 0.0485),
                finger(-0.150, 0.86, 0.0430),
            ],
            center: place(0.5, 0.05, 0.0),
            reach: 0.85 * length,
            size: anatomy.size,
        }
    }

    fn distance(&self, point: &Vec3) -> f64 {
        let s = self.size;
        let mut fingers = f64::MAX;
        for [root, tip] in &self.fingers {
            let finger = smooth_union(root.distance(point), tip.distance(point), 0.006 * s);
            fingers = smooth_union(fingers, finger, 0.011 * s);
        }
        let [root, tip] = &self.thumb;
        let thumb = smooth_union(root.distance(point), tip.distance(point), 0.008 * s);
        let palm = smooth_union(self.palm.distance(point), fingers, 0.012 * s);
        smooth_union(palm, thumb, 0.022 * s)
    }
}
