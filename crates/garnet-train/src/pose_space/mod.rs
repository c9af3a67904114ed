//! Pose-space deformations: fitted to the drapes of a data set, and what networks start from.
//!
//! A fit takes seconds where a network takes hours. Offsets of the drapes from the warp are put
//! into few principal shapes; the share of each is interpolated between scenes by a Gaussian
//! process. How much each joint counts is found by leaving out the body and the sequence of poses
//! of each scene. Where left and right of body and garment are alike, each scene counts as its
//! mirror image, too. Or small networks tell the shares of the shapes of [regions](regions) of the
//! garment.

mod folds;
mod mirror;
mod offsets;
mod principal;
mod regions;
mod regression;
mod relevance;
mod scenes;
mod start;
mod starts;

pub(crate) use mirror::{GarmentMirror, images_on};
pub(crate) use start::{Beginning, start, start_of};

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use garnet_data::{Dataset, Split};
use garnet_net::pose_space::{PoseSpaceParts, deformation_name};
use garnet_net::{Moment, PoseSpace, Precision, Start, TrainedRange};
use serde::{Deserialize, Serialize};

use crate::context::{Example, TrainingContext};
use crate::examples::examples;
use crate::publish::{HasSplits, add_variant, choose_default, named, scored_variant, weights_file};
use crate::validate::{Validation, validate_drapes};
use crate::{
    EpochRecord, SceneName, Scores, Stage, TrainConfig, TrainError, TrainEvent, TrainJob, Trained,
    training_folder,
};
pub use folds::LeftOut;
use offsets::Offsets;
use regression::{Places, Regression};
use relevance::Relevance;
use scenes::{chosen, left_out_with};
use starts::Starts;

/// Scenes that differ in pose or shape are needed to tell what comes of that.
const LEAST_SCENES: usize = 2;

/// How a pose-space deformation is fitted.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PoseSpaceConfig {
    /// Principal shapes.
    pub shapes: u32,
    /// Scenes that it is fitted to at most; bodies are chosen evenly.
    pub scenes: u32,
    /// Scenes by which it is found out how much each joint counts, at most.
    pub searched: u32,
    /// Rounds of that search.
    pub rounds: u32,
    /// Whether each scene counts as its mirror image, too, if left and right of body and garment
    /// are alike.
    pub mirror: bool,
    /// What predicts the shares of the shapes.
    #[serde(alias = "told_by")]
    pub predictor: Predictor,
    /// Folds that are left out in turn to find out how `pose-space` would have predicted each scene
    /// of the training without them: networks that start from it learn from that. 0 for none.
    pub folds: u32,
    /// What the folds are of.
    pub left_out: LeftOut,
    /// Networks a region whose mean is distilled into one; 1 for none. Each takes as long as one.
    pub ensemble: u32,
    /// Principal shapes of each region that networks predict.
    pub region_shapes: u32,
    /// Scenes by which it is found out how much each feature counts in a region, at most.
    pub region_searched: u32,
    /// Whether such networks are told how the garment is cut: for scenes in several sizes.
    pub cuts: bool,
    /// Numbers of each layer in the middle of such a network.
    pub hidden: u32,
    /// Times that such a network sees each scene.
    pub passes: u32,
}

/// What predicts the shares of the shapes of a pose-space deformation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Predictor {
    /// The scenes that it was fitted to, by how alike they are.
    Scenes,
    /// A small network for each region of the garment.
    Networks,
}

impl Default for PoseSpaceConfig {
    fn default() -> Self {
        Self {
            shapes: 128,
            scenes: 4000,
            searched: 1000,
            rounds: 5,
            mirror: true,
            predictor: Predictor::Networks,
            folds: 3,
            left_out: LeftOut::Both,
            ensemble: 1,
            region_shapes: 80,
            region_searched: 1000,
            cuts: false,
            hidden: 384,
            passes: 80,
        }
    }
}

/// Most memory of the networks of a region, in bytes: as much as that of a network of GarNet.
const MOST_BYTES: f64 = 1.6e9;

/// Inputs of a network of a region, more than bodies have features.
const MOST_INPUTS: f64 = 512.0;

/// Numbers of four bytes that a training keeps for each weight: itself, its derivative, and the two
/// means of Adam.
const NUMBERS_A_WEIGHT: f64 = 4.0;

impl PoseSpaceConfig {
    /// Checks that memory has room for the networks of a region: an ensemble is kept until it is
    /// distilled.
    ///
    /// # Errors
    ///
    /// [`TrainError::Memory`].
    pub(crate) fn check_size(&self) -> Result<(), TrainError> {
        let [hidden, shapes, ensemble] =
            [self.hidden, self.region_shapes, self.ensemble].map(f64::from);
        let between = (regions::HIDDEN_LAYERS - 1) as f64;
        let weights = hidden * (MOST_INPUTS + between * hidden + shapes);
        let kept = if self.ensemble > 1 { ensemble } else { 0.0 };
        let found = 4.0 * weights * (NUMBERS_A_WEIGHT + kept);
        if found <= MOST_BYTES {
            return Ok(());
        }
        Err(TrainError::Memory {
            fields: format!(
                "`pose_space.hidden` of {}, `region_shapes` of {} and `ensemble` of {}",
                self.hidden, self.region_shapes, self.ensemble
            ),
            found: 1e-9 * found,
            most: 1e-9 * MOST_BYTES,
        })
    }
}

/// Fits a pose-space deformation and adds it to its package. Its scores are those of what it tells.
#[expect(clippy::too_many_lines, reason = "a step after the other")]
pub(crate) fn fit(
    job: &TrainJob,
    moment: Moment,
    stage: &Stage,
    observer: &mut dyn FnMut(TrainEvent),
    stop: &AtomicBool,
) -> Result<Trained, TrainError> {
    stage.check_moment(moment)?;
    let predictor = job.config.pose_space.predictor;
    check_more(job, stage, predictor)?;
    let name = &job.recipe.name;
    let mut network = job.config.network_config()?;
    network.start = Start::Shape;
    let mut context = TrainingContext::new(stage, network, &job.config.loss)?;
    context.moment = moment;
    let train = examples(stage, &context, Split::Train, None, observer)?;
    let mut left_out = Vec::new();
    let (mut space, num_train) = match predictor {
        Predictor::Scenes => {
            let count = train.len();
            check_enough(count)?;
            (fitted(&job.config, stage, &train, observer, stop)?, count)
        }
        Predictor::Networks => {
            let mut samples = regions::samples_of(0, &train);
            for (number, path) in (1..).zip(&job.more) {
                let more = Stage::open(&job.package, path)?;
                more.check_moment(moment)?;
                let more = examples(&more, &context, Split::Train, None, observer)?;
                samples.extend(regions::samples_of(number, &more));
            }
            check_enough(samples.len())?;
            let folds = match job.config.pose_space.folds {
                count if count > 0 && *name == deformation_name(Moment::Rest) => {
                    let left_out = job.config.pose_space.left_out;
                    folds::folds(&samples, count as usize, left_out)
                }
                _ => Vec::new(),
            };
            let space;
            (space, left_out) = of_regions(&job.config, stage, &samples, &folds, observer, stop)?;
            (space, samples.len())
        }
    };
    space.moment = moment;
    space.record = record(job, stage, &space, num_train)?;
    let file = weights_file(name);
    let path = job.package.join(&file);
    // What is measured are the numbers that the file will have.
    let bytes = space.to_bytes(&path, job.config.precision)?;
    let rounded = PoseSpace::from_bytes(&path, &bytes)?;
    let scenes: Vec<SceneName> = train.iter().map(|example| example.scene).collect();
    drop(train);
    let rounded = Beginning::of(rounded);
    let mut scored = |split: Split| match stage.num_scenes(split) {
        Ok(_) => {
            let started = examples(stage, &context, split, Some(&rounded), observer)?;
            let drape = &mut |example: &Example| Ok(example.warped.positions.clone());
            validate_drapes(stage, &context, drape, &started).map(Some)
        }
        Err(TrainError::EmptySplit { .. }) => Ok(None),
        Err(error) => Err(error),
    };
    let (valid, test) = (scored(Split::Valid)?, scored(Split::Test)?);
    let scores = |found: &Option<Validation>| found.as_ref().map(|found| found.scores);
    for (split, found) in [(Split::Valid, scores(&valid)), (Split::Test, scores(&test))] {
        let found = found.map(|found| named(split.name(), &found));
        space.scores.extend(found.unwrap_or_default());
    }
    space.save(&path, job.config.precision)?;
    let folder = training_folder(&job.package, name);
    Starts::of(&space, &scenes, &left_out).save(&folder)?;

    let test = scores(&test);
    let error = test.map(|test| test.distance);
    let variant = scored_variant(name, moment, error, space.cost().flops);
    let splits = HasSplits {
        valid: valid.is_some(),
        test: test.is_some(),
    };
    let drapes = add_variant(&job.package, stage, variant, splits, observer, stop)?;
    let default = choose_default(&job.package, job.makes_default.then_some(name))?;
    Ok(Trained {
        name: name.clone(),
        weights: path,
        valid: scores(&valid),
        best: best(valid),
        epochs: 0,
        epochs_asked: 0,
        test,
        valid_drapes: drapes.valid,
        settled: drapes.settled,
        default,
    })
}

/// Refuses further data sets for what cannot learn from them, which is `what`.
pub(crate) fn check_no_more(more: &[PathBuf], what: &'static str) -> Result<(), TrainError> {
    match more.first() {
        Some(path) => Err(TrainError::MoreScenes {
            path: path.clone(),
            what,
        }),
        None => Ok(()),
    }
}

/// Refuses further data sets that cannot be learned from, or are learned from already.
fn check_more(job: &TrainJob, stage: &Stage, predictor: Predictor) -> Result<(), TrainError> {
    if predictor == Predictor::Scenes {
        return check_no_more(&job.more, "a pose-space deformation that scenes tell");
    }
    let mut known = vec![stage.dataset.manifest.fingerprint()];
    for path in &job.more {
        let fingerprint = Dataset::open(path)?.manifest.fingerprint();
        if known.contains(&fingerprint) {
            return Err(TrainError::SameScenes { path: path.clone() });
        }
        known.push(fingerprint);
    }
    Ok(())
}

/// Refuses fewer scenes than a deformation can be told from: what all have in common tells nothing.
fn check_enough(found: usize) -> Result<(), TrainError> {
    if found >= LEAST_SCENES {
        return Ok(());
    }
    Err(TrainError::FewScenes {
        found,
        needed: LEAST_SCENES,
    })
}

/// The validation as a record.
fn best(valid: Option<Validation>) -> EpochRecord {
    EpochRecord {
        epoch: 0,
        learning_rate: 0.0,
        loss: None,
        terms: BTreeMap::new(),
        skipped: 0,
        valid_loss: valid.as_ref().map_or(0.0, |found| found.loss),
        valid: valid.map_or_else(Scores::default, |found| found.scores),
        is_best: true,
    }
}

fn record(
    job: &TrainJob,
    stage: &Stage,
    space: &PoseSpace,
    num_train: usize,
) -> Result<serde_json::Value, TrainError> {
    let more = job.more.iter().map(|path| {
        let dataset = Dataset::open(path)?;
        Ok(dataset.manifest.fingerprint().to_string())
    });
    let more: Vec<String> = more.collect::<Result<_, TrainError>>()?;
    Ok(serde_json::json!({
        "variant": job.recipe.name,
        "dataset": stage.dataset.manifest.fingerprint().to_string(),
        "more": more,
        "scenes": num_train,
        "config": job.config.pose_space,
        "precision": job.config.precision,
        "left_out_m": space.scores.get("left_out_m"),
        "version": env!("CARGO_PKG_VERSION"),
    }))
}

/// The deformation of the regions of the garment, and what [`regions::Fitted::left_out`] has.
fn of_regions(
    config: &TrainConfig,
    stage: &Stage,
    samples: &[regions::Sample],
    folds: &[folds::Fold],
    observer: &mut dyn FnMut(TrainEvent),
    stop: &AtomicBool,
) -> Result<(PoseSpace, Vec<Vec<f32>>), TrainError> {
    let (asked, seed) = (&config.pose_space, config.seed);
    let fitted = regions::fitted(asked, seed, stage, samples, folds, observer, stop)?;
    let range = TrainedRange::of(samples.iter().map(|sample| &sample.parameters));
    let range = range.ok_or(TrainError::EmptySplit {
        split: Split::Train,
    })?;
    let garment = stage.template().graph.fingerprint();
    let space = PoseSpace::of_regions(fitted.regions, garment, range)?;
    Ok((space, fitted.left_out))
}

/// Numbers as a file keeps them.
fn rounded(mut numbers: faer::Mat<f64>, precision: Precision) -> faer::Mat<f64> {
    for column in 0..numbers.ncols() {
        for row in 0..numbers.nrows() {
            let number = &mut numbers[(row, column)];
            *number = f64::from(precision.rounded(*number as f32));
        }
    }
    numbers
}

/// The deformation of the scenes that the configuration chooses.
fn fitted(
    config: &TrainConfig,
    stage: &Stage,
    train: &[Example],
    observer: &mut dyn FnMut(TrainEvent),
    stop: &AtomicBool,
) -> Result<PoseSpace, TrainError> {
    let asked = &config.pose_space;
    let used = chosen(train, asked.scenes as usize);
    let mirror = if asked.mirror {
        GarmentMirror::of(stage)
    } else {
        None
    };
    let mirror = mirror.as_ref();
    let offsets = Offsets::of(&used, mirror);
    let principal = principal::principal(&offsets, asked.shapes as usize);
    let mut relevance = Relevance::new(stage.package.body.skeleton());
    let searched = chosen(&used, asked.searched as usize);
    let mut round = |round, left_out| {
        observer(TrainEvent::Searched {
            round,
            rounds: asked.rounds,
            left_out,
        });
        round < asked.rounds && !stop.load(Ordering::Relaxed)
    };
    relevance.search(&searched, &used, &principal, mirror, &mut round);
    if stop.load(Ordering::Relaxed) {
        return Err(TrainError::Stopped);
    }
    let scales = relevance.scales(&used, mirror);
    // Fitted where the file will have the scenes: what is rounded there is made up for here.
    let Places { own, mirrored } = relevance::places(&used, &scales, mirror);
    let places = Places {
        own: rounded(own, config.precision),
        mirrored: mirrored.map(|mirrored| rounded(mirrored, config.precision)),
    };
    let (shares, parity) = (&principal.shares, &principal.parity);
    let (regression, ridge) = Regression::surely(&places, shares, parity, relevance.ridge());
    let left_out = regression.left_out(&left_out_with(&used));
    let numbers = |matrix: &faer::Mat<f64>| -> Vec<f32> {
        let rows = 0..matrix.nrows();
        rows.flat_map(|row| (0..matrix.ncols()).map(move |column| matrix[(row, column)] as f32))
            .collect()
    };
    let parts = PoseSpaceParts {
        scales,
        centers: numbers(&places.own),
        weights: numbers(regression.weights()),
        mean: offsets.mean,
        shapes: principal.shapes,
        mirror: mirror.map(|mirror| mirror.with_parity(principal.parity)),
    };
    let range = TrainedRange::of(train.iter().map(|example| &example.parameters));
    let range = range.ok_or(TrainError::EmptySplit {
        split: Split::Train,
    })?;
    let garment = stage.template().graph.fingerprint();
    let mut space = PoseSpace::new(parts, garment, range, ridge)?;
    let num_vertices = space.num_vertices().max(1) as f64;
    let error = relevance::mean_root(&left_out) / num_vertices.sqrt();
    space.scores.insert("left_out_m".to_owned(), error);
    Ok(space)
}
