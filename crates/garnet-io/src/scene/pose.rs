//! Poses that are named: one of the library, a frame of a file, or several frames.

use std::{
    collections::BTreeSet,
    fmt,
    path::{Path, PathBuf},
};

use garnet_body::{
    motion::{
        Figure, FrameRange, Ground, ReadOptions, RetargetError, RetargetOptions, StartAt, Upward,
        lowest_points, pose_between, put_on_ground,
    },
    poses::{BodyAngles, Poser, SelfContact, SeparationOptions, key_pose, turn},
    shape::tape_measures,
};
use garnet_mesh::{Unit, Vector3};
use garnet_skin::{Body, Pose, Skeleton, SkinError};
use nalgebra::UnitQuaternion;

use super::SceneError;
use crate::{Alignment, MotionError, PartsNote, Take, TakeError};

/// Where poses come from: a name of the library, or a file and the frames in it.
///
/// From a text it is `NAME`, `FILE`, `FILE:FRAME` or `FILE:FIRST:END[:STEP]`; of a GLB or glTF file
/// `FILE:CLIP` and the like, too.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PoseSource {
    /// The file, or the name.
    pub path: PathBuf,
    /// The animation in a GLB or glTF file; the first without it.
    pub clip: Option<String>,
    /// The frames in the file, from 0; the first without it.
    pub frames: Option<FrameRange>,
    /// The direction that points up in a motion; detected without it.
    pub up: Option<Upward>,
}

/// Where a motion goes, and how fast.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a choice of its own")]
pub struct MotionOptions {
    /// Stand it on y = 0: the lowest vertex of a single frame, or of the whole motion.
    pub on_ground: bool,
    /// Keep it above the origin, whatever its path.
    pub in_place: bool,
    /// Play it anew with so many frames a second.
    pub fps: Option<f64>,
    /// Leave joints that the recording turns over from one frame to the next as they are.
    pub keep_flips: bool,
    /// Leave arms where the recording has them, be that inside of the body.
    pub keep_arms: bool,
}

impl MotionOptions {
    fn retarget(self) -> RetargetOptions {
        RetargetOptions {
            start_at: if self.in_place {
                StartAt::OriginAlways
            } else {
                StartAt::Motion
            },
            keep_flips: self.keep_flips,
        }
    }
}

/// A pose and what to call it.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct NamedPose {
    /// For messages: the name or the file, and the frame in it.
    pub label: String,
    /// For outputs: like the label, without folder and extension.
    pub stem: String,
    /// The pose.
    pub pose: Pose,
}

/// About so many frames of a motion tell where its ground is.
const GROUND_FRAMES: usize = 2000;

/// How deep parts of a body may run into each other in a motion, in metres: half of what poses of
/// the library may have. Less of it leaves more room for cloth and changes motions more.
const TOUCH: f32 = 0.005;

/// Turns of arms that are told of, in radians.
const TOLD_TURN: f32 = 0.01;

/// Poses, and what was taken for granted while they were read.
#[derive(Debug, Clone, Default)]
pub struct Posing {
    /// The poses, in the order of their frames.
    pub poses: Vec<NamedPose>,
    /// What was taken for granted.
    pub notes: Vec<PoseNote>,
    /// Seconds from each pose to the next, if the file says.
    pub seconds: Option<f64>,
}

/// Something that was taken for granted while poses were read.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum PoseNote {
    /// Which meshes of a rig file are the body.
    Parts(PartsNote),
    /// The garment lies on the bind pose of a rig, and not on the pose that its file shows.
    OnBind {
        /// The rig.
        rig: PathBuf,
    },
    /// The garment was brought to its body.
    Placed {
        /// The garment.
        garment: PathBuf,
        /// What was done.
        alignment: Alignment,
    },
    /// The rest body is in another pose than its rig, which was recovered.
    RestPosed {
        /// The rest body.
        path: PathBuf,
        /// The rig.
        rig: PathBuf,
        /// The largest turn of a joint, in degrees.
        degrees: f32,
    },
    /// The rest body has another shape than the mesh of its rig.
    RestShaped {
        /// The rest body.
        path: PathBuf,
        /// The rig.
        rig: PathBuf,
        /// How far both are apart at most, in metres.
        distance: f32,
    },
    /// A body is in an imperial unit, which the rest body is not in.
    InUnit {
        /// The body.
        path: PathBuf,
        /// The unit in which it is as large as the rest body.
        unit: Unit,
    },
    /// Left and right of a rig are exchanged: its toes would point backwards.
    OtherSides,
    /// What the reader of a motion file says.
    Motion(String),
    /// What is asked of a motion is asked of poses, which stand where they stand.
    NoMotion {
        /// The poses.
        path: PathBuf,
    },
    /// Arms were kept out of other parts of the body.
    ArmsTurned {
        /// The largest turn, in degrees.
        degrees: f32,
        /// In how many frames arms were turned.
        num_turned: usize,
        /// Of how many.
        num_frames: usize,
    },
    /// No frame was named: the first one is taken.
    FirstFrame {
        /// The file.
        path: PathBuf,
        /// How many frames it has.
        num_frames: usize,
    },
    /// The body runs through itself in a pose of the library.
    ThroughItself {
        /// The pose.
        name: String,
    },
}

impl fmt::Display for PoseNote {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parts(parts) => parts.fmt(formatter),
            Self::OnBind { rig } => write!(
                formatter,
                "`{}` shows a frame of an animation; the garment lies on its bind pose, which is \
                 taken",
                rig.display()
            ),
            Self::OtherSides => formatter.write_str(
                "left and right of the rig are exchanged, since its toes would point backwards: it \
                 was mirrored, or its joints are named as they are seen",
            ),
            Self::InUnit { path, unit } => write!(
                formatter,
                "`{}` is as large as the rest body if it is in {}, which is taken",
                path.display(),
                unit.name()
            ),
            Self::Placed { garment, alignment } => write!(
                formatter,
                "`{}` is brought to the body: {alignment}",
                garment.display()
            ),
            Self::RestPosed { path, rig, degrees } => write!(
                formatter,
                "`{}` is in another pose than its rig `{}` (joints turned by up to {degrees:.0} \
                 degrees): its pose is recovered, and poses start from that of the rig",
                path.display(),
                rig.display()
            ),
            Self::RestShaped {
                path,
                rig,
                distance,
            } => write!(
                formatter,
                "`{}` has another shape than its rig `{}` (by up to {:.0} mm): its joints are moved \
                 with the skin round them",
                path.display(),
                rig.display(),
                1e3 * distance
            ),
            Self::Motion(text) => formatter.write_str(text),
            Self::NoMotion { path } => write!(
                formatter,
                "`{}` is no motion: its place, time and arms are as they are, whatever is asked of motions",
                path.display()
            ),
            Self::ArmsTurned {
                degrees,
                num_turned,
                num_frames,
            } => write!(
                formatter,
                "arms are kept out of other parts of the body: turned by {degrees:.0} degrees at \
                 most, in {num_turned} of {num_frames} frames"
            ),
            Self::FirstFrame { path, num_frames } => {
                let path = path.display();
                write!(
                    formatter,
                    "of the {num_frames} frames of `{path}` frame 0 is taken: `{path}:FRAME` names \
                     another one, `{path}:FIRST:END:STEP` several"
                )
            }
            Self::ThroughItself { name } => {
                write!(
                    formatter,
                    "in the pose `{name}` this body runs through itself"
                )
            }
        }
    }
}

/// Why a pose cannot be read.
///
/// The text says what does not go; [`std::error::Error::source`] says why.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PoseError {
    /// A motion file cannot be read.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// A motion cannot be carried over to the body.
    #[error(transparent)]
    Take(#[from] TakeError),
    /// A frame is not there.
    #[error("cannot read frames of `{}`", path.display())]
    Frames {
        /// The file.
        path: PathBuf,
        /// Which is not there.
        source: RetargetError,
    },
    /// The joints of the body are not those of a human figure.
    #[error(transparent)]
    Figure(#[from] RetargetError),
    /// What stands for frames names none.
    #[error("cannot read frames of `{of}`")]
    BadFrames {
        /// The file, or the pose of the library.
        of: String,
        /// What is wrong with the frames.
        #[source]
        problem: PoseProblem,
    },
    /// There is no such pose.
    #[error("there is no pose `{name}`")]
    Unknown {
        /// The name.
        name: String,
        /// Where it was looked for.
        #[source]
        problem: PoseProblem,
    },
    /// The body cannot take a pose of the library.
    #[error("cannot take the pose `{name}`")]
    Library {
        /// The pose.
        name: String,
        /// What is wrong with the body.
        source: RetargetError,
    },
    /// A pose is impossible.
    #[error(transparent)]
    Skin(#[from] SkinError),
}

/// The cause of a [`PoseError`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PoseProblem {
    /// A pose of the library has no frames.
    #[error("a pose of the library has none")]
    OfLibrary,
    /// The text is no range of frames.
    #[error("`{text}` names none")]
    NoFrames {
        /// The text.
        text: String,
    },
    /// The text is neither a file nor a name.
    #[error("it is neither a file nor a pose of the library")]
    Neither,
}

impl PoseError {
    /// The error with the name of the rig, if its joints are at fault.
    pub fn of_rig(self, rig: &Path) -> SceneError {
        let is_of_body = match &self {
            Self::Take(TakeError::Retarget { problem, .. })
            | Self::Figure(problem)
            | Self::Library {
                source: problem, ..
            } => problem.is_of_body(),
            _ => false,
        };
        if is_of_body {
            SceneError::Unposable {
                rig: rig.to_path_buf(),
                source: self,
            }
        } else {
            SceneError::Pose(self)
        }
    }
}

impl From<&str> for PoseSource {
    /// Splits `FILE:FRAMES` at the first colon after a file that there is, or after which nothing
    /// but frames follows; a file whose own name ends like this comes first.
    fn from(text: &str) -> Self {
        let whole = Self {
            path: text.into(),
            clip: None,
            frames: None,
            up: None,
        };
        if whole.path.exists() {
            return whole;
        }
        let colons = text.match_indices(':').filter(|&(place, _)| place > 0);
        let mut split = colons.map(|(place, _)| (&text[..place], &text[place + 1..]));
        let on_disk = split.clone().find(|(path, _)| Path::new(path).is_file());
        if let Some((path, rest)) = on_disk.filter(|(path, _)| has_clips(Path::new(path))) {
            let (clip, frames) = clip_and_frames(rest);
            return Self {
                path: path.into(),
                clip,
                frames,
                up: None,
            };
        }
        let found = match on_disk {
            Some((path, frames)) => frames.parse().ok().map(|frames| (path, frames)),
            None => split.find_map(|(path, frames)| Some((path, frames.parse().ok()?))),
        };
        match found {
            Some((path, frames)) => Self {
                path: path.into(),
                clip: None,
                frames: Some(frames),
                up: None,
            },
            None => whole,
        }
    }
}

/// Whether a file may hold several motions that have names.
fn has_clips(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default();
    ["glb", "gltf", "vrm"]
        .into_iter()
        .any(|known| extension.eq_ignore_ascii_case(known))
}

/// `CLIP`, `FRAMES` or `CLIP:FRAMES`; what reads as frames are frames.
fn clip_and_frames(text: &str) -> (Option<String>, Option<FrameRange>) {
    if let Ok(frames) = text.parse() {
        return (None, Some(frames));
    }
    let colons = text.match_indices(':').filter(|&(place, _)| place > 0);
    let mut split = colons.map(|(place, _)| (&text[..place], &text[place + 1..]));
    let found = split.find_map(|(clip, frames)| Some((clip, frames.parse().ok()?)));
    match found {
        Some((clip, frames)) => (Some(clip.to_owned()), Some(frames)),
        None => (Some(text.to_owned()), None),
    }
}

impl PoseSource {
    /// Whether it may stand for more than one pose.
    pub fn is_several(&self) -> bool {
        self.frames.is_some_and(|frames| !frames.is_single())
    }

    /// Refuses what is no pose without reading any file.
    ///
    /// # Errors
    ///
    /// [`PoseError::Unknown`] for a name that there is not, [`PoseError::BadFrames`] for frames of
    /// a pose of the library, or a text that stands for none.
    pub fn check(&self) -> Result<(), PoseError> {
        if self.path.exists() {
            return Ok(());
        }
        let name = self.path.to_string_lossy();
        if key_pose(&name).is_some() {
            return match self.frames {
                None => Ok(()),
                Some(_) => Err(PoseError::BadFrames {
                    of: name.into_owned(),
                    problem: PoseProblem::OfLibrary,
                }),
            };
        }
        let colons = name.match_indices(':');
        let mut split = colons.map(|(place, _)| (&name[..place], &name[place + 1..]));
        if let Some((file, frames)) = split.find(|(file, _)| Path::new(file).is_file()) {
            return Err(PoseError::BadFrames {
                of: file.to_owned(),
                problem: PoseProblem::NoFrames {
                    text: frames.to_owned(),
                },
            });
        }
        if self.path.extension().is_none() {
            return Err(PoseError::Unknown {
                name: name.into_owned(),
                problem: PoseProblem::Neither,
            });
        }
        Ok(())
    }

    /// The poses, on a body.
    ///
    /// Those of motions are carried over to its skeleton, and are where the motion has them unless
    /// the options say otherwise.
    ///
    /// # Errors
    ///
    /// [`PoseError`]: a name or frames that there are not, a file that cannot be read, or a body
    /// that is no human figure.
    pub fn read(&self, body: &Body, of_motion: &MotionOptions) -> Result<Posing, PoseError> {
        self.check()?;
        let name = self.path.to_string_lossy();
        let mut posing = match key_pose(&name) {
            Some(pose) if !self.path.exists() => {
                let mut posing = of_library(&name, &pose.angles, body)?;
                let is_told = *of_motion != MotionOptions::default() || self.up.is_some();
                posing.notes.extend(is_told.then(|| self.no_motion()));
                posing
            }
            _ => self.read_take(body, of_motion)?,
        };
        if Figure::new(body.skeleton(), "the body").is_ok_and(|figure| figure.has_other_sides()) {
            posing.notes.push(PoseNote::OtherSides);
        }
        Ok(posing)
    }

    fn no_motion(&self) -> PoseNote {
        PoseNote::NoMotion {
            path: self.path.clone(),
        }
    }

    /// The poses of a file.
    fn read_take(&self, body: &Body, of_motion: &MotionOptions) -> Result<Posing, PoseError> {
        let skeleton = body.skeleton();
        let of_file = ReadOptions {
            up: self.up,
            ..ReadOptions::default()
        };
        let take = Take::read_clip(&self.path, self.clip.as_deref(), &of_file)?;
        let range = self.frames.unwrap_or(FrameRange::single(0));
        let options = of_motion.retarget();
        let moments = Moments::new(range, &take, of_motion.fps);
        let moments = moments.map_err(|source| PoseError::Frames {
            path: self.path.clone(),
            source,
        })?;
        let notes = take.notes(skeleton, &options).into_iter();
        let mut notes: Vec<PoseNote> = notes.map(PoseNote::Motion).collect();
        let mut poses = take.poses_of(skeleton, &moments.frames, &options)?;
        let is_motion = take.motion().is_some();
        if !is_motion && *of_motion != MotionOptions::default() {
            notes.push(self.no_motion());
        }
        if is_motion && !of_motion.keep_arms {
            notes.extend(keep_apart(
                body,
                &take,
                &moments.frames,
                options,
                &mut poses,
            )?);
        }
        let mut poses = moments.of(poses);
        if is_motion && of_motion.on_ground && range.is_single() {
            put_on_ground(body, &mut poses, Ground::EachPose)?;
        } else if is_motion && of_motion.on_ground {
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
            notes.push(PoseNote::FirstFrame {
                path: self.path.clone(),
                num_frames,
            });
        }
        let stem = stem(&self.path);
        let named = moments
            .names()
            .zip(poses)
            .map(|((label, number), pose)| NamedPose {
                label: format!("{}:{label}", self.path.display()),
                stem: format!("{stem}_{number:04}"),
                pose,
            });
        Ok(Posing {
            poses: named.collect(),
            notes,
            seconds: moments.seconds(take.frame_time(), of_motion.fps),
        })
    }
}

/// Frames of a motion, or places between them.
struct Moments {
    /// The frames that are needed, ascending where there are places between.
    frames: Vec<usize>,
    /// The places, in frames from the first one, if the motion is played anew, and the seconds
    /// from frame to frame.
    between: Option<(Vec<f64>, f64)>,
}

impl Moments {
    fn new(range: FrameRange, take: &Take, fps: Option<f64>) -> Result<Self, RetargetError> {
        let (num_frames, frame_time) = (take.num_frames(), take.frame_time());
        let Some(fps) = fps else {
            return Ok(Self {
                frames: range.of(num_frames, frame_time)?,
                between: None,
            });
        };
        let places = range.samples(num_frames, frame_time, fps)?;
        let around = places
            .iter()
            .flat_map(|place| [place.floor() as usize, place.ceil() as usize]);
        let frames: BTreeSet<usize> = around.filter(|&frame| frame < num_frames).collect();
        Ok(Self {
            frames: frames.into_iter().collect(),
            between: Some((places, frame_time.unwrap_or_default())),
        })
    }

    /// The poses at the places, of those in the frames.
    fn of(&self, poses: Vec<Pose>) -> Vec<Pose> {
        let Some((places, _)) = &self.between else {
            return poses;
        };
        let at = |frame: usize| &poses[self.frames.partition_point(|&other| other < frame)];
        let pose = |place: &f64| {
            let before = place.floor();
            let share = (place - before) as f32;
            if share < 1e-6 {
                return at(before as usize).clone();
            }
            pose_between(at(before as usize), at(place.ceil() as usize), share)
        };
        places.iter().map(pose).collect()
    }

    /// Seconds from one to the next.
    fn seconds(&self, frame_time: Option<f64>, fps: Option<f64>) -> Option<f64> {
        if let (Some(_), Some(fps)) = (&self.between, fps) {
            return Some(1.0 / fps);
        }
        let step = match *self.frames.as_slice() {
            [first, second, ..] => (second - first) as f64,
            _ => 1.0,
        };
        Some(step * frame_time?)
    }

    /// What each is called in messages, and its number in names of files: that of the frame, or
    /// how many places are before it.
    fn names(&self) -> Box<dyn Iterator<Item = (String, usize)> + '_> {
        match &self.between {
            None => Box::new(self.frames.iter().map(|frame| (frame.to_string(), *frame))),
            Some((places, seconds)) => {
                let times = places
                    .iter()
                    .map(move |place| format!("{:.4}s", place * seconds));
                Box::new(times.zip(0..))
            }
        }
    }
}

/// Turns arms of a body away from what they run into in frames of a motion, and tells of it.
fn keep_apart(
    body: &Body,
    take: &Take,
    frames: &[usize],
    of_motion: RetargetOptions,
    poses: &mut [Pose],
) -> Result<Option<PoseNote>, PoseError> {
    let contact = SelfContact::new(body)?;
    let options = arms_apart(&contact);
    let easing = take.easing(&contact, frames, &options, &of_motion)?;
    let largest = |turns: &[Vector3]| turns.iter().map(Vector3::norm).fold(0.0, f32::max);
    let largest: Vec<f32> = easing.iter().map(|turns| largest(turns)).collect();
    for (pose, turns) in poses.iter_mut().zip(&easing) {
        turn(pose, turns);
    }
    let num_turned = largest.iter().filter(|&&angle| angle > TOLD_TURN).count();
    let most = largest.into_iter().fold(0.0, f32::max).to_degrees();
    Ok((num_turned > 0).then_some(PoseNote::ArmsTurned {
        degrees: most,
        num_turned,
        num_frames: frames.len(),
    }))
}

/// How arms that run into other parts of the body, or are too near to them for cloth, are turned
/// away.
fn arms_apart(contact: &SelfContact) -> SeparationOptions {
    SeparationOptions {
        max_depth: TOUCH,
        room: contact.room_for_cloth(),
        legs_give_way: false,
        ..SeparationOptions::default()
    }
}

/// A pose of the library with room for cloth beside the arms, if they can leave it. Built-in bodies
/// stay in the poses that networks have learned.
fn with_room(pose: Pose, body: &Body, contact: &SelfContact) -> Result<Pose, PoseError> {
    if tape_measures(body).is_some() {
        return Ok(pose);
    }
    let separated = contact.separated(&pose, &arms_apart(contact))?;
    Ok(separated.map_or(pose, |separated| separated.pose))
}

/// A pose of the library, with the parts of the body apart and the lowest vertex on the ground.
fn of_library(name: &str, angles: &BodyAngles, body: &Body) -> Result<Posing, PoseError> {
    let cannot = |source| PoseError::Library {
        name: name.to_owned(),
        source,
    };
    let poser = Poser::new(body.skeleton()).map_err(cannot)?;
    let pose = poser.pose(angles);
    let contact = SelfContact::new(body).map_err(cannot)?;
    let mut notes = Vec::new();
    let separated = match contact.separated(&pose, &SeparationOptions::least())? {
        // Where little does not do, more may.
        None => contact.separated(&pose, &SeparationOptions::default())?,
        separated => separated,
    };
    let mut poses = if let Some(separated) = separated {
        vec![with_room(separated.pose, body, &contact)?]
    } else {
        notes.push(PoseNote::ThroughItself {
            name: name.to_owned(),
        });
        vec![pose]
    };
    put_on_ground(body, &mut poses, Ground::EachPose)?;
    for pose in &mut poses {
        keep_place(body.skeleton(), pose);
    }
    let named = poses.into_iter().map(|pose| NamedPose {
        label: name.to_owned(),
        stem: name.to_owned(),
        pose,
    });
    Ok(Posing {
        poses: named.collect(),
        notes,
        seconds: None,
    })
}

/// Bodies that are nearer to the origin than this, in metres, or look to the front but for so many
/// radians, stand as poses have it.
const AT_ORIGIN: f32 = 0.1;
const TO_FRONT: f32 = 0.1;

/// Brings a pose, which stands at the origin and looks along +z, to where the body stands at rest.
fn keep_place(skeleton: &Skeleton, pose: &mut Pose) {
    let Ok(figure) = Figure::new(skeleton, "the body") else {
        return;
    };
    let front: Vector3 = (figure.rest_from_body() * Vector3::z().cast()).cast();
    let heading = front.x.atan2(front.z);
    let joints = skeleton.joints();
    let hips = joints[figure.pelvis()].rest_position;
    let place = Vector3::new(hips.x, 0.0, hips.z);
    // Other roots, of props, are not turned.
    let mut root = figure.pelvis();
    while let Some(parent) = joints[root].parent {
        root = parent;
    }
    if place.norm() < AT_ORIGIN && heading.abs() < TO_FRONT {
        return;
    }
    let start = joints[root].rest_position.coords;
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), heading);
    let posed = start + pose.root_translation;
    pose.root_translation = place + turn * posed - start;
    pose.rotations[root] = turn * pose.rotations[root];
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
        assert_eq!(
            split("walk.bvh:0.5s:3s"),
            ("walk.bvh".into(), Some("0.5s:3s:1".to_owned()))
        );
        assert!(PoseSource::from("walk.bvh:0:9").is_several());
        assert!(!PoseSource::from("walk.bvh:9").is_several());
    }

    #[test]
    fn clips_precede_frames() {
        let split = |text: &str| {
            let (clip, frames) = clip_and_frames(text);
            (clip, frames.map(|frames| frames.to_string()))
        };
        assert_eq!(split("Walk"), (Some("Walk".to_owned()), None));
        assert_eq!(split("3:9"), (None, Some("3:9:1".to_owned())));
        assert_eq!(
            split("a:b:0:9"),
            (Some("a:b".to_owned()), Some("0:9:1".to_owned()))
        );
        assert_eq!(split("run.001"), (Some("run.001".to_owned()), None));
    }
}
