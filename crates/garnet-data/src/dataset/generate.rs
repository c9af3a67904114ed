//! Making a data set: bodies and poses are drawn, garments simulated, results kept.

use std::{
    fs,
    path::Path,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use garnet_drape::{GarmentPackage, Quality, quality_name};
use garnet_mesh::Fingerprint;

use super::dress::{Dresser, Outcome};
use super::lock::Lock;
use super::manifest::{DATASET_SCHEMA, DatasetManifest, GENERATOR, Sizing};
use super::plan::{Counts, Plan, Protocol};
use super::record::{Rejection, SceneRecord, Split};
use super::shard::{Layout, Shard};
use super::variations::Variations;
use crate::{DataError, Limits, Moment};

/// Bodies in a shard: at 5k vertices and 8 poses a shard has 5 MB.
const BODIES_PER_SHARD: u32 = 10;

/// What data set is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct DatasetOptions {
    /// Seed of bodies and poses.
    pub seed: u64,
    /// Bodies in each split.
    pub bodies: Counts,
    /// Scenes on each body.
    pub poses: u32,
    /// Whether poses are [mixed](garnet_body::poses::PoseSampler::mixed) of several.
    pub mixed: bool,
    /// The noise of the poses' angles, as a share of the usual one.
    pub noise: f64,
    /// What validation and test have that the training has not.
    pub protocol: Protocol,
    /// Quality of the simulation.
    pub quality: Quality,
    /// How far the simulation goes.
    pub until: Moment,
    /// Who wears what.
    pub sizing: Sizing,
    /// Sewing parameters that are drawn for each body; garments that are cut to measure alone have
    /// any.
    pub vary: Variations,
    /// Above these a scene is rejected.
    pub limits: Limits,
    /// This machine's share: shard `i` is made if `i % part.1 == part.0`.
    pub part: (u32, u32),
    /// Scenes simulated at the same time.
    pub threads: usize,
}

/// What happened while a data set is made.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum DatasetEvent {
    /// What there is to do: all scenes of this part, and those that an earlier run has left.
    Planned {
        /// Scenes of this part.
        scenes: usize,
        /// Scenes that are there already.
        done: usize,
        /// Bodies of the population that were looked at for those that the garment fits.
        tried: u64,
    },
    /// A scene is in the data set.
    Accepted {
        /// Its split.
        split: Split,
        /// How long it took.
        time: Duration,
    },
    /// A scene was rejected.
    Rejected {
        /// Its split.
        split: Split,
        /// Why.
        rejection: Rejection,
        /// How long it took.
        time: Duration,
    },
}

/// What a data set has got.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tally {
    /// Scenes in the data set.
    pub accepted: usize,
    /// Scenes that were rejected.
    pub rejected: usize,
}

/// A body that is to be dressed.
#[derive(Debug, Clone, Copy)]
struct Task {
    split: Split,
    /// Number in the split.
    body: u32,
    /// Number in the population.
    index: u64,
    /// Place of its shard among those of this part.
    shard: usize,
}

/// A shard of this part that is not yet written.
#[derive(Debug)]
struct Pending {
    split: Split,
    number: u32,
    /// Bodies whose scenes are not all there.
    open_bodies: AtomicUsize,
    bodies: std::ops::Range<u32>,
}

/// Makes a data set, or what is left of it to make.
///
/// Each thread takes a body and drapes the garment on it in all its poses, one scene after the
/// other; each scene is written when it is done, and scenes become a shard when all its bodies are
/// done. A run that is stopped or killed goes on where it was: it loses at most the scene that each
/// thread was at. What is in the files depends on the options alone, not on threads, parts and
/// interruptions.
///
/// # Errors
///
/// [`DataError::OtherDataset`] if the folder holds another data set, [`DataError::InUse`] while
/// another run writes shards of this part, [`DataError::FewFit`], [`DataError::ForeignBody`],
/// [`DataError::Pattern`] for variations that the pattern does not allow,
/// [`DataError::VariedTemplate`], [`DataError::Stopped`] after `stop` was set, or that a file
/// cannot be read or written. A scene that cannot be simulated is a rejection, not an error.
pub fn generate(
    package: &GarmentPackage,
    folder: &Path,
    options: &DatasetOptions,
    observer: &(dyn Fn(DatasetEvent) + Sync),
    stop: &AtomicBool,
) -> Result<Tally, DataError> {
    let layout = Layout {
        folder: folder.to_path_buf(),
    };
    let manifest = DatasetManifest::asked(package, options).gone_on_with(&layout)?;
    // Before anything is written.
    let dresser = Dresser::new(package, options)?;
    let _lock = begin(&layout, &manifest, options.part)?;
    let plan = Plan::new(options.seed, options.bodies, |body| dresser.fits(body))?;
    let (shards, tasks) = tasks(&plan, &layout, options);
    let job = Job {
        options,
        layout,
        dataset: manifest.fingerprint(),
        dresser,
        shards,
        tasks,
        next: AtomicUsize::new(0),
        stop,
        observer,
    };
    job.announce(plan.tried);
    job.run()?;
    tally(folder)
}

impl DatasetManifest {
    fn asked(package: &GarmentPackage, options: &DatasetOptions) -> Self {
        Self {
            schema: DATASET_SCHEMA.to_owned(),
            generator: GENERATOR.to_owned(),
            garment: package.manifest.of_garment(),
            seed: options.seed,
            bodies: options.bodies,
            poses: options.poses,
            mixed: options.mixed,
            noise: options.noise,
            protocol: options.protocol,
            quality: Some(quality_name(options.quality).to_owned()),
            until: options.until,
            sizing: options.sizing,
            vary: options.vary.clone(),
            limits: options.limits,
            bodies_per_shard: BODIES_PER_SHARD,
            imported: None,
        }
    }

    /// The same, as the data set in the folder tells whether the garment is cut for each wearer: a
    /// training on it says so of the package, which was another one when the data set was begun.
    fn gone_on_with(mut self, layout: &Layout) -> Result<Self, DataError> {
        let path = layout.manifest();
        if path.exists() {
            let begun = Self::read(&path)?.garment.is_made_to_measure();
            if let Some(pattern) = &mut self.garment.pattern {
                pattern.made_to_measure = begun;
            }
        }
        Ok(self)
    }
}

/// Makes the folders and the manifest, or checks the manifest that is there, and takes the part.
fn begin(layout: &Layout, manifest: &DatasetManifest, part: (u32, u32)) -> Result<Lock, DataError> {
    let path = layout.manifest();
    if path.exists() {
        DatasetManifest::read(&path)?.check_same(manifest, &path)?;
    }
    let lock = Lock::of_part(layout, part)?;
    let shards = layout.shards();
    fs::create_dir_all(&shards).map_err(|source| DataError::folder(&shards, source))?;
    // Another part may have come between.
    if path.exists() {
        DatasetManifest::read(&path)?.check_same(manifest, &path)?;
    } else {
        for shard in layout.found()? {
            Shard::read_named(&shard, manifest.fingerprint(), manifest.bodies_per_shard)?;
        }
        manifest.write(&path)?;
    }
    Ok(lock)
}

/// Counts what a data set has got.
fn tally(folder: &Path) -> Result<Tally, DataError> {
    let dataset = super::Dataset::open(folder)?;
    let mut tally = Tally::default();
    for shard in dataset.shards() {
        let shard = shard?;
        tally.accepted += shard.scenes.len();
        tally.rejected += shard.rejections.len();
    }
    Ok(tally)
}

/// The shards of this part that are not written, and their bodies.
fn tasks(plan: &Plan, layout: &Layout, options: &DatasetOptions) -> (Vec<Pending>, Vec<Task>) {
    let (mut shards, mut tasks) = (Vec::new(), Vec::new());
    let (part, num_parts) = options.part;
    let mut shard_index = 0;
    for split in Split::ALL {
        let bodies = plan.bodies(split);
        for (number, chunk) in bodies.chunks(BODIES_PER_SHARD as usize).enumerate() {
            let number = number as u32;
            let is_ours = shard_index % num_parts == part;
            shard_index += 1;
            if !is_ours || layout.shard(split, number).exists() {
                continue;
            }
            let first = number * BODIES_PER_SHARD;
            tasks.extend((first..).zip(chunk).map(|(body, &index)| Task {
                split,
                body,
                index,
                shard: shards.len(),
            }));
            shards.push(Pending {
                split,
                number,
                open_bodies: AtomicUsize::new(chunk.len()),
                bodies: first..first + chunk.len() as u32,
            });
        }
    }
    (shards, tasks)
}

/// A run.
struct Job<'a> {
    options: &'a DatasetOptions,
    layout: Layout,
    dataset: Fingerprint,
    dresser: Dresser<'a>,
    shards: Vec<Pending>,
    tasks: Vec<Task>,
    next: AtomicUsize,
    stop: &'a AtomicBool,
    observer: &'a (dyn Fn(DatasetEvent) + Sync),
}

impl Job<'_> {
    fn announce(&self, tried: u64) {
        let poses = self.options.poses;
        let pieces = self.tasks.iter().map(|task| {
            let there = (0..poses).filter(|&pose| self.piece_is_there(task, pose));
            there.count()
        });
        (self.observer)(DatasetEvent::Planned {
            scenes: self.tasks.len() * poses as usize,
            done: pieces.sum(),
            tried,
        });
    }

    fn piece_is_there(&self, task: &Task, pose: u32) -> bool {
        let path = self.layout.piece(task.split, task.body, pose);
        path.exists()
    }

    /// One thread a scene: a simulation has too little work at a time for two.
    fn run(&self) -> Result<(), DataError> {
        let failure: Mutex<Option<DataError>> = Mutex::new(None);
        let work = || {
            // What the simulation uses of rayon stays on this thread.
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
            let result = match pool {
                Ok(pool) => pool.install(|| self.work(&failure)),
                Err(_) => self.work(&failure),
            };
            if let Err(error) = result {
                let mut failure = failure.lock().unwrap_or_else(PoisonError::into_inner);
                failure.get_or_insert(error);
            }
        };
        std::thread::scope(|scope| {
            for _ in 1..self.options.threads {
                scope.spawn(work);
            }
            work();
        });
        match failure.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(error) => Err(error),
            None => Ok(()),
        }
    }

    fn work(&self, failure: &Mutex<Option<DataError>>) -> Result<(), DataError> {
        while let Some(task) = self.tasks.get(self.next.fetch_add(1, Ordering::Relaxed)) {
            let has_failed = failure.lock().is_ok_and(|failure| failure.is_some());
            if has_failed {
                return Ok(());
            }
            self.dress(task)?;
            let shard = &self.shards[task.shard];
            if shard.open_bodies.fetch_sub(1, Ordering::AcqRel) == 1 {
                self.finish(shard)?;
            }
        }
        Ok(())
    }

    /// Drapes the garment on a body in all poses that are not there yet.
    fn dress(&self, task: &Task) -> Result<(), DataError> {
        let missing = |&pose: &u32| !self.piece_is_there(task, pose);
        let missing: Vec<u32> = (0..self.options.poses).filter(missing).collect();
        if missing.is_empty() {
            return Ok(());
        }
        let options = self.options;
        let sampler = options.protocol.sampler(options.seed, task.split);
        let sampler = sampler.mixed(options.mixed).with_noise(options.noise);
        let start = Instant::now();
        let dressed = self.dresser.dressed(task.index, self.stop);
        let mut fitting = start.elapsed();
        for pose in missing {
            let start = Instant::now();
            let number = options.protocol.number(task.body, pose, options.poses);
            let outcome = dressed.drape(&self.dresser, &sampler, number, self.stop);
            if self.stop.load(Ordering::Relaxed) {
                return Err(DataError::Stopped);
            }
            let mut piece = Shard::new(task.split);
            piece.bodies.push(dressed.record(task.body));
            let time = start.elapsed() + std::mem::take(&mut fitting);
            let event = keep(task, pose, outcome, &mut piece, time);
            piece.write(
                &self.layout.piece(task.split, task.body, pose),
                self.dataset,
            )?;
            (self.observer)(event);
        }
        Ok(())
    }

    /// Makes a shard of its scenes, and removes these.
    fn finish(&self, pending: &Pending) -> Result<(), DataError> {
        let mut shard = Shard::new(pending.split);
        let bodies = pending.bodies.clone();
        let pieces: Vec<_> = bodies
            .flat_map(|body| (0..self.options.poses).map(move |pose| (body, pose)))
            .map(|(body, pose)| self.layout.piece(pending.split, body, pose))
            .collect();
        for path in &pieces {
            shard.merge(Shard::read(path, self.dataset)?);
        }
        shard.write(
            &self.layout.shard(pending.split, pending.number),
            self.dataset,
        )?;
        for path in &pieces {
            fs::remove_file(path).map_err(|source| DataError::folder(path, source))?;
        }
        Ok(())
    }
}

/// Puts what became of a scene into its file.
fn keep(
    task: &Task,
    pose: u32,
    outcome: Outcome,
    piece: &mut Shard,
    time: Duration,
) -> DatasetEvent {
    let split = task.split;
    match outcome {
        Outcome::Accepted(scene) => {
            piece.scenes.push(SceneRecord {
                body: task.body,
                pose,
                ..*scene
            });
            DatasetEvent::Accepted { split, time }
        }
        Outcome::Rejected {
            sequence,
            kind,
            reason,
        } => {
            let rejection = Rejection {
                body: task.body,
                pose,
                sequence,
                kind: kind.to_owned(),
                reason,
            };
            piece.rejections.push(rejection.clone());
            DatasetEvent::Rejected {
                split,
                rejection,
                time,
            }
        }
    }
}
