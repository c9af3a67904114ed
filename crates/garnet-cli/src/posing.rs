//! Poses that the user names: one of the library, a frame of a file, or several frames.

use std::{
    error::Error as StdError,
    path::{Path, PathBuf},
};

use anyhow::Context;
use garnet::{
    Body, Pose, Vector3,
    io::Take,
    motion::{
        FrameRange, Ground, ReadOptions, RetargetError, RetargetOptions, lowest_points,
        put_on_ground,
    },
    poses::{Poser, SelfContact, SeparationOptions, key_pose, key_poses, turn},
    shape::tape_measures,
};

use crate::failure::refused;

/// What the user wrote: a name of the library, or a file and the frames in it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct PoseSource {
    /// The file, or the name.
    pub(crate) path: PathBuf,
    /// The frames in the file, from 0; the first without it.
    pub(crate) frames: Option<FrameRange>,
}

/// A pose and what to call it.
#[derive(Debug, Clone)]
pub(crate) struct NamedPose {
    /// For messages: the name or the file, and the frame in it.
    pub(crate) label: String,
    /// For outputs: like the label, without folder and extension.
    pub(crate) stem: String,
    pub(crate) pose: Pose,
}

/// About so many frames of a motion tell where its ground is.
const GROUND_FRAMES: usize = 2000;

/// How deep parts of a body may run into each other in a motion, in metres: half of what poses of the library may have. Of a T-shirt
/// on a walk 43 vertices were trapped with 10 mm, 24 with 4 mm and 13 with 1 mm.
const TOUCH: f32 = 0.005;

/// Turns of arms that are told of, in radians.
const TOLD_TURN: f32 = 0.01;

/// Poses, and what was taken for granted while they were read.
#[derive(Debug, Clone, Default)]
pub(crate) struct Posing {
    pub(crate) poses: Vec<NamedPose>,
    pub(crate) notes: Vec<String>,
}

impl From<&str> for PoseSource {
    /// Splits `FILE:FRAMES` at the first colon after a file that there is, or after which nothing but frames follows; a file
    /// whose own name ends like this comes first.
    fn from(text: &str) -> Self {
        let whole = Self {
            path: text.into(),
            frames: None,
        };
        if whole.path.exists() {
            return whole;
        }
        let colons = text.match_indices(':').filter(|&(place, _)| place > 0);
        let mut split = colons.map(|(place, _)| (&text[..place], &text[place + 1..]));
        let on_disk = split.clone().find(|(path, _)| Path::new(path).is_file());
        let found = match on_disk {
            Some((path, frames)) => frames.parse().ok().map(|frames| (path, frames)),
            None => split.find_map(|(path, frames)| Some((path, frames.parse().ok()?))),
        };
        match found {
            Some((path, frames)) => Self {
                path: path.into(),
                frames: Some(frames),
            },
            None => whole,
        }
    }
}

impl PoseSource {
    /// Whether it may stand for more than one pose.
    pub(crate) fn is_several(&self) -> bool {
        self.frames.is_some_and(|frames| !frames.is_single())
    }

    /// The poses, on a body.
    pub(crate) fn read(&self, body: &Body) -> anyhow::Result<Posing> {
        if !self.path.exists() {
            let name = self.path.to_string_lossy();
            if let Some(pose) = key_pose(&name) {
                if self.frames.is_some() {
                    return Err(refused(
                        format!("cannot read frames of `{name}`"),
                        "a pose of the library has none",
                        "leave out what follows the colon",
                    ));
                }
                return of_library(&name, &pose.angles, body);
            }
            let colons = name.match_indices(':');
            let mut split = colons.map(|(place, _)| (&name[..place], &name[place + 1..]));
            if let Some((file, frames)) = split.find(|(file, _)| Path::new(file).is_file()) {
                return Err(refused(
                    format!("cannot read frames of `{file}`"),
                    format!("`{frames}` names none"),
                    "frames are one, as 12, or FIRST:END:STEP, as 0:100:5, with a step of 1 at least",
                ));
            }
            if self.path.extension().is_none() {
                return Err(refused(
                    format!("there is no pose `{name}`"),
                    "it is neither a file nor a pose of the library",
                    format!("the poses of the library are: {}", library_names()),
                ));
            }
        }
        let skeleton = body.skeleton();
        let take = Take::read(&self.path, &ReadOptions::default())?;
        let range = self.frames.unwrap_or(FrameRange::single(0));
        let options = RetargetOptions::default();
        let frames = range.of(take.num_frames())?;
        let mut notes = take.notes(skeleton);
        let mut poses = take.poses_of(skeleton, &frames, &options)?;
        let is_motion = take.motion().is_some();
        if is_motion && tape_measures(body).is_some() {
            notes.extend(keep_apart(body, &take, &frames, &mut poses)?);
        }
        if is_motion && range.is_single() {
            put_on_ground(body, &mut poses, Ground::EachPose)?;
        } else if is_motion {
            // Where the ground is does not depend on which frames are asked for.
            let step = take.num_frames().div_ceil(GROUND_FRAMES);
            let clip = take.poses(skeleton, FrameRange::every(step), &options)?;
            let lowest = lowest_points(body, &clip)?.into_iter();
            let ground = lowest.fold(f32::INFINITY, f32::min);
            for pose in poses.iter_mut().filter(|_| ground.is_finite()) {
                pose.root_translation.y -= ground;
            }
        }
        let num_frames = take.num_frames();
        if self.frames.is_none() && num_frames > 1 {
            let path = self.path.display();
            notes.push(format!(
                "of the {num_frames} frames of `{path}` frame 0 is taken: `{path}:FRAME` names another one, \
                 `{path}:FIRST:END:STEP` several"
            ));
        }
        let named = frames
            .into_iter()
            .zip(poses)
            .map(|(frame, pose)| NamedPose {
                label: format!("{}:{frame}", self.path.display()),
                stem: format!("{}_{frame:04}", stem(&self.path)),
                pose,
            });
        Ok(Posing {
            poses: named.collect(),
            notes,
        })
    }
}

/// Turns arms of a built-in body away from what they run into in frames of a motion, and tells of it. Other bodies go as the
/// motion says: they may have to match what another program makes of it.
fn keep_apart(
    body: &Body,
    take: &Take,
    frames: &[usize],
    poses: &mut [Pose],
) -> anyhow::Result<Option<String>> {
    let contact = SelfContact::new(body)?;
    let options = SeparationOptions {
        max_depth: TOUCH,
        legs_give_way: false,
        ..SeparationOptions::default()
    };
    let easing = take.easing(&contact, frames, &options)?;
    let largest = |turns: &[Vector3]| turns.iter().map(Vector3::norm).fold(0.0, f32::max);
    let largest: Vec<f32> = easing.iter().map(|turns| largest(turns)).collect();
    for (pose, turns) in poses.iter_mut().zip(&easing) {
        turn(pose, turns);
    }
    let num_turned = largest.iter().filter(|&&angle| angle > TOLD_TURN).count();
    let most = largest.into_iter().fold(0.0, f32::max).to_degrees();
    Ok((num_turned > 0).then(|| {
        format!(
            "arms are kept out of other parts of the body: turned by {most:.0} degrees at most, in {num_turned} of {} frames",
            frames.len()
        )
    }))
}

/// Names the rig of a body, from `rig`, where its joints are at fault that a body cannot be posed.
pub(crate) fn of_rig(error: anyhow::Error, rig: &Path) -> anyhow::Error {
    let is_of_body = |link: &(dyn StdError + 'static)| {
        let found = link.downcast_ref::<RetargetError>();
        found.is_some_and(RetargetError::is_of_body)
    };
    if error.chain().any(is_of_body) {
        return error.context(format!("the rig `{}` cannot be posed", rig.display()));
    }
    error
}

/// A pose of the library, with the parts of the body apart and the lowest vertex on the ground.
fn of_library(
    name: &str,
    angles: &garnet::poses::BodyAngles,
    body: &Body,
) -> anyhow::Result<Posing> {
    let cannot = || format!("cannot take the pose `{name}`");
    let poser = Poser::new(body.skeleton()).with_context(cannot)?;
    let pose = poser.pose(angles);
    let contact = SelfContact::new(body).with_context(cannot)?;
    let mut notes = Vec::new();
    let separated = contact.separated(&pose, &SeparationOptions::default())?;
    let mut poses = if let Some(separated) = separated {
        vec![separated.pose]
    } else {
        notes.push(format!(
            "in the pose `{name}` this body runs through itself"
        ));
        vec![pose]
    };
    put_on_ground(body, &mut poses, Ground::EachPose)?;
    let named = poses.into_iter().map(|pose| NamedPose {
        label: name.to_owned(),
        stem: name.to_owned(),
        pose,
    });
    Ok(Posing {
        poses: named.collect(),
        notes,
    })
}

fn library_names() -> String {
    let names: Vec<&str> = key_poses().map(|pose| pose.name).collect();
    names.join(", ")
}

fn stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or(path.as_os_str());
    stem.to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(text: &str) -> (PathBuf, Option<String>) {
        let source = PoseSource::from(text);
        (source.path, source.frames.map(|frames| frames.to_string()))
    }

    #[test]
    fn frames_follow_a_colon() {
        assert_eq!(
            split("walk.json:12"),
            ("walk.json".into(), Some("12".to_owned()))
        );
        assert_eq!(
            split("walk.bvh:0:9:2"),
            ("walk.bvh".into(), Some("0:9:2".to_owned()))
        );
        assert_eq!(
            split("walk.bvh:3:"),
            ("walk.bvh".into(), Some("3::1".to_owned()))
        );
        assert_eq!(split("a:b/walk.json"), ("a:b/walk.json".into(), None));
        assert_eq!(split(":3"), (":3".into(), None));
        assert!(PoseSource::from("walk.bvh:0:9").is_several());
        assert!(!PoseSource::from("walk.bvh:9").is_several());
    }
}
