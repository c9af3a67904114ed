//! A trained network in its package.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use burn::tensor::Device;
use garnet_data::Split;
use garnet_drape::{GarmentPackage, Manifest, MeasuredCost, Package, Variant};
use garnet_net::{Checkpoint, ModelHeader, Moment, PoseSpace, Precision, TrainedRange};

use crate::evaluate::evaluate_until;
use crate::examples::examples;
use crate::state::State;
use crate::subject::{Example, Subject};
use crate::validate::validate;
use crate::{Candidate, EpochRecord, EvalEvent, Finish, Scores, Stage, TrainError, TrainEvent};

/// What a training has come to.
#[derive(Debug, Clone, PartialEq)]
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
    /// Mean distance to the teacher on the test split once the cloth has settled, in metres, if
    /// that is known.
    pub settled_error: Option<f64>,
    /// What the package drapes with if no variant is asked for, now.
    pub default: DefaultVariant,
}

/// The variant that drapes if none is asked for.
#[derive(Debug, Clone, PartialEq)]
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
pub enum WhyDefault {
    /// It was asked for.
    Asked,
    /// It is the best on validation, of those whose error there is known.
    Best,
    /// It was the default, and how good it is on validation is not known.
    Unknown,
}

/// The file in a package that the weights of a variant are written to.
pub(crate) fn weights_file(name: &str) -> String {
    format!("{name}.safetensors")
}

/// Refuses a name whose weights would take the place of another file of the package.
pub(crate) fn check_free(manifest: &Manifest, name: &str) -> Result<(), TrainError> {
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
    pub(crate) subject: &'a Subject,
    /// What the network starts from, if not from the warp alone.
    pub(crate) start: Option<&'a PoseSpace>,
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
        subject,
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
            let examples = examples(stage, subject, Split::Test, start, observer)?;
            Some(validate(stage, subject, &checkpoint.model, &examples)?.scores)
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

    let cost = subject.config.cost(
        stage.package.mesh.num_vertices(),
        subject.sampling.used().len(),
    )?;
    let errors = [Some(best.valid.distance), test.map(|test| test.distance)];
    let variant = scored_variant(&progress.name, subject.moment, errors, cost.flops);
    let splits = HasSplits {
        valid: true,
        test: test.is_some(),
    };
    let settled_error = add_variant(folder, stage, variant, splits, observer, stop)?;
    let default = choose_default(folder, makes_default.then_some(&progress.name))?;
    Ok(Trained {
        name: progress.name.clone(),
        weights,
        epochs: progress.epoch - 1,
        epochs_asked: progress.config.epochs,
        valid: Some(best.valid),
        best,
        test,
        settled_error,
        default,
    })
}

/// A variant with its distances from the teacher on the validation and the test split, in metres,
/// and the operations of a forward pass.
pub(crate) fn scored_variant(
    name: &str,
    moment: Moment,
    errors: [Option<f64>; 2],
    flops: u64,
) -> Variant {
    // Where cloth is on its way is no drape.
    let [valid_error, distance_error] = errors.map(|error| error.filter(|_| moment.is_rest()));
    Variant {
        aliases: Vec::new(),
        seconds: None,
        settled_seconds: None,
        name: name.to_owned(),
        weights: weights_file(name),
        default: false,
        distance_error,
        settled_error: None,
        settle_frames: None,
        valid_error,
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

/// Adds a variant to the manifest of a package, and measures on the test split, if there is one,
/// how far from the teacher its cloth is once it has settled, in metres; the same on the validation
/// split, if its drapes settle.
///
/// That takes longer than all else but the training: the variant is in the manifest before it
/// begins. It is there without that number, too, if the garment cannot be simulated, or `stop` ends
/// that; the observer is told why.
pub(crate) fn add_variant(
    folder: &Path,
    stage: &Stage,
    mut variant: Variant,
    splits: HasSplits,
    observer: &mut dyn FnMut(TrainEvent),
    stop: &AtomicBool,
) -> Result<Option<f64>, TrainError> {
    let add = |variant: &Variant, cost: Option<&MeasuredCost>| {
        let variant = variant.clone();
        // Another training may have added a variant meanwhile.
        let changed = GarmentPackage::change_manifest(folder, |manifest| {
            let name = variant.name.clone();
            manifest.add(variant);
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
    if !splits.test {
        return Ok(None);
    }
    let weights = folder.join(&variant.weights);
    let mut settle = |split| match settled(stage, split, &weights, observer, stop) {
        Ok(found) => Some(found),
        Err(error) => {
            observer(TrainEvent::NotSettled {
                why: error.to_string(),
            });
            None
        }
    };
    let Some((error, frames)) = settle(Split::Test) else {
        return Ok(None);
    };
    variant.settled_error = Some(error);
    variant.settle_frames = Some(frames);
    let moment = ModelHeader::read(&weights)?.moment;
    if splits.valid && variant.settling(moment).frames > 0 {
        variant.valid_error = settle(Split::Valid).map(|(error, _)| error);
    }
    add(&variant, cost.as_ref())?;
    Ok(Some(error))
}

/// The mean distance to the teacher on a split, in metres, of cloth that has settled where weights
/// put it, and for how many frames it settles.
fn settled(
    stage: &Stage,
    split: Split,
    weights: &Path,
    observer: &mut dyn FnMut(TrainEvent),
    stop: &AtomicBool,
) -> Result<(f64, u32), TrainError> {
    let frames = ModelHeader::read(weights)?.moment.settle_frames();
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
    let row = found.rows.first();
    match row.filter(|row| row.unsettled < found.scenes) {
        Some(row) => Ok((row.scores.distance, frames)),
        None => Err(TrainError::FliesApart {
            scenes: found.scenes,
        }),
    }
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
