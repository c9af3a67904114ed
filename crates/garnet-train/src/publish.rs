//! A trained network in its package.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use burn::tensor::Device;
use garnet_data::{GarmentPackage, Manifest, Split, Variant};
use garnet_net::{Checkpoint, ModelHeader, PoseSpace, Precision, TrainedRange};

use crate::contender::put_of;
use crate::examples::examples;
use crate::state::State;
use crate::subject::{Example, Subject};
use crate::validate::validate;
use crate::{Candidate, EpochRecord, Finish, Scores, Stage, TrainError, TrainEvent, evaluate};

/// What a training has come to.
#[derive(Debug, Clone, PartialEq)]
pub struct Trained {
    /// The variant.
    pub name: String,
    /// Its weights.
    pub weights: PathBuf,
    /// The epoch that was chosen by the validation.
    pub best: EpochRecord,
    /// Epochs that were done.
    pub epochs: u32,
    /// Epochs that were asked for: more, if the patience ended the training.
    pub epochs_asked: u32,
    /// The scores on the test split, without untangling; none if the split is empty.
    pub test: Option<Scores>,
    /// Mean distance to the teacher on the test split once the cloth has settled, in metres, if that is known.
    pub settled_error: Option<f64>,
}

/// Where the weights of a variant are.
///
/// # Errors
///
/// [`TrainError::NoVariant`] with those that there are.
pub fn weights_of(folder: &Path, manifest: &Manifest, name: &str) -> Result<PathBuf, TrainError> {
    let mut variants = manifest.variants.iter();
    if let Some(variant) = variants.find(|variant| variant.name == name) {
        return Ok(folder.join(&variant.weights));
    }
    let names = manifest
        .variants
        .iter()
        .map(|variant| format!("`{}`", variant.name));
    let names: Vec<String> = names.collect();
    Err(TrainError::NoVariant {
        name: name.to_owned(),
        known: if names.is_empty() {
            "none".to_owned()
        } else {
            names.join(", ")
        },
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
}

/// Measures the best model on the test split, writes its weights, and adds it to the manifest.
pub(crate) fn publish(
    job: &Job<'_>,
    state: &State,
    train: &[Example],
    observer: &mut dyn FnMut(TrainEvent),
) -> Result<Trained, TrainError> {
    let Job {
        folder,
        stage,
        subject,
        start,
    } = *job;
    let progress = &state.progress;
    let best = progress.best().cloned();
    let best = best.expect("the record before the first epoch is the best at first");
    let file = format!("{}.safetensors", progress.name);
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

    // Another training may have added a variant meanwhile.
    let mut manifest = GarmentPackage::read_manifest(folder)?;
    let cost = subject.config.cost(
        stage.package.mesh.num_vertices(),
        subject.sampling.used().len(),
    )?;
    let settled = test.and_then(|_| settled_error(stage, &weights));
    manifest.add(Variant {
        name: progress.name.clone(),
        weights: file,
        default: false,
        // Where cloth arrives is no drape.
        distance_error: test
            .filter(|_| subject.aim.is_rest())
            .map(|test| test.distance),
        settled_error: settled.map(|settled| settled.error),
        settle_frames: settled.map(|settled| settled.frames),
        flop: Some(cost.flops as f64),
    });
    GarmentPackage::write_manifest(folder, &manifest)?;
    Ok(Trained {
        name: progress.name.clone(),
        weights,
        epochs: progress.epoch - 1,
        epochs_asked: progress.config.epochs,
        best,
        test,
        settled_error: settled.map(|settled| settled.error),
    })
}

/// What settling comes to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settled {
    /// Mean distance to the teacher on the test split, in metres.
    pub(crate) error: f64,
    /// For how many frames the cloth settles.
    pub(crate) frames: u32,
}

/// How far from the teacher cloth is once it has settled where weights put it; none of garments that cannot be
/// simulated, and none if it cannot be measured: the weights are worth publishing without it.
pub(crate) fn settled_error(stage: &Stage, weights: &Path) -> Option<Settled> {
    let aim = ModelHeader::read(weights).ok()?.aim;
    let frames = put_of(aim).frames();
    let candidate = Candidate::Model {
        name: String::new(),
        weights: weights.to_path_buf(),
        settle: frames,
    };
    let found = evaluate(stage, Split::Test, &[candidate], Finish::None, &mut |_| {});
    let found = found.ok()?;
    let row = found
        .rows
        .first()
        .filter(|row| row.unsettled < found.scenes);
    row.map(|row| Settled {
        error: row.scores.distance,
        frames,
    })
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
