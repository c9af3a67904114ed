//! The simulation along a motion: its frames wait in a folder until all are there, so that it can
//! go on after a stop.

use std::{
    ffi::OsString,
    fs::{self, File, OpenOptions},
    hash::{DefaultHasher, Hash, Hasher},
    io::{self, Read, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
    sync::atomic::{AtomicBool, Ordering},
};

use anyhow::Context;
use garnet::{
    Point3, PosedBody, Vector3,
    package::{FileLock, MovingCloth, Quality, Simulator},
    sim::Event,
};
use serde::{Deserialize, Serialize};

use super::{Bound, args::Job};
use crate::{console::Console, input, interrupt::Interrupted, output};

/// So many frames are simulated before what is there is kept. What cloth touches is looked for anew
/// after each, so the bytes depend on it.
const STRETCH: usize = 8;

/// Time from frame to frame of what does not say, in seconds.
const USUAL_FRAME: f64 = 1.0 / 30.0;

const SCHEMA: &str = "garnet.following/1";

/// Where the cloth is.
#[derive(Debug, Serialize, Deserialize)]
struct State {
    schema: String,
    /// Of all that the simulation depends on.
    fingerprint: u64,
    /// Frames that are there.
    num_done: usize,
    positions: Vec<[f32; 3]>,
    velocities: Vec<[f32; 3]>,
    faces: Vec<u32>,
}

/// The frames of a motion, simulated one after the other.
#[derive(Debug)]
pub(super) struct Followed {
    folder: PathBuf,
    num_vertices: usize,
    /// Keeps other runs out of the folder.
    _lock: FileLock,
}

impl Followed {
    /// Simulates what is not there yet of all frames.
    pub(super) fn new(
        (bound, simulator, quality): (&Bound, &Simulator, Quality),
        job: &Job,
        stop: &AtomicBool,
        console: &Console,
    ) -> anyhow::Result<Self> {
        let folder = folder_of(job);
        let mut lock = folder.clone().into_os_string();
        lock.push(".lock");
        let followed = Self {
            _lock: FileLock::take(Path::new(&lock), &folder)?,
            folder,
            num_vertices: bound.garment.mesh().num_vertices(),
        };
        let fingerprint = fingerprint(bound, job, quality)?;
        let count = bound.targets.len();
        let frame_time = bound.frame_time.unwrap_or(USUAL_FRAME);
        let begun = if job.resumes {
            followed.begun(fingerprint)?
        } else {
            None
        };
        let body = bound.garment.body();
        let posed =
            |number: usize| -> anyhow::Result<PosedBody> { Ok(bound.targets[number].posed(body)?) };
        let cannot = || format!("cannot simulate `{}`", bound.garment_file.path().display());
        let bar = console.progress(count);
        let (mut cloth, mut num_done) = if let Some(begun) = begun {
            begun
        } else {
            followed.begin()?;
            bar.set_message("the way to the first frame");
            let ready = simulator.ready(body, &posed(0)?, quality, stop, &mut |_: Event<'_>| {
                bar.tick();
            });
            let cloth = followed.unless_stopped(ready, (stop, 0, count))?;
            let cloth = cloth.with_context(cannot)?;
            followed.keep(
                &[simulator.vertices(&cloth.positions)],
                &cloth,
                1,
                fingerprint,
            )?;
            (cloth, 1)
        };
        bar.set_message("");
        while num_done < count {
            bar.set_position(num_done as u64);
            let end = (num_done + STRETCH).min(count);
            let bodies: anyhow::Result<Vec<PosedBody>> = (num_done - 1..end).map(posed).collect();
            let went = simulator.follow(&bodies?, frame_time, &cloth, quality, stop);
            let went = followed.unless_stopped(went, (stop, num_done, count))?;
            let (frames, left) = went.with_context(cannot)?;
            followed.keep(&frames, &left, end, fingerprint)?;
            (cloth, num_done) = (left, end);
        }
        bar.finish_and_clear();
        Ok(followed)
    }

    /// What was simulated, unless it was told to stop.
    fn unless_stopped<T, E>(
        &self,
        result: Result<T, E>,
        (stop, num_done, count): (&AtomicBool, usize, usize),
    ) -> anyhow::Result<Result<T, E>> {
        if !stop.load(Ordering::Relaxed) {
            return Ok(result);
        }
        let folder = self.folder.display();
        Err(anyhow::Error::new(Interrupted {
            told: format!("{num_done} of {count} frames wait in `{folder}`; `--resume` goes on"),
        }))
    }

    /// Positions `[vertex]` of a frame, in metres.
    pub(super) fn positions(&self, number: usize) -> anyhow::Result<Vec<Point3>> {
        let length = 12 * self.num_vertices;
        let mut bytes = vec![0; length];
        let read = || -> io::Result<()> {
            let mut file = File::open(self.frames())?;
            file.seek(SeekFrom::Start((number * length) as u64))?;
            file.read_exact(&mut bytes)
        };
        let mut read = read;
        read().with_context(|| format!("cannot read `{}`", self.frames().display()))?;
        let (words, _) = bytes.as_chunks::<4>();
        let (points, _) = words.as_chunks::<3>();
        Ok(points
            .iter()
            .map(|point| point.map(f32::from_le_bytes).into())
            .collect())
    }

    /// Removes what is not needed once all is written.
    pub(super) fn remove(self) -> anyhow::Result<()> {
        let cannot = || format!("cannot remove `{}`", self.folder.display());
        fs::remove_file(self.frames()).with_context(cannot)?;
        fs::remove_file(self.state()).with_context(cannot)?;
        fs::remove_dir(&self.folder).with_context(cannot)
    }

    fn frames(&self) -> PathBuf {
        self.folder.join("frames.f32")
    }

    fn state(&self) -> PathBuf {
        self.folder.join("state.json")
    }

    /// Empties the folder of what an earlier run has left.
    fn begin(&self) -> anyhow::Result<()> {
        output::open_folder(&self.folder)?;
        let cannot = || format!("cannot write into `{}`", self.folder.display());
        if self.state().exists() {
            fs::remove_file(self.state()).with_context(cannot)?;
        }
        File::create(self.frames()).with_context(cannot)?;
        Ok(())
    }

    /// What an earlier run of the same simulation has left.
    fn begun(&self, fingerprint: u64) -> anyhow::Result<Option<(MovingCloth, usize)>> {
        let path = self.state();
        let cannot = || format!("cannot go on with `{}`", self.folder.display());
        if !path.exists() {
            return Ok(None);
        }
        let bytes = input::bytes(&path).with_context(cannot)?;
        let state: State = serde_json::from_slice(&bytes).with_context(cannot)?;
        if state.schema != SCHEMA || state.fingerprint != fingerprint {
            return Err(crate::failure::refused(
                cannot(),
                "it was begun with other files or options",
                "begin anew without `--resume`",
            ));
        }
        let length = (12 * self.num_vertices * state.num_done) as u64;
        let file = OpenOptions::new()
            .write(true)
            .open(self.frames())
            .with_context(cannot)?;
        let found = file.metadata().with_context(cannot)?.len();
        if found < length || state.num_done == 0 {
            return Err(crate::failure::refused(
                cannot(),
                format!("`{}` is cut off", self.frames().display()),
                "begin anew without `--resume`",
            ));
        }
        file.set_len(length).with_context(cannot)?;
        let cloth = MovingCloth {
            positions: state.positions.into_iter().map(Point3::from).collect(),
            velocities: state.velocities.into_iter().map(Vector3::from).collect(),
            faces: state.faces,
        };
        Ok(Some((cloth, state.num_done)))
    }

    /// Adds frames, and then where the cloth is.
    fn keep(
        &self,
        frames: &[Vec<Point3>],
        cloth: &MovingCloth,
        num_done: usize,
        fingerprint: u64,
    ) -> anyhow::Result<()> {
        let coordinates = frames
            .iter()
            .flatten()
            .flat_map(|point| [point.x, point.y, point.z]);
        let bytes: Vec<u8> = coordinates.flat_map(f32::to_le_bytes).collect();
        let append = || -> io::Result<()> {
            let mut file = OpenOptions::new().append(true).open(self.frames())?;
            file.write_all(&bytes)?;
            file.sync_data()
        };
        append().with_context(|| format!("cannot write `{}`", self.frames().display()))?;
        let state = State {
            schema: SCHEMA.to_owned(),
            fingerprint,
            num_done,
            positions: cloth
                .positions
                .iter()
                .map(|point| point.coords.into())
                .collect(),
            velocities: cloth
                .velocities
                .iter()
                .map(|velocity| (*velocity).into())
                .collect(),
            faces: cloth.faces.clone(),
        };
        output::write(&self.state(), serde_json::to_string(&state)?.as_bytes())
    }
}

/// Where the frames of a job wait: beside its output.
pub(super) fn folder_of(job: &Job) -> PathBuf {
    let cache = job.cache.as_ref().map(|cache| cache.path.as_path());
    let output = cache.or(job.folder.as_deref()).unwrap_or(Path::new("out"));
    let mut name = OsString::from(output.components().as_path());
    name.push(".part");
    PathBuf::from(name)
}

/// Of all that a simulation depends on, within one version of garnet.
fn fingerprint(bound: &Bound, job: &Job, quality: Quality) -> anyhow::Result<u64> {
    let mut hasher = DefaultHasher::new();
    env!("CARGO_PKG_VERSION").hash(&mut hasher);
    format!("{:?} {quality:?} {:?}", job.source, job.simulation).hash(&mut hasher);
    for place in bound
        .garment
        .mesh()
        .positions()
        .iter()
        .chain(bound.garment.body().rest().positions())
    {
        place.coords.map(f32::to_bits).as_slice().hash(&mut hasher);
    }
    bound.garment.mesh().faces().hash(&mut hasher);
    bound.targets.len().hash(&mut hasher);
    if let Some(pose) = &bound.pose {
        input::bytes(&pose.path)?.hash(&mut hasher);
    }
    Ok(hasher.finish())
}
