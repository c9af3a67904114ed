//! Tape measures of a mesh with the built-in skeleton.

use garnet_mesh::Point3;
use rayon::prelude::*;

use super::anatomy::{
    COLLAR_BELOW_ACROMION, KNEE_BELOW_PATELLA, PELVIS_ABOVE_HIP_HEIGHT, REFERENCE_STATURE,
    SHOULDER_INSIDE_ACROMION, SPINE1_BELOW_WAIST, SPINE3_ABOVE_CHEST, UNDER_BUST_DROP,
    UPPER_ARM_ABOVE_JOINT,
};
use super::arm::{FOREARM_PLACE, UPPER_ARM_PLACE, WRIST_PLACE};
use super::leg::{ANKLE_PLACE, CALF_PLACE, THIGH_PLACE};
use super::primitives::Vec3;
use super::skeleton::JOINT_NAMES;
use super::{Measure, Measures};

/// The mass of a body over its volume, in kg/m³.
pub const BODY_DENSITY: f64 = 985.0;

/// The plane of a girth: a point of the axis of the limb or trunk in it, and its normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TapePlane {
    pub(crate) measure: Measure,
    pub(crate) center: Vec3,
    pub(crate) normal: Vec3,
}

/// Which faces a tape can touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Region {
    Trunk,
    LeftLeg,
    LeftArm,
    Neck,
}

impl TapePlane {
    fn region(&self) -> Region {
        match self.measure {
            Measure::Chest | Measure::UnderBust | Measure::Waist | Measure::Hip => Region::Trunk,
            Measure::Thigh | Measure::Knee | Measure::Calf | Measure::Ankle => Region::LeftLeg,
            Measure::UpperArm | Measure::Forearm | Measure::Wrist => Region::LeftArm,
            _ => Region::Neck,
        }
    }
}

impl Region {
    /// How far from its center the tape may be, in metres.
    fn reach(self) -> f64 {
        match self {
            Self::Trunk => 0.6,
            Self::LeftLeg => 0.28,
            Self::LeftArm => 0.13,
            Self::Neck => 0.12,
        }
    }

    fn touches(self, corners: [Vec3; 3], is_arm: bool) -> bool {
        match self {
            Self::LeftLeg => !is_arm && corners.iter().all(|corner| corner.x >= 0.0),
            Self::LeftArm => is_arm && corners[0].x > 0.0,
            // What a trunk has of an arm is cut off later.
            Self::Trunk | Self::Neck => true,
        }
    }
}

/// The perimeter of the convex hull of the section by a plane, in metres.
///
/// The tape goes below the armpits: what is more than half arm
/// (`arm_share[vertex]` of the template) is no part of a trunk girth. No section gives zero.
pub(crate) fn girth(
    positions: &[Vec3],
    faces: &[[u32; 3]],
    arm_share: &[f64],
    plane: &TapePlane,
) -> f64 {
    let region = plane.region();
    let reach = region.reach();
    let side = if plane.normal.x.abs() < 0.9 {
        Vec3::x()
    } else {
        Vec3::z()
    };
    let u = (side - plane.normal * side.dot(&plane.normal)).normalize();
    let v = plane.normal.cross(&u);
    let level = plane.normal.dot(&plane.center);
    let mut points = Vec::new();
    for face in faces {
        let corners = face.map(|vertex| positions[vertex as usize]);
        let heights = corners.map(|corner| plane.normal.dot(&corner) - level);
        let above = heights.map(|height| height >= 0.0);
        if above[0] == above[1] && above[1] == above[2] {
            continue;
        }
        if (corners[0] - plane.center).norm_squared() > reach * reach
            || !region.touches(
                corners,
                face.iter().all(|&vertex| arm_share[vertex as usize] > 0.5),
            )
        {
            continue;
        }
        let mut ends = [([0.0; 2], 0.0); 2];
        let mut count = 0;
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            if above[a] != above[b] {
                let share = heights[a] / (heights[a] - heights[b]);
                let offset = corners[a] + share * (corners[b] - corners[a]) - plane.center;
                let [of_a, of_b] = [a, b].map(|corner| arm_share[face[corner] as usize]);
                ends[count] = (
                    [offset.dot(&u), offset.dot(&v)],
                    of_a + share * (of_b - of_a) - 0.5,
                );
                count += 1;
            }
        }
        if region == Region::Trunk {
            without_arm(ends, &mut points);
        } else {
            points.extend(ends.map(|(point, _)| point));
        }
    }
    if plane.measure == Measure::UpperArm {
        press_armpit(&mut points);
    }
    hull_perimeter(points)
}

/// The flesh of a heavy body's armpit reaches half-way down the arm, into the plane of its girth.
/// The tape presses it in: the arm is hardly thicker towards the trunk than away from it, where
/// nothing hides it. The first coordinate points away from the trunk.
fn press_armpit(points: &mut [[f64; 2]]) {
    let outer = points.iter().map(|point| point[0]).fold(0.0, f64::max);
    for point in points {
        point[0] = point[0].max(-ARM_ASYMMETRY * outer);
    }
}

/// Adds the ends of a segment of a section, less what has a positive share of the arm: cutting it
/// there keeps the girth continuous while the mesh moves through the plane.
fn without_arm(ends: [([f64; 2], f64); 2], points: &mut Vec<[f64; 2]>) {
    let [(a, share_a), (b, share_b)] = ends;
    points.extend(ends.into_iter().filter(|end| end.1 <= 0.0).map(|end| end.0));
    if (share_a > 0.0) != (share_b > 0.0) {
        let place = share_a / (share_a - share_b);
        points.push(std::array::from_fn(|axis| {
            a[axis] + place * (b[axis] - a[axis])
        }));
    }
}

/// The perimeter of the convex hull: Andrew 1979.
fn hull_perimeter(mut points: Vec<[f64; 2]>) -> f64 {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..]
                && (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0]) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain
            .windows(2)
            .map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]))
            .sum::<f64>()
    };
    half(&mut points.iter().copied()) + half(&mut points.iter().rev().copied())
}

/// The volume inside a closed mesh, in m³.
pub(crate) fn volume(positions: &[Vec3], faces: &[[u32; 3]]) -> f64 {
    let tetrahedron = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|vertex| positions[vertex as usize]);
        a.dot(&b.cross(&c))
    };
    faces.iter().map(tetrahedron).sum::<f64>() / 6.0
}

/// The plane across the trunk at a height, with the middle of the trunk in it.
pub(crate) fn trunk_plane(joints: &[Vec3], measure: Measure, height: f64) -> TapePlane {
    let above = SPINE
        .windows(2)
        .position(|pair| joints[pair[1]].y > height)
        .unwrap_or(3);
    let (low, high) = (joints[SPINE[above]], joints[SPINE[above + 1]]);
    let share = ((height - low.y) / (high.y - low.y)).clamp(0.0, 1.0);
    let z = low.z + share * (high.z - low.z);
    TapePlane {
        measure,
        center: Vec3::new(0.0, height, z),
        normal: Vec3::y(),
    }
}

/// The plane across a bone of the left side, a share of the way along it.
pub(crate) fn bone_plane(joints: &[Vec3], measure: Measure, share: f64) -> TapePlane {
    let [start, end] = bone_of(measure).map(|name| joints[index(name)]);
    let bone = end - start;
    TapePlane {
        measure,
        center: start + share * bone,
        normal: bone.normalize(),
    }
}

/// The joints between which the girth of a limb or the neck is taken.
fn bone_of(measure: Measure) -> [&'static str; 2] {
    match measure {
        Measure::Thigh | Measure::Knee => ["left_hip", "left_knee"],
        Measure::Calf | Measure::Ankle => ["left_knee", "left_ankle"],
        Measure::UpperArm => ["left_shoulder", "left_elbow"],
        Measure::Forearm | Measure::Wrist => ["left_elbow", "left_wrist"],
        _ => ["neck", "head"],
    }
}

/// Where along its bone the girth of a limb or the neck is taken.
pub(crate) fn share_of(measure: Measure) -> f64 {
    match measure {
        Measure::Thigh => THIGH_PLACE,
        Measure::Knee => 1.0,
        Measure::Calf => CALF_PLACE,
        Measure::Ankle => ANKLE_PLACE,
        Measure::UpperArm => UPPER_ARM_PLACE,
        Measure::Forearm => FOREARM_PLACE,
        Measure::Wrist => WRIST_PLACE,
        _ => NECK_PLACE,
    }
}

/// The height at which a girth of the trunk is taken; none of other girths.
pub(crate) fn height_of(joints: &[Vec3], stature: f64, measure: Measure) -> Option<f64> {
    let heights = heights(joints, stature);
    let armpit = joints[index("left_shoulder")].y - ARMPIT_DROP * stature;
    match measure {
        Measure::Chest => Some(heights.chest.min(armpit)),
        Measure::UnderBust => Some(heights.chest - UNDER_BUST_DROP * stature),
        Measure::Waist => Some(heights.waist),
        Measure::Hip => Some(heights.hip),
        _ => None,
    }
}

/// The plane of a girth of a body at rest with the built-in joints.
pub(crate) fn plane(joints: &[Vec3], stature: f64, measure: Measure) -> TapePlane {
    match height_of(joints, stature, measure) {
        Some(height) => trunk_plane(joints, measure, height),
        None => bone_plane(joints, measure, share_of(measure)),
    }
}

/// The planes of all girths of a body at rest with the built-in joints.
pub(crate) fn planes(joints: &[Vec3], stature: f64) -> Vec<TapePlane> {
    Measure::GIRTHS
        .map(|measure| plane(joints, stature, measure))
        .to_vec()
}

/// Heights of the landmarks that the joints mark, in metres.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Heights {
    pub(crate) hip: f64,
    pub(crate) waist: f64,
    pub(crate) chest: f64,
    pub(crate) acromion: f64,
    pub(crate) knee: f64,
}

pub(crate) fn heights(joints: &[Vec3], stature: f64) -> Heights {
    let s = stature / REFERENCE_STATURE;
    let height = |name: &str| joints[index(name)].y;
    Heights {
        hip: height("pelvis") - PELVIS_ABOVE_HIP_HEIGHT * s,
        waist: height("spine1") + SPINE1_BELOW_WAIST * s,
        chest: height("spine3") - SPINE3_ABOVE_CHEST * s,
        acromion: height("left_collar") + COLLAR_BELOW_ACROMION * s,
        knee: height("left_knee") + KNEE_BELOW_PATELLA * s,
    }
}

/// All measures of a body at rest with the built-in mesh and joints, whose first `num_middle`
/// vertices lie in the middle plane.
pub(crate) fn measured(
    positions: &[Vec3],
    faces: &[[u32; 3]],
    arm_share: &[f64],
    num_middle: usize,
    joints: &[Vec3],
) -> Measures {
    let stature = positions
        .iter()
        .map(|point| point.y)
        .fold(f64::MIN, f64::max);
    let s = stature / REFERENCE_STATURE;
    let planes = planes(joints, stature);
    let heights = heights(joints, stature);
    let at = |name: &str| joints[index(name)];
    let girths: Vec<f64> = planes
        .par_iter()
        .map(|plane| girth(positions, faces, arm_share, plane))
        .collect();
    Measures::from_fn(|measure| match measure {
        Measure::Stature => stature,
        Measure::ShoulderBreadth => 2.0 * (at("left_shoulder").x + SHOULDER_INSIDE_ACROMION * s),
        Measure::ArmLength => {
            let upper = (at("left_elbow") - at("left_shoulder")).norm();
            upper + UPPER_ARM_ABOVE_JOINT * s + (at("left_wrist") - at("left_elbow")).norm()
        }
        Measure::Inseam => crotch_height(&positions[..num_middle]),
        Measure::ShoulderHeight => heights.acromion,
        Measure::ChestHeight => heights.chest,
        Measure::WaistHeight => heights.waist,
        Measure::HipHeight => heights.hip,
        Measure::KneeHeight => heights.knee,
        girth_measure => {
            let place = planes
                .iter()
                .position(|plane| plane.measure == girth_measure);
            place.map_or(0.0, |place| girths[place])
        }
    })
}

/// How far the armpits lie below the shoulder joints in the rest pose, in statures; the chest girth
/// is taken no higher.
const ARMPIT_DROP: f64 = 0.074;

/// How much farther an upper arm reaches towards the trunk than away from it, at most: 1.02 on
/// bodies whose armpits are clear of the tape.
const ARM_ASYMMETRY: f64 = 1.06;

/// Joints of the trunk from below; the tape looks for the middle of the trunk on the line of them.
const SPINE: [usize; 5] = [0, 3, 6, 9, 12];

/// Where along the neck its girth is taken.
pub(crate) const NECK_PLACE: f64 = 0.38;

pub(crate) fn index(name: &str) -> usize {
    JOINT_NAMES
        .iter()
        .position(|&other| other == name)
        .expect("the joint is one of ours")
}

/// The lowest point where the middle plane meets the trunk between the legs: the crotch.
pub(crate) fn crotch_height(middle: &[Vec3]) -> f64 {
    middle.iter().map(|point| point.y).fold(f64::MAX, f64::min)
}

/// Positions in double precision.
pub(crate) fn doubled(positions: &[Point3]) -> Vec<Vec3> {
    positions.iter().map(|point| point.coords.cast()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tape_around_a_tube_measures_its_circumference() {
        let tube = garnet_mesh::primitives::tube(0.1, 0.4, 64, 20);
        let positions = doubled(tube.positions());
        let center = positions.iter().sum::<Vec3>() / positions.len() as f64;
        let plane = TapePlane {
            measure: Measure::Waist,
            center,
            normal: Vec3::y(),
        };
        let round = girth(
            &positions,
            tube.faces(),
            &vec![0.0; positions.len()],
            &plane,
        );
        approx::assert_relative_eq!(round, std::f64::consts::TAU * 0.1, max_relative = 2e-3);
    }

    #[test]
    fn an_armpit_is_no_part_of_the_arm() {
        let mut section = vec![[0.05, 0.0], [0.0, 0.05], [0.0, -0.05], [-0.12, 0.0]];
        press_armpit(&mut section);
        approx::assert_relative_eq!(section[3][0], -ARM_ASYMMETRY * 0.05);
        approx::assert_relative_eq!(section[0][0], 0.05);
    }

    #[test]
    fn a_hull_bridges_hollows() {
        let hollow = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5, 0.5], [0.0, 1.0]];
        approx::assert_relative_eq!(hull_perimeter(hollow), 4.0, epsilon = 1e-9);
    }
}
