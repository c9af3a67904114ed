//! Motions in the layout of AMASS and SMPL: npz archives of axis-angle vectors or matrices.
//!
//! `poses` has one rotation for each joint a frame, in the order of the 22 joints of the
//! built-in skeleton, or root and body have arrays of their own; hands, jaw and eyes are left out.
//! The axes are the body's: x to its left, y up, z to its front; the rest pose is a T-pose with
//! straight legs. The first row turns the body into the world, whose up axis is told by where the
//! bodies stand.
//!
//! The file has no skeleton. The one here stands in a T-pose with bones along the axes and lengths
//! as parts of the stature from Drillis and Contini 1966 (Winter 2009, figure 4.1): only directions
//! matter, and the length of the leg, to which shifts are in proportion.

use std::{ops::RangeInclusive, path::Path};

use garnet_body::motion::{Motion, ReadOptions, Upward};
use garnet_skin::{Joint, Point3, Pose, Skeleton, Vector3};

use super::{
    MotionProblem,
    turns::{Kind, turns},
};
use crate::{ArrayProblem, FileError, FileProblem, NpzFile, pose_json::FARTHEST};

/// Joints of the body; those of the hands follow them in the file.
const NUM_BODY_JOINTS: usize = 22;

/// Name, parent and offset from the parent in metres, for a stature of 1.70 m.
const JOINTS: [(&str, Option<usize>, [f32; 3]); NUM_BODY_JOINTS] = [
    ("pelvis", None, [0.0, 0.93, 0.0]),
    ("left_hip", Some(0), [0.09, -0.03, 0.0]),
    ("right_hip", Some(0), [-0.09, -0.03, 0.0]),
    ("spine1", Some(0), [0.0, 0.11, 0.0]),
    ("left_knee", Some(1), [0.0, -0.415, 0.0]),
    ("right_knee", Some(2), [0.0, -0.415, 0.0]),
    ("spine2", Some(3), [0.0, 0.13, 0.0]),
    ("left_ankle", Some(4), [0.0, -0.415, 0.0]),
    ("right_ankle", Some(5), [0.0, -0.415, 0.0]),
    ("spine3", Some(6), [0.0, 0.06, 0.0]),
    ("left_foot", Some(7), [0.02, -0.05, 0.13]),
    ("right_foot", Some(8), [-0.02, -0.05, 0.13]),
    ("neck", Some(9), [0.0, 0.21, 0.0]),
    ("left_collar", Some(9), [0.06, 0.12, 0.0]),
    ("right_collar", Some(9), [-0.06, 0.12, 0.0]),
    ("head", Some(12), [0.0, 0.10, 0.02]),
    ("left_shoulder", Some(13), [0.11, 0.03, 0.0]),
    ("right_shoulder", Some(14), [-0.11, 0.03, 0.0]),
    ("left_elbow", Some(16), [0.29, 0.0, 0.0]),
    ("right_elbow", Some(17), [-0.29, 0.0, 0.0]),
    ("left_wrist", Some(18), [0.25, 0.0, 0.0]),
    ("right_wrist", Some(19), [-0.25, 0.0, 0.0]),
];

/// Name and parent of the joints, as models of the family have them.
pub(crate) const JOINT_PARENTS: [(&str, Option<usize>); NUM_BODY_JOINTS] = {
    let mut all = [("", None); NUM_BODY_JOINTS];
    let mut joint = 0;
    while joint < NUM_BODY_JOINTS {
        all[joint] = (JOINTS[joint].0, JOINTS[joint].1);
        joint += 1;
    }
    all
};

/// Keys of all joints, of the root, of the others, and of the shift of the body: as AMASS, SMPL-X,
/// `VPoser` and programs that fit bodies to pictures call them.
const ALL_KEYS: [&str; 6] = [
    "poses",
    "fullpose",
    "full_pose",
    "pose",
    "thetas",
    "smpl_poses",
];
const ROOT_KEYS: [&str; 3] = ["root_orient", "global_orient", "root_pose"];
const BODY_KEYS: [&str; 2] = ["pose_body", "body_pose"];
const SHIFT_KEYS: [&str; 4] = ["trans", "transl", "translation", "smpl_trans"];
const RATE_KEYS: [&str; 5] = [
    "mocap_framerate",
    "mocap_frame_rate",
    "mocap_fps",
    "fps",
    "framerate",
];

/// Keys that AMASS has, and few others.
const AMASS_KEYS: [&str; 2] = ["mocap_framerate", "mocap_frame_rate"];

/// A part of the frames in which an upright body tells where up is.
const UPRIGHT: f32 = 0.5;

/// Reads an npz archive with the poses of a body of the SMPL family, in any of its layouts.
#[expect(clippy::too_many_lines, reason = "a layout after the other")]
pub(super) fn read(path: &Path, options: &ReadOptions) -> Result<Motion, MotionProblem> {
    let mut npz = NpzFile::open(path).map_err(boxed)?;
    let keys = npz.keys();
    let first_of = |names: &[&'static str]| {
        let mut names = names.iter();
        names
            .find(|name| keys.iter().any(|key| key == *name))
            .copied()
    };
    let Some(body_key) = first_of(&ALL_KEYS).or_else(|| first_of(&BODY_KEYS)) else {
        return Err(npz
            .require(&["poses"])
            .map_err(boxed)
            .err()
            .unwrap_or(MotionProblem::NoFrames));
    };
    let mut turns = turns(&mut npz, body_key, Kind::Joints)?;
    if turns.has_no_root() {
        let Some(root_key) = first_of(&ROOT_KEYS) else {
            let missing = npz.require(&["root_orient"]).map_err(boxed);
            return Err(missing.err().unwrap_or(MotionProblem::NoFrames));
        };
        let root = self::turns(&mut npz, root_key, Kind::Root(turns.num_frames()))?;
        turns = turns.under(&root);
    }
    if turns.num_joints < NUM_BODY_JOINTS {
        let found = vec![turns.num_frames(), 3 * turns.num_joints];
        let expected =
            "[frames, 66], [frames, 72], [frames, 156], [frames, 165], or as many matrices";
        let expected = expected.to_owned();
        return Err(wrong_shape(&npz, body_key, found, expected));
    }
    let num_frames = turns.num_frames();
    if num_frames == 0 {
        return Err(MotionProblem::NoFrames);
    }
    let mut notes: Vec<String> = turns.note.take().into_iter().collect();
    let has_more = [
        "pose_hand",
        "left_hand_pose",
        "hand_pose",
        "pose_jaw",
        "jaw_pose",
    ];
    if turns.num_joints > NUM_BODY_JOINTS || first_of(&has_more).is_some() {
        notes.push("joints of hands, jaw and eyes are left out".to_owned());
    }
    if first_of(&["betas"]).is_some() {
        notes.push("`betas` (the shape of the body) are left out".to_owned());
    }
    let shifts = if let Some(key) = first_of(&SHIFT_KEYS) {
        shifts(&mut npz, key, num_frames)?
    } else {
        notes.push("there is no `trans`: the body stays at its place".to_owned());
        vec![Vector3::zeros(); num_frames]
    };
    let rate = match first_of(&RATE_KEYS) {
        Some(key) => scalar(&mut npz, key)?,
        None => None,
    };
    // AIST++ has bodies so many times as large.
    let times = match first_of(&["smpl_scaling"]) {
        Some(key) => scalar(&mut npz, key)?.filter(|times| *times > 0.0 && times.is_finite()),
        None => None,
    };
    let metres = (options.metres_per_unit.unwrap_or(1.0) / times.unwrap_or(1.0)) as f32;
    let skeleton = skeleton()?;
    let frames = turns.frames().zip(&shifts).map(|(row, shift)| Pose {
        // The shift moves the origin of the body, which lies at the pelvis within a hand's breadth.
        root_translation: shift * metres - Vector3::from(JOINTS[0].2),
        rotations: row[..NUM_BODY_JOINTS].to_vec(),
    });
    let mut frames: Vec<Pose> = frames.collect();
    let lying = if first_of(&AMASS_KEYS).is_some() {
        Lying::IN_AMASS
    } else {
        Lying::ANYWHERE
    };
    let detected = || detected_up(&skeleton, &frames, &shifts, &lying);
    let (up, doubt) = options.up.map_or_else(detected, |up| (up, None));
    let sort = if up == Upward::MinusY {
        " (that of a camera)"
    } else {
        ""
    };
    let why = doubt.map(|doubt| match doubt {
        Doubt::StandAlong(other) => {
            format!(", on whose floor the bodies lie: `--pose-up {other}` lets them stand")
        }
        Doubt::FloorOf(Upward::Z) => {
            ", since the bodies stand along it: `--pose-up z` reads it as AMASS is".to_owned()
        }
        Doubt::FloorOf(other) => {
            format!(", since the bodies stand along it: `--pose-up {other}` lays them on the floor")
        }
    });
    let why = why.unwrap_or_default();
    notes.push(format!("{up}{sort} is read as the up axis{why}"));
    turn_to_y_up(&mut frames, up);
    notes.extend(height_note(&frames));
    Ok(Motion {
        frames,
        skeleton,
        frame_time: rate
            .filter(|rate| *rate > 0.0 && rate.is_finite())
            .map(|rate| 1.0 / rate),
        notes,
    })
}

/// No body is that far above or below the floor for half of a motion, in metres.
const FAR_FROM_FLOOR: f32 = 20.0;

/// Tells of shifts that are in another unit, as it seems. Poses have Y up.
fn height_note(frames: &[Pose]) -> Option<String> {
    let heights = frames.iter().map(|pose| pose.root_translation.y);
    let mut heights: Vec<f32> = heights.collect();
    heights.sort_by(f32::total_cmp);
    let middle = *heights.get(heights.len() / 2)?;
    (middle.abs() > FAR_FROM_FLOOR).then(|| {
        format!(
            "the body is {:.0} m from the floor in half of the frames: its shifts may be in another \
             unit than metres",
            middle.abs()
        )
    })
}

/// Turns the world of poses to Y up.
fn turn_to_y_up(frames: &mut [Pose], up: Upward) {
    let to_y_up = up.to_y_up();
    let hips = Vector3::from(JOINTS[0].2);
    for pose in frames {
        // The body's own axes have Y up; only the world of the first rotation has not.
        pose.rotations[0] = to_y_up * pose.rotations[0];
        pose.root_translation = to_y_up * (pose.root_translation + hips) - hips;
    }
}

/// About so many frames tell which way is up.
const FRAMES_LOOKED_AT: usize = 50;

/// Another way up that a motion may have.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Doubt {
    /// The bodies lie, and stand along this one.
    StandAlong(Upward),
    /// The bodies stand, and are above the floor of this one, or that is the one of AMASS.
    FloorOf(Upward),
}

/// Which way is up, and which one may be instead.
///
/// Bodies whose own Y points along an axis in the mean stand along it, unless they lie on the floor
/// of AMASS, in which z is up. Else they are above the floor of y or z: the pelvis as high as that
/// of who stands, sits or lies, and no joint far below; of another axis, if it is the only one; and
/// of AMASS otherwise.
fn detected_up(
    skeleton: &Skeleton,
    frames: &[Pose],
    shifts: &[Vector3],
    lying: &Lying,
) -> (Upward, Option<Doubt>) {
    let step = frames.len().div_ceil(FRAMES_LOOKED_AT).max(1);
    let some: Vec<&Pose> = frames.iter().step_by(step).collect();
    let mean = |sum: f32| sum / some.len().max(1) as f32;
    let uprights = some.iter().map(|pose| pose.rotations[0] * Vector3::y());
    let upward = uprights.sum::<Vector3>() / some.len().max(1) as f32;
    let nearest = Upward::nearest(&upward);
    let stands = nearest.direction().dot(&upward) > UPRIGHT;
    let is_usual = matches!(nearest, Upward::Y | Upward::Z | Upward::MinusY);
    let standing = |doubt: Option<Doubt>| {
        let unusual = (!is_usual).then_some(Doubt::FloorOf(Upward::Z));
        (nearest, doubt.or(unusual))
    };
    // Without shifts there is no floor.
    if shifts.iter().all(|shift| *shift == Vector3::zeros()) {
        return if stands {
            standing(None)
        } else {
            (Upward::Z, None)
        };
    }
    let likely = |up: Upward| {
        mean(
            some.iter()
                .map(|pose| likely_above(skeleton, pose, up))
                .sum(),
        )
    };
    let share = |up: Upward, is_there: &dyn Fn(f32, f32) -> bool| {
        let there = some.iter().filter(|pose| {
            let [pelvis, lowest] = heights(skeleton, pose, up);
            is_there(pelvis, lowest)
        });
        there.count() as f32 / some.len().max(1) as f32
    };
    if stands {
        let lies =
            |pelvis, lowest| lying.pelvis.contains(&pelvis) && lying.lowest.contains(&lowest);
        let may_lie = nearest != Upward::Z && share(Upward::Z, &lies) > MOST;
        let is_near = |_, lowest| NEAR_FLOOR.contains(&lowest);
        let may_stand = nearest == Upward::Y && share(nearest, &is_near) > UPRIGHT;
        // On the hands they are above the floor of AMASS, too.
        let is_upside_down = nearest == Upward::MinusZ && likely(Upward::Z) >= UPSIDE_DOWN * MOST;
        if may_lie && !may_stand || is_upside_down {
            return (Upward::Z, Some(Doubt::StandAlong(nearest)));
        }
        let lie_elsewhere = nearest == Upward::Z
            && likely(Upward::Y) > MOST_LIKELY
            && likely(Upward::Z) < MOST_LIKELY;
        return standing(lie_elsewhere.then_some(Doubt::FloorOf(Upward::Y)));
    }
    let [y, z] = [Upward::Y, Upward::Z].map(likely);
    if y.max(z) > MOST_LIKELY {
        let is_y = y > z + APART;
        return (if is_y { Upward::Y } else { Upward::Z }, None);
    }
    let mut others = Upward::ALL.into_iter();
    let other = others.find(|&up| likely(up) > MOST_LIKELY);
    (other.unwrap_or(Upward::Z), None)
}

/// How high pelvis and lowest joint are above the floor, in metres, of bodies that lie on it.
struct Lying {
    pelvis: RangeInclusive<f32>,
    lowest: RangeInclusive<f32>,
}

impl Lying {
    /// In any file: none of those whose origin is at the pelvis.
    const ANYWHERE: Self = Self {
        pelvis: f32::NEG_INFINITY..=f32::INFINITY,
        lowest: 0.01..=0.25,
    };
    /// In files with the keys of AMASS, whose floor is at the origin.
    const IN_AMASS: Self = Self {
        pelvis: 0.04..=1.2,
        lowest: -0.15..=0.2,
    };
}

/// How high the lowest joint of who stands is above the floor, in metres: of bodies of another
/// size, origin or with jumps, too.
const NEAR_FLOOR: RangeInclusive<f32> = -0.2..=0.45;

/// How high pelvis and lowest joint are, in metres.
fn heights(skeleton: &Skeleton, pose: &Pose, up: Upward) -> [f32; 2] {
    let up = up.direction();
    let pelvis = (pose.root_translation + Vector3::from(JOINTS[0].2)).dot(&up);
    let Ok(transforms) = skeleton.transforms(pose) else {
        return [pelvis, f32::NAN];
    };
    let joints = skeleton.joints().iter().zip(&transforms);
    let heights = joints.map(|(joint, transform)| {
        let place = transform * joint.rest_position;
        place.coords.dot(&up)
    });
    [pelvis, heights.fold(f32::INFINITY, f32::min)]
}

/// How likely a pose is with this way up, above a floor at the origin: 1 for who stands, sits or
/// lies, less for who is upside down, and 0 for who hovers or is below.
fn likely_above(skeleton: &Skeleton, pose: &Pose, up: Upward) -> f32 {
    let [pelvis, lowest] = heights(skeleton, pose, up);
    let upright = (pose.rotations[0] * Vector3::y()).dot(&up.direction());
    match PELVIS.contains(&pelvis) && LOWEST.contains(&lowest) {
        true if upright < -UPRIGHT => UPSIDE_DOWN,
        true => 1.0,
        false => 0.0,
    }
}

/// How high a pelvis is above the floor, in metres: of who lies on it, to who jumps. Lower ones
/// take bodies whose pelvis is at the origin for bodies on the floor.
const PELVIS: RangeInclusive<f32> = 0.04..=1.4;

/// How high the lowest joint is above the floor, in metres: of bodies of another size or with
/// jumps, too, and those that are not quite on it.
const LOWEST: RangeInclusive<f32> = -0.3..=0.45;

/// How likely it is to be upside down.
const UPSIDE_DOWN: f32 = 0.5;

/// Bodies are above the floor of an axis in more than this share of the frames, and in so many more
/// than of the other axis.
const MOST_LIKELY: f32 = 0.6;
const APART: f32 = 0.25;

/// A part of the frames that is nearly all.
const MOST: f32 = 0.9;

/// The shift of each frame.
fn shifts(
    npz: &mut NpzFile,
    key: &'static str,
    num_frames: usize,
) -> Result<Vec<Vector3>, MotionProblem> {
    let Some(array) = npz.array(key).map_err(boxed)? else {
        return Err(MotionProblem::NoFrames);
    };
    let values = array.floats();
    let values = values.map_err(|problem| boxed(npz.wrong(key, problem)))?;
    if array.shape.last() != Some(&3) || values.len() != 3 * num_frames {
        let expected = format!("[{num_frames}, 3]");
        return Err(wrong_shape(npz, key, array.shape, expected));
    }
    let rows = values.chunks_exact(3).enumerate();
    let shift = |(frame, row): (usize, &[f64])| {
        let shift = Vector3::new(row[0] as f32, row[1] as f32, row[2] as f32);
        let is_finite = shift.iter().all(|value| value.is_finite());
        if !is_finite {
            return Err(MotionProblem::NonFinite { frame, key });
        }
        let far = shift.iter().find(|value| value.abs() > FARTHEST as f32);
        match far {
            Some(&value) => Err(MotionProblem::TooFar { frame, key, value }),
            None => Ok(shift),
        }
    };
    rows.map(shift).collect()
}

/// The T-pose that angles of zero stand for.
pub(crate) fn skeleton() -> Result<Skeleton, MotionProblem> {
    let mut joints: Vec<Joint> = Vec::with_capacity(NUM_BODY_JOINTS);
    for (name, parent, offset) in JOINTS {
        let start = parent.map_or_else(Point3::origin, |parent| joints[parent].rest_position);
        joints.push(Joint {
            name: name.to_owned(),
            parent,
            rest_position: start + Vector3::from(offset),
        });
    }
    Ok(Skeleton::new(joints)?)
}

fn scalar(npz: &mut NpzFile, key: &str) -> Result<Option<f64>, MotionProblem> {
    let Some(array) = npz.array(key).map_err(boxed)? else {
        return Ok(None);
    };
    let values = array.floats();
    let values = values.map_err(|problem| boxed(npz.wrong(key, problem)))?;
    Ok(values.first().copied())
}

pub(super) fn wrong_shape(
    npz: &NpzFile,
    key: &str,
    found: Vec<usize>,
    expected: String,
) -> MotionProblem {
    boxed(npz.wrong(key, ArrayProblem::Shape { found, expected }))
}

/// The error of the archive without its path, which the motion's own error names.
pub(super) fn boxed(error: FileError) -> MotionProblem {
    match error.problem {
        FileProblem::Io(error) => MotionProblem::Io(error),
        problem => MotionProblem::File(Box::new(problem)),
    }
}
