//! Motions of the SMPL family as rotation matrices: which are read, and which are refused.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

#[path = "common/arrays.rs"]
mod arrays;

use std::{error::Error, fs, path::Path};

use arrays::npz;
use garnet_body::motion::ReadOptions;
use garnet_io::{MotionError, Take};
use garnet_skin::Pose;

/// Turns differ by no more than this, in radians.
const ROUNDING: f32 = 1e-4;

fn take(folder: &Path, bytes: &[u8]) -> Result<Take, MotionError> {
    let path = folder.join("clip.npz");
    fs::write(&path, bytes).unwrap();
    Take::read(&path, &ReadOptions::default())
}

fn largest_angle(a: &Pose, b: &Pose) -> f32 {
    // The vector part resolves small angles that `angle_to` does not.
    let angles = a
        .rotations
        .iter()
        .zip(&b.rotations)
        .map(|(a, b)| 2.0 * (a.inverse() * b).vector().norm());
    angles.fold(0.0, f32::max)
}

/// An error and its causes in one line.
fn chain(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(next) = cause {
        text = format!("{text}: {next}");
        cause = next.source();
    }
    text
}

/// The entries of a matrix, row after row, for each of some axis-angle vectors.
fn matrices(angles: &[f64]) -> Vec<[f64; 9]> {
    let rows = angles.chunks_exact(3);
    rows.map(|row| {
        let vector = nalgebra::Vector3::new(row[0], row[1], row[2]);
        let matrix = nalgebra::Rotation3::from_scaled_axis(vector).into_inner();
        std::array::from_fn(|place| matrix[(place / 3, place % 3)])
    })
    .collect()
}

#[test]
fn matrices_of_every_layout_are_the_motion_of_the_angles() {
    let folder = tempfile::tempdir().unwrap();
    let read = |key: &str, shape: &[usize], values: &[f64]| {
        take(folder.path(), &npz(&[(key, shape, values)]))
    };
    for num_joints in [22, 24, 52, 55] {
        let angle = |place: usize| (place % 13) as f64 * 0.02;
        let angles: Vec<f64> = (0..6 * num_joints).map(angle).collect();
        let expected = read("poses", &[2, 3 * num_joints], &angles).unwrap();
        let expected = &expected.motion().unwrap().frames;
        let all: Vec<f64> = matrices(&angles).concat();
        // Of a matrix `m`, two columns are the rows of `m[:, :2]`.
        let columns = |m: &[f64; 9]| [m[0], m[1], m[3], m[4], m[6], m[7]];
        let two: Vec<f64> = matrices(&angles).iter().flat_map(columns).collect();
        let half = 9 * num_joints;
        let layouts: [(&[usize], &[f64], &str); 8] = [
            (&[2, num_joints, 3, 3], &all, "rotation matrices"),
            (&[1, 2, num_joints, 3, 3], &all, "rotation matrices"),
            (&[2, num_joints, 9], &all, "rotation matrices"),
            (&[2, 9 * num_joints], &all, "rotation matrices"),
            (&[num_joints, 3, 3], &all[..half], "rotation matrices"),
            (&[9 * num_joints], &all[..half], "rotation matrices"),
            (&[2, num_joints, 6], &two, "first two columns"),
            (&[2, 6 * num_joints], &two, "first two columns"),
        ];
        for (shape, values, note) in layouts {
            let take = read("poses", shape, values).unwrap();
            let motion = take.motion().unwrap();
            let size = if note.starts_with("first") { 6 } else { 9 };
            assert_eq!(motion.frames.len(), values.len() / num_joints / size);
            for (found, expected) in motion.frames.iter().zip(expected) {
                assert!(largest_angle(found, expected) < ROUNDING, "{shape:?}");
            }
            assert!(motion.notes[0].contains(note), "{:?}", motion.notes);
        }
    }
}

#[test]
fn degrees_are_refused_and_other_units_of_shifts_told() {
    let folder = tempfile::tempdir().unwrap();
    let mut angles = vec![0.0; 2 * 66];
    // A root may have turned often, another joint not.
    angles[1] = 40.0;
    let read = |angles: &[f64], shift: [f64; 3]| {
        let shifts = [shift, shift].concat();
        let poses = ("poses", &[2, 66][..], angles);
        let archive = npz(&[poses, ("trans", &[2, 3], &shifts)]);
        take(folder.path(), &archive)
    };
    let notes = |shift: [f64; 3]| {
        let take = read(&angles, shift).unwrap();
        take.motion().unwrap().notes.join("; ")
    };
    assert!(!notes([0.0, 0.95, 0.0]).contains("another unit"));
    let told = notes([0.0, 95.0, 0.0]);
    assert!(
        told.contains("m from the floor in half of the frames"),
        "{told}"
    );
    angles[66 + 12] = 30.0;
    let error = chain(&read(&angles, [0.0; 3]).unwrap_err());
    let expected = "frame 1, joint 4 (`left_knee`): `poses` turns by 30.0 radians";
    assert!(error.contains(expected), "{error}");
}

#[test]
fn a_root_is_told_by_the_frames_of_its_body() {
    let folder = tempfile::tempdir().unwrap();
    for num_frames in [1, 2, 3] {
        let body: Vec<f64> = (0..63 * num_frames)
            .map(|place| place as f64 * 1e-3)
            .collect();
        let root: Vec<f64> = (0..3 * num_frames)
            .map(|place| 0.1 * place as f64)
            .collect();
        let (bodies, roots) = (matrices(&body).concat(), matrices(&root).concat());
        let body: (&str, &[usize], &[f64]) = ("pose_body", &[num_frames, 63], &body);
        let bodies: (&str, &[usize], &[f64]) = ("pose_body", &[num_frames, 21, 3, 3], &bodies);
        let expected = take(
            folder.path(),
            &npz(&[body, ("root_orient", &[num_frames, 3], &root)]),
        );
        let expected = expected.unwrap();
        for shape in [
            &[num_frames, 3, 3][..],
            &[num_frames, 1, 3, 3],
            &[num_frames, 9],
        ] {
            let found = take(
                folder.path(),
                &npz(&[bodies, ("root_orient", shape, &roots)]),
            );
            let found = found.unwrap();
            let frames = [&expected, &found].map(|take| &take.motion().unwrap().frames);
            assert_eq!(frames[1].len(), num_frames);
            for (expected, found) in frames[0].iter().zip(frames[1]) {
                assert!(largest_angle(expected, found) < ROUNDING, "{shape:?}");
            }
        }
        let error = take(
            folder.path(),
            &npz(&[bodies, ("root_orient", &[4, 3], &[0.0; 12])]),
        );
        let text = chain(&error.unwrap_err());
        assert!(
            text.contains(&format!("expected [{num_frames}, 3]")),
            "{text}"
        );
    }
}

#[test]
fn what_may_be_two_rotations_or_none_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let error = |shape: &[usize], values: &[f64]| {
        chain(&take(folder.path(), &npz(&[("poses", shape, values)])).unwrap_err())
    };
    let angles: Vec<f64> = (0..144).map(|place| f64::from(place % 13) * 0.02).collect();
    let mut all = matrices(&angles).concat();
    // Frame 1, joint 4: longer by a tenth, then a mirror image.
    for (scale, shape) in [(1.1, &[2, 216][..]), (-1.0, &[2, 24, 3, 3])] {
        for value in &mut all[9 * 28..9 * 29] {
            *value *= scale;
        }
        let text = error(shape, &all);
        assert!(text.contains("frame 1, joint 4 (`left_knee`)"), "{text}");
        assert!(text.contains("clip.npz"), "{text}");
    }
    // Two rows after each other are those of the inverse, if they are columns.
    let rows = matrices(&angles);
    let rows: Vec<f64> = rows.iter().flat_map(|row| row[..6].to_vec()).collect();
    for shape in [&[2, 24, 6][..], &[2, 144]] {
        let text = error(shape, &rows);
        assert!(text.contains("two rows, or two columns"), "{text}");
    }
    // Quaternions, in whichever order, and an array of roots alone.
    let quaternions = [0.0, 0.6, 0.0, 0.8].repeat(48);
    assert!(error(&[2, 96], &quaternions).contains("[2, 96], expected [frames, 3 n]"));
    assert!(error(&[300, 3], &[0.0; 900]).contains("[300, 3], expected"));
}
