//! Motion files, written here and read back.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

#[path = "../../garnet-body/tests/common/mod.rs"]
mod common;

#[path = "common/arrays.rs"]
mod arrays;

use std::{fmt::Write as _, fs, path::Path};

use arrays::npz;
use common::{CMU, bone, chain, pose, renamed, skeleton};
use garnet_body::motion::{FrameRange, ReadOptions, RetargetOptions, Role, Side, Upward};
use garnet_io::{MotionError, MotionProblem, Take};
use garnet_skin::{Point3, Pose, Skeleton, Vector3};
use nalgebra::UnitQuaternion;
use proptest::prelude::*;

/// Angles in the files have six digits behind the point.
const ROUNDING: f32 = 1e-4;

/// How a BVH file is written.
#[derive(Clone, Copy)]
struct Style {
    order: [usize; 3],
    metres_per_unit: f32,
    is_z_up: bool,
    positions_everywhere: Option<bool>,
    newline: &'static str,
}

const PLAIN: Style = Style {
    order: [2, 1, 0],
    metres_per_unit: 0.01,
    is_z_up: false,
    positions_everywhere: None,
    newline: "\n",
};

/// A BVH file of one pose a row.
fn bvh(skeleton: &Skeleton, frames: &[Pose], style: Style) -> String {
    let to_file = if style.is_z_up {
        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f32::consts::FRAC_PI_2)
    } else {
        UnitQuaternion::identity()
    };
    let vector = |vector: Vector3| to_file * vector / style.metres_per_unit;
    let mut text = String::from("HIERARCHY\n");
    let mut order = Vec::new();
    write_joint(&mut text, skeleton, 0, &vector, style, &mut order);
    writeln!(
        text,
        "MOTION\nFrames: {}\nFrame Time: 8.333e-3",
        frames.len()
    )
    .unwrap();
    for pose in frames {
        for &index in &order {
            let joint = &skeleton.joints()[index];
            let offset = joint.parent.map_or(joint.rest_position.coords, |parent| {
                joint.rest_position - skeleton.joints()[parent].rest_position
            });
            if joint.parent.is_none() {
                let position = vector(offset + pose.root_translation);
                write!(text, "{:e} {} {} ", position.x, position.y, position.z).unwrap();
            } else if let Some(replaces) = style.positions_everywhere {
                let position = if replaces {
                    vector(offset)
                } else {
                    Vector3::zeros()
                };
                write!(text, "{} {} {} ", position.x, position.y, position.z).unwrap();
            }
            let rotation = to_file * pose.rotations[index] * to_file.inverse();
            for angle in euler_angles(&rotation, style.order) {
                write!(text, "{:.6} ", angle.to_degrees()).unwrap();
            }
        }
        text.push('\n');
    }
    text.replace('\n', style.newline)
}

fn write_joint(
    text: &mut String,
    skeleton: &Skeleton,
    index: usize,
    vector: &impl Fn(Vector3) -> Vector3,
    style: Style,
    order: &mut Vec<usize>,
) {
    order.push(index);
    let joint = &skeleton.joints()[index];
    let (word, offset) = match joint.parent {
        Some(parent) => (
            "JOINT",
            joint.rest_position - skeleton.joints()[parent].rest_position,
        ),
        None => ("ROOT", joint.rest_position.coords),
    };
    let offset = vector(offset);
    let has_positions = joint.parent.is_none() || style.positions_everywhere.is_some();
    let channels = if has_positions {
        "6 Xposition Yposition Zposition"
    } else {
        "3"
    };
    writeln!(
        text,
        "{word} {}\n{{\n\tOFFSET {} {} {}",
        joint.name, offset.x, offset.y, offset.z
    )
    .unwrap();
    write!(text, "\tCHANNELS {channels}").unwrap();
    for axis in style.order {
        write!(text, " {}rotation", ["X", "Y", "Z"][axis]).unwrap();
    }
    text.push('\n');
    let children: Vec<usize> = (0..skeleton.num_joints())
        .filter(|&child| skeleton.joints()[child].parent == Some(index))
        .collect();
    if children.is_empty() {
        text.push_str("End Site\n{\nOFFSET 0 0 0.1\n}\n");
    }
    for child in children {
        write_joint(text, skeleton, child, vector, style, order);
    }
    text.push_str("}\n");
}

/// Angles about the axes of `order`, the first one outermost, of a small rotation: found by
/// fixed-point iteration, so that every order is served.
fn euler_angles(rotation: &UnitQuaternion<f32>, order: [usize; 3]) -> [f64; 3] {
    let axes = [
        nalgebra::Vector3::x_axis(),
        nalgebra::Vector3::y_axis(),
        nalgebra::Vector3::z_axis(),
    ];
    let wanted: UnitQuaternion<f64> = UnitQuaternion::new_normalize(rotation.into_inner().cast());
    let made = |angles: [f64; 3]| {
        let parts = [0, 1, 2]
            .map(|place| UnitQuaternion::from_axis_angle(&axes[order[place]], angles[place]));
        parts[0] * parts[1] * parts[2]
    };
    let mut angles = [0.0; 3];
    for _ in 0..500 {
        let left = (wanted * made(angles).inverse()).scaled_axis();
        for place in 0..3 {
            angles[place] += 0.5 * left[order[place]];
        }
    }
    assert!(
        wanted.angle_to(&made(angles)) < 1e-6,
        "the iteration does not settle"
    );
    angles
}

fn take(folder: &Path, bytes: &[u8]) -> Result<Take, MotionError> {
    let path = folder.join("clip.bvh");
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

#[test]
fn a_motion_comes_back_from_bvh_in_every_order_unit_axis_and_layout() {
    let folder = tempfile::tempdir().unwrap();
    let skeleton = renamed(&skeleton(0.0, 12.0), &CMU);
    let frames = [pose(22, 1.0), pose(22, 2.0)];
    let orders = [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ];
    let units = [1.0, 0.1, 0.01, 0.0254, 0.001, 0.0254 / 0.45];
    for (index, (order, metres_per_unit)) in orders.into_iter().zip(units).enumerate() {
        let style = Style {
            order,
            metres_per_unit,
            is_z_up: index % 2 == 1,
            positions_everywhere: [None, Some(true), Some(false)][index % 3],
            newline: if index % 2 == 0 { "\r\n" } else { "\n" },
        };
        let text = bvh(&skeleton, &frames, style);
        let take = take(folder.path(), text.as_bytes()).unwrap();
        let motion = take.motion().unwrap();
        assert_eq!(motion.frames.len(), 2);
        assert!((motion.frame_time.unwrap() - 8.333e-3).abs() < 1e-9);
        // Children may be written in another order than they have here.
        for (joint, expected) in skeleton.joints().iter().enumerate() {
            let found = motion.skeleton.find(&expected.name).unwrap();
            let off = motion.skeleton.joints()[found].rest_position - expected.rest_position;
            assert!(
                off.norm() < ROUNDING,
                "{order:?}: {} is off by {off}",
                expected.name
            );
            for (frame, expected) in motion.frames.iter().zip(&frames) {
                let turn = frame.rotations[found].inverse() * expected.rotations[joint];
                assert!(turn.vector().norm() < ROUNDING, "{order:?}: joint {joint}");
                assert!((frame.root_translation - expected.root_translation).norm() < 1e-3);
            }
        }
    }
}

#[test]
fn a_root_that_lays_the_figure_down_is_told_and_read_by_the_up_axis() {
    let folder = tempfile::tempdir().unwrap();
    let (source, target) = (renamed(&skeleton(0.0, 12.0), &CMU), skeleton(45.0, 3.0));
    let frames = [pose(22, 1.0), pose(22, 2.0)].map(|mut pose| {
        pose.rotations[0] = UnitQuaternion::identity();
        pose
    });
    let plain = bvh(&source, &frames, PLAIN);
    // At rest along y, in the frames along z: the root turns it, and goes the same way.
    let up = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f32::consts::FRAC_PI_2);
    let hips = source.joints()[0].rest_position.coords;
    let lying = frames.clone().map(|mut pose| {
        pose.rotations[0] = up * pose.rotations[0];
        pose.root_translation = up * (hips + pose.root_translation) - hips;
        pose
    });
    let lying = bvh(&source, &lying, PLAIN);
    let read = |text: &str, up: Option<Upward>| {
        let path = folder.path().join("clip.bvh");
        fs::write(&path, text).unwrap();
        let options = ReadOptions {
            up,
            ..ReadOptions::default()
        };
        Take::read(&path, &options).unwrap()
    };
    let options = RetargetOptions::default();
    let poses = |take: &Take| take.poses(&target, FrameRange::ALL, &options).unwrap();
    let expected = poses(&read(&plain, None));
    let found = read(&lying, None);
    let notes = &found.motion().unwrap().notes;
    let is_told = |note: &String| note.contains("`--pose-up z`");
    assert!(notes.iter().any(is_told), "{notes:?}");
    for (found, expected) in poses(&read(&lying, Some(Upward::Z))).iter().zip(&expected) {
        assert!(largest_angle(found, expected) < 1e-3);
        assert!((found.root_translation - expected.root_translation).norm() < 1e-2);
    }
}

#[test]
fn units_and_up_axis_can_be_told() {
    let folder = tempfile::tempdir().unwrap();
    let skeleton = renamed(&skeleton(0.0, 0.0), &CMU);
    let path = folder.path().join("clip.bvh");
    fs::write(&path, bvh(&skeleton, &[Pose::rest(22)], PLAIN)).unwrap();
    let options = ReadOptions {
        metres_per_unit: Some(0.02),
        up: Some(Upward::Z),
    };
    let take = Take::read(&path, &options).unwrap();
    let motion = take.motion().unwrap();
    let hips = motion.skeleton.joints()[0].rest_position;
    assert!(
        (hips - Point3::new(0.0, 0.0, -1.9)).norm() < ROUNDING,
        "{hips}"
    );
    assert!(motion.notes.is_empty());
}

#[test]
fn errors_of_bvh_files_name_the_line() {
    let folder = tempfile::tempdir().unwrap();
    let good = bvh(
        &renamed(&skeleton(0.0, 0.0), &CMU),
        &[pose(22, 1.0), pose(22, 2.0)],
        PLAIN,
    );
    let lines: Vec<&str> = good.lines().collect();
    let last = lines.len();
    let cases = [
        (good.replacen("HIERARCHY", "HIERARCHI", 1), "no motion"),
        (
            good.replacen("ROOT Hips", "JOINT Hips", 1),
            "line 2: found `JOINT`, expected `ROOT`",
        ),
        (
            good.replacen("OFFSET 0 95", "OFFSET 0 x95", 1),
            "line 4: found `x95`",
        ),
        (
            good.replacen("CHANNELS 6", "CHANNELS 7", 1),
            "line 5: found `7`, expected the number of channels",
        ),
        (
            good.replacen("Zrotation", "Wrotation", 1),
            "line 5: found `Wrotation`",
        ),
        (
            good.replacen("Frames: 2", "Frames: two", 1),
            "found `two`, expected the number of frames",
        ),
        (format!("{good}1 2 3\n"), "3 numbers, expected 69"),
        (
            good.replacen("OFFSET 0 95", "OFFSET 0 95,3", 1),
            "line 4: found `95,3`, expected numbers with a decimal point",
        ),
        (
            good.replacen("8.333e-3", "0,00833", 1),
            "found `0,00833`, expected numbers with a decimal point",
        ),
        (good.replacen("8.333e-3", "nan", 1), "found `nan`"),
        (lines[..20].join("\n"), "line 20: the file ends here"),
        (
            good.replacen("MOTION", "}\nMOTION", 1),
            "found `}`, expected `MOTION`",
        ),
        (
            good.replacen("}\nMOTION", "MOTION", 1),
            "found `MOTION`, expected `JOINT`",
        ),
    ];
    for (text, expected) in cases {
        let error = take(folder.path(), text.as_bytes()).unwrap_err();
        let text = chain(&error);
        assert!(text.contains(expected), "{text} has no {expected}");
        assert!(text.contains("clip.bvh"), "{text}");
    }
    let error = take(folder.path(), &good.as_bytes()[..good.len() - 30]).unwrap_err();
    assert!(
        matches!(error.problem, MotionProblem::RowLength { line, .. } if line == last),
        "{error:?}"
    );
}

#[test]
fn the_rows_that_are_there_are_read_and_that_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let good = bvh(
        &renamed(&skeleton(0.0, 0.0), &CMU),
        &[pose(22, 1.0), pose(22, 2.0)],
        PLAIN,
    );
    let lines: Vec<&str> = good.lines().collect();
    let last = lines.len();
    let rows = [
        (
            good.replacen("Frames: 2", "Frames: 3", 1),
            2,
            "says 3, but there are 2",
        ),
        (
            good.replacen("Frames: 2", "Frames:1", 1),
            2,
            "says 1, but there are 2",
        ),
        (lines[..last - 1].join("\n"), 1, "says 2, but there are 1"),
    ];
    for (text, num_frames, note) in rows {
        let take = take(folder.path(), text.as_bytes()).unwrap();
        assert_eq!(take.num_frames(), num_frames);
        let notes = &take.motion().unwrap().notes;
        assert!(notes.iter().any(|found| found.contains(note)), "{notes:?}");
    }
}

/// Lines of the frames of a BVH file, each cut after so many numbers.
fn wrapped(text: &str, length: usize) -> String {
    let (head, rows) = text.split_once("8.333e-3\n").unwrap();
    let words: Vec<&str> = rows.split_whitespace().collect();
    let lines: Vec<String> = words.chunks(length).map(|line| line.join(" ")).collect();
    format!("{head}8.333e-3\n{}\n", lines.join("\n"))
}

const KEYWORDS: [&str; 10] = [
    "HIERARCHY",
    "ROOT",
    "JOINT",
    "OFFSET",
    "CHANNELS",
    "End Site",
    "Xrotation",
    "MOTION",
    "Frames",
    "Frame Time",
];

#[test]
fn variants_of_bvh_files_are_the_same_motion() {
    let folder = tempfile::tempdir().unwrap();
    let good = bvh(
        &renamed(&skeleton(0.0, 0.0), &CMU),
        &[pose(22, 1.0), pose(22, 2.0)],
        PLAIN,
    );
    let expected = take(folder.path(), good.as_bytes()).unwrap();
    let expected = expected.motion().unwrap();
    let same = [
        good.replace('\n', "\r"),
        good.replace('\n', "\r\n"),
        good.replace(' ', "\t").replace("End\tSite", "End Site"),
        KEYWORDS.iter().fold(good.clone(), |text, word| {
            text.replace(word, &word.to_lowercase())
        }),
        format!("{good}\n\n  \n\t\n"),
        good.replace("End Site", "EndSite"),
        good.replace("End Site", "End Site of a chain"),
        good.replace("End Site\n", "END SITE "),
        good.replace("End Site\n{\nOFFSET 0 0 0.1\n}", "End Site\n{\n}"),
        good.replacen("ROOT Hips", "ROOT Hips // the first", 1),
        good.replacen("ROOT Hips", "ROOT Hips\tthe first", 1),
        good.replacen("ROOT Hips", "ROOT \"Hips\" # the first", 1),
    ];
    for text in same {
        let take = take(folder.path(), text.as_bytes()).unwrap();
        let motion = take.motion().unwrap();
        assert_eq!(motion.frames, expected.frames, "{}", &text[..200]);
        assert_eq!(motion.frame_time, expected.frame_time);
        assert_eq!(motion.notes, expected.notes);
        assert_eq!(motion.skeleton.joints()[0].name, "Hips");
    }
    // Anything may be cut anywhere, if the number of frames is right.
    for length in [1, 7, 68, 69, 70, 1000] {
        let text = wrapped(&good, length);
        let take = take(folder.path(), text.as_bytes()).unwrap();
        let motion = take.motion().unwrap();
        assert_eq!(motion.frames, expected.frames);
        let is_told = motion
            .notes
            .iter()
            .any(|note| note.contains("every 69 numbers"));
        assert_eq!(is_told, length != 69);
    }
    let text = wrapped(&good, 23).replacen("Frames: 2", "Frames: 6", 1);
    let error = chain(&take(folder.path(), text.as_bytes()).unwrap_err());
    assert!(error.contains("23 numbers, expected 69"), "{error}");
}

#[test]
fn a_bvh_file_without_a_frame_time_has_frames_and_no_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let target = skeleton(45.0, 3.0);
    let good = bvh(
        &renamed(&skeleton(0.0, 0.0), &CMU),
        &[pose(22, 1.0), pose(22, 2.0)],
        PLAIN,
    );
    for (line, note) in [
        ("", "there is no `Frame Time:`"),
        ("Frame Time: 0\n", "`Frame Time:` is 0"),
        ("Frame Time: -1.0\n", "`Frame Time:` is -1.0"),
    ] {
        let text = good.replacen("Frame Time: 8.333e-3\n", line, 1);
        assert_ne!(text, good);
        let take = take(folder.path(), text.as_bytes()).unwrap();
        assert_eq!((take.num_frames(), take.frame_time()), (2, None));
        let notes = &take.motion().unwrap().notes;
        assert!(notes.iter().any(|found| found.contains(note)), "{notes:?}");
        let options = RetargetOptions::default();
        let seconds = take.poses(&target, "0s:1s".parse().unwrap(), &options);
        let text = chain(&seconds.unwrap_err());
        assert!(text.contains("clip.bvh"), "{text}");
    }
}

#[test]
fn angles_of_zero_are_a_t_pose_and_z_is_up_in_amass() {
    let folder = tempfile::tempdir().unwrap();
    let target = skeleton(45.0, 3.0);
    for columns in [72, 156, 165] {
        // Two frames: upright in a world with Z up, then the left knee bent by a right angle.
        let mut poses = vec![0.0; 2 * columns];
        for frame in 0..2 {
            poses[frame * columns] = std::f64::consts::FRAC_PI_2;
        }
        poses[columns + 3 * 4] = std::f64::consts::FRAC_PI_2;
        let trans = [1.0, 2.0, 0.9, 1.0, 1.5, 0.9];
        let bytes = npz(&[
            ("poses", &[2, columns], &poses),
            ("trans", &[2, 3], &trans),
            ("betas", &[10], &[0.0; 10]),
            ("mocap_framerate", &[], &[120.0]),
        ]);
        let take = take(folder.path(), &bytes).unwrap();
        assert!((take.frame_time().unwrap() - 1.0 / 120.0).abs() < 1e-12);
        let notes = take.notes(&target, &RetargetOptions::default());
        let notes = notes.join("; ");
        assert!(notes.contains("`betas`"), "{notes}");
        let poses = take
            .poses(&target, FrameRange::ALL, &RetargetOptions::default())
            .unwrap();
        let left_arm = bone(
            &target,
            &poses[0],
            Role::Shoulder(Side::Left),
            Role::Wrist(Side::Left),
        );
        assert!((left_arm - Vector3::x()).norm() < ROUNDING, "{left_arm}");
        let leg = bone(
            &target,
            &poses[0],
            Role::Hip(Side::Right),
            Role::Ankle(Side::Right),
        );
        assert!((leg + Vector3::y()).norm() < ROUNDING, "{leg}");
        let shank = bone(
            &target,
            &poses[1],
            Role::Knee(Side::Left),
            Role::Ankle(Side::Left),
        );
        assert!((shank + Vector3::z()).norm() < ROUNDING, "{shank}");
        // -y of a world with Z up is the front of this one.
        let walked = poses[1].root_translation - poses[0].root_translation;
        assert!(
            (walked.z - 0.5).abs() < 0.02 && walked.x.abs() < 1e-3,
            "{walked}"
        );
    }
}

#[test]
fn every_layout_of_the_smpl_family_is_the_same_motion() {
    let folder = tempfile::tempdir().unwrap();
    let turned = |joint: usize| if joint == 0 { 0.2 } else { 0.01 * joint as f64 };
    let row: Vec<f64> = (0..66).map(|column| turned(column / 3)).collect();
    let rows = |length: usize| {
        let mut row = row.clone();
        row.resize(length, 0.3);
        [row.clone(), row].concat()
    };
    let (all, root) = (rows(72), [&row[..3], &row[..3]].concat());
    let body = [&row[3..], &row[3..]].concat();
    let shift = [0.0; 6];
    let layouts = [
        npz(&[("poses", &[2, 66], &rows(66))]),
        npz(&[("poses", &[2, 24, 3], &all), ("trans", &[2, 3], &shift)]),
        npz(&[
            ("fullpose", &[1, 2, 72], &all),
            ("transl", &[1, 2, 3], &shift),
        ]),
        npz(&[
            ("root_orient", &[2, 3], &root),
            ("pose_body", &[2, 63], &body),
        ]),
        npz(&[
            ("global_orient", &[2, 1, 3], &root),
            ("body_pose", &[2, 21, 3], &body),
        ]),
    ];
    let first = take(folder.path(), &layouts[0]).unwrap();
    let expected = &first.motion().unwrap().frames;
    assert_eq!(expected.len(), 2);
    for layout in &layouts {
        let take = take(folder.path(), layout).unwrap();
        assert_eq!(&take.motion().unwrap().frames, expected);
        // The body's own axis points to y.
        assert!(
            take.motion()
                .unwrap()
                .notes
                .contains(&"y is read as the up axis".to_owned())
        );
    }
}

#[test]
fn shifts_of_bodies_that_are_scaled_are_divided_by_that() {
    let folder = tempfile::tempdir().unwrap();
    let poses = vec![0.0; 2 * 72];
    let [large, small] = [
        [0.0, 0.0, 0.0, 90.0, 0.0, 45.0],
        [0.0, 0.0, 0.0, 1.0, 0.0, 0.5],
    ];
    let scaled = npz(&[
        ("poses", &[2, 72], &poses),
        ("smpl_trans", &[2, 3], &large),
        ("smpl_scaling", &[1], &[90.0]),
    ]);
    let plain = npz(&[("poses", &[2, 72], &poses), ("trans", &[2, 3], &small)]);
    let [scaled, plain] = [scaled, plain].map(|bytes| {
        let take = take(folder.path(), &bytes).unwrap();
        take.motion().unwrap().frames.clone()
    });
    assert_eq!(scaled, plain);
}

#[test]
fn errors_of_npz_files_name_the_key() {
    let folder = tempfile::tempdir().unwrap();
    let poses = [0.0; 72];
    let broken: [(Vec<u8>, &str); 5] = [
        (
            npz(&[("trans", &[1, 3], &[0.0; 3])]),
            "missing `poses`; found `trans`",
        ),
        (
            npz(&[("poses", &[1, 71], &poses[..71])]),
            "[1, 71], expected [frames, 3 n]",
        ),
        (
            npz(&[("poses", &[1, 72], &poses), ("trans", &[2, 3], &[0.0; 6])]),
            "key `trans`",
        ),
        (
            npz(&[("poses", &[1, 72], &[f64::NAN; 72])]),
            "frame 0: a value of `poses`",
        ),
        (npz(&[("poses", &[0, 72], &[])]), "there is no frame"),
    ];
    for (bytes, expected) in broken {
        let text = chain(&take(folder.path(), &bytes).unwrap_err());
        assert!(text.contains(expected), "{text} has no {expected}");
    }
    let good = npz(&[("poses", &[1, 72], &poses)]);
    for length in (0..good.len()).step_by(7) {
        assert!(take(folder.path(), &good[..length]).is_err());
    }
}

#[test]
fn empty_files_and_pickles_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let text = chain(&take(folder.path(), b"").unwrap_err());
    assert!(
        text.contains("clip.bvh") && text.contains("empty"),
        "{text}"
    );
    let text = chain(&take(folder.path(), b"\x80\x04\x95").unwrap_err());
    assert!(text.contains("a pickle of Python"), "{text}");
}

#[test]
fn pose_json_gives_its_frames() {
    let folder = tempfile::tempdir().unwrap();
    let target = skeleton(45.0, 3.0);
    let text = r#"{"schema": "garnet.pose/1", "frames": [
        {"joints": {}}, {"joints": {"left_knee": [1, 0, 0, 0]}, "root_translation": [0, 1, 0]}]}"#;
    let take = take(folder.path(), text.as_bytes()).unwrap();
    assert_eq!(take.num_frames(), 2);
    let poses = take
        .poses(&target, FrameRange::ALL, &RetargetOptions::default())
        .unwrap();
    assert_eq!(poses[0], Pose::rest(22));
    assert!((poses[1].root_translation.y - 1.0).abs() < ROUNDING);
    assert!(largest_angle(&poses[0], &poses[1]) > 1.9);
    let error = take.poses(&target, FrameRange::single(2), &RetargetOptions::default());
    assert!(chain(&error.unwrap_err()).contains("frame 2"));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn garbage_is_refused_and_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..200), kind in 0..4) {
        let folder = tempfile::tempdir().unwrap();
        let start: &[u8] = [b"HIERARCHY\n".as_slice(), b"PK\x03\x04", b"{", b""][kind as usize];
        let bytes = [start, &bytes].concat();
        prop_assert!(take(folder.path(), &bytes).is_err());
    }

    #[test]
    fn damaged_bvh_files_never_panic(place in 0_usize..4000, byte in any::<u8>(), cut in any::<bool>()) {
        let folder = tempfile::tempdir().unwrap();
        let target = skeleton(45.0, 3.0);
        let mut bytes = bvh(&renamed(&target, &CMU), &[pose(22, 1.0)], PLAIN).into_bytes();
        let place = place % bytes.len();
        if cut { bytes.truncate(place) } else { bytes[place] = byte }
        if let Ok(take) = take(folder.path(), &bytes) {
            let _ = take.poses(&target, FrameRange::ALL, &RetargetOptions::default());
        }
    }
}
