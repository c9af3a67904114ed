//! Motions in the layout of AMASS and SMPL: npz archives of axis-angle vectors.
//!
//! `poses` has one row of 3 numbers for each joint a frame, in the order of the 22 joints of the
//! built-in skeleton; the joints of hands, jaw and eyes that follow are left out. The axes are the
//! body's: x to its left, y up, z to its front; the rest pose is a T-pose with straight legs. The
//! first row turns the body into the world, which has Z up in AMASS.
//!
//! The file has no skeleton. The one here stands in a T-pose with bones along the axes and lengths
//! as parts of the stature from Drillis and Contini 1966 (Winter 2009, figure 4.1): only directions
//! matter, and the length of the leg, to which shifts are in proportion.

use std::path::Path;

use garnet_body::motion::{Motion, ReadOptions};
use garnet_mesh::UpAxis;
use garnet_skin::{Joint, Point3, Pose, Skeleton, Vector3};
use nalgebra::UnitQuaternion;

use super::MotionProblem;
use crate::{ArrayProblem, FileError, FileProblem, NpzFile};

/// Joints of the body; those of the hands follow them in the file.
const NUM_BODY_JOINTS: usize = 22;

/// Numbers in a row: SMPL (24 joints), SMPL+H (52) and SMPL-X (55).
const ROW_LENGTHS: [usize; 3] = [72, 156, 165];

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

/// Reads an npz archive with `poses`.
pub(super) fn read(path: &Path, options: &ReadOptions) -> Result<Motion, MotionProblem> {
    let mut npz = NpzFile::open(path).map_err(boxed)?;
    npz.require(&["poses"]).map_err(boxed)?;
    let mut notes = Vec::new();
    let (num_frames, row_length, poses) = matrix(&mut npz, "poses")?;
    if !ROW_LENGTHS.contains(&row_length) {
        let expected = "[frames, 72], [frames, 156] or [frames, 165]".to_owned();
        return Err(wrong_shape(
            &npz,
            "poses",
            vec![num_frames, row_length],
            expected,
        ));
    }
    if num_frames == 0 {
        return Err(MotionProblem::NoFrames);
    }
    if row_length > 3 * NUM_BODY_JOINTS {
        notes.push("joints of hands, jaw and eyes are left out".to_owned());
    }
    let keys = npz.keys();
    let has = |key: &str| keys.iter().any(|found| found == key);
    if has("betas") {
        notes.push("`betas` (the shape of the body) are left out".to_owned());
    }
    let shifts = if has("trans") {
        let (rows, columns, shifts) = matrix(&mut npz, "trans")?;
        if rows != num_frames || columns != 3 {
            let expected = format!("[{num_frames}, 3]");
            return Err(wrong_shape(&npz, "trans", vec![rows, columns], expected));
        }
        shifts
    } else {
        notes.push("there is no `trans`: the body stays at its place".to_owned());
        vec![0.0; 3 * num_frames]
    };
    let rate = match has("mocap_framerate") {
        true => scalar(&mut npz, "mocap_framerate")?,
        false if has("mocap_frame_rate") => scalar(&mut npz, "mocap_frame_rate")?,
        false => None,
    };
    let up = options.up.unwrap_or(UpAxis::Z);
    notes.push(format!("{up} is read as the up axis"));
    let metres = options.metres_per_unit.unwrap_or(1.0);
    let rows = poses.chunks_exact(row_length).zip(shifts.chunks_exact(3));
    let mut frames = Vec::with_capacity(num_frames);
    for (frame, (row, shift)) in rows.enumerate() {
        frames.push(pose(frame, &row[..3 * NUM_BODY_JOINTS], shift, metres, up)?);
    }
    Ok(Motion {
        skeleton: skeleton()?,
        frames,
        frame_time: rate
            .filter(|rate| *rate > 0.0 && rate.is_finite())
            .map(|rate| 1.0 / rate),
        notes,
    })
}

/// The T-pose that angles of zero stand for.
fn skeleton() -> Result<Skeleton, MotionProblem> {
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

fn pose(
    frame: usize,
    angles: &[f64],
    shift: &[f64],
    metres: f64,
    up: UpAxis,
) -> Result<Pose, MotionProblem> {
    let is_finite = |values: &[f64]| values.iter().all(|&value| (value as f32).is_finite());
    for (key, values) in [("poses", angles), ("trans", shift)] {
        if !is_finite(values) {
            return Err(MotionProblem::NonFinite { frame, key });
        }
    }
    let to_y_up = match up {
        UpAxis::Y => UnitQuaternion::identity(),
        UpAxis::Z => UnitQuaternion::from_axis_angle(
            &nalgebra::Vector3::x_axis(),
            -std::f32::consts::FRAC_PI_2,
        ),
    };
    let vector =
        |values: &[f64]| Vector3::new(values[0] as f32, values[1] as f32, values[2] as f32);
    let mut rotations: Vec<UnitQuaternion<f32>> = angles
        .chunks_exact(3)
        .map(|angle| UnitQuaternion::from_scaled_axis(vector(angle)))
        .collect();
    // The body's own axes have Y up; only the world of the first rotation has not.
    rotations[0] = to_y_up * rotations[0];
    let shift = to_y_up * (vector(shift) * metres as f32);
    // `trans` moves the origin of the body, which lies at the pelvis within a hand's breadth.
    let rest = Vector3::from(JOINTS[0].2);
    Ok(Pose {
        root_translation: shift - rest,
        rotations,
    })
}

/// Rows, columns and elements of an array; a single row may be without its first axis.
fn matrix(npz: &mut NpzFile, key: &'static str) -> Result<(usize, usize, Vec<f64>), MotionProblem> {
    let Some(array) = npz.array(key).map_err(boxed)? else {
        return Err(MotionProblem::NoFrames);
    };
    let values = array.floats();
    let values = values.map_err(|problem| boxed(npz.wrong(key, problem)))?;
    match *array.shape.as_slice() {
        [columns] => Ok((1, columns, values)),
        [rows, columns] => Ok((rows, columns, values)),
        _ => Err(wrong_shape(
            npz,
            key,
            array.shape,
            "[frames, numbers]".to_owned(),
        )),
    }
}

fn scalar(npz: &mut NpzFile, key: &str) -> Result<Option<f64>, MotionProblem> {
    let Some(array) = npz.array(key).map_err(boxed)? else {
        return Ok(None);
    };
    let values = array.floats();
    let values = values.map_err(|problem| boxed(npz.wrong(key, problem)))?;
    Ok(values.first().copied())
}

fn wrong_shape(npz: &NpzFile, key: &str, found: Vec<usize>, expected: String) -> MotionProblem {
    boxed(npz.wrong(key, ArrayProblem::Shape { found, expected }))
}

/// The error of the archive without its path, which the motion's own error names.
fn boxed(error: FileError) -> MotionProblem {
    match error.problem {
        FileProblem::Io(error) => MotionProblem::Io(error),
        problem => MotionProblem::File(Box::new(problem)),
    }
}
