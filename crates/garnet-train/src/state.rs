//! The saved state of a training: all that it takes to go on as if nothing had happened.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

use burn::module::{Module, ModuleVisitor, Param};
use burn::optim::{AdamConfig, AdamWConfig, ModuleOptimizer, OptimizerRecord};
use burn::store::RecordError;
use burn::tensor::{Bytes, Device, Tensor};
use burn_pack::{DType, Reader};
use garnet_mesh::{Fingerprint, MOST_BYTES, read_bounded, write_atomically};
use garnet_net::losses::LossValue;
use garnet_net::{Checkpoint, GarNet, Precision};
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensors};
use serde::{Deserialize, Serialize};

use crate::{EpochRecord, TrainConfig, TrainError};

/// What this version writes and reads.
const SCHEMA: &str = "garnet.training/1";

/// The metadata key of the JSON text.
const KEY: &str = "garnet";

/// How a text without its checksum says so.
const UNSIGNED: &str = r#""checksum":"""#;

/// The parts of a file: what the optimizer knows, and two weight files.
const PARTS: [&str; 3] = ["adam", "best", "model"];

/// One more weight file, where the mean of weights is taken.
const MEAN: &str = "mean";

/// Where a training is, apart from its numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Progress {
    pub(crate) schema: String,
    /// Checksum of this text without it, and of the parts of the file; empty in states of earlier
    /// versions.
    #[serde(default)]
    checksum: String,
    /// The variant that is trained.
    pub(crate) name: String,
    /// How.
    pub(crate) config: TrainConfig,
    /// Fingerprint of the data set.
    pub(crate) dataset: String,
    /// The weights that it started from, by the name of their file and their checksum; none for
    /// random ones.
    pub(crate) base: Option<String>,
    /// Checksum of the pose-space deformation that it starts from, if it starts from one.
    #[serde(default)]
    pub(crate) pose_space: Option<String>,
    /// The terms of the loss before the first step; none in states of earlier versions.
    #[serde(default)]
    pub(crate) first_terms: Vec<FirstTerm>,
    /// Steps of the optimizer that are done.
    pub(crate) step: u64,
    /// The epoch that is under way, from 1.
    pub(crate) epoch: u32,
    /// Scenes of it that are done.
    pub(crate) scene: usize,
    /// Sums over those scenes.
    pub(crate) sums: EpochSums,
    /// What is past; first that before the first epoch.
    pub(crate) epochs: Vec<EpochRecord>,
    /// Whether it came to its end.
    pub(crate) is_finished: bool,
}

/// A term of the loss over the first scenes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct FirstTerm {
    /// Its name.
    pub(crate) term: String,
    /// Its mean; none if it was not finite, for which JSON has no number.
    pub(crate) value: Option<f64>,
    /// Its weight.
    pub(crate) weight: f64,
}

impl From<&LossValue> for FirstTerm {
    fn from(found: &LossValue) -> Self {
        Self {
            term: found.term.name().to_owned(),
            value: Some(found.value).filter(|value| value.is_finite()),
            weight: found.weight,
        }
    }
}

/// Sums over the scenes of an epoch.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct EpochSums {
    /// Of the weighted loss.
    pub(crate) loss: f64,
    /// Of each term.
    pub(crate) terms: BTreeMap<String, f64>,
    /// Scenes that gave a step.
    pub(crate) count: usize,
    /// Scenes that gave none.
    pub(crate) skipped: u32,
}

/// A training as it is saved.
pub(crate) struct State {
    pub(crate) progress: Progress,
    pub(crate) model: GarNet,
    /// The best model so far.
    pub(crate) best: GarNet,
    pub(crate) optimizer: ModuleOptimizer,
    /// The mean of the weights over the steps, if it is taken.
    pub(crate) mean: Option<GarNet>,
}

/// The file of a state in the folder of a training.
pub(crate) fn state_file(folder: &Path) -> PathBuf {
    folder.join("state.safetensors")
}

impl State {
    /// Writes the file in one piece. Only whole steps are saved, so derivatives are never in it.
    pub(crate) fn save(&self, folder: &Path, garment: Fingerprint) -> Result<(), TrainError> {
        let path = state_file(folder);
        let unsound = |reason: String| TrainError::State {
            path: path.clone(),
            reason,
        };
        let weights = |model: &GarNet| {
            let checkpoint = Checkpoint {
                model: model.clone(),
                garment,
                range: None,
                pose_space: None,
                record: serde_json::Value::Null,
                scores: BTreeMap::new(),
            };
            checkpoint.to_bytes(&path, Precision::F32)
        };
        let (model, best) = (weights(&self.model)?, weights(&self.best)?);
        let adam = canonical(&self.optimizer);
        let adam = adam.map_err(|error| unsound(error.to_string()))?;
        let mean = self.mean.as_ref().map(weights).transpose()?;
        let mut parts: Vec<&[u8]> = vec![&adam, &best, &model];
        parts.extend(mean.as_deref());
        let mut views = Vec::new();
        for (name, &bytes) in PARTS.into_iter().chain([MEAN]).zip(&parts) {
            let view = TensorView::new(Dtype::U8, vec![bytes.len()], bytes);
            views.push((name, view.map_err(|error| unsound(error.to_string()))?));
        }
        let unsigned = Progress {
            checksum: String::new(),
            ..self.progress.clone()
        };
        let text = serde_json::to_string(&unsigned);
        let text = text.map_err(|error| unsound(error.to_string()))?;
        let text = text.replacen(UNSIGNED, &signed(checksum(&text, &parts)), 1);
        let bytes = safetensors::serialize(views, Some(HashMap::from([(KEY.to_owned(), text)])));
        let bytes = bytes.map_err(|error| unsound(error.to_string()))?;
        Ok(write_atomically(&path, |writer| writer.write_all(&bytes))?)
    }

    /// Reads the file onto a device.
    pub(crate) fn load(folder: &Path, device: &Device) -> Result<Self, TrainError> {
        let path = state_file(folder);
        let bytes = read(&path)?;
        let (progress, parts) = sound(&path, &bytes)?;
        let unsound = |reason: String| TrainError::State {
            path: path.clone(),
            reason,
        };
        let weights = |bytes: &[u8]| Checkpoint::from_bytes(&path, bytes.to_vec(), device);
        let (model, best) = (weights(parts[2])?.model, weights(parts[1])?.model);
        let mean = match parts.get(3) {
            Some(mean) => Some(weights(mean)?.model),
            None => None,
        };
        let all = [Some(&best), mean.as_ref()];
        if all
            .into_iter()
            .flatten()
            .any(|other| other.config() != model.config())
        {
            return Err(unsound("its networks differ".to_owned()));
        }
        if mean.is_some() != (progress.config.mean_of_weights > 0.0) {
            return Err(unsound(
                "it has no mean of weights, or one too many".to_owned(),
            ));
        }
        let optimizer = optimizer(&progress.config);
        Ok(Self {
            optimizer: optimizer_of(optimizer, &model, parts[0]).map_err(unsound)?,
            mean,
            progress,
            model,
            best,
        })
    }

    /// The network that is validated.
    pub(crate) fn judged(&self) -> &GarNet {
        self.mean.as_ref().unwrap_or(&self.model)
    }

    /// What a file tells of its progress, if there is one.
    pub(crate) fn progress(folder: &Path) -> Result<Option<Progress>, TrainError> {
        let path = state_file(folder);
        if !path.exists() {
            return Ok(None);
        }
        let bytes = read(&path)?;
        Ok(Some(sound(&path, &bytes)?.0))
    }

    /// The first state of a training from these weights.
    pub(crate) fn new(progress: Progress, model: GarNet) -> Self {
        Self {
            optimizer: optimizer(&progress.config),
            mean: (progress.config.mean_of_weights > 0.0).then(|| model.clone()),
            progress,
            best: model.clone(),
            model,
        }
    }
}

/// Adam (*Kingma and Ba 2015*), or where weights shrink AdamW (*Loshchilov and Hutter 2019*).
pub(crate) fn optimizer(config: &TrainConfig) -> ModuleOptimizer {
    let epsilon = config.epsilon as f32;
    if config.weight_decay > 0.0 {
        let optimizer = AdamWConfig::new().with_epsilon(epsilon);
        return optimizer
            .with_weight_decay(config.weight_decay as f32)
            .init();
    }
    AdamConfig::new().with_epsilon(epsilon).init()
}

/// What states of before said nothing of, as it was then.
fn completed(any: &mut serde_json::Value) {
    let Some(config) = any
        .get_mut("config")
        .and_then(serde_json::Value::as_object_mut)
    else {
        return;
    };
    if config.contains_key("weight_decay") {
        return;
    }
    let before = serde_json::json!({
        "weight_decay": 0.0,
        "epsilon": 1e-5,
        "mean_of_weights": 0.0,
        "mirror": false,
        "standardize": false,
    });
    config.extend(before.as_object().cloned().unwrap_or_default());
    let space = config.get_mut("pose_space");
    let space = space.and_then(serde_json::Value::as_object_mut);
    // The earlier name of `predictor`, in which null stood for the default.
    let is_null = |space: &&mut serde_json::Map<_, _>| {
        space.get("told_by").is_some_and(serde_json::Value::is_null)
    };
    if let Some(space) = space.filter(is_null) {
        space.remove("told_by");
    }
}

fn read(path: &Path) -> Result<Vec<u8>, TrainError> {
    read_bounded(path, MOST_BYTES).map_err(|source| TrainError::Read {
        path: path.to_path_buf(),
        source,
    })
}

/// What a file tells of its progress and its parts, if they are those that were written.
fn sound<'a>(path: &Path, bytes: &'a [u8]) -> Result<(Progress, Vec<&'a [u8]>), TrainError> {
    let unsound = |reason: String| TrainError::State {
        path: path.to_path_buf(),
        reason,
    };
    let (_, metadata) =
        SafeTensors::read_metadata(bytes).map_err(|error| unsound(error.to_string()))?;
    let text = metadata.metadata().as_ref().and_then(|map| map.get(KEY));
    let text = text.ok_or_else(|| unsound(format!("it has no `{KEY}` in its metadata")))?;
    let mut any: serde_json::Value =
        serde_json::from_str(text).map_err(|error| unsound(error.to_string()))?;
    let schema = any.get("schema").and_then(serde_json::Value::as_str);
    if schema != Some(SCHEMA) {
        let found = schema.unwrap_or("none");
        return Err(unsound(format!("its schema is `{found}`, not `{SCHEMA}`")));
    }
    completed(&mut any);
    let progress: Progress =
        serde_json::from_value(any).map_err(|error| unsound(error.to_string()))?;
    let tensors = SafeTensors::deserialize(bytes);
    let tensors = tensors.map_err(|error| unsound(error.to_string()))?;
    let mut parts = Vec::new();
    for name in PARTS {
        let view = tensors.tensor(name);
        parts.push(view.map_err(|error| unsound(error.to_string()))?.data());
    }
    parts.extend(tensors.tensor(MEAN).ok().map(|view| view.data()));
    if !progress.checksum.is_empty() {
        let found = checksum(
            &text.replacen(&signed(&progress.checksum), UNSIGNED, 1),
            &parts,
        );
        if found.to_string() != progress.checksum {
            let expected = &progress.checksum;
            let reason = format!("its checksum is {found}, and was {expected} when it was written");
            return Err(unsound(reason));
        }
    }
    if progress.epoch == 0 || (progress.scene > 0 && progress.step == 0) {
        return Err(unsound(
            "it says how far it is in no way that can be".to_owned(),
        ));
    }
    Ok((progress, parts))
}

/// How a text says its checksum.
fn signed(checksum: impl std::fmt::Display) -> String {
    format!(r#""checksum":"{checksum}""#)
}

/// Of the unsigned text and of the parts.
fn checksum(text: &str, parts: &[&[u8]]) -> Fingerprint {
    let sums = parts
        .iter()
        .map(|part| Fingerprint::of_bytes(part).to_string());
    Fingerprint::of_bytes((text.to_owned() + &sums.collect::<String>()).as_bytes())
}

/// The bytes of what an optimizer knows, weight by weight in the order of their names: the
/// optimizer itself has them in the order of a table that differs from run to run.
fn canonical(optimizer: &ModuleOptimizer) -> Result<Bytes, RecordError> {
    OptimizerRecord::from_bytes(optimizer.into_bytes()?)?.into_bytes()
}

/// The optimizer of a model, with what the bytes tell of its weights.
///
/// What is told of weights that the model does not have, or in another form, would be left out
/// without a word, or end the program.
fn optimizer_of(
    new: ModuleOptimizer,
    model: &GarNet,
    bytes: &[u8],
) -> Result<ModuleOptimizer, String> {
    let mut shapes = Shapes::default();
    model.visit(&mut shapes);
    let ours = || Bytes::from_bytes_vec(bytes.to_vec());
    let reader = Reader::from_bytes(ours()).map_err(|error| error.to_string())?;
    for name in reader.scalars().keys() {
        let number = name.split('.').next().and_then(|id| id.parse().ok());
        let shape = number.and_then(|number| shapes.0.get(&number));
        let Some(shape) = shape else {
            return Err(format!("`{name}` is of no weight of the network"));
        };
        let rank = usize::try_from(reader.scalars()[name]);
        if name.ends_with(RANK) && rank.ok() != Some(shape.len()) {
            return Err(format!("`{name}` is not that of its weight"));
        }
    }
    for tensor in reader.into_tensors().map_err(|error| error.to_string())? {
        let parts = tensor.into_parts().map_err(|error| error.to_string())?;
        let (name, dtype, shape, number, _) = parts;
        let is_named = number.is_some_and(|number| name.starts_with(&format!("{number}.")));
        let expected = number.and_then(|number| shapes.0.get(&number));
        if !is_named || dtype != DType::F32 || expected.is_none_or(|dims| dims[..] != shape[..]) {
            return Err(format!("`{name}` is of no weight of the network"));
        }
    }
    let optimizer = new.from_bytes(ours());
    let optimizer = optimizer.map_err(|error| error.to_string())?;
    let told = OptimizerRecord::from_bytes(ours()).and_then(OptimizerRecord::into_bytes);
    let told = told.map_err(|error| error.to_string())?;
    let kept = canonical(&optimizer).map_err(|error| error.to_string())?;
    if kept[..] != told[..] {
        return Err("what it tells of the optimizer is not complete".to_owned());
    }
    Ok(optimizer)
}

/// How the name ends of how many axes a weight has.
const RANK: &str = ".__rank";

/// The shape of each weight, by its number.
#[derive(Default)]
struct Shapes(BTreeMap<u64, Vec<usize>>);

impl ModuleVisitor for Shapes {
    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        self.0.insert(param.id.val(), param.dims().to_vec());
    }
}

impl Progress {
    /// Before the first step.
    pub(crate) fn new(name: &str, config: &TrainConfig, dataset: Fingerprint) -> Self {
        Self {
            schema: SCHEMA.to_owned(),
            checksum: String::new(),
            name: name.to_owned(),
            config: config.clone(),
            dataset: dataset.to_string(),
            base: None,
            pose_space: None,
            first_terms: Vec::new(),
            step: 0,
            epoch: 1,
            scene: 0,
            sums: EpochSums::default(),
            epochs: Vec::new(),
            is_finished: false,
        }
    }

    /// The best epoch so far.
    pub(crate) fn best(&self) -> Option<&EpochRecord> {
        self.epochs.iter().rfind(|epoch| epoch.is_best)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_of_before_are_gone_on_with() {
        let data = Fingerprint::of_bytes(b"data");
        let progress = Progress::new("local", &TrainConfig::default(), data);
        let mut before = serde_json::to_value(&progress).unwrap();
        for field in ["first_terms", "checksum"] {
            before.as_object_mut().unwrap().remove(field);
        }
        let found: Progress = serde_json::from_value(before.clone()).unwrap();
        assert_eq!(found, progress);
        // They were trained as was usual then.
        let config = before["config"].as_object_mut().unwrap();
        for field in [
            "weight_decay",
            "epsilon",
            "mean_of_weights",
            "mirror",
            "standardize",
        ] {
            config.remove(field).unwrap();
        }
        let space = config["pose_space"].as_object_mut().unwrap();
        space.remove("predictor").unwrap();
        space.insert("told_by".to_owned(), serde_json::Value::Null);
        completed(&mut before);
        let found: Progress = serde_json::from_value(before).unwrap();
        let config = found.config;
        let usual = (config.weight_decay, config.epsilon, config.mean_of_weights);
        assert_eq!(usual, (0.0, 1e-5, 0.0));
        assert!(!config.mirror && !config.standardize);
    }
}
