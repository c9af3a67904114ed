//! Poses in anatomical angles.

use nalgebra::Vector3;

use super::ranges::{Range, hip, shoulder};
use crate::motion::Side;

type Rotation = nalgebra::UnitQuaternion<f64>;

/// How a part of the trunk turns against the one below it, in degrees.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bend {
    /// Forwards; backwards is negative.
    pub flexion: f64,
    /// To the left.
    pub side: f64,
    /// The front turns to the left.
    pub turn: f64,
}

/// Angles of a leg, in degrees; 0 is straight down, foot forwards.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Leg {
    /// The thigh swings forwards. Together with `abduction` it is a direction: the thigh swings
    /// towards it at once, by the length of (`flexion`, `abduction`).
    pub flexion: f64,
    /// The thigh swings outwards.
    pub abduction: f64,
    /// The thigh turns about itself, toes outwards.
    pub rotation: f64,
    /// Flexion of the knee.
    pub knee: f64,
    /// The foot bends upwards; a pointed foot is negative. Against a right angle of foot and shank.
    pub ankle: f64,
    /// 1: the sole is level, whatever the ankle says; 0: the ankle counts; in between: mixed.
    pub sole: f64,
    /// Whether the leg stands on the ground, with whatever part of it is lowest.
    pub is_planted: bool,
}

/// Angles of an arm, in degrees; 0 hangs down, thumb forwards.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Arm {
    /// The collarbone rises, beyond what raising the arm does by itself.
    pub shrug: f64,
    /// The collarbone turns forwards, beyond what swinging the arm forwards does by itself.
    pub protraction: f64,
    /// The upper arm swings forwards, against the chest. Together with `abduction` it is a
    /// direction, as for the leg: straight up is (180, 0) or (0, 180).
    pub flexion: f64,
    /// The upper arm swings outwards, against the chest.
    pub abduction: f64,
    /// The upper arm turns about itself, the bent forearm outwards.
    pub rotation: f64,
    /// Flexion of the elbow.
    pub elbow: f64,
    /// The hand turns the thumb inwards: the palm backwards on a hanging arm.
    pub pronation: f64,
    /// The hand bends towards its palm.
    pub wrist: f64,
    /// The hand bends towards its thumb.
    pub deviation: f64,
}

/// A pose of the whole body.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BodyAngles {
    /// The pelvis against the world: tilted forwards, then to the side, all turned about the
    /// vertical.
    pub pelvis: Bend,
    /// The chest against the pelvis.
    pub spine: Bend,
    /// The head against the chest.
    pub neck: Bend,
    /// Left, right.
    pub legs: [Leg; 2],
    /// Left, right.
    pub arms: [Arm; 2],
    /// Whether the body leans until its hands stand on the ground.
    pub hands_planted: bool,
}

/// In how many parts the way between two rotations is looked at.
const SAMPLES: u32 = 8;

/// How many angles a body has.
pub const NUM_ANGLES: usize = 3 * 3 + 2 * 5 + 2 * 9;

impl BodyAngles {
    /// Left and right exchanged.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let mirrored = |bend: Bend| Bend {
            flexion: bend.flexion,
            side: -bend.side,
            turn: -bend.turn,
        };
        Self {
            pelvis: mirrored(self.pelvis),
            spine: mirrored(self.spine),
            neck: mirrored(self.neck),
            legs: [self.legs[1], self.legs[0]],
            arms: [self.arms[1], self.arms[0]],
            hands_planted: self.hands_planted,
        }
    }

    /// All angles in degrees: pelvis, spine and neck (flexion, side, turn); left and right leg
    /// (flexion, abduction, rotation, knee, ankle); left and right arm (shrug, protraction,
    /// flexion, abduction, rotation, elbow, pronation, wrist, deviation).
    pub fn to_array(&self) -> [f64; NUM_ANGLES] {
        let mut copy = *self;
        copy.angles_mut().map(|angle| *angle)
    }

    /// These angles in place of the own ones.
    #[must_use]
    pub fn with_array(mut self, angles: &[f64; NUM_ANGLES]) -> Self {
        for (own, &angle) in self.angles_mut().into_iter().zip(angles) {
            *own = angle;
        }
        self
    }

    fn angles_mut(&mut self) -> [&mut f64; NUM_ANGLES] {
        let [left_leg, right_leg] = &mut self.legs;
        let [left_arm, right_arm] = &mut self.arms;
        let [p0, p1, p2] = self.pelvis.angles_mut();
        let [s0, s1, s2] = self.spine.angles_mut();
        let [n0, n1, n2] = self.neck.angles_mut();
        let [l0, l1, l2, l3, l4] = left_leg.angles_mut();
        let [r0, r1, r2, r3, r4] = right_leg.angles_mut();
        let [a0, a1, a2, a3, a4, a5, a6, a7, a8] = left_arm.angles_mut();
        let [b0, b1, b2, b3, b4, b5, b6, b7, b8] = right_arm.angles_mut();
        [
            p0, p1, p2, s0, s1, s2, n0, n1, n2, l0, l1, l2, l3, l4, r0, r1, r2, r3, r4, a0, a1, a2,
            a3, a4, a5, a6, a7, a8, b0, b1, b2, b3, b4, b5, b6, b7, b8,
        ]
    }

    /// The pose between this one and `other`, at `share` 0 to 1: hips and shoulders by spherical
    /// interpolation, all else by linear.
    #[must_use]
    pub fn blended(&self, other: &Self, share: f64) -> Self {
        let (from, to) = (self.to_array(), other.to_array());
        let mut mixed = from;
        for (mixed, to) in mixed.iter_mut().zip(to) {
            *mixed += share * (to - *mixed);
        }
        let nearer = if share < 0.5 { self } else { other };
        let mut blended = nearer.with_array(&mixed);
        for side in Side::BOTH {
            let index = side.index();
            let (a, b) = (self.legs[index], other.legs[index]);
            let ball = blended_ball(
                [a.flexion, a.abduction, a.rotation],
                [b.flexion, b.abduction, b.rotation],
                share,
                side,
                &hip(),
            );
            let leg = &mut blended.legs[index];
            [leg.flexion, leg.abduction, leg.rotation] = ball;
            leg.sole = a.sole + share * (b.sole - a.sole);
            leg.is_planted = a.is_planted && b.is_planted;
            let (a, b) = (self.arms[index], other.arms[index]);
            let ball = blended_ball(
                [a.flexion, a.abduction, a.rotation],
                [b.flexion, b.abduction, b.rotation],
                share,
                side,
                &shoulder(),
            );
            let arm = &mut blended.arms[index];
            [arm.flexion, arm.abduction, arm.rotation] = ball;
        }
        blended.hands_planted = self.hands_planted && other.hands_planted;
        blended
    }
}

impl Bend {
    fn angles_mut(&mut self) -> [&mut f64; 3] {
        [&mut self.flexion, &mut self.side, &mut self.turn]
    }

    /// The rotation vector in the body's axes, in radians.
    pub(super) fn rotation_vector(&self) -> Vector3<f64> {
        Vector3::new(self.flexion, self.turn, -self.side).map(f64::to_radians)
    }
}

impl Leg {
    fn angles_mut(&mut self) -> [&mut f64; 5] {
        [
            &mut self.flexion,
            &mut self.abduction,
            &mut self.rotation,
            &mut self.knee,
            &mut self.ankle,
        ]
    }
}

impl Arm {
    fn angles_mut(&mut self) -> [&mut f64; 9] {
        [
            &mut self.shrug,
            &mut self.protraction,
            &mut self.flexion,
            &mut self.abduction,
            &mut self.rotation,
            &mut self.elbow,
            &mut self.pronation,
            &mut self.wrist,
            &mut self.deviation,
        ]
    }
}

/// The rotation of a hip or shoulder: the limb turns about itself, then swings.
pub(super) fn ball([flexion, abduction, rotation]: [f64; 3], side: Side) -> Rotation {
    let sign = side.sign();
    let swing = Vector3::new(-flexion, 0.0, sign * abduction).map(f64::to_radians);
    let twist = Vector3::new(0.0, sign * rotation, 0.0).map(f64::to_radians);
    Rotation::from_scaled_axis(swing) * Rotation::from_scaled_axis(twist)
}

/// Flexion, abduction and rotation in degrees of which [`ball`] makes `rotation`.
pub(super) fn ball_angles(rotation: &Rotation, side: Side) -> [f64; 3] {
    let sign = side.sign();
    let mut q = *rotation.quaternion();
    if q.w < 0.0 {
        q = -q;
    }
    // The twist is the part of the rotation about the limb, which hangs along y.
    let twist = 2.0 * q.j.atan2(q.w);
    let twist_only = Rotation::from_scaled_axis(Vector3::new(0.0, twist, 0.0));
    let swing = (*rotation * twist_only.inverse()).scaled_axis();
    let mut twist = twist.to_degrees();
    if twist > 180.0 {
        twist -= 360.0;
    }
    [
        -swing.x.to_degrees(),
        sign * swing.z.to_degrees(),
        sign * twist,
    ]
}

/// The rotation of a hip or shoulder between two others: the shortest way, unless that leaves the
/// range of motion, as from behind the back to overhead; then angle by angle.
fn blended_ball(
    from: [f64; 3],
    to: [f64; 3],
    share: f64,
    side: Side,
    limits: &[Range; 3],
) -> [f64; 3] {
    let (a, b) = (ball(from, side), ball(to, side));
    let between = |share: f64| {
        let rotation = a.try_slerp(&b, share, 1e-9)?;
        let angles = ball_angles(&rotation, side);
        let mut pairs = angles.iter().zip(limits);
        let is_possible = pairs.all(|(angle, limit)| limit.holds(*angle));
        is_possible.then_some(angles)
    };
    let is_way = (1..SAMPLES).all(|step| between(f64::from(step) / f64::from(SAMPLES)).is_some());
    let found = if is_way { between(share) } else { None };
    found.unwrap_or_else(|| [0, 1, 2].map(|axis| from[axis] + share * (to[axis] - from[axis])))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn hips_and_shoulders_give_their_angles_back(
            direction in -180.0_f64..180.0, swing in 0.0_f64..175.0, rotation in -150.0_f64..150.0,
            is_left in any::<bool>(),
        ) {
            let side = if is_left { Side::Left } else { Side::Right };
            let (sin, cos) = direction.to_radians().sin_cos();
            let angles = [swing * cos, swing * sin, rotation];
            let found = ball_angles(&ball(angles, side), side);
            for (found, angle) in found.iter().zip(angles) {
                prop_assert!((found - angle).abs() < 1e-6, "{found} {angle}");
            }
        }

        #[test]
        fn mirroring_twice_changes_nothing_and_arrays_are_whole(
            values in prop::collection::vec(-90.0_f64..90.0, NUM_ANGLES),
        ) {
            let angles: [f64; NUM_ANGLES] = values.try_into().unwrap();
            let body = BodyAngles::default().with_array(&angles);
            prop_assert_eq!(body.to_array().map(f64::to_bits), angles.map(f64::to_bits));
            prop_assert_eq!(body.mirrored().mirrored(), body);
        }
    }

    #[test]
    fn a_blend_starts_and_ends_at_its_poses() {
        let mut a = BodyAngles::default();
        a.arms[0].flexion = 150.0;
        a.legs[1].knee = 80.0;
        let mut b = BodyAngles::default();
        b.arms[0].abduction = 90.0;
        b.spine.turn = 30.0;
        for (share, expected) in [(0.0, a), (1.0, b)] {
            let found = a.blended(&b, share).to_array();
            for (found, expected) in found.into_iter().zip(expected.to_array()) {
                assert!((found - expected).abs() < 1e-6);
            }
        }
    }
}
