//! The body as a smooth signed distance.

use super::Measure;
use super::anatomy::Anatomy;
use super::arm::Arm;
use super::head::Head;
use super::leg::Leg;
use super::primitives::{Vec3, length, smooth_union};
use super::torso::Torso;

/// Right and left meet in the middle plane with a bend of this radius, in metres.
const MIDDLE_RADIUS: f64 = 0.006;

/// Parts farther than this do not matter, in metres.
const REACH: f64 = 0.08;

/// The surface of a body as the zero set of a smooth function, negative inside.
///
/// Near the surface it is the distance to it, to first order.
#[derive(Debug, Clone)]
pub(crate) struct Field {
    pub(crate) torso: Torso,
    pub(crate) head: Head,
    pub(crate) arm: Arm,
    pub(crate) leg: Leg,
    /// Below this height there is only leg.
    leg_only: f64,
    /// Above this there is no leg.
    leg_top: f64,
    /// The arm lies beyond this plane: normal and offset.
    arm_side: f64,
    arm_low: f64,
    /// Width of the blend of trunk and arm; flesh fills the armpit.
    armpit: f64,
    size: f64,
}

impl Field {
    pub(crate) fn new(anatomy: &Anatomy) -> Self {
        let joints = &anatomy.joints;
        Self {
            torso: Torso::new(anatomy),
            head: Head::new(anatomy),
            arm: Arm::new(anatomy),
            leg: Leg::new(anatomy),
            leg_only: anatomy.crotch() - 0.20 * anatomy.size,
            leg_top: joints.hip.y + 0.36 * anatomy.size,
            arm_side: joints.shoulder.x - 0.16 * anatomy.size,
            arm_low: joints.fingertip.y - REACH,
            armpit: 0.038 * anatomy.size
                + 2.2 * (anatomy.radius(Measure::UpperArm) - 0.050).max(0.0),
            size: anatomy.size,
        }
    }

    /// The distance of a point of space.
    pub(crate) fn distance(&self, point: &Vec3) -> f64 {
        let folded = Vec3::new(length(point.x, MIDDLE_RADIUS), point.y, point.z);
        let s = self.size;
        let mut body = f64::MAX;
        if point.y > self.leg_only {
            body = self.torso.distance(&folded);
        }
        if point.y < self.leg_top {
            body = smooth_union(body, self.leg.distance(&folded), 0.038 * s);
        }
        if point.y > self.head.bottom() {
            body = smooth_union(body, self.head.distance(&folded), 0.022 * s);
        }
        if folded.x > self.arm_side && point.y > self.arm_low {
            body = smooth_union(body, self.arm.distance(&folded), self.armpit);
        }
        body
    }

    /// Distances to trunk, head, arm and leg, each by itself.
    pub(crate) fn part_distances(&self, point: &Vec3) -> [f64; 4] {
        let folded = Vec3::new(length(point.x, MIDDLE_RADIUS), point.y, point.z);
        [
            self.torso.distance(&folded),
            self.head.distance(&folded),
            self.arm.distance(&folded),
            self.leg.distance(&folded),
        ]
    }

    /// Distance and its gradient, by forward differences.
    pub(crate) fn distance_and_gradient(&self, point: &Vec3) -> (f64, Vec3) {
        const STEP: f64 = 1e-5;
        let distance = self.distance(point);
        let slope = |axis: usize| {
            let mut moved = *point;
            moved[axis] += STEP;
            (self.distance(&moved) - distance) / STEP
        };
        (distance, Vec3::new(slope(0), slope(1), slope(2)))
    }
}
