//! Ranges of motion of the joints.
//!
//! The usual ranges are those of the American Academy of Orthopaedic Surgeons, *Joint Motion:
//! Method of Measuring and Recording*, 1965, as reprinted in Norkin and White, *Measurement of
//! Joint Motion*, 5th edition 2016, appendix A; those of the collarbone and the hips of trained
//! dancers are from Kapandji, *The Physiology of the Joints*, 6th edition 2007/2010, volume 1
//! section "The sternoclavicular joint" and volume 2 section "Movements of the hip". The range of
//! trained people is what a pose of the library may use; noise never leaves the usual range.
//!
//! The numbers were entered without these books at hand and are not checked against them: each is
//! an approximation, rounded to 5 degrees.

use super::{BodyAngles, angles::NUM_ANGLES};

/// Limits of one angle, in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// What the angle is.
    pub name: &'static str,
    /// Smallest and largest angle of most healthy adults.
    pub usual: [f64; 2],
    /// Smallest and largest angle of dancers, gymnasts and people who practise yoga.
    pub trained: [f64; 2],
    /// Standard deviation of the sampler's noise.
    pub noise: f64,
}

const fn range(name: &'static str, usual: [f64; 2], trained: [f64; 2], noise: f64) -> Range {
    Range {
        name,
        usual,
        trained,
        noise,
    }
}

const TRUNK: [Range; 9] = [
    // The pelvis turns as a whole: these are no limits of a joint.
    range("pelvis tilt", [-180.0, 180.0], [-180.0, 180.0], 2.0),
    range("pelvis side", [-90.0, 90.0], [-90.0, 90.0], 1.5),
    range("pelvis turn", [-180.0, 180.0], [-180.0, 180.0], 5.0),
    range("spine flexion", [-25.0, 80.0], [-60.0, 90.0], 4.0),
    range("spine side", [-35.0, 35.0], [-50.0, 50.0], 3.0),
    range("spine turn", [-45.0, 45.0], [-60.0, 60.0], 4.0),
    range("neck flexion", [-45.0, 45.0], [-60.0, 60.0], 5.0),
    range("neck side", [-45.0, 45.0], [-45.0, 45.0], 3.0),
    range("neck turn", [-60.0, 60.0], [-80.0, 80.0], 7.0),
];

const LEG: [Range; 5] = [
    range("hip flexion", [-30.0, 120.0], [-60.0, 145.0], 4.0),
    range("hip abduction", [-30.0, 45.0], [-40.0, 100.0], 3.0),
    range("hip rotation", [-45.0, 45.0], [-45.0, 80.0], 4.0),
    range("knee flexion", [0.0, 135.0], [0.0, 160.0], 4.0),
    range("ankle flexion", [-50.0, 20.0], [-75.0, 35.0], 4.0),
];

const ARM: [Range; 9] = [
    range("shoulder shrug", [-10.0, 30.0], [-10.0, 40.0], 2.0),
    range("shoulder protraction", [-25.0, 30.0], [-30.0, 35.0], 2.0),
    range("shoulder flexion", [-60.0, 180.0], [-80.0, 180.0], 6.0),
    // Across the body: 135 degrees of horizontal flexion from the side, 45 beyond straight ahead.
    range("shoulder abduction", [-60.0, 180.0], [-80.0, 180.0], 5.0),
    range("shoulder rotation", [-90.0, 90.0], [-110.0, 110.0], 7.0),
    range("elbow flexion", [0.0, 145.0], [0.0, 155.0], 6.0),
    range("forearm pronation", [-80.0, 80.0], [-90.0, 90.0], 8.0),
    range("wrist flexion", [-70.0, 80.0], [-90.0, 90.0], 6.0),
    range("wrist deviation", [-30.0, 20.0], [-40.0, 30.0], 3.0),
];

/// Flexion, abduction and rotation of the hip.
pub(super) const fn hip() -> [Range; 3] {
    [LEG[0], LEG[1], LEG[2]]
}

/// Flexion, abduction and rotation of the shoulder.
pub(super) const fn shoulder() -> [Range; 3] {
    [ARM[2], ARM[3], ARM[4]]
}

impl Range {
    /// Whether trained people reach an angle.
    pub fn holds(&self, angle: f64) -> bool {
        let [low, high] = self.trained;
        // Rounding of angles that are exactly at the limit.
        (low - 1e-6..=high + 1e-6).contains(&angle)
    }
}

/// The range of every angle, in the order of [`BodyAngles::to_array`].
pub fn ranges() -> [Range; NUM_ANGLES] {
    let mut all = [TRUNK[0]; NUM_ANGLES];
    let table = TRUNK.iter().chain(&LEG).chain(&LEG).chain(&ARM).chain(&ARM);
    for (slot, range) in all.iter_mut().zip(table) {
        *slot = *range;
    }
    all
}

impl BodyAngles {
    /// These angles moved by `noise`, in degrees: no angle leaves its usual range, one that is
    /// outside of it comes no further out.
    #[must_use]
    pub(super) fn moved_within_ranges(&self, noise: &[f64; NUM_ANGLES]) -> Self {
        let mut angles = self.to_array();
        for ((angle, range), noise) in angles.iter_mut().zip(ranges()).zip(noise) {
            let [low, high] = [range.usual[0].min(*angle), range.usual[1].max(*angle)];
            *angle = (*angle + noise).clamp(low, high);
        }
        self.with_array(&angles)
    }

    /// The angles outside of the ranges of trained people.
    pub fn beyond_ranges(&self) -> Vec<(&'static str, f64)> {
        let pairs = self.to_array().into_iter().zip(ranges());
        let outside = pairs.filter(|(angle, range)| !range.holds(*angle));
        outside.map(|(angle, range)| (range.name, angle)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_range_lies_within_the_trained_one() {
        for range in ranges() {
            assert!(range.trained[0] <= range.usual[0], "{}", range.name);
            assert!(range.usual[1] <= range.trained[1], "{}", range.name);
            assert!(
                range.usual[0] <= 0.0 && range.usual[1] >= 0.0,
                "{}",
                range.name
            );
        }
    }

    #[test]
    fn noise_stays_within_the_ranges_and_drives_no_angle_further_out() {
        let mut angles = BodyAngles::default();
        angles.legs[0].rotation = 70.0;
        let far = angles.moved_within_ranges(&[500.0; NUM_ANGLES]);
        assert_eq!(
            far.legs.map(|leg| leg.rotation.to_bits()),
            [70.0, 45.0].map(f64::to_bits)
        );
        assert_eq!(far.beyond_ranges(), Vec::new());
        let knee = angles.moved_within_ranges(&[-500.0; NUM_ANGLES]).legs[1].knee;
        assert!(knee.abs() < f64::EPSILON);
    }
}
