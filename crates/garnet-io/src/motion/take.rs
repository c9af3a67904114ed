//! Any file with poses: motion capture or our own pose JSON.

use std::path::{Path, PathBuf};

use garnet_body::{
    motion::{FrameRange, Motion, ReadOptions, Retarget, RetargetError, RetargetOptions},
    poses::{SelfContact, SeparationOptions, Timing, Turns},
};
use garnet_mesh::{MOST_BYTES, read_at_most};
use garnet_skin::{Pose, Skeleton, SkinError};
use serde::{Deserialize, de::IgnoredAny};

use super::{MotionError, MotionProblem, bvh, smpl};
use crate::{FileError, FileProblem, gltf, read_pose, read_rig::is_pickle};

/// A file with poses: a motion with its own skeleton, or pose JSON for the skeleton it is read for.
///
/// # Examples
///
/// ```no_run
/// use garnet_body::motion::{Ground, ReadOptions, RetargetOptions, put_on_ground};
/// use garnet_io::Take;
///
/// # fn example(body: &garnet_skin::Body) -> Result<(), Box<dyn std::error::Error>> {
/// let take = Take::read("walk.bvh", &ReadOptions::default())?;
/// let mut poses = take.poses(body.skeleton(), "0:120:4".parse()?, &RetargetOptions::default())?;
/// put_on_ground(body, &mut poses, Ground::Clip)?;
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Take {
    path: PathBuf,
    content: Content,
}

#[derive(Debug, Clone)]
enum Content {
    Motion(Box<Motion>),
    /// Poses of the very skeleton that they are for, `frames` of them.
    Json {
        num_frames: usize,
    },
}

/// Poses that cannot be had from a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TakeError {
    /// The motion does not fit the skeleton.
    #[error("cannot carry the motion of `{}` over to the body", path.display())]
    Retarget {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        problem: RetargetError,
    },
    /// The pose JSON does not fit the skeleton.
    #[error(transparent)]
    Pose(#[from] FileError),
}

/// What can go wrong while a motion is eased.
enum Eased {
    Take(TakeError),
    Skin(SkinError),
}

impl From<SkinError> for Eased {
    fn from(error: SkinError) -> Self {
        Self::Skin(error)
    }
}

#[derive(Deserialize)]
struct FramesJson {
    frames: Option<Vec<IgnoredAny>>,
}

impl Take {
    /// Reads a BVH file, an npz archive in the layout of AMASS, the first animation of a GLB or
    /// glTF file, or pose JSON, told by their content.
    ///
    /// # Errors
    ///
    /// [`MotionError`] with the line of what does not parse.
    pub fn read(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Self, MotionError> {
        Self::read_clip(path, None, options)
    }

    /// The same of a clip of a GLB or glTF file, by its name; the first one without it.
    ///
    /// # Errors
    ///
    /// [`MotionError`] with the line of what does not parse, or the clips that there are.
    pub fn read_clip(
        path: impl AsRef<Path>,
        clip: Option<&str>,
        options: &ReadOptions,
    ) -> Result<Self, MotionError> {
        let path = path.as_ref();
        let content = content(path, clip, options);
        match content {
            Ok(content) => Ok(Self {
                path: path.to_path_buf(),
                content,
            }),
            Err(problem) => Err(MotionError {
                path: path.to_path_buf(),
                problem,
            }),
        }
    }

    /// The motion, if the file has a skeleton of its own.
    pub fn motion(&self) -> Option<&Motion> {
        match &self.content {
            Content::Motion(motion) => Some(motion),
            Content::Json { .. } => None,
        }
    }

    /// How many frames there are.
    pub fn num_frames(&self) -> usize {
        match &self.content {
            Content::Motion(motion) => motion.frames.len(),
            Content::Json { num_frames } => *num_frames,
        }
    }

    /// Seconds from one frame to the next, if the file says.
    pub fn frame_time(&self) -> Option<f64> {
        self.motion().and_then(|motion| motion.frame_time)
    }

    /// What was taken for granted or left out when the file is used for `skeleton`.
    pub fn notes(&self, skeleton: &Skeleton, options: &RetargetOptions) -> Vec<String> {
        let Some(motion) = self.motion() else {
            return Vec::new();
        };
        let mut notes = motion.notes.clone();
        if let Ok(retarget) = Retarget::new(motion, skeleton, options) {
            notes.extend_from_slice(retarget.notes());
        }
        notes
    }

    /// The poses of `skeleton` in the frames of a range.
    ///
    /// # Errors
    ///
    /// [`TakeError`] naming the joints that are missing or the frame that is not there.
    pub fn poses(
        &self,
        skeleton: &Skeleton,
        range: FrameRange,
        options: &RetargetOptions,
    ) -> Result<Vec<Pose>, TakeError> {
        let frames = range.of(self.num_frames(), self.frame_time());
        self.poses_of(
            skeleton,
            &frames.map_err(|problem| self.wrong(problem))?,
            options,
        )
    }

    /// The poses of `skeleton` in some frames.
    ///
    /// # Errors
    ///
    /// [`TakeError`] naming the joints that are missing or the frame that is not there.
    pub fn poses_of(
        &self,
        skeleton: &Skeleton,
        frames: &[usize],
        options: &RetargetOptions,
    ) -> Result<Vec<Pose>, TakeError> {
        match &self.content {
            Content::Motion(motion) => {
                let wrong = |problem| self.wrong(problem);
                let retarget = Retarget::new(motion, skeleton, options).map_err(wrong)?;
                let poses = frames.iter().map(|&frame| retarget.pose(frame));
                poses.collect::<Result<_, _>>().map_err(wrong)
            }
            Content::Json { .. } => {
                let read = |&frame: &usize| read_pose(&self.path, Some(frame), skeleton);
                Ok(frames.iter().map(read).collect::<Result<_, _>>()?)
            }
        }
    }

    /// The turns that keep the parts of a body apart in some frames, smooth over the motion
    /// `[frame][joint]`: those of [`SelfContact::easing_of_frames`].
    ///
    /// # Errors
    ///
    /// Those of [`Take::poses_of`].
    pub fn easing(
        &self,
        contact: &SelfContact,
        frames: &[usize],
        options: &SeparationOptions,
        of_motion: &RetargetOptions,
    ) -> Result<Vec<Turns>, TakeError> {
        let skeleton = contact.body().skeleton();
        let poses_of = |frames: &[usize]| {
            let poses = self.poses_of(skeleton, frames, of_motion);
            poses.map_err(Eased::Take)
        };
        let timing = Timing {
            num_frames: self.num_frames(),
            frame_time: self.frame_time(),
        };
        let turns = contact.easing_of_frames(timing, frames, options, poses_of);
        turns.map_err(|error| match error {
            Eased::Take(error) => error,
            Eased::Skin(error) => self.wrong(RetargetError::from(error)),
        })
    }

    /// What is wrong with the motion for a body.
    fn wrong(&self, problem: RetargetError) -> TakeError {
        TakeError::Retarget {
            path: self.path.clone(),
            problem,
        }
    }
}

fn content(
    path: &Path,
    clip: Option<&str>,
    options: &ReadOptions,
) -> Result<Content, MotionProblem> {
    let bytes = read_at_most(path, MOST_BYTES)?;
    let refused = |problem| Err(MotionProblem::File(Box::new(problem)));
    if bytes.is_empty() {
        return refused(FileProblem::Empty);
    }
    if is_pickle(&bytes) {
        return refused(FileProblem::Pickle);
    }
    if bytes.starts_with(gltf::MAGIC) || is_gltf(path) {
        let folder = path.parent().unwrap_or(Path::new(""));
        let motion = gltf::read_clip(&bytes, folder, clip, options);
        let motion = motion.map_err(|problem| MotionProblem::File(Box::new(problem)))?;
        return Ok(Content::Motion(Box::new(motion)));
    }
    if let Some(clip) = clip {
        return Err(MotionProblem::NoClips {
            clip: clip.to_owned(),
        });
    }
    if bytes.starts_with(b"PK") {
        return Ok(Content::Motion(Box::new(smpl::read(path, options)?)));
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
    let start = bytes.trim_ascii_start();
    if start.first() == Some(&b'{') {
        let json: FramesJson = serde_json::from_slice(bytes)?;
        let num_frames = json.frames.map_or(1, |frames| frames.len());
        return Ok(Content::Json { num_frames });
    }
    let is_bvh = start
        .get(..9)
        .is_some_and(|word| word.eq_ignore_ascii_case(b"HIERARCHY"));
    if !is_bvh {
        return Err(MotionProblem::UnknownFormat);
    }
    let text = String::from_utf8_lossy(bytes);
    Ok(Content::Motion(Box::new(bvh::parse(&text, options)?)))
}

/// Whether a file is called as glTF in text is.
fn is_gltf(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("gltf"))
}
