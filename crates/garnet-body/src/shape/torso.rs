//! Trunk, shoulders and neck.

use super::Measure;
use super::anatomy::Anatomy;
use super::primitives::{Bump, Capsule, Loft, Section, Vec3, ellipsoid, perimeter, smooth_union};

/// A solid that is blended into the trunk.
#[derive(Debug, Clone, Copy)]
struct Blob {
    center: Vec3,
    radii: Vec3,
    blend: f64,
}

/// The trunk without arms and legs.
#[derive(Debug, Clone)]
pub(crate) struct Torso {
    pub(crate) trunk: Loft,
    pub(crate) neck: Loft,
    blobs: Vec<Blob>,
    trapezius: Capsule,
    clavicle: Capsule,
    bumps: Vec<Bump>,
    /// Below this height shoulders and neck do not matter.
    shoulder_low: f64,
    size: f64,
}

/// One row of the table of trunk sections.
struct Row {
    height: f64,
    girth: f64,
    /// Depth over width.
    aspect: f64,
    exponent: f64,
    /// Where the section is widest, to the front of the axis of the body.
    center: f64,
    /// Share of the depth that lies in front of that.
    front_share: f64,
}

impl Row {
    fn section(&self) -> Section {
        let side = self.girth / perimeter(self.aspect, self.exponent);
        let depth = 2.0 * self.aspect * side;
        Section {
            side,
            front: depth * self.front_share,
            back: depth * (1.0 - self.front_share),
            center: [0.0, self.center],
            exponent: self.exponent,
        }
    }
}

impl Torso {
    pub(crate) fn new(anatomy: &Anatomy) -> Self {
        let rows = rows(anatomy);
        let bottom = rows[0].height;
        let top = rows[rows.len() - 1].height;
        let stations: Vec<(f64, Section)> = rows
            .iter()
            .map(|row| ((row.height - bottom) / (top - bottom), row.section()))
            .collect();
        let trunk = Loft::new(
            [Vec3::new(0.0, bottom, 0.0), Vec3::new(0.0, top, 0.0)],
            Vec3::x(),
            &stations,
            0.036,
        )
        .with_caps([0.45, 0.4]);
        let s = anatomy.size;
        let shoulder = anatomy.joints.shoulder;
        let acromion = anatomy.height(Measure::ShoulderHeight);
        let half_breadth = 0.5 * anatomy.measures[Measure::ShoulderBreadth];
        let neck_base = anatomy.joints.neck.y;
        let thick = anatomy.mix(1.0, 0.86);
        Self {
            trunk,
            neck: neck(anatomy),
            blobs: blobs(anatomy),
            trapezius: Capsule::new(
                Vec3::new(0.022 * s, neck_base - 0.010 * s, -0.049 * s),
                Vec3::new(0.72 * half_breadth, acromion - 0.012 * s, -0.034 * s),
                [0.026 * s * thick, 0.030 * s * thick],
            ),
            clavicle: Capsule::new(
                Vec3::new(0.050 * s, acromion - 0.018 * s, -0.014 * s),
                shoulder + Vec3::new(-0.020, 0.010, 0.0) * s,
                [0.034 * s * thick, 0.044 * s * thick],
            ),
            bumps: bumps(anatomy),
            shoulder_low: acromion.min(shoulder.y) - 0.20 * s,
            size: s,
        }
    }

    pub(crate) fn distance(&self, point: &Vec3) -> f64 {
        let s = self.size;
        let mut torso = self.trunk.distance(point);
        if point.y > self.shoulder_low {
            torso = smooth_union(torso, self.clavicle.distance(point), 0.060 * s);
            torso = smooth_union(torso, self.trapezius.distance(point), 0.055 * s);
        }
        for blob in &self.blobs {
            let distance = ellipsoid(point, &blob.center, &blob.radii);
            torso = smooth_union(torso, distance, blob.blend);
        }
        if point.y > self.shoulder_low {
            torso = smooth_union(torso, self.neck.distance(point), 0.040 * s);
        }
        if torso < 0.05 {
            torso -= self.bumps.iter().map(|bump| bump.at(point)).sum::<f64>();
        }
        torso
    }
}

#[expect(clippy::too_many_lines, reason = "a table of sections")]
fn rows(anatomy: &Anatomy) -> Vec<Row> {
    let s = anatomy.size;
    let crotch = anatomy.crotch();
    let hip_height = anatomy.height(Measure::HipHeight);
    let hip_row = (hip_height + 0.035 * s).max(crotch + 0.108 * s);
    let waist_height = anatomy.height(Measure::WaistHeight);
    let chest_height = anatomy.height(Measure::ChestHeight);
    let under_height = anatomy.under_bust_height();
    let acromion = anatomy.height(Measure::ShoulderHeight);
    let hip = anatomy.girth(Measure::Hip);
    let waist = anatomy.girth(Measure::Waist);
    let under = anatomy.girth(Measure::UnderBust);
    // The ribs under a bust follow the under-bust girth, a man's chest the chest girth.
    let ribs = anatomy.mix(
        0.985 * anatomy.girth(Measure::Chest),
        1.045
            * anatomy.measures[Measure::UnderBust]
            * anatomy.corrections[Measure::Chest].powf(0.6),
    );
    let breadth = anatomy.measures[Measure::ShoulderBreadth];
    let waist_aspect = anatomy.waist_aspect;
    let narrow = 0.45 * under_height + 0.55 * waist_height;
    let row =
        |height: f64, girth: f64, aspect: f64, exponent: f64, center: f64, front_share: f64| Row {
            height,
            girth,
            aspect,
            exponent,
            center: center * s,
            front_share,
        };
    let between = |share: f64| hip_row + share * (waist_height - hip_row);
    vec![
        row(crotch + 0.046 * s, 0.46 * hip, 0.98, 2.1, -0.014, 0.50),
        row(crotch + 0.074 * s, 0.64 * hip, 0.84, 2.2, -0.012, 0.49),
        row(hip_row, 0.84 * hip, 0.735, 2.3, -0.008, 0.51),
        row(
            between(0.35),
            0.56 * 0.96 * hip + 0.44 * waist,
            0.70,
            2.3,
            0.000,
            0.515,
        ),
        row(
            between(0.70),
            0.25 * hip + 0.75 * waist,
            0.5 * waist_aspect + 0.5 * 0.69,
            2.3,
            0.005,
            0.53,
        ),
        row(waist_height, waist, waist_aspect, 2.3, 0.008, 0.54),
        row(
            narrow,
            0.5 * waist + 0.5 * under - anatomy.mix(0.024, 0.052) * s,
            0.5 * waist_aspect + 0.5 * 0.72,
            2.3,
            0.010,
            0.54,
        ),
        row(under_height, under, 0.73, 2.25, 0.000, 0.52),
        row(chest_height, ribs, 0.71, 2.25, -0.002, 0.49),
        row(
            chest_height + 0.40 * (acromion - chest_height),
            0.97 * ribs,
            0.66,
            2.2,
            -0.010,
            0.48,
        ),
        row(
            acromion - 0.055 * s,
            1.60 * breadth + 0.22 * ribs,
            0.55,
            2.15,
            -0.021,
            0.50,
        ),
        row(
            acromion - 0.020 * s,
            1.40 * breadth + 0.14 * ribs,
            0.50,
            2.1,
            -0.031,
            0.50,
        ),
        row(
            acromion + 0.010 * s,
            0.98 * breadth + 0.10 * ribs,
            0.50,
            2.0,
            -0.037,
            0.50,
        ),
        row(
            acromion + 0.028 * s,
            0.62 * breadth + 0.10 * ribs,
            0.55,
            2.0,
            -0.040,
            0.50,
        ),
    ]
}

fn neck(anatomy: &Anatomy) -> Loft {
    let radius = anatomy.radius(Measure::Neck);
    let s = anatomy.size;
    let base = anatomy.joints.neck + Vec3::new(0.0, -0.030, -0.002) * s;
    let top = anatomy.joints.head + Vec3::new(0.0, 0.035, -0.002) * s;
    let sections = [
        (0.0, Section::ellipse(1.16 * radius, 1.08 * radius)),
        (0.35, Section::ellipse(0.99 * radius, 1.01 * radius)),
        (0.6, Section::ellipse(0.97 * radius, 1.03 * radius)),
        (1.0, Section::ellipse(0.98 * radius, 1.02 * radius)),
    ];
    Loft::new([base, top], Vec3::x(), &sections, 0.08)
}

/// Buttocks, bust and belly.
fn blobs(anatomy: &Anatomy) -> Vec<Blob> {
    let s = anatomy.size;
    let hip = anatomy.girth(Measure::Hip) / 1.02;
    let hip_height = anatomy.height(Measure::HipHeight);
    let chest_height = anatomy.height(Measure::ChestHeight);
    let seat = hip_height.max(anatomy.crotch() + 0.062 * s) + 0.010 * s;
    let mut blobs = vec![Blob {
        center: Vec3::new(0.070 * hip, seat, -0.064 * hip),
        radii: Vec3::new(0.079 * hip, 0.088 * s, anatomy.mix(0.077, 0.080) * hip),
        blend: 0.045 * s,
    }];
    let bust = bust_radius(anatomy);
    if bust > 0.0 {
        let front = chest_front(anatomy);
        blobs.push(Blob {
            center: Vec3::new(
                0.070 * s + 0.25 * bust,
                chest_height + 0.02 * bust,
                front - 0.45 * bust,
            ),
            radii: Vec3::new(1.20 * bust, 1.10 * bust, 0.98 * bust),
            blend: 0.022 * s + 0.30 * bust,
        });
        // The slope above the bust.
        blobs.push(Blob {
            center: Vec3::new(
                0.072 * s + 0.25 * bust,
                chest_height + 0.62 * bust,
                front - 0.66 * bust,
            ),
            radii: Vec3::new(0.95 * bust, 1.35 * bust, 0.86 * bust),
            blend: 0.05 * s,
        });
    }
    blobs
}

/// Where the ribs are in front at the chest height, to the front of the axis.
fn chest_front(anatomy: &Anatomy) -> f64 {
    let ribs = anatomy.measures[Measure::UnderBust] * 1.03;
    0.118 * ribs / 0.90 - 0.012 * anatomy.size
}

/// The size of a breast; grows with the excess of chest over under-bust girth.
fn bust_radius(anatomy: &Anatomy) -> f64 {
    let excess = anatomy.girth(Measure::Chest) * 1.0 - 1.035 * anatomy.measures[Measure::UnderBust];
    let female = anatomy.sex * (2.0 - anatomy.sex);
    let radius = 0.036 * anatomy.size + 0.24 * (excess - 0.06);
    female * radius.clamp(0.022, 0.105)
}

#[expect(clippy::too_many_lines, reason = "a table of bumps")]
fn bumps(anatomy: &Anatomy) -> Vec<Bump> {
    let s = anatomy.size;
    let hip = anatomy.girth(Measure::Hip) / 1.02;
    let hip_height = anatomy.height(Measure::HipHeight);
    let waist_height = anatomy.height(Measure::WaistHeight);
    let chest_height = anatomy.height(Measure::ChestHeight);
    let acromion = anatomy.height(Measure::ShoulderHeight);
    let crotch = anatomy.crotch();
    let chest = anatomy.girth(Measure::Chest) / anatomy.mix(1.06, 0.95);
    let waist = anatomy.girth(Measure::Waist) / 0.90;
    let male = 1.0 - anatomy.sex;
    let lean = (1.15 - 0.9 * (waist - 0.95).max(0.0)).clamp(0.3, 1.0);
    vec![
        // The cleft between the buttocks, and the fold below them.
        Bump::new(
            -0.034 * s,
            [0.0, hip_height - 0.022 * s, -0.135 * hip],
            [0.013 * s, 0.062 * s, 0.055 * s],
        ),
        // The furrow of the spine.
        Bump::new(
            -0.008 * s * lean,
            [0.0, waist_height + 0.02 * s, -0.100 * s * waist],
            [0.016 * s, 0.085 * s, 0.05 * s],
        ),
        Bump::new(
            -0.007 * s * lean,
            [0.0, chest_height, -0.125 * s * chest],
            [0.014 * s, 0.095 * s, 0.05 * s],
        ),
        // Shoulder blades.
        Bump::new(
            0.007 * s * lean,
            [0.082 * s, chest_height + 0.055 * s, -0.125 * s * chest],
            [0.036 * s, 0.050 * s, 0.045 * s],
        ),
        // Pectoral muscles.
        Bump::new(
            0.013 * s * male * lean,
            [
                0.078 * s * chest,
                chest_height + 0.022 * s,
                0.105 * s * chest,
            ],
            [0.048 * s, 0.036 * s, 0.05 * s],
        ),
        Bump::new(
            -0.004 * s * male,
            [0.0, chest_height + 0.015 * s, 0.115 * s * chest],
            [0.010 * s, 0.050 * s, 0.04 * s],
        ),
        // The hollow above the sternum and behind the clavicles.
        Bump::new(
            -0.008 * s,
            [0.0, acromion - 0.006 * s, 0.030 * s],
            [0.016 * s, 0.014 * s, 0.03 * s],
        ),
        Bump::new(
            0.0035 * s * lean,
            [0.065 * s, acromion - 0.018 * s, 0.038 * s],
            [0.040 * s, 0.009 * s, 0.03 * s],
        ),
        Bump::new(
            -0.005 * s * lean,
            [0.080 * s, acromion + 0.008 * s, 0.012 * s],
            [0.034 * s, 0.014 * s, 0.03 * s],
        ),
        // Middle line and lower edge of the belly.
        Bump::new(
            -0.004 * s * lean,
            [0.0, waist_height + 0.085 * s, 0.115 * s * waist],
            [0.014 * s, 0.075 * s, 0.05 * s],
        ),
        Bump::new(
            0.008 * s * anatomy.mix(0.5, 1.0) * (2.5 * waist - 1.6).clamp(0.0, 1.0),
            [0.0, waist_height - 0.055 * s, 0.112 * s * waist],
            [0.065 * s, 0.055 * s, 0.05 * s],
        ),
        Bump::new(
            -0.005 * s,
            [0.0, waist_height, 0.135 * s * waist],
            [0.010 * s, 0.012 * s, 0.03 * s],
        ),
        // The mound at the front of the crotch.
        Bump::new(
            0.012 * s * anatomy.mix(1.6, 0.6),
            [0.0, crotch + 0.066 * s, 0.075 * s],
            [0.030 * s, 0.030 * s, 0.04 * s],
        ),
    ]
}
