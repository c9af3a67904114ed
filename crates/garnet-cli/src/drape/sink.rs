//! Where drapes are written: an OBJ each, or one file of all frames.

use std::path::{Path, PathBuf};

use garnet::{
    Point3, PosedBody,
    io::{self, CacheKind, CachePart, CacheWriter, Target},
};

use super::{Bound, args::Job, outputs::body_out_of};

/// Frames a second of what does not say.
const USUAL_FPS: f64 = 30.0;

/// Files of motions round the time of a frame: 0.033333 seconds are meant as 30 frames a second.
const ROUNDING: f64 = 1e-4;

fn frames_a_second(frame_time: f64) -> f64 {
    let fps = 1.0 / frame_time;
    if (fps - fps.round()).abs() < ROUNDING * fps {
        fps.round()
    } else {
        fps
    }
}

/// Frames a second of the targets.
pub(super) fn fps_of(bound: &Bound) -> f64 {
    bound.frame_time.map_or(USUAL_FPS, frames_a_second)
}

/// That frames of a motion are written with a time that its file does not tell.
pub(super) fn note_of_time(bound: &Bound, job: &Job) -> Option<String> {
    let is_timed = job.cache.is_some() || job.body_cache.is_some() || job.follows;
    let is_unknown = bound.pose.is_some() && bound.frame_time.is_none();
    (is_timed && is_unknown && bound.targets.len() > 1).then(|| {
        format!(
            "note: the motion does not say how many frames it has a second: {USUAL_FPS} are taken"
        )
    })
}

/// A file of all frames.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct CacheFile {
    pub(super) path: PathBuf,
    pub(super) kind: CacheKind,
}

impl CacheFile {
    /// What a name stands for, if that is not a mesh or a folder.
    pub(super) fn of(path: &Path) -> Option<Self> {
        let kind = CacheKind::of(path)?;
        (!path.is_dir()).then(|| Self {
            path: path.to_path_buf(),
            kind,
        })
    }
}

/// The files of all frames that are being written.
#[derive(Debug, Default)]
pub(super) struct Sink {
    drapes: Option<CacheWriter>,
    bodies: Option<CacheWriter>,
}

impl Sink {
    /// Begins the files that a job asks for, of `num_frames` frames.
    pub(super) fn open(bound: &Bound, job: &Job, num_frames: usize) -> anyhow::Result<Self> {
        let fps = fps_of(bound);
        let begin = |file: &CacheFile, parts: Vec<CachePart>| {
            CacheWriter::create(&file.path, file.kind, parts, num_frames, fps)
        };
        let drapes = |file: &CacheFile| {
            let mut parts = vec![CachePart::of_obj(&bound.garment_file, bound.garment_frame)];
            if file.kind.holds_parts() {
                parts.push(body_part(bound));
            }
            begin(file, parts)
        };
        Ok(Self {
            drapes: job.cache.as_ref().map(drapes).transpose()?,
            bodies: (job.body_cache.as_ref())
                .map(|file| begin(file, vec![body_part(bound)]))
                .transpose()?,
        })
    }

    /// Adds a frame.
    pub(super) fn push(&mut self, drape: &[Point3], body: &PosedBody) -> anyhow::Result<()> {
        let body = body.skin().positions();
        if let Some(cache) = &mut self.drapes {
            cache.push(&[drape, body])?;
        }
        if let Some(cache) = &mut self.bodies {
            cache.push(&[body])?;
        }
        Ok(())
    }

    /// Puts the files into their places.
    pub(super) fn finish(self) -> anyhow::Result<()> {
        for cache in self.drapes.into_iter().chain(self.bodies) {
            cache.finish()?;
        }
        Ok(())
    }
}

/// The body, in the file of which its faces have their numbers.
fn body_part(bound: &Bound) -> CachePart {
    let rest = &bound.rest;
    match &rest.file {
        Some(file) => CachePart::of_obj(file, rest.file_frame),
        None => CachePart::of_mesh("body", bound.garment.body().rest(), rest.file_frame),
    }
}

/// Writes a drape and the body below it that have files of their own.
pub(super) fn write_files(
    bound: &Bound,
    job: &Job,
    (target, output): (&Target, &Path),
    drape: &[Point3],
    body: &PosedBody,
) -> anyhow::Result<()> {
    if job.cache.is_none() {
        let positions = bound.garment_frame.to_file(drape.to_vec());
        bound
            .garment_file
            .write_with_positions(output, &positions)?;
    }
    let path = job.body_out.as_ref().filter(|_| job.body_cache.is_none());
    if let Some(path) = path {
        write_body(&body_out_of(path, target), bound, body)?;
    }
    Ok(())
}

/// Writes a posed body with the text of the rest body's OBJ, or plainly if there is none.
fn write_body(path: &Path, bound: &Bound, posed: &PosedBody) -> anyhow::Result<()> {
    let rest = &bound.rest;
    let positions = rest.file_frame.to_file(posed.skin().positions().to_vec());
    if let Some(file) = &rest.file {
        file.write_with_positions(path, &positions)?;
    } else {
        // Without the faces that close holes of the skin.
        let body = bound.garment.body().rest();
        io::write_obj(path, &body.with_positions(positions)?)?;
    }
    Ok(())
}
