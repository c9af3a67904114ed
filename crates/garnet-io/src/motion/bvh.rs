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
    bvh_text::{Lines, number, unexpected},
};

/// The largest number of joints.
const MAX_JOINTS: usize = 4096;

/// Lengths below the root may stretch by this part of the bone before a note is made of it.
const STRETCH: f64 = 0.02;

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
    let mut lines = Lines::new(text);
    let joints = hierarchy(&mut lines)?;
    let count = lines.header("Frames", "`Frames:`", "the number of frames")?;
    let announced: usize = count
        .parse()
        .map_err(|_not_a_count| lines.unexpected(count, "the number of frames"))?;
    let time = lines.header("Frame Time", "`Frame Time:`", "the seconds between frames")?;
    let frame_time =
        number(time).ok_or_else(|| lines.unexpected(time, "the seconds between frames"))?;
    let (rows, mut notes) = rows(&mut lines, &joints, announced)?;
    if rows.is_empty() {
        return Err(MotionProblem::NoFrames);
    }

    let skeleton = rest_skeleton(&joints)?;
    let (adds, stretch) = positions_below_roots(&joints, &rows);
    let root = skeleton.parents_first().first().copied().unwrap_or(0);
    let frames = rows.iter().map(|row| frame(&joints, root, row)).collect();
    let mut motion = Motion::in_metres(&skeleton, frames, options)?;
    if frame_time > 0.0 {
        motion.frame_time = Some(frame_time);
    }
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
        } else if is("End") && is_in_joint {
            lines.expect_word("Site", "`End Site`")?;
            lines.rest_of_line();
            lines.expect_word("{", "`{`")?;
            lines.expect_word("OFFSET", "`OFFSET`")?;
            for _axis in 0..3 {
                lines.number("three numbers after `OFFSET`")?;
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

/// Reads a joint's name, offset and channels.
fn joint(lines: &mut Lines<'_>, parent: Option<usize>) -> Result<BvhJoint, MotionProblem> {
    let name = lines.rest_of_line();
    if name.is_empty() {
        return Err(lines.unexpected("", "the name of a joint"));
    }
    lines.expect_word("{", "`{`")?;
    lines.expect_word("OFFSET", "`OFFSET`")?;
    let mut offset = Vector::zeros();
    for axis in 0..3 {
        offset[axis] = lines.number("three numbers after `OFFSET`")?;
    }
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
/// were announced.
fn rows(
    lines: &mut Lines<'_>,
    joints: &[BvhJoint],
    announced: usize,
) -> Result<(Vec<Vec<f64>>, Vec<String>), MotionProblem> {
    let num_channels = joints.iter().map(|joint| joint.channels.len()).sum();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut notes = Vec::new();
    while let Some((line, text)) = lines.next_line() {
        let mut row = Vec::with_capacity(num_channels);
        for word in text.split_whitespace() {
            row.push(number(word).ok_or_else(|| unexpected(line, word, "a number"))?);
        }
        if row.len() != num_channels {
            return Err(MotionProblem::RowLength {
                line,
                found: row.len(),
                expected: num_channels,
            });
        }
        rows.push(row);
    }
    if rows.len() != announced && !rows.is_empty() {
        notes.push(format!(
            "`Frames:` says {announced}, but there are {}: those are read",
            rows.len()
        ));
    }
    Ok((rows, notes))
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
