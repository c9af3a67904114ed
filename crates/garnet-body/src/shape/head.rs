//! The head of a display mannequin: a likeness without features of its own.

use super::anatomy::Anatomy;
use super::primitives::{Bump, Capsule, Loft, Section, Vec3, ellipsoid, smooth_union};

/// Skull, face, nose and ears.
#[derive(Debug, Clone)]
pub(crate) struct Head {
    skull: [Vec3; 2],
    face: Loft,
    chin: [Vec3; 2],
    nose: Capsule,
    ear: [Vec3; 2],
    bumps: Vec<Bump>,
    scale: f64,
    bottom: f64,
}

impl Head {
    pub(crate) fn new(anatomy: &Anatomy) -> Self {
        let h = anatomy.head_size();
        let top = anatomy.stature();
        let place =
            |x: f64, below_top: f64, z: f64| Vec3::new(x * h, top - below_top * h, z * h + 0.006);
        let jaw = anatomy.mix(1.0, 0.93);
        let face = [
            (0.0, Section::ellipse(0.066 * h, 0.066 * h)),
            (0.35, Section::ellipse(0.064 * h, 0.062 * h).squared(2.15)),
            (
                0.72,
                Section::ellipse(0.059 * h * jaw, 0.054 * h).squared(2.2),
            ),
            (
                1.0,
                Section::ellipse(0.046 * h * jaw, 0.040 * h).squared(2.2),
            ),
        ];
        let brow = anatomy.mix(1.0, 0.4);
        Self {
            skull: [
                place(0.0, 0.0905, -0.012),
                Vec3::new(0.0765, 0.0905, 0.0975) * h,
            ],
            face: Loft::new(
                [place(0.0, 0.095, 0.020), place(0.0, 0.205, 0.038)],
                Vec3::x(),
                &face,
                0.06,
            )
            .with_caps([1.0, 0.55]),
            chin: [
                place(0.0, 0.210, 0.055),
                Vec3::new(0.025 * jaw, 0.017, 0.022) * h,
            ],
            nose: Capsule::new(
                place(0.0, 0.112, 0.083),
                place(0.0, 0.147, 0.099),
                [0.007 * h, 0.0105 * h],
            ),
            ear: [
                place(0.077, 0.128, -0.012),
                Vec3::new(0.009, 0.030, 0.018) * h,
            ],
            bumps: features(&place, h, brow),
            scale: h,
            bottom: top - 0.30 * h,
        }
    }

    /// The lowest height at which the head matters.
    pub(crate) fn bottom(&self) -> f64 {
        self.bottom
    }

    pub(crate) fn distance(&self, point: &Vec3) -> f64 {
        let h = self.scale;
        let skull = ellipsoid(point, &self.skull[0], &self.skull[1]);
        let mut head = smooth_union(skull, self.face.distance(point), 0.040 * h);
        head = smooth_union(
            head,
            ellipsoid(point, &self.chin[0], &self.chin[1]),
            0.024 * h,
        );
        head = smooth_union(head, self.nose.distance(point), 0.018 * h);
        if head < 0.04 {
            head -= self.bumps.iter().map(|bump| bump.at(point)).sum::<f64>();
        }
        smooth_union(
            head,
            ellipsoid(point, &self.ear[0], &self.ear[1]),
            0.008 * h,
        )
    }
}

/// Eye sockets, brow, upper jaw, lips, the hollow above the chin, temples and cheeks.
fn features(place: &dyn Fn(f64, f64, f64) -> Vec3, h: f64, brow: f64) -> Vec<Bump> {
    vec![
        Bump::new(
            -0.010 * h,
            place(0.033, 0.114, 0.088).into(),
            [0.019 * h, 0.012 * h, 0.022 * h],
        ),
        Bump::new(
            0.003 * h * brow,
            place(0.026, 0.096, 0.086).into(),
            [0.026 * h, 0.008 * h, 0.02 * h],
        ),
        Bump::new(
            0.005 * h,
            place(0.0, 0.166, 0.086).into(),
            [0.026 * h, 0.014 * h, 0.02 * h],
        ),
        Bump::new(
            0.005 * h,
            place(0.0, 0.177, 0.086).into(),
            [0.018 * h, 0.009 * h, 0.02 * h],
        ),
        Bump::new(
            -0.002 * h,
            place(0.0, 0.193, 0.088).into(),
            [0.018 * h, 0.006 * h, 0.02 * h],
        ),
        Bump::new(
            -0.004 * h,
            place(0.070, 0.095, 0.045).into(),
            [0.02 * h, 0.03 * h, 0.025 * h],
        ),
        Bump::new(
            0.003 * h,
            place(0.055, 0.135, 0.06).into(),
            [0.02 * h, 0.014 * h, 0.02 * h],
        ),
    ]
}
