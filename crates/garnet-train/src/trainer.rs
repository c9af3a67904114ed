//! The training of a variant, from the data set to the package.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use burn::optim::GradientsAccumulator;
use burn::tensor::Device;
use garnet_data::Split;
use garnet_drape::GarmentPackage;
use garnet_mesh::Fingerprint;
use garnet_net::losses::LossValue;
use garnet_net::{Checkpoint, GarNet, GarNetConfig, InputScaling, ScalingSums};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::context::{Example, TrainingContext};
use crate::examples::examples;
use crate::mirrored::SceneMirror;
use crate::run_log::RunLog;
use crate::scene_gradients::scene_gradients;
use crate::state::{EpochSums, FirstTerm, Progress, State, state_file};
use crate::validate::{Validation, validate};
use crate::{
    Began, Choice, EpochRecord, Recipe, Stage, TrainConfig, TrainError, TrainEvent, Trained,
    gradients, kind_name, pose_space, publish, weights_mean,
};

/// Scenes whose terms are told before the first step.
const FIRST_SCENES: usize = 8;

/// Scenes that tell how much inputs change, at most.
const SCALING_SCENES: usize = 500;

/// So many scenes in a row without a step, and a training has diverged.
const MAX_SKIPPED: u32 = 20;

/// What is to be trained, and on what.
#[derive(Debug, Clone)]
pub struct TrainJob {
    /// The folder of the package; the variant is added to it.
    pub package: PathBuf,
    /// The folder of the data set.
    pub dataset: PathBuf,
    /// Folders of further data sets to learn from, of other bodies; for deformations that networks
    /// tell.
    pub more: Vec<PathBuf>,
    /// The variant.
    pub recipe: Recipe,
    /// How it is trained.
    pub config: TrainConfig,
    /// Weights to start from, besides those that the recipe names.
    pub base: Option<PathBuf>,
    /// Whether a training that is under way is gone on with.
    pub begin: Begin,
    /// Whether the variant becomes the default of the package; else that is the best on validation.
    pub makes_default: bool,
}

impl TrainJob {
    /// The file in the package that the weights are written to.
    pub fn weights(&self) -> PathBuf {
        let name = publish::weights_file(&self.recipe.name);
        self.package.join(name)
    }
}

/// Where a training begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Begin {
    /// At its start; one that is under way is an error.
    Anew,
    /// Where an earlier run was saved.
    WhereSaved,
}

/// The folder of a training in its package.
pub fn training_folder(package: &Path, name: &str) -> PathBuf {
    package.join("training").join(name)
}

/// Trains a variant and adds it to its package.
///
/// The state is saved after each epoch, and in between as the configuration says; a run that goes
/// on from it gives the same numbers as one that was never interrupted. `stop` ends the run after
/// the scene at hand, with its state saved.
///
/// # Errors
///
/// [`TrainError`]: an old checkpoint and an old state stay as they were. While another run trains
/// the variant, or writes the package, that is [`DataError::InUse`](garnet_data::DataError::InUse).
#[expect(clippy::too_many_lines, reason = "a step after the other")]
pub fn train(
    job: &TrainJob,
    observer: &mut dyn FnMut(TrainEvent),
    stop: &AtomicBool,
) -> Result<Trained, TrainError> {
    job.config.validate()?;
    let folder = training_folder(&job.package, &job.recipe.name);
    GarmentPackage::read_manifest(&job.package)?;
    let _lock = GarmentPackage::lock_variant(&job.package, &job.recipe.name, &folder)?;
    check_begin(job, &folder)?;
    let stage = stage_of(job)?;
    if let Some(moment) = job.recipe.pose_space() {
        return pose_space::fit(job, moment, &stage, observer, stop);
    }
    let device = Device::flex().autodiff();
    let data = stage.dataset.manifest.fingerprint();
    let state = match job.begin {
        Begin::WhereSaved => Some(State::load(&folder, &device)?),
        Begin::Anew => None,
    };
    if let Some(state) = &state {
        check_same(&state.progress, job, data, &folder)?;
    }
    let base = match &state {
        Some(_) => None,
        None => base_of(job, &stage, &device)?,
    };
    let network = match (&state, &base) {
        (Some(state), _) => state.model.config().clone(),
        (None, Some(base)) => base.checkpoint.model.config().clone(),
        (None, None) => new_network(&job.config, &stage)?,
    };
    let mut context = TrainingContext::new(&stage, network, &job.config.loss)?;
    let start = pose_space::start_of(&job.package, &stage, &context.config)?;
    let start_name = start
        .as_ref()
        .map(|start| start.space.checksum().to_owned());
    if let Some(state) = &state
        && state.progress.pose_space != start_name
    {
        return Err(other_training(&folder, "pose-space deformation"));
    }
    let other = (base.as_ref()).filter(|base| base.checkpoint.pose_space != start_name);
    if let Some(other) = other {
        let base = other.path.display().to_string();
        return Err(TrainError::OtherStart { base });
    }
    let train = examples(&stage, &context, Split::Train, start.as_ref(), observer)?;
    if state.is_none() && base.is_none() && job.config.standardize {
        context.config.scaling = Some(scaling(&context, &train)?);
    }
    let state = if let Some(state) = state {
        state
    } else {
        let mut progress = Progress::new(&job.recipe.name, &job.config, data);
        progress.base = base.as_ref().map(|base| base.name.clone());
        let model = match base {
            Some(base) => base.checkpoint.model,
            None => context.config.init(job.config.seed, &device)?,
        };
        progress.pose_space = start_name;
        State::new(progress, model)
    };
    let valid = examples(&stage, &context, Split::Valid, start.as_ref(), observer)?;
    fs::create_dir_all(&folder).map_err(|source| TrainError::folder(&folder, source))?;
    let mut trainer = Trainer {
        stage: &stage,
        context: &context,
        mirror: job.config.mirror.then(|| SceneMirror::of(&stage)).flatten(),
        train,
        valid,
        device,
        garment: stage.template().graph.fingerprint(),
        log: RunLog::new(&folder),
        folder,
        state,
        skipped_in_a_row: 0,
    };
    trainer.begin(observer)?;
    trainer.run(observer, stop)?;
    let job = publish::Job {
        folder: &job.package,
        stage: &stage,
        context: &context,
        start: start.as_ref(),
        makes_default: job.makes_default,
    };
    let trained = publish::publish(&job, &trainer.state, &trainer.train, observer, stop)?;
    trainer.state.progress.is_finished = true;
    trainer.save()?;
    Ok(trained)
}

/// Package and data set, where the variant has a file of its own in the package.
fn stage_of(job: &TrainJob) -> Result<Stage, TrainError> {
    let package = GarmentPackage::read(&job.package)?;
    publish::check_free(&package.manifest, &job.recipe.name)?;
    Stage::open(&job.package, &job.dataset)
}

/// The network of a configuration, with what the data set decides.
fn new_network(config: &TrainConfig, stage: &Stage) -> Result<GarNetConfig, TrainError> {
    let mut network = config.network_config()?;
    if config.sewing_parameters {
        network.num_sewing_parameters = stage.num_sewing_parameters()?;
    }
    Ok(network)
}

/// Mean and spread of what a network is told of the scenes of the training.
fn scaling(context: &TrainingContext, train: &[Example]) -> Result<InputScaling, TrainError> {
    let mut sums = ScalingSums::default();
    for example in train.iter().step_by(train.len().div_ceil(SCALING_SCENES)) {
        sums.add(&context.prepared(example)?.scene);
    }
    Ok(sums.scaling())
}

/// Refuses to overwrite a training that is under way, and to go on with none.
fn check_begin(job: &TrainJob, folder: &Path) -> Result<(), TrainError> {
    if job.recipe.pose_space().is_none() {
        pose_space::check_no_more(&job.more, "a network")?;
    }
    let name = job.recipe.name.clone();
    match (State::progress(folder)?, job.begin) {
        (Some(progress), Begin::Anew) if !progress.is_finished => Err(TrainError::UnderWay {
            name,
            folder: folder.to_path_buf(),
            epoch: progress.epoch - 1,
        }),
        (None, Begin::WhereSaved) => Err(TrainError::NothingToResume {
            name,
            path: state_file(folder),
        }),
        _ => Ok(()),
    }
}

/// A state is gone on with only in the way in which it was begun.
fn check_same(
    progress: &Progress,
    job: &TrainJob,
    dataset: Fingerprint,
    folder: &Path,
) -> Result<(), TrainError> {
    if progress.name != job.recipe.name {
        return Err(other_training(folder, "name"));
    }
    if progress.dataset != dataset.to_string() {
        return Err(other_training(folder, "data set"));
    }
    if progress.config != job.config {
        return Err(other_training(folder, "configuration"));
    }
    Ok(())
}

fn other_training(folder: &Path, what: &'static str) -> TrainError {
    TrainError::OtherTraining {
        path: state_file(folder),
        what,
    }
}

/// Weights that are started from.
struct Base {
    checkpoint: Checkpoint,
    path: PathBuf,
    /// The name of the file and the checksum of what is in it: the same wherever the package is.
    name: String,
}

/// The weights that are fine-tuned.
fn base_of(job: &TrainJob, stage: &Stage, device: &Device) -> Result<Option<Base>, TrainError> {
    let path = match (&job.base, &job.recipe.fine_tuned) {
        (Some(path), _) => path.clone(),
        (None, Some((name, _))) => stage.package.manifest.weights_of(&job.package, name)?,
        (None, None) => return Ok(None),
    };
    let checkpoint = Checkpoint::load(&path, device)?;
    checkpoint.accepts(&stage.template().graph)?;
    let found = checkpoint.model.config().variant;
    if job.recipe.kind.is_some_and(|kind| kind != found) {
        return Err(TrainError::OtherKind {
            name: job.recipe.name.clone(),
            base: path.display().to_string(),
            found: kind_name(found),
        });
    }
    let file = path.file_name().unwrap_or_default().display();
    let name = format!("{file} {}", Checkpoint::header(&path)?.checksum);
    Ok(Some(Base {
        checkpoint,
        path,
        name,
    }))
}

/// A training under way.
struct Trainer<'a> {
    stage: &'a Stage,
    context: &'a TrainingContext,
    /// Shows every other scene, if there is one.
    mirror: Option<SceneMirror>,
    train: Vec<Example>,
    valid: Vec<Example>,
    device: Device,
    garment: Fingerprint,
    folder: PathBuf,
    log: RunLog,
    state: State,
    /// Scenes without a step since the last one with it.
    skipped_in_a_row: u32,
}

impl Trainer<'_> {
    /// Validates what there is before the first step, and tells what it starts from.
    fn begin(&mut self, observer: &mut dyn FnMut(TrainEvent)) -> Result<(), TrainError> {
        if self.state.progress.epochs.is_empty() {
            let found = validate(self.stage, self.context, self.state.judged(), &self.valid)?;
            self.state.progress.epochs.push(EpochRecord {
                epoch: 0,
                learning_rate: 0.0,
                loss: None,
                terms: BTreeMap::new(),
                skipped: 0,
                valid_loss: found.loss,
                valid: found.scores,
                is_best: true,
            });
        }
        let config = &self.context.config;
        let num_vertices = self.stage.package.mesh.num_vertices();
        let num_body_points = self.context.sampling.used().len();
        let cost = config.cost(num_vertices, num_body_points)?;
        let terms = self.first_terms()?;
        if self.state.progress.first_terms.is_empty() {
            self.state.progress.first_terms = terms.iter().map(FirstTerm::from).collect();
        }
        let began = Began {
            num_train: self.train.len(),
            num_valid: self.valid.len(),
            num_vertices,
            num_body_points,
            parameters: cost.parameters,
            flops: cost.flops,
            terms,
            past: self.state.progress.epochs.clone(),
        };
        self.log
            .begin(&self.state.progress, &self.context.config, &began)?;
        observer(TrainEvent::Began(began));
        Ok(())
    }

    /// The mean of each term over the first scenes, with the weights as they are.
    fn first_terms(&self) -> Result<Vec<LossValue>, TrainError> {
        let first = &self.train[..self.train.len().min(FIRST_SCENES)];
        let mut means: Vec<LossValue> = Vec::new();
        for example in first {
            let prepared = self.context.prepared(example)?;
            let output = self.state.model.forward(
                &example.graph,
                &self.context.sampling,
                &prepared.scene,
                &self.device,
            );
            let translations: Vec<f32> =
                (output.into_data().try_into_vec()).expect("networks compute in single precision");
            let predicted = prepared.scene.moved(&translations)?;
            let losses = &self.context.losses;
            let report = losses.measure(&predicted, &prepared.target, &prepared.body)?;
            if means.is_empty() {
                means = report
                    .values
                    .iter()
                    .map(|&value| LossValue {
                        value: 0.0,
                        ..value
                    })
                    .collect();
            }
            for (mean, value) in means.iter_mut().zip(&report.values) {
                mean.value += value.value / first.len() as f64;
            }
        }
        Ok(means)
    }

    /// Trains until all epochs are done or the patience is at its end.
    fn run(
        &mut self,
        observer: &mut dyn FnMut(TrainEvent),
        stop: &AtomicBool,
    ) -> Result<(), TrainError> {
        let config = self.state.progress.config.clone();
        while self.state.progress.epoch <= config.epochs && !self.has_no_patience() {
            self.epoch(&config, observer, stop)?;
        }
        Ok(())
    }

    fn has_no_patience(&self) -> bool {
        let progress = &self.state.progress;
        let patience = progress.config.patience;
        let best = progress.best().map_or(0, |best| best.epoch);
        patience > 0 && progress.epoch > best + patience
    }

    /// The scenes of an epoch in a random order that depends on seed and epoch alone, and whether
    /// each is seen as a mirror shows it.
    fn order(&self) -> Vec<(usize, bool)> {
        let progress = &self.state.progress;
        let mut random = ChaCha8Rng::seed_from_u64(progress.config.seed);
        random.set_stream(u64::from(progress.epoch));
        let mut order: Vec<usize> = (0..self.train.len()).collect();
        for last in (1..order.len()).rev() {
            order.swap(last, random.random_range(0..=last));
        }
        let mut is_mirrored = || self.mirror.is_some() && random.random_range(0..2) == 1;
        let seen = order.into_iter().map(|scene| (scene, is_mirrored()));
        seen.collect()
    }

    fn epoch(
        &mut self,
        config: &TrainConfig,
        observer: &mut dyn FnMut(TrainEvent),
        stop: &AtomicBool,
    ) -> Result<(), TrainError> {
        let order = self.order();
        let batch = config.accumulate as usize;
        let steps_an_epoch = order.len().div_ceil(batch) as u64;
        let num_steps = steps_an_epoch * u64::from(config.epochs);
        let rate = |step: u64| {
            config.learning_rate * config.schedule.share(step, num_steps, config.warm_up)
        };
        let mut since_saved = 0;
        while self.state.progress.scene < order.len() {
            let scenes = order[self.state.progress.scene..].iter().take(batch);
            let scenes: Vec<(usize, bool)> = scenes.copied().collect();
            let rate = rate(self.state.progress.step);
            self.step(&scenes, rate, observer)?;
            let progress = &mut self.state.progress;
            progress.scene += scenes.len();
            since_saved += scenes.len();
            let is_due = config.save_every > 0 && since_saved >= config.save_every as usize;
            let is_stopped = stop.load(Ordering::Relaxed);
            if is_due || is_stopped {
                self.save()?;
                since_saved = 0;
            }
            if is_stopped {
                return Err(TrainError::Stopped);
            }
        }
        // A run that goes on after the last step of an epoch has taken no step itself.
        self.finish_epoch(rate(self.state.progress.step - 1), observer)
    }

    /// One step of the optimizer on some scenes.
    fn step(
        &mut self,
        scenes: &[(usize, bool)],
        rate: f64,
        observer: &mut dyn FnMut(TrainEvent),
    ) -> Result<(), TrainError> {
        let mut sum = GradientsAccumulator::new();
        let mut is_empty = true;
        let share = 1.0 / scenes.len() as f32;
        let total = u64::from(self.state.progress.config.epochs) * self.train.len() as u64;
        let epoch = self.state.progress.epoch;
        for (number, &(scene, is_mirrored)) in scenes.iter().enumerate() {
            let own = &self.train[scene];
            let mirror = self.mirror.as_ref().filter(|_| is_mirrored);
            let image = mirror.map(|mirror| mirror.mirrored(own));
            let example = image.as_ref().unwrap_or(own);
            let model = &self.state.model;
            let sums = &mut self.state.progress.sums;
            let found = scene_gradients(self.context, example, model, &self.device, share)?;
            if let Some(known) = image.as_ref().and_then(|image| image.neighbors.get()) {
                own.mirrored_neighbors.get_or_init(|| known.clone());
            }
            match found {
                Ok(derived) => {
                    self.skipped_in_a_row = 0;
                    is_empty = false;
                    let loss = derived.report.total();
                    sums.count += 1;
                    sums.loss += loss;
                    for value in &derived.report.values {
                        *sums.terms.entry(value.term.name().to_owned()).or_default() += value.value;
                    }
                    sum.accumulate(model, derived.gradients);
                    let before = u64::from(epoch - 1) * self.train.len() as u64;
                    let done = before + (self.state.progress.scene + number + 1) as u64;
                    observer(TrainEvent::Scene {
                        epoch,
                        done,
                        total,
                        loss,
                    });
                }
                Err(trouble) => {
                    sums.skipped += 1;
                    self.skipped_in_a_row += 1;
                    if self.skipped_in_a_row >= MAX_SKIPPED {
                        return Err(TrainError::Diverged {
                            epoch,
                            trouble,
                            num_skipped: self.skipped_in_a_row,
                        });
                    }
                    observer(TrainEvent::Skipped(trouble));
                }
            }
        }
        if !is_empty {
            self.take_step(sum, rate);
        }
        self.state.progress.step += 1;
        Ok(())
    }

    fn take_step(&mut self, mut sum: GradientsAccumulator<GarNet>, rate: f64) {
        let max = self.state.progress.config.max_gradient;
        let mut gradients = sum.grads();
        if max > 0.0 {
            let norm = gradients::norm(&self.state.model, &gradients).unwrap_or(f64::INFINITY);
            if norm > max {
                gradients = gradients::scaled(&self.state.model, gradients, max / norm);
            }
        }
        let model = self.state.model.clone();
        self.state.model = self.state.optimizer.step(rate, model, gradients);
        let State {
            mean,
            model,
            progress,
            ..
        } = &mut self.state;
        if let Some(old) = mean.take() {
            let share = weights_mean::share(progress.config.mean_of_weights, progress.step);
            *mean = Some(weights_mean::moved(old, model, share));
        }
    }

    fn finish_epoch(
        &mut self,
        learning_rate: f64,
        observer: &mut dyn FnMut(TrainEvent),
    ) -> Result<(), TrainError> {
        let Validation { scores, loss } =
            validate(self.stage, self.context, self.state.judged(), &self.valid)?;
        let progress = &mut self.state.progress;
        let choice = progress.config.choose_by;
        let figure = |record: &EpochRecord| match choice {
            Choice::Distance => record.valid.distance,
            Choice::Loss => record.valid_loss,
        };
        let EpochSums {
            loss: sum,
            terms,
            count,
            skipped,
        } = std::mem::take(&mut progress.sums);
        let count = count.max(1) as f64;
        let mut record = EpochRecord {
            epoch: progress.epoch,
            learning_rate,
            loss: Some(sum / count),
            terms: terms
                .into_iter()
                .map(|(name, sum)| (name, sum / count))
                .collect(),
            skipped,
            valid_loss: loss,
            valid: scores,
            is_best: false,
        };
        record.is_best = progress
            .best()
            .is_none_or(|best| figure(&record) < figure(best));
        progress.epoch += 1;
        progress.scene = 0;
        progress.epochs.push(record.clone());
        if record.is_best {
            self.state.best = self.state.judged().clone();
        }
        self.save()?;
        self.log.epochs(&self.state.progress.epochs)?;
        observer(TrainEvent::Epoch(record));
        Ok(())
    }

    fn save(&self) -> Result<(), TrainError> {
        self.state.save(&self.folder, self.garment)
    }
}
