//! BVH, the Biovision hierarchy.
//!
//! Joints have an offset from their parent and up to six channels. Rotation channels are applied in
//! their order, each about an axis turned by those before it. A joint's position channels replace
//! its offset, as Blender and most others write them, or add to it, as MakeHuman does it below the
//! root: what comes closer to keeping the bones' lengths is taken, for the whole file. The bones of
//! a body do not stretch: below the root, positions are only used to tell that and then left out.

use garnet_body::motion::{Motion, ReadOptions};
use garnet_skin::{Joint, Point3, Pose, Skeleton, Vector3};
use nalgebra::{UnitQuaternion, Vector3 as Vector};

use super::{
    MotionProblem,
    bvh_text::{Lines, decimal, number, unexpected},
};

/// The largest number of joints.
const MAX_JOINTS: usize = 4096;

/// Lengths below the root may stretch by this part of the bone before a note is made of it.
const STRETCH: f64 = 0.02;

/// How the ends of chains are called.
const END_SITES: [&str; 4] = ["End", "EndSite", "End_Site", "End-Site"];

#[derive(Debug, Clone, Copy)]
enum Channel {
    Position(usize),
    Rotation(usize),
}

#[derive(Debug)]
struct BvhJoint {
    name: String,
    parent: Option<usize>,
    offset: Vector<f64>,
    channels: Vec<Channel>,
}

/// Reads a BVH file.
pub(super) fn parse(text: &str, options: &ReadOptions) -> Result<Motion, MotionProblem> {
    // Lines end as on Unix, Windows or, long ago, a Mac.
    let text = text.replace("\r\n", "\n").replace('\r', "\n");
    let mut lines = Lines::new(&text);
    let joints = hierarchy(&mut lines)?;
    let count = lines.header("Frames", "`Frames:`", "the number of frames")?;
    let announced: usize = count
        .parse()
        .map_err(|_not_a_count| lines.unexpected(count, "the number of frames"))?;
    let (frame_time, note) = frame_time(&mut lines)?;
    let mut notes: Vec<String> = note.into_iter().collect();
    let rows = rows(&mut lines, &joints, announced, &mut notes)?;
    if rows.is_empty() {
        return Err(MotionProblem::NoFrames);
    }

    check_angles(&joints, &rows)?;
    let skeleton = rest_skeleton(&joints)?;
    let (adds, stretch) = positions_below_roots(&joints, &rows);
    let root = skeleton.parents_first().first().copied().unwrap_or(0);
    notes.extend(other_figures(&joints));
    let frames = rows.iter().map(|row| frame(&joints, root, row)).collect();
    let mut motion = Motion::in_metres(&skeleton, frames, options)?;
    motion.frame_time = frame_time;
    motion.notes.append(&mut notes);
    if stretch > STRETCH {
        let how = if adds { "add to" } else { "replace" };
        motion.notes.push(format!(
            "positions below the root {how} the offsets and stretch bones by up to {:.0} %; \
             they are left out",
            100.0 * stretch
        ));
    }
    Ok(motion)
}

/// A hierarchy with so many joints is a figure, and no prop.
const FIGURE_JOINTS: usize = 12;

/// What to tell of the figures after the first one.
fn other_figures(joints: &[BvhJoint]) -> Option<String> {
    let mut root_of: Vec<usize> = Vec::with_capacity(joints.len());
    let mut sizes = vec![0; joints.len()];
    for (index, joint) in joints.iter().enumerate() {
        let root = joint.parent.map_or(index, |parent| root_of[parent]);
        root_of.push(root);
        sizes[root] += 1;
    }
    let figures = sizes.iter().filter(|&&size| size >= FIGURE_JOINTS).count();
    (figures > 1).then(|| format!("it holds {figures} figures, of which the first is read"))
}

/// Reads the seconds between frames, and what to tell if there are none.
fn frame_time(lines: &mut Lines<'_>) -> Result<(Option<f64>, Option<String>), MotionProblem> {
    const EXPECTED: &str = "the seconds between frames";
    let untimed = |what: &str| {
        let note = format!("{what}: how long a frame lasts is not known");
        Ok((None, Some(note)))
    };
    // Rows of numbers may follow at once.
    let mut ahead = lines.clone();
    let is_row = ahead.next_line().is_some_and(|(_, text)| {
        let mut words = text.split_whitespace();
        words.next().is_some_and(|word| number(word).is_some())
    });
    if is_row {
        return untimed("there is no `Frame Time:`");
    }
    let time = lines.header("Frame Time", "`Frame Time:`", EXPECTED)?;
    match number(time) {
        Some(seconds) if seconds > 0.0 => Ok((Some(seconds), None)),
        Some(_) => untimed(&format!("`Frame Time:` is {time}")),
        None => Err(lines.unexpected(time, decimal(time, EXPECTED))),
    }
}

/// Reads `HIERARCHY` up to and with the word `MOTION`.
fn hierarchy(lines: &mut Lines<'_>) -> Result<Vec<BvhJoint>, MotionProblem> {
    lines.expect_word("HIERARCHY", "`HIERARCHY`")?;
    let mut joints: Vec<BvhJoint> = Vec::new();
    // The joints whose braces are open; `None` is an end site.
    let mut open: Vec<Option<usize>> = Vec::new();
    loop {
        let word = lines.expect("`JOINT`, `End Site`, `}` or `MOTION`")?;
        let is = |other: &str| word.eq_ignore_ascii_case(other);
        let is_in_joint = matches!(open.last(), Some(Some(_)));
        if is("ROOT") && open.is_empty() || is("JOINT") && is_in_joint {
            if joints.len() >= MAX_JOINTS {
                let limit = MAX_JOINTS;
                return Err(MotionProblem::TooDeep {
                    line: lines.line(),
                    limit,
                });
            }
            let joint = joint(lines, open.last().copied().flatten())?;
            open.push(Some(joints.len()));
            joints.push(joint);
        } else if is_in_joint && END_SITES.into_iter().any(is) {
            lines.rest_of_line();
            lines.expect_word("{", "`{`")?;
            if lines.takes_word("OFFSET") {
                offset(lines)?;
            }
            open.push(None);
        } else if is("}") && !open.is_empty() {
            open.pop();
        } else if is("MOTION") && open.is_empty() && !joints.is_empty() {
            return Ok(joints);
        } else {
            let expected = match open.last() {
                Some(Some(_)) => "`JOINT`, `End Site` or `}`",
                Some(None) => "`}`",
                None if joints.is_empty() => "`ROOT`",
                None => "`MOTION` or `ROOT`",
            };
            return Err(lines.unexpected(word, expected));
        }
    }
}

/// Reads the three numbers behind `OFFSET`.
fn offset(lines: &mut Lines<'_>) -> Result<Vector<f64>, MotionProblem> {
    let mut offset = Vector::zeros();
    for axis in 0..3 {
        offset[axis] = lines.number("three numbers after `OFFSET`")?;
    }
    Ok(offset)
}

/// A name without what stands behind it: a tab and more, or a comment.
fn bare_name(text: &str) -> &str {
    let ends = ["\t", "//", " #"];
    let end = ends.iter().filter_map(|end| text.find(end)).min();
    let name = &text[..end.unwrap_or(text.len())];
    name.trim().trim_matches('"').trim()
}

/// Reads a joint's name, offset and channels.
fn joint(lines: &mut Lines<'_>, parent: Option<usize>) -> Result<BvhJoint, MotionProblem> {
    let name = bare_name(lines.rest_of_line());
    if name.is_empty() {
        return Err(lines.unexpected("", "the name of a joint"));
    }
    lines.expect_word("{", "`{`")?;
    lines.expect_word("OFFSET", "`OFFSET`")?;
    let offset = offset(lines)?;
    lines.expect_word("CHANNELS", "`CHANNELS`")?;
    let word = lines.expect("the number of channels, 0 to 6")?;
    let num_channels = word.parse().ok().filter(|&count: &usize| count <= 6);
    let num_channels =
        num_channels.ok_or_else(|| lines.unexpected(word, "the number of channels, 0 to 6"))?;
    let mut channels = Vec::with_capacity(num_channels);
    for _channel in 0..num_channels {
        const EXPECTED: &str = "`Xposition`, `Xrotation` or another channel";
        let word = lines.expect(EXPECTED)?;
        channels.push(channel(word).ok_or_else(|| lines.unexpected(word, EXPECTED))?);
    }
    Ok(BvhJoint {
        name: name.to_owned(),
        parent,
        offset,
        channels,
    })
}

fn channel(word: &str) -> Option<Channel> {
    let word = word.to_ascii_lowercase();
    let axis = match word.chars().next()? {
        'x' => 0,
        'y' => 1,
        'z' => 2,
        _ => return None,
    };
    match &word[1..] {
        "position" => Some(Channel::Position(axis)),
        "rotation" => Some(Channel::Rotation(axis)),
        _ => None,
    }
}

/// Reads `[frame][channel]`: the rows that are there, and what to tell if they are not as many as
/// were announced, or not one a line.
fn rows(
    lines: &mut Lines<'_>,
    joints: &[BvhJoint],
    announced: usize,
    notes: &mut Vec<String>,
) -> Result<Vec<Vec<f64>>, MotionProblem> {
    let expected: usize = joints.iter().map(|joint| joint.channels.len()).sum();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut first_wrong = None;
    while let Some((line, text)) = lines.next_line() {
        let mut row = Vec::with_capacity(expected);
        for word in text.split_whitespace() {
            let value = number(word);
            row.push(value.ok_or_else(|| unexpected(line, word, decimal(word, "a number")))?);
        }
        if row.len() != expected && first_wrong.is_none() {
            let found = row.len();
            first_wrong = Some(MotionProblem::RowLength {
                line,
                found,
                expected,
            });
        }
        rows.push(row);
    }
    if let Some(wrong) = first_wrong {
        // Rows that go on in the next line are told by the number of frames.
        let num_numbers: usize = rows.iter().map(Vec::len).sum();
        let is_wrapped = announced > 0 && announced.checked_mul(expected) == Some(num_numbers);
        if !is_wrapped {
            return Err(wrong);
        }
        notes.push(format!(
            "frames are not a line each: every {expected} numbers are one"
        ));
        let numbers = rows.concat();
        rows = numbers.chunks(expected).map(<[f64]>::to_vec).collect();
    }
    if rows.len() != announced && !rows.is_empty() {
        notes.push(format!(
            "`Frames:` says {announced}, but there are {}: those are read",
            rows.len()
        ));
    }
    Ok(rows)
}

fn rest_skeleton(joints: &[BvhJoint]) -> Result<Skeleton, MotionProblem> {
    let mut positions: Vec<Vector<f64>> = Vec::with_capacity(joints.len());
    let mut checked = Vec::with_capacity(joints.len());
    for joint in joints {
        let position = joint
            .parent
            .map_or(joint.offset, |parent| positions[parent] + joint.offset);
        positions.push(position);
        checked.push(Joint {
            name: joint.name.clone(),
            parent: joint.parent,
            rest_position: Point3::from(position.cast::<f32>()),
        });
    }
    Ok(Skeleton::new(checked)?)
}

/// Whether positions below the roots add to the offsets, and by which part of its length a bone
/// stretches at most.
fn positions_below_roots(joints: &[BvhJoint], rows: &[Vec<f64>]) -> (bool, f64) {
    let mut sums = [0.0, 0.0];
    let mut largest = [0.0_f64, 0.0];
    for row in rows {
        let mut values = row.iter();
        for joint in joints {
            let mut position = joint.offset;
            let mut added = Vector::zeros();
            for (channel, &value) in joint.channels.iter().zip(values.by_ref()) {
                if let Channel::Position(axis) = *channel {
                    position[axis] = value;
                    added[axis] = value;
                }
            }
            let length = joint.offset.norm();
            if joint.parent.is_some() && length > 0.0 {
                let replaced = (position - joint.offset).norm();
                for (way, shift) in [replaced, added.norm()].into_iter().enumerate() {
                    sums[way] += shift;
                    largest[way] = largest[way].max(shift / length);
                }
            }
        }
    }
    let adds = sums[1] < sums[0];
    (adds, largest[usize::from(adds)])
}

/// No joint turns by more, in degrees: a hundred turns, as of a root that is never wound back.
const MOST_DEGREES: f64 = 36_000.0;

/// Refuses numbers that are no angles.
fn check_angles(joints: &[BvhJoint], rows: &[Vec<f64>]) -> Result<(), MotionProblem> {
    let channels = joints.iter().enumerate().flat_map(|(number, joint)| {
        let channels = joint.channels.iter();
        channels.map(move |channel| (number, joint, channel))
    });
    let channels: Vec<_> = channels.collect();
    for (frame, row) in rows.iter().enumerate() {
        for (&(number, joint, channel), &degrees) in channels.iter().zip(row) {
            if matches!(channel, Channel::Rotation(_)) && degrees.abs() > MOST_DEGREES {
                return Err(MotionProblem::NotAnAngle {
                    frame,
                    joint: format!("{number} (`{}`)", joint.name),
                    degrees,
                });
            }
        }
    }
    Ok(())
}

fn frame(joints: &[BvhJoint], root: usize, row: &[f64]) -> Pose {
    let mut pose = Pose::rest(joints.len());
    let mut values = row.iter();
    for (index, joint) in joints.iter().enumerate() {
        let mut rotation = UnitQuaternion::<f64>::identity();
        let mut position = joint.offset;
        for (channel, &value) in joint.channels.iter().zip(values.by_ref()) {
            match *channel {
                Channel::Position(axis) => position[axis] = value,
                Channel::Rotation(axis) => {
                    let axis = [Vector::x_axis(), Vector::y_axis(), Vector::z_axis()][axis];
                    rotation *= UnitQuaternion::from_axis_angle(&axis, value.to_radians());
                }
            }
        }
        pose.rotations[index] = UnitQuaternion::new_normalize(rotation.into_inner().cast());
        if index == root {
            pose.root_translation = Vector3::from((position - joint.offset).cast::<f32>());
        }
    }
    pose
}
