//! The saved state of a training: all that it takes to go on as if nothing had happened.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

use burn::optim::{AdamConfig, ModuleOptimizer};
use burn::tensor::{Bytes, Device};
use garnet_mesh::{Fingerprint, write_atomically};
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

/// Where a training is, apart from its numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Progress {
    pub(crate) schema: String,
    /// The variant that is trained.
    pub(crate) name: String,
    /// How.
    pub(crate) config: TrainConfig,
    /// Fingerprint of the data set.
    pub(crate) dataset: String,
    /// The weights that it started from; none for random ones.
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
        let adam = self.optimizer.into_bytes();
        let adam = adam.map_err(|error| unsound(error.to_string()))?;
        let mut views = Vec::new();
        for (name, bytes) in [("adam", &adam[..]), ("best", &best), ("model", &model)] {
            let view = TensorView::new(Dtype::U8, vec![bytes.len()], bytes);
            views.push((name, view.map_err(|error| unsound(error.to_string()))?));
        }
        let text = serde_json::to_string(&self.progress);
        let text = text.map_err(|error| unsound(error.to_string()))?;
        let bytes = safetensors::serialize(views, Some(HashMap::from([(KEY.to_owned(), text)])));
        let bytes = bytes.map_err(|error| unsound(error.to_string()))?;
        Ok(write_atomically(&path, |writer| writer.write_all(&bytes))?)
    }

    /// Reads the file onto a device.
    pub(crate) fn load(folder: &Path, device: &Device) -> Result<Self, TrainError> {
        let path = state_file(folder);
        let bytes = read(&path)?;
        let progress = parse(&path, &bytes)?;
        let unsound = |reason: String| TrainError::State {
            path: path.clone(),
            reason,
        };
        let tensors = SafeTensors::deserialize(&bytes);
        let tensors = tensors.map_err(|error| unsound(error.to_string()))?;
        let part = |name: &str| {
            let view = tensors
                .tensor(name)
                .map_err(|error| unsound(error.to_string()))?;
            Ok::<_, TrainError>(view.data().to_vec())
        };
        let model = Checkpoint::from_bytes(&path, part("model")?, device)?.model;
        let best = Checkpoint::from_bytes(&path, part("best")?, device)?.model;
        let adam = adam().from_bytes(Bytes::from_bytes_vec(part("adam")?));
        Ok(Self {
            progress,
            model,
            best,
            optimizer: adam.map_err(|error| unsound(error.to_string()))?,
        })
    }

    /// What a file tells of its progress, if there is one.
    pub(crate) fn progress(folder: &Path) -> Result<Option<Progress>, TrainError> {
        let path = state_file(folder);
        if !path.exists() {
            return Ok(None);
        }
        parse(&path, &read(&path)?).map(Some)
    }

    /// The first state of a training from these weights.
    pub(crate) fn new(progress: Progress, model: GarNet) -> Self {
        Self {
            progress,
            best: model.clone(),
            model,
            optimizer: adam(),
        }
    }
}

/// Adam with the constants of its authors (*Kingma and Ba 2015*).
fn adam() -> ModuleOptimizer {
    AdamConfig::new().init()
}

fn read(path: &Path) -> Result<Vec<u8>, TrainError> {
    std::fs::read(path).map_err(|source| TrainError::Read {
        path: path.to_path_buf(),
        source,
    })
}

fn parse(path: &Path, bytes: &[u8]) -> Result<Progress, TrainError> {
    let unsound = |reason: String| TrainError::State {
        path: path.to_path_buf(),
        reason,
    };
    let (_, metadata) =
        SafeTensors::read_metadata(bytes).map_err(|error| unsound(error.to_string()))?;
    let text = metadata.metadata().as_ref().and_then(|map| map.get(KEY));
    let text = text.ok_or_else(|| unsound(format!("it has no `{KEY}` in its metadata")))?;
    let any: serde_json::Value =
        serde_json::from_str(text).map_err(|error| unsound(error.to_string()))?;
    let schema = any.get("schema").and_then(serde_json::Value::as_str);
    if schema != Some(SCHEMA) {
        let found = schema.unwrap_or("none");
        return Err(unsound(format!("its schema is `{found}`, not `{SCHEMA}`")));
    }
    serde_json::from_value(any).map_err(|error| unsound(error.to_string()))
}

impl Progress {
    /// Before the first step.
    pub(crate) fn new(name: &str, config: &TrainConfig, dataset: Fingerprint) -> Self {
        Self {
            schema: SCHEMA.to_owned(),
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
        before.as_object_mut().unwrap().remove("first_terms");
        let found: Progress = serde_json::from_value(before).unwrap();
        assert_eq!(found, progress);
    }
}
