//! What was measured so far: `samples.json`, from which a run goes on.

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use garnet::train::{
    SceneName, Stage,
    chart::{NetworkCost, Sample},
};
use serde::{Deserialize, Serialize};

use super::ChartArgs;
use crate::{failure::refused, input, machine, output};

const SCHEMA: &str = "garnet.chart-samples/1";

/// Between two writes while samples come fast.
const BETWEEN_WRITES: Duration = Duration::from_secs(5);

/// All samples, with what they were measured on; what earlier versions kept beside them is passed
/// over.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Record {
    schema: String,
    pub(super) setting: Setting,
    pub(super) methods: Vec<MethodRecord>,
    /// How far drapes of the teacher move, by scene.
    pub(super) noise: Vec<NoiseRecord>,
}

/// What all samples have in common; SI units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Setting {
    pub(super) version: String,
    pub(super) machine: String,
    pub(super) threads: usize,
    pub(super) garment: String,
    pub(super) template: String,
    pub(super) dataset: String,
    pub(super) clearance: f32,
    pub(super) repeat: usize,
}

/// What samples of a way to drape belong together by.
#[derive(Debug, Clone, Copy)]
pub(super) struct Key<'a> {
    pub(super) name: &'a str,
    /// Checksum of the weights of a network.
    pub(super) weights: Option<&'a str>,
    /// For how many frames the cloth settles.
    pub(super) settle_frames: u32,
}

/// The samples of a way to drape.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MethodRecord {
    pub(super) name: String,
    /// Checksum of the weights of a network.
    pub(super) weights: Option<String>,
    /// For how many frames the cloth settled; earlier versions did not say.
    #[serde(default)]
    pub(super) settle_frames: Option<u32>,
    pub(super) cost: Option<NetworkCost>,
    /// The most memory of a process that drapes once, in bytes.
    pub(super) peak_bytes: Option<u64>,
    pub(super) samples: Vec<Sample>,
    /// Scenes on which a simulation came to no end.
    pub(super) failed: Vec<FailedScene>,
}

/// A scene on which a simulation came to no end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FailedScene {
    pub(super) body: u32,
    pub(super) pose: u32,
    pub(super) reason: String,
}

/// How far a drape of the teacher moves on a scene; none if it came to no end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct NoiseRecord {
    pub(super) body: u32,
    pub(super) pose: u32,
    pub(super) distance: Option<f64>,
}

impl FailedScene {
    fn is_of(&self, scene: SceneName) -> bool {
        (self.body, self.pose) == (scene.body, scene.pose)
    }
}

impl NoiseRecord {
    pub(super) fn is_of(&self, scene: SceneName) -> bool {
        (self.body, self.pose) == (scene.body, scene.pose)
    }
}

impl Setting {
    pub(super) fn new(args: &ChartArgs, stage: &Stage) -> Self {
        let manifest = &stage.package.manifest;
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            machine: machine::description(),
            threads: rayon::current_num_threads(),
            garment: manifest.fingerprint.clone(),
            template: manifest.positions.clone(),
            dataset: stage.dataset.manifest.fingerprint().to_string(),
            clearance: args.untangle().clearance,
            repeat: args.repeat,
        }
    }

    /// What is not as it was.
    fn difference(&self, other: &Self) -> Option<&'static str> {
        let pairs = [
            ("version", self.version == other.version),
            ("machine", self.machine == other.machine),
            ("number of threads", self.threads == other.threads),
            ("garment", self.garment == other.garment),
            ("template", self.template == other.template),
            ("data set", self.dataset == other.dataset),
            (
                "clearance",
                self.clearance.to_bits() == other.clearance.to_bits(),
            ),
            ("number of repeats", self.repeat == other.repeat),
        ];
        pairs
            .into_iter()
            .find(|(_, same)| !same)
            .map(|(what, _)| what)
    }
}

impl Record {
    fn new(setting: Setting) -> Self {
        Self {
            schema: SCHEMA.to_owned(),
            setting,
            methods: Vec::new(),
            noise: Vec::new(),
        }
    }

    /// The record of a way to drape; a new one if there is none, or of other weights or frames.
    pub(super) fn method(&mut self, key: Key<'_>) -> &mut MethodRecord {
        let Key {
            name,
            weights,
            settle_frames,
        } = key;
        let place = self.methods.iter().position(|method| method.name == name);
        let place = place.unwrap_or_else(|| {
            self.methods.push(MethodRecord::default());
            self.methods.len() - 1
        });
        let method = &mut self.methods[place];
        let settled = method.settle_frames.unwrap_or(settle_frames);
        if method.name != name || method.weights.as_deref() != weights || settled != settle_frames {
            *method = MethodRecord {
                name: name.to_owned(),
                weights: weights.map(str::to_owned),
                ..MethodRecord::default()
            };
        }
        method.settle_frames = Some(settle_frames);
        method
    }

    /// The record of a way to drape.
    pub(super) fn find(&self, name: &str) -> Option<&MethodRecord> {
        self.methods.iter().find(|method| method.name == name)
    }
}

impl MethodRecord {
    /// Whether a scene is measured, or known to come to no end.
    pub(super) fn has(&self, scene: SceneName) -> bool {
        let has_failed = self.failed.iter().any(|failed| failed.is_of(scene));
        has_failed || self.samples.iter().any(|sample| sample.is_of(scene))
    }

    /// The samples of some scenes.
    pub(super) fn of<'a>(&'a self, scenes: &'a [SceneName]) -> impl Iterator<Item = &'a Sample> {
        let is_chosen = |sample: &&Sample| scenes.iter().any(|&scene| sample.is_of(scene));
        self.samples.iter().filter(is_chosen)
    }
}

/// A record and its file.
pub(super) struct Keeper {
    pub(super) record: Record,
    path: PathBuf,
    last: Instant,
}

impl Keeper {
    /// The record in a folder, or a new one; samples that cannot be gone on with are refused, since
    /// they may have taken hours.
    pub(super) fn open(args: &ChartArgs, setting: Setting) -> anyhow::Result<Self> {
        let path = args.output.join("samples.json");
        let found = if args.fresh {
            Found::Nothing
        } else {
            read(&path)?
        };
        let problem = match &found {
            Found::Nothing => None,
            Found::Damaged => Some("it is damaged or of another version".to_owned()),
            Found::Record(found) => (found.setting.difference(&setting))
                .map(|what| format!("it was measured with another {what}")),
        };
        if let Some(problem) = problem {
            return Err(refused(
                format!("cannot go on from `{}`", path.display()),
                problem,
                "`--fresh` measures all anew, in place of what is there; `-o` takes another folder",
            ));
        }
        let record = match found {
            Found::Record(record) => *record,
            _ => Record::new(setting),
        };
        Ok(Self {
            record,
            path,
            last: Instant::now(),
        })
    }

    /// Writes the record.
    pub(super) fn write(&mut self) -> anyhow::Result<()> {
        self.last = Instant::now();
        let mut text = serde_json::to_string(&self.record)?;
        text.push('\n');
        output::write(&self.path, text.as_bytes())
    }

    /// Writes the record if the last time is some seconds ago.
    pub(super) fn write_now_and_then(&mut self) -> anyhow::Result<()> {
        if self.last.elapsed() < BETWEEN_WRITES {
            return Ok(());
        }
        self.write()
    }
}

/// What is in place of a record.
enum Found {
    Nothing,
    Damaged,
    Record(Box<Record>),
}

fn read(path: &Path) -> anyhow::Result<Found> {
    if !path.exists() {
        return Ok(Found::Nothing);
    }
    let text = input::bytes(path)?;
    let record: Option<Record> = serde_json::from_slice(&text).ok();
    let record = record.filter(|record| record.schema == SCHEMA);
    Ok(record.map_or(Found::Damaged, |record| Found::Record(Box::new(record))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_of_other_weights_or_frames_are_not_gone_on_with() {
        let setting = Setting {
            version: String::new(),
            machine: String::new(),
            threads: 1,
            garment: String::new(),
            template: String::new(),
            dataset: String::new(),
            clearance: 0.0,
            repeat: 1,
        };
        let mut record = Record::new(setting);
        let key = Key {
            name: "net settled",
            weights: Some("a"),
            settle_frames: 6,
        };
        let measured = |record: &mut Record, key| record.method(key).peak_bytes.is_some();
        record.method(key).peak_bytes = Some(1);
        assert!(measured(&mut record, key));
        // Earlier versions did not say for how long cloth settled.
        record.methods[0].settle_frames = None;
        assert!(measured(&mut record, key));
        let longer = Key {
            settle_frames: 12,
            ..key
        };
        assert!(!measured(&mut record, longer));
        record.method(longer).peak_bytes = Some(1);
        let other = Key {
            weights: Some("b"),
            ..longer
        };
        assert!(!measured(&mut record, other));
        assert_eq!(record.methods.len(), 1);
    }
}
