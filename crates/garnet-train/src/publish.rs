//! A trained network in its package.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use burn::tensor::Device;
use garnet_data::Split;
use garnet_drape::{GarmentPackage, Manifest, MeasuredCost, Package, Variant};
use garnet_mesh::vertex_distances;
use garnet_net::{Checkpoint, ModelHeader, Moment, Precision, TrainedRange};
use serde::Serialize;

use crate::bound_candidate::BoundCandidate;
use crate::context::{Example, TrainingContext};
use crate::evaluate::evaluate_until;
use crate::examples::examples;
use crate::pose_space::Beginning;
use crate::state::State;
use crate::validate::validate;
use crate::{
    Candidate, EpochRecord, EvalEvent, Finish, ScenesFound, Scores, Stage, StagedScene, TrainError,
    TrainEvent,
};

/// What a training has come to.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Trained {
    /// The variant.
    pub name: String,
    /// Its weights.
    pub weights: PathBuf,
    /// The epoch that was chosen by the validation; its scores are 0 if nothing was validated.
    pub best: EpochRecord,
    /// The scores on the validation split; none if the split is empty, which networks do not take.
    pub valid: Option<Scores>,
    /// Epochs that were done.
    pub epochs: u32,
    /// Epochs that were asked for: more, if the patience ended the training.
    pub epochs_asked: u32,
    /// The scores on the test split, without untangling; none if the split is empty.
    pub test: Option<Scores>,
    /// Whole drapes of the validation split, settled if drapes with the variant settle, if they
    /// were measured.
    pub valid_drapes: Option<DrapeScores>,
    /// Settled drapes of the test split, if they were measured.
    pub settled: Option<DrapeScores>,
    /// What the package drapes with if no variant is asked for, now.
    pub default: DefaultVariant,
}

/// The variant that drapes if none is asked for.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct DefaultVariant {
    /// Its name.
    pub name: String,
    /// Mean distance to the teacher on the validation split of what a drape with it gives, in
    /// metres, if that is known.
    pub valid_error: Option<f64>,
    /// Why it is the default.
    pub why: WhyDefault,
}

/// Why a variant is the default of its package.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum WhyDefault {
    /// It was asked for.
    Asked,
    /// It is the best on validation, of those whose error there is known.
    Best,
    /// It was the default, and how good it is on validation is not known.
    Unknown,
    /// It was the default, and no variant has a score on validation: all scenes fell back.
    NoScore,
}

/// How far whole drapes of a split are from the teacher's, before untangling.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct DrapeScores {
    /// Scenes.
    pub scenes: usize,
    /// Mean distance, in metres; of scenes that fell back, that of the fallback's drape.
    pub distance: f64,
    /// The same without scenes whose bodies are unlike the training; none if all are.
    pub familiar_distance: Option<f64>,
    /// Scenes that fell back.
    pub fallbacks: usize,
    /// Those of them whose bodies are unlike the training.
    pub unfamiliar: usize,
}

/// The file in a package that the weights of a variant are written to.
pub(crate) fn weights_file(name: &str) -> String {
    format!("{name}.safetensors")
}

/// Refuses a name that another variant had before, or whose weights would take the place of another
/// file of the package.
pub(crate) fn check_free(manifest: &Manifest, name: &str) -> Result<(), TrainError> {
    let is_older = |names: &[String]| names.iter().any(|known| known == name);
    let variants = &manifest.variants;
    if let Some(variant) = variants.iter().find(|variant| is_older(&variant.aliases))
        && variants.iter().all(|variant| variant.name != name)
    {
        return Err(TrainError::OlderName {
            name: name.to_owned(),
            variant: variant.name.clone(),
        });
    }
    let file = weights_file(name);
    let mut others = (manifest.variants.iter()).filter(|variant| variant.name != name);
    let is_taken = others.any(|variant| variant.weights == file)
        || manifest.rest_body.rig == file
        || GarmentPackage::file_names().contains(&file.as_str());
    if !is_taken {
        return Ok(());
    }
    Err(TrainError::Taken {
        name: name.to_owned(),
        file,
    })
}

/// Where a network goes, and what it is measured on.
pub(crate) struct Job<'a> {
    /// The package.
    pub(crate) folder: &'a Path,
    pub(crate) stage: &'a Stage,
    pub(crate) context: &'a TrainingContext,
    /// What the network starts from, if not from the warp alone.
    pub(crate) start: Option<&'a Beginning>,
    /// Whether it becomes the default, be it the best or not.
    pub(crate) makes_default: bool,
}

/// Measures the best model on the test split, writes its weights, and adds it to the manifest.
pub(crate) fn publish(
    job: &Job<'_>,
    state: &State,
    train: &[Example],
    observer: &mut dyn FnMut(TrainEvent),
    stop: &AtomicBool,
) -> Result<Trained, TrainError> {
    let Job {
        folder,
        stage,
        context,
        start,
        makes_default,
    } = *job;
    let progress = &state.progress;
    let best = progress.best().cloned();
    let best = best.expect("the record before the first epoch is the best at first");
    let file = weights_file(&progress.name);
    let weights = folder.join(&file);
    let mut checkpoint = Checkpoint {
        model: state.best.clone(),
        garment: stage.template().graph.fingerprint(),
        range: TrainedRange::of(train.iter().map(|example| &example.parameters)),
        pose_space: progress.pose_space.clone(),
        record: serde_json::json!({
            "variant": progress.name,
            "dataset": progress.dataset,
            "base": progress.base,
            "epochs": progress.epoch - 1,
            "best_epoch": best.epoch,
            "config": progress.config,
            "version": env!("CARGO_PKG_VERSION"),
        }),
        scores: BTreeMap::new(),
    };
    let precision = progress.config.precision;
    if precision != Precision::F32 {
        // What is tested are the weights that the file will have.
        let bytes = checkpoint.to_bytes(&weights, precision)?;
        checkpoint.model = Checkpoint::from_bytes(&weights, bytes, &Device::flex())?.model;
    }
    let test = match stage.num_scenes(Split::Test) {
        Ok(_) => {
            let examples = examples(stage, context, Split::Test, start, observer)?;
            Some(validate(stage, context, &checkpoint.model, &examples)?.scores)
        }
        Err(TrainError::EmptySplit { .. }) => None,
        Err(error) => return Err(error),
    };
    let mut scores = named("valid", &best.valid);
    if let Some(test) = &test {
        scores.extend(named("test", test));
    }
    checkpoint.scores = scores;
    checkpoint.save(&weights, precision)?;

    let cost = context.config.cost(
        stage.package.mesh.num_vertices(),
        context.sampling.used().len(),
    )?;
    let error = test.map(|test| test.distance);
    let variant = scored_variant(&progress.name, context.moment, error, cost.flops);
    let splits = HasSplits {
        valid: true,
        test: test.is_some(),
    };
    let drapes = add_variant(folder, stage, variant, splits, observer, stop)?;
    let default = choose_default(folder, makes_default.then_some(&progress.name))?;
    Ok(Trained {
        name: progress.name.clone(),
        weights,
        epochs: progress.epoch - 1,
        epochs_asked: progress.config.epochs,
        valid: Some(best.valid),
        best,
        test,
        valid_drapes: drapes.valid,
        settled: drapes.settled,
        default,
    })
}

/// A variant with its distance from the teacher on the test split, in metres, and the operations of
/// a forward pass.
pub(crate) fn scored_variant(
    name: &str,
    moment: Moment,
    test_error: Option<f64>,
    flops: u64,
) -> Variant {
    Variant {
        aliases: Vec::new(),
        seconds: None,
        settled_seconds: None,
        name: name.to_owned(),
        weights: weights_file(name),
        weights_of_sizes: None,
        default: false,
        // Where cloth is on its way is no drape.
        distance_error: test_error.filter(|_| moment.is_rest()),
        settled_error: None,
        settle_frames: None,
        valid_error: None,
        valid_scenes: None,
        expected: None,
        // Nothing says yet that it gains by that.
        settles: moment.is_rest().then_some(false),
        flop: Some(flops as f64),
    }
}

/// Makes a variant the default: the one that is asked for, or else the best on validation.
pub(crate) fn choose_default(
    folder: &Path,
    asked: Option<&String>,
) -> Result<DefaultVariant, TrainError> {
    let mut why = WhyDefault::Asked;
    let manifest = GarmentPackage::change_manifest(folder, |manifest| match asked {
        Some(name) => manifest.make_default(name),
        None if manifest.choose_default().is_some() => why = WhyDefault::Best,
        None if manifest
            .default_variant()
            .is_some_and(Variant::has_no_score) =>
        {
            why = WhyDefault::NoScore;
        }
        None => why = WhyDefault::Unknown,
    })?;
    let default = manifest.default_variant();
    Ok(DefaultVariant {
        name: default.map_or_else(String::new, |variant| variant.name.clone()),
        valid_error: default.and_then(|variant| variant.valid_error),
        why,
    })
}

/// Which splits have scenes, of those that models do not learn from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HasSplits {
    pub(crate) valid: bool,
    pub(crate) test: bool,
}

/// What whole drapes with a variant have come to.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Drapes {
    /// On the validation split, as the package drapes with it.
    pub(crate) valid: Option<DrapeScores>,
    /// On the test split, settled.
    pub(crate) settled: Option<DrapeScores>,
}

/// Adds a variant to the manifest of a package, and measures whole drapes with it: on the
/// validation split to choose whether they settle, and what the default is; on the test split,
/// settled, to report them.
///
/// That takes longer than all else but the training: the variant is in the manifest before it
/// begins. It is there without those numbers, too, if the garment cannot be simulated, or `stop`
/// ends that; the observer is told why.
pub(crate) fn add_variant(
    folder: &Path,
    stage: &Stage,
    mut variant: Variant,
    splits: HasSplits,
    observer: &mut dyn FnMut(TrainEvent),
    stop: &AtomicBool,
) -> Result<Drapes, TrainError> {
    let add = |variant: &Variant, cost: Option<&MeasuredCost>| {
        let variant = variant.clone();
        // Another training may have added a variant meanwhile.
        let changed = GarmentPackage::change_manifest(folder, |manifest| {
            let name = variant.name.clone();
            manifest.add(variant);
            if let Some(pattern) = &mut manifest.pattern {
                pattern.made_to_measure = stage.is_made_to_measure();
            }
            if let Some(cost) = cost {
                manifest.set_cost(&name, cost);
            }
        });
        changed.map(drop)
    };
    add(&variant, None)?;
    // Without it no budget of time chooses the variant.
    let cost = Package::open(folder).and_then(|package| package.measure(&variant.name));
    let cost = cost.ok();
    add(&variant, cost.as_ref())?;

    let weights = folder.join(&variant.weights);
    let moment = ModelHeader::read(&weights)?.moment;
    let frames = moment.settle_frames();
    let left = if moment.is_rest() && splits.valid {
        // What ends this ends settling, too, which tells why.
        drapes_of(stage, Split::Valid, &weights, 0, observer, stop).ok()
    } else {
        None
    };
    let mut has_failed = false;
    let mut settled = |split, is_there: bool| {
        if has_failed || !is_there {
            return None;
        }
        let found = drapes_of(stage, split, &weights, frames, observer, stop);
        found
            .inspect_err(|error| {
                has_failed = true;
                observer(TrainEvent::NotSettled {
                    why: error.to_string(),
                });
            })
            .ok()
    };
    let settled_valid = settled(Split::Valid, splits.valid);
    let settled_test = settled(Split::Test, splits.test);
    let settled_test = settled_test.map(|(scores, _)| scores);
    let error = |found: Option<&(DrapeScores, ScenesFound)>| {
        found.and_then(|(scores, _)| scores.familiar_distance)
    };
    let settles = match (error(settled_valid.as_ref()), error(left.as_ref())) {
        (Some(settled), Some(left)) => settled < left,
        _ => !moment.is_rest(),
    };
    variant.settle_frames = (settled_test.is_some() || settled_valid.is_some()).then_some(frames);
    let valid = if settles { settled_valid } else { left };
    variant.settles = moment.is_rest().then_some(settles);
    variant.valid_error = error(valid.as_ref());
    let (valid, scenes) = valid.unzip();
    variant.valid_scenes = valid.map(|valid| valid.scenes - valid.unfamiliar);
    variant.settled_error = settled_test.map(|test| test.distance);
    add(&variant, cost.as_ref())?;
    if let Some(scenes) = scenes {
        let name = &variant.name;
        GarmentPackage::change_manifest(folder, |manifest| scenes.store(manifest, name))?;
    }
    Ok(Drapes {
        valid,
        settled: settled_test,
    })
}

/// How far from the teacher drapes of weights are on a split, scene by scene, before untangling:
/// cloth settles for so many frames, or is left where they put it. `stop` ends it.
///
/// # Errors
///
/// Those of [`evaluate`](crate::evaluate), and [`TrainError::Stopped`].
pub fn scenes_found(
    stage: &Stage,
    split: Split,
    weights: &Path,
    settle: u32,
    stop: &AtomicBool,
) -> Result<ScenesFound, TrainError> {
    let candidate = Candidate::Model {
        name: String::new(),
        weights: weights.to_path_buf(),
        settle,
    };
    let mut candidate = BoundCandidate::new(stage, &candidate)?;
    let mut found = ScenesFound::default();
    stage.for_each(split, Ok, &mut |staged: StagedScene| {
        if stop.load(Ordering::Relaxed) {
            return Err(TrainError::Stopped);
        }
        candidate.drape(&staged, Finish::None, |draper, placed, _| {
            let positions = placed.positions(draper.garment());
            let distances = vertex_distances(&staged.draped, &positions)?;
            found.add(draper.garment(), &staged.posed, &distances);
            Ok(())
        })
    })?;
    Ok(found)
}

/// How far cloth is from the teacher's on a split once it has settled for so many frames where
/// weights put it.
fn drapes_of(
    stage: &Stage,
    split: Split,
    weights: &Path,
    frames: u32,
    observer: &mut dyn FnMut(TrainEvent),
    stop: &AtomicBool,
) -> Result<(DrapeScores, ScenesFound), TrainError> {
    let candidate = Candidate::Model {
        name: String::new(),
        weights: weights.to_path_buf(),
        settle: frames,
    };
    let mut tell = |event: EvalEvent| {
        let EvalEvent::Scene { done, total } = event;
        observer(TrainEvent::Settled { done, total });
    };
    let found = evaluate_until(stage, split, &[candidate], Finish::None, &mut tell, stop)?;
    let scenes = found.scenes;
    let row = found.rows.into_iter().next();
    let row = row.filter(|row| row.unsettled < scenes);
    let row = row.ok_or(TrainError::FliesApart { scenes })?;
    let scores = DrapeScores {
        scenes,
        distance: row.scores.distance,
        familiar_distance: row.familiar_distance,
        fallbacks: row.fallbacks,
        unfamiliar: row.unfamiliar,
    };
    Ok((scores, row.scenes_found))
}

/// Scores under the names that weight files keep them by.
pub(crate) fn named(split: &str, scores: &Scores) -> BTreeMap<String, f64> {
    let figures = [
        ("distance_m", scores.distance),
        ("distance_std_m", scores.distance_std),
        ("normal_rad", scores.normal),
        ("mean_curvature", scores.mean_curvature),
        ("rayleigh", scores.rayleigh),
        ("inside", scores.inside),
        ("stretch_p99", scores.stretch_p99),
    ];
    let name = |name: &str| format!("{split}.{name}");
    figures
        .into_iter()
        .map(|(figure, value)| (name(figure), value))
        .collect()
}
