//! Carries points from one body to another: a first guess of where a vertex goes.
//!
//! Every part of the body has coordinates of its own (along the bone, and across it in units of the
//! section). A point keeps its coordinates; a vertex is the mean of what its parts say, weighted by
//! how much it follows each.

use super::Measure;
use super::anatomy::Anatomy;
use super::field::Field;
use super::primitives::{Loft, Vec3};

/// The parts of the left side and the middle.
pub(crate) const NUM_PARTS: usize = 8;

/// The part that each joint moves; the right side is mirrored to the left.
const PART_OF_JOINT: [u8; super::skeleton::NUM_JOINTS] = [
    0, 1, 1, 0, 2, 2, 0, 3, 3, 0, 3, 3, 4, 0, 0, 4, 5, 5, 6, 6, 7, 7,
];

pub(crate) fn part_of_joint(joint: usize) -> usize {
    usize::from(PART_OF_JOINT[joint])
}

/// Axes and scales of a part that keeps its form.
#[derive(Debug, Clone)]
struct Frame {
    origin: Vec3,
    /// Axes times the length of a unit along each.
    axes: [Vec3; 3],
}

impl Frame {
    fn coordinates(&self, point: &Vec3) -> [f64; 3] {
        let offset = point - self.origin;
        self.axes
            .map(|axis| offset.dot(&axis) / axis.norm_squared())
    }

    fn point(&self, coordinates: [f64; 3]) -> Vec3 {
        let parts = self.axes.iter().zip(coordinates);
        self.origin + parts.map(|(axis, value)| axis * value).sum::<Vec3>()
    }
}

/// The coordinates of all parts of one body.
#[derive(Debug, Clone)]
pub(crate) struct Guide {
    trunk: Loft,
    /// Heights that correspond between bodies.
    landmarks: Vec<f64>,
    /// Half width and depth at the hip height; sections near the crotch would be too small.
    hip_units: [f64; 2],
    thigh: Loft,
    shank: Loft,
    foot: Frame,
    head: Frame,
    upper_arm: Loft,
    forearm: Loft,
    hand: Frame,
}

impl Guide {
    pub(crate) fn new(anatomy: &Anatomy, field: &Field) -> Self {
        let s = anatomy.size;
        let joints = &anatomy.joints;
        let acromion = anatomy.height(Measure::ShoulderHeight);
        let length = anatomy.foot_length;
        let forward = Vec3::new(0.14, 0.0, 1.0).normalize();
        let out = Vec3::new(forward.z, 0.0, -forward.x);
        let h = anatomy.head_size();
        let along = joints.fingertip - joints.wrist;
        let direction = along.normalize();
        let thumb = (Vec3::z() - direction * direction.z).normalize();
        let back = thumb.cross(&direction);
        let hand = anatomy.hand_length;
        let landmarks = vec![
            0.0,
            anatomy.crotch(),
            anatomy
                .height(Measure::HipHeight)
                .max(anatomy.crotch() + 0.02 * s),
            anatomy.height(Measure::WaistHeight),
            anatomy.under_bust_height(),
            anatomy.height(Measure::ChestHeight),
            acromion - 0.055 * s,
            acromion,
            acromion + 0.08 * s,
            anatomy.stature(),
        ];
        Self {
            trunk: field.torso.trunk.clone(),
            landmarks,
            hip_units: [
                anatomy.hip_breadth * anatomy.corrections[Measure::Hip],
                0.7 * anatomy.hip_breadth * anatomy.corrections[Measure::Hip],
            ],
            thigh: field.leg.thigh.clone(),
            shank: field.leg.shank.clone(),
            foot: Frame {
                origin: Vec3::new(joints.ankle.x, 0.0, joints.ankle.z),
                axes: [
                    out * length,
                    Vec3::y() * (0.5 * s + 0.5 * length / 0.26),
                    forward * length,
                ],
            },
            head: Frame {
                origin: Vec3::new(0.0, anatomy.stature(), 0.006),
                axes: [Vec3::x() * h, Vec3::y() * h, Vec3::z() * h],
            },
            upper_arm: field.arm.upper.clone(),
            forearm: field.arm.fore.clone(),
            hand: Frame {
                origin: joints.wrist,
                axes: [along, thumb * hand, back * hand],
            },
        }
    }

    /// The coordinates of a point in a part.
    pub(crate) fn coordinates(&self, part: usize, point: &Vec3) -> [f64; 3] {
        match part {
            0 => self.trunk_coordinates(point),
            1 => self.thigh.coordinates(point),
            2 => self.shank.coordinates(point),
            3 => self.foot.coordinates(point),
            4 => self.head.coordinates(point),
            5 => self.upper_arm.coordinates(point),
            6 => self.forearm.coordinates(point),
            _ => self.hand.coordinates(point),
        }
    }

    /// The point at given coordinates in a part.
    pub(crate) fn point(&self, part: usize, coordinates: [f64; 3]) -> Vec3 {
        match part {
            0 => self.trunk_point(coordinates),
            1 => self.thigh.point(coordinates),
            2 => self.shank.point(coordinates),
            3 => self.foot.point(coordinates),
            4 => self.head.point(coordinates),
            5 => self.upper_arm.point(coordinates),
            6 => self.forearm.point(coordinates),
            _ => self.hand.point(coordinates),
        }
    }

    /// Center, half width and depth of the trunk at a height.
    fn trunk_section(&self, height: f64) -> [f64; 3] {
        let height_in_loft = self.trunk.coordinates(&Vec3::new(0.0, height, 0.0))[0];
        let place = height_in_loft.clamp(0.0, 1.0);
        let center = self.trunk.center(place);
        let side = self.trunk.point([place, 1.0, 0.0]).x;
        let depth = self.trunk.point([place, 0.0, 1.0]).z - center.z;
        let [hip_side, hip_depth] = self.hip_units;
        let [crotch, waist] = [self.landmarks[1], self.landmarks[3]];
        let share = ((waist - height) / (waist - crotch)).clamp(0.0, 1.0);
        let share = share * share * (3.0 - 2.0 * share);
        [
            center.z,
            side + share * (0.5 * hip_side - side),
            depth + share * (0.5 * hip_depth - depth),
        ]
    }

    fn trunk_coordinates(&self, point: &Vec3) -> [f64; 3] {
        let [center, side, depth] = self.trunk_section(point.y);
        let last = self.landmarks.len() - 2;
        let above = self.landmarks.partition_point(|&height| height <= point.y);
        let cell = above.saturating_sub(1).min(last);
        let width = self.landmarks[cell + 1] - self.landmarks[cell];
        let place = cell as f64 + (point.y - self.landmarks[cell]) / width;
        [place, point.x / side, (point.z - center) / depth]
    }

    fn trunk_point(&self, [place, side_units, depth_units]: [f64; 3]) -> Vec3 {
        let last = self.landmarks.len() - 2;
        let cell = (place.max(0.0) as usize).min(last);
        let width = self.landmarks[cell + 1] - self.landmarks[cell];
        let height = self.landmarks[cell] + (place - cell as f64) * width;
        let [center, side, depth] = self.trunk_section(height);
        Vec3::new(side_units * side, height, center + depth_units * depth)
    }
}
