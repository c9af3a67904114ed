//! Motions whose up axis is any of the six.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

#[path = "common/arrays.rs"]
mod arrays;

use std::{f32::consts::FRAC_PI_2, fs};

use arrays::npz;
use garnet_body::motion::{Motion, ReadOptions, Upward};
use garnet_io::Take;
use garnet_skin::{Pose, Vector3};
use nalgebra::UnitQuaternion;

const ROUNDING: f32 = 1e-4;

/// Height of the pelvis of who stands, in metres.
const STANDING: f32 = 0.93;

/// A motion of roots and shifts, y up, written with another way up.
fn read(roots: &[UnitQuaternion<f32>], shifts: Option<&[Vector3]>, up: Upward) -> Motion {
    read_as(roots, shifts, up, None)
}

fn read_as(
    roots: &[UnitQuaternion<f32>],
    shifts: Option<&[Vector3]>,
    up: Upward,
    told: Option<Upward>,
) -> Motion {
    read_file(roots, shifts, (up, told), &[])
}

/// The same with further arrays of one number.
fn read_file(
    roots: &[UnitQuaternion<f32>],
    shifts: Option<&[Vector3]>,
    (up, told): (Upward, Option<Upward>),
    numbers: &[(&str, f64)],
) -> Motion {
    let from_y_up = up.to_y_up().inverse();
    let mut poses = Vec::new();
    for root in roots {
        let mut row = [0.0; 66];
        let turn = (from_y_up * root).scaled_axis();
        for (value, angle) in row.iter_mut().zip(turn.iter()) {
            *value = f64::from(*angle);
        }
        // A knee, so that bodies are not at rest.
        row[12] = 0.3;
        poses.extend(row);
    }
    let shifts = shifts.map(|shifts| {
        let turned = shifts.iter().map(|shift| from_y_up * shift);
        let values = turned.flat_map(|shift| [shift.x, shift.y, shift.z]);
        values.map(f64::from).collect::<Vec<_>>()
    });
    let shape = [roots.len(), 3];
    let poses_shape = [roots.len(), 66];
    let mut entries: Vec<(&str, &[usize], &[f64])> = vec![("poses", &poses_shape, &poses)];
    if let Some(shifts) = &shifts {
        entries.push(("trans", &shape, shifts));
    }
    for (name, number) in numbers {
        entries.push((name, &[], std::slice::from_ref(number)));
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("clip.npz");
    fs::write(&path, npz(&entries)).unwrap();
    let options = ReadOptions {
        up: told,
        ..ReadOptions::default()
    };
    let take = Take::read(&path, &options).unwrap();
    take.motion().unwrap().clone()
}

fn about(axis: Vector3, angle: f32) -> UnitQuaternion<f32> {
    UnitQuaternion::from_scaled_axis(axis * angle)
}

fn is_same(a: &Pose, b: &Pose) -> bool {
    let turns = a.rotations.iter().zip(&b.rotations);
    let mut angles = turns.map(|(a, b)| a.angle_to(b));
    let off = (a.root_translation - b.root_translation).norm();
    off < ROUNDING && angles.all(|angle| angle < 1e-3)
}

#[test]
fn whoever_stands_tells_which_way_is_up() {
    let roots: Vec<_> = (0..4)
        .map(|frame| about(Vector3::y(), 0.4 * frame as f32))
        .collect();
    let walk: Vec<_> = (0..4)
        .map(|frame| Vector3::new(1.0, STANDING, 0.5 * frame as f32))
        .collect();
    // About the pelvis, as programs that fit bodies to pictures have it.
    let centred: Vec<_> = walk.iter().map(|place| place - walk[0]).collect();
    for shifts in [Some(&walk), Some(&centred), None] {
        let shifts = shifts.map(Vec::as_slice);
        let expected = read_as(&roots, shifts, Upward::Y, Some(Upward::Y));
        for up in Upward::ALL {
            let found = read(&roots, shifts, up);
            let pairs = found.frames.iter().zip(&expected.frames);
            assert!(pairs.into_iter().all(|(a, b)| is_same(a, b)), "{up}");
            let is_told = |note: &String| note.starts_with(&up.to_string());
            assert!(found.notes.iter().any(is_told), "{up}: {:?}", found.notes);
            let told = read_as(&roots, shifts, up, Some(up));
            assert_eq!(told.frames, found.frames, "{up}");
        }
    }
}

#[test]
fn who_lies_on_the_floor_of_amass_stays_there() {
    // On the back and on both sides, held up by an arm; the head to any side.
    for turn in [-1.0, 0.0, 1.0] {
        for heading in 0..4 {
            let down = about(Vector3::x(), -FRAC_PI_2) * about(Vector3::y(), FRAC_PI_2 * turn);
            let root = about(Vector3::y(), FRAC_PI_2 * heading as f32) * down;
            let shifts = [Vector3::new(0.8, 0.15 + 0.72 * turn.abs(), 2.5); 3];
            let found = read(&[root; 3], Some(&shifts), Upward::Z);
            let expected = read_as(&[root; 3], Some(&shifts), Upward::Z, Some(Upward::Z));
            let told = found.notes.last().unwrap();
            assert!(told.starts_with("z is read"), "{told}");
            let is_equal = found.frames == expected.frames;
            assert!(is_equal, "{turn} {heading}: {:?}", found.notes);
        }
    }
}

#[test]
fn who_rolls_over_the_floor_is_read_by_the_floor() {
    let roll = |frame: usize| about(Vector3::x(), 0.25 * std::f32::consts::TAU * frame as f32);
    let roots: Vec<_> = (0..4).map(roll).collect();
    // As high as the legs under the pelvis, the body that lies, and the head over it.
    let heights = [STANDING + 0.05, 0.2, 0.7, 0.2];
    let place = |frame: usize| Vector3::new(3.0, heights[frame], 2.0 * frame as f32 + 4.0);
    let shifts: Vec<_> = (0..4).map(place).collect();
    for up in [Upward::Y, Upward::Z] {
        let found = read(&roots, Some(&shifts), up);
        let expected = read_as(&roots, Some(&shifts), up, Some(up));
        assert!(found.frames == expected.frames, "{up}: {:?}", found.notes);
    }
}

#[test]
fn bodies_on_the_floor_of_amass_lie() {
    // On the back, prone on the arms, and standing for a while before: at heights of a pelvis.
    let back = about(Vector3::x(), -FRAC_PI_2);
    let prone = about(Vector3::x(), FRAC_PI_2 - 0.3);
    let none = UnitQuaternion::identity();
    let lain = [vec![none; 2], vec![back; 6]].concat();
    let heights = [vec![STANDING; 2], vec![0.12; 6]].concat();
    let down = about(Vector3::x(), 2.0 * FRAC_PI_2);
    let scenes = [
        (vec![back; 4], vec![0.1; 4]),
        (vec![prone; 4], vec![0.45; 4]),
        (lain, heights),
        // On the hands.
        (vec![down; 4], vec![0.9; 4]),
    ];
    for (roots, heights) in &scenes {
        let shifts: Vec<Vector3> = (heights.iter())
            .map(|&height| Vector3::new(0.2, height, 0.0))
            .collect();
        let told = Some(Upward::Z);
        let rate = [("mocap_framerate", 60.0)];
        let found = read_file(roots, Some(&shifts), (Upward::Z, None), &rate);
        let expected = read_file(roots, Some(&shifts), (Upward::Z, told), &rate);
        assert!(found.frames == expected.frames, "{:?}", found.notes);
    }
}

#[test]
fn whoever_stands_away_from_the_floor_stands() {
    let roots = [UnitQuaternion::identity(); 6];
    let step = |frame: usize| 0.07 * frame as f32;
    // On a stage, with the pelvis at first at the origin, a child, on a rising floor.
    let ways: [&dyn Fn(usize) -> [f32; 2]; 5] = [
        &|_| [STANDING + 1.0, 0.5],
        &|frame| [0.0, step(frame)],
        &|_| [0.45 * STANDING, -0.07],
        &|frame| [STANDING + 4.0 * step(frame), 0.5],
        &|_| [0.0, 0.5],
    ];
    for way in ways {
        let shifts: Vec<Vector3> = (0..roots.len())
            .map(way)
            .map(|[height, forwards]| Vector3::new(0.0, height, forwards))
            .collect();
        for up in [Upward::Y, Upward::Z, Upward::MinusY] {
            let found = read(&roots, Some(&shifts), up);
            let expected = read_as(&roots, Some(&shifts), up, Some(up));
            assert!(found.frames == expected.frames, "{up}: {:?}", found.notes);
        }
    }
}
