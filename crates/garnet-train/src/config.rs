//! How a network is trained: the file that `garnet train --config` reads.

use std::io;
use std::path::Path;

use garnet_drape::toml_problem;
use garnet_mesh::read_bounded;
use garnet_net::losses::LossConfig;
use garnet_net::{GarNetConfig, Precision, Variant};
use serde::{Deserialize, Serialize};

use crate::{PoseSpaceConfig, Schedule, TrainError};

/// How a network is trained; a TOML file may name any of the fields.
///
/// ```
/// use garnet_train::TrainConfig;
///
/// let config = TrainConfig::parse("epochs = 20\n[loss]\nnormal = 0.0\n[network.garment]\nheads = 4")?;
/// assert_eq!(config.epochs, 20);
/// assert_eq!(config.learning_rate, 3e-3);
/// assert_eq!(config.network_config()?.garment.heads, 4);
/// # Ok::<(), garnet_train::TrainError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TrainConfig {
    /// The named configuration that the network starts from.
    pub preset: String,
    /// Which parts the network has.
    pub kind: Variant,
    /// Whether vertices are told the sewing parameters of their garment.
    pub sewing_parameters: bool,
    /// Times that each scene is seen.
    pub epochs: u32,
    /// Scenes whose derivatives are summed up into one step.
    pub accumulate: u32,
    /// Weights shrink by the learning rate times this in each step (*Loshchilov and Hutter 2019*);
    /// 0 for none.
    pub weight_decay: f64,
    /// Added to the root of the mean square of derivatives that Adam divides by.
    pub epsilon: f64,
    /// The share of the past in the mean of weights over the steps, which is what is validated and
    /// published; 0 takes the weights of the last step.
    pub mean_of_weights: f64,
    /// Whether every other scene is seen as a mirror shows it, if left and right of body and
    /// garment are alike.
    pub mirror: bool,
    /// Whether pose, shape, and what vertices bring along are told by how many spreads they are
    /// from their mean.
    pub standardize: bool,
    /// Learning rate of Adam: more learns faster, as long as it rises slowly and derivatives are
    /// bounded. The paper's is 1e-3. Tried: 1e-3 and 3e-3 (docs/experiments/006-learning-rates.md).
    pub learning_rate: f64,
    /// How it changes over the steps.
    pub schedule: Schedule,
    /// Steps in which it rises from zero.
    pub warm_up: u32,
    /// Longest derivative of a step, in its norm over all weights; longer ones are shortened. 0 for
    /// no bound.
    pub max_gradient: f64,
    /// What the best epoch is chosen by, on the validation split.
    pub choose_by: Choice,
    /// Stop after so many epochs without a better validation; 0 never stops.
    pub patience: u32,
    /// Scenes between two saved states, besides that after each epoch; 0 for none.
    pub save_every: u32,
    /// How the weights in the package are stored; the state of the training keeps all their bits.
    pub precision: Precision,
    /// The seed of first weights and of the order of scenes.
    pub seed: u64,
    /// Weights and constants of the losses.
    pub loss: LossConfig,
    /// How a pose-space deformation is fitted; networks do not ask for it.
    pub pose_space: PoseSpaceConfig,
    /// What differs from the preset, in the form of a network's configuration.
    pub network: toml::Table,
}

/// A deformation is fitted as often as the square of this, at most.
const MOST_FOLDS: f64 = 16.0;

/// The preset that is trained as the paper has it.
const PAPER: &str = "paper";

/// A number of a configuration, and the range that it has to be in.
struct Number {
    field: &'static str,
    value: f64,
    min: f64,
    max: f64,
}

impl Number {
    fn check(&self, value: f64) -> Result<(), TrainError> {
        let &Self {
            field, min, max, ..
        } = self;
        if (min..=max).contains(&value) {
            return Ok(());
        }
        Err(TrainError::Config {
            field,
            value,
            min,
            max,
        })
    }
}

/// What the best epoch is chosen by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Choice {
    /// The mean distance of vertices.
    Distance,
    /// The weighted loss: where other terms are what a network is trained for.
    Loss,
}

impl Default for TrainConfig {
    fn default() -> Self {
        Self {
            preset: "small".to_owned(),
            kind: Variant::Local,
            sewing_parameters: false,
            epochs: 100,
            accumulate: 1,
            weight_decay: 0.01,
            epsilon: 1e-8,
            mean_of_weights: 0.999,
            mirror: true,
            standardize: true,
            learning_rate: 3e-3,
            schedule: Schedule::Cosine,
            warm_up: 500,
            max_gradient: 1.0,
            choose_by: Choice::Distance,
            patience: 0,
            save_every: 500,
            precision: Precision::F32,
            seed: 1,
            loss: LossConfig::nearer(),
            pose_space: PoseSpaceConfig::default(),
            network: toml::Table::new(),
        }
    }
}

impl TrainConfig {
    /// The usual way, or for the preset `paper` that of the paper: Adam of a constant rate, scene
    /// by scene, with its losses. What it does not tell is as its authors' library has it.
    pub fn of_preset(name: &str) -> Self {
        let usual = Self {
            preset: name.to_owned(),
            ..Self::default()
        };
        if name != PAPER {
            return usual;
        }
        Self {
            accumulate: 1,
            weight_decay: 0.0,
            mean_of_weights: 0.0,
            mirror: false,
            standardize: false,
            learning_rate: 1e-3,
            schedule: Schedule::Constant,
            warm_up: 0,
            max_gradient: 0.0,
            loss: LossConfig::paper(),
            ..usual
        }
    }

    /// Reads a TOML file and checks what is in it.
    ///
    /// # Errors
    ///
    /// [`TrainError::Read`], or [`TrainError::ConfigText`] with the line or the field.
    pub fn read(path: &Path) -> Result<Self, TrainError> {
        let text = text_of(path)?;
        let config = Self::parse(&text).and_then(|config| config.validate().map(|()| config));
        config.map_err(|error| TrainError::ConfigText {
            path: Some(path.to_path_buf()),
            reason: match error {
                TrainError::ConfigText { reason, .. } => reason,
                other => other.to_string(),
            },
        })
    }

    /// The kind of network that a TOML file names; none if it leaves that to the name of the
    /// variant.
    ///
    /// # Errors
    ///
    /// As [`TrainConfig::read`].
    pub fn kind_in(path: &Path) -> Result<Option<Variant>, TrainError> {
        let config = Self::read(path)?;
        let table: toml::Table =
            toml::from_str(&text_of(path)?).map_err(|source| TrainError::ConfigText {
                path: Some(path.to_path_buf()),
                reason: source.to_string(),
            })?;
        Ok(table.contains_key("kind").then_some(config.kind))
    }

    /// Reads the text of a TOML file.
    ///
    /// # Errors
    ///
    /// [`TrainError::ConfigText`] with the line, or [`TrainError::Config`] for a number that its
    /// field cannot hold.
    pub fn parse(text: &str) -> Result<Self, TrainError> {
        let wrong = |source: &toml::de::Error| {
            Self::out_of_range(text).unwrap_or_else(|| TrainError::ConfigText {
                path: None,
                reason: toml_problem(text, source),
            })
        };
        let alone: Self = toml::from_str(text).map_err(|source| wrong(&source))?;
        // What a table does not name is as the preset has it, in tables of tables, too.
        let given: toml::Table = toml::from_str(text).map_err(|source| wrong(&source))?;
        let mut table =
            toml::Table::try_from(Self::of_preset(&alone.preset)).map_err(|source| {
                TrainError::ConfigText {
                    path: None,
                    reason: source.to_string(),
                }
            })?;
        overlay(&mut table, &given);
        table.try_into().map_err(|source| wrong(&source))
    }

    /// The first number of a text that is out of range: those that are too small or too large for
    /// the type of their field never come to it.
    fn out_of_range(text: &str) -> Option<TrainError> {
        let table: toml::Table = toml::from_str(text).ok()?;
        let wrong = |number: &Number| {
            let mut names = number.field.split('.');
            let first = table.get(names.next()?)?;
            let value = names.try_fold(first, |value, name| value.get(name))?;
            let value = value
                .as_float()
                .or(value.as_integer().map(|whole| whole as f64))?;
            number.check(value).err()
        };
        Self::default().numbers().iter().find_map(wrong)
    }

    /// The same as a TOML text.
    ///
    /// # Errors
    ///
    /// [`TrainError::ConfigText`] for a number that TOML cannot hold.
    pub fn to_text(&self) -> Result<String, TrainError> {
        toml::to_string(self).map_err(|source| TrainError::ConfigText {
            path: None,
            reason: source.to_string(),
        })
    }

    /// Checks what does not depend on a garment.
    ///
    /// # Errors
    ///
    /// [`TrainError::Config`] with the first number out of range, [`TrainError::Memory`] for
    /// numbers that ask for too much together, [`TrainError::NoLoss`] if no term of the loss has
    /// a weight, [`TrainError::Net`] for a loss or a network that cannot be, and as
    /// [`TrainConfig::network_config`].
    pub fn validate(&self) -> Result<(), TrainError> {
        for number in self.numbers() {
            number.check(number.value)?;
        }
        if self.pose_space.folds == 1 {
            // A fold that is all that there is leaves nothing to learn from.
            return Err(TrainError::Config {
                field: "pose_space.folds",
                value: 1.0,
                min: 2.0,
                max: MOST_FOLDS,
            });
        }
        self.pose_space.check_size()?;
        self.loss.check()?;
        if self.loss.is_nothing() {
            return Err(TrainError::NoLoss);
        }
        let mut network = self.network_config()?;
        // How many there are depends on the body.
        network.num_body_parameters = network.num_body_parameters.max(1);
        Ok(network.check_size()?)
    }

    /// All numbers but those of the loss and of the network, which have ranges of their own. Any
    /// seed will do.
    fn numbers(&self) -> [Number; 20] {
        let number = |field, value, min, max| Number {
            field,
            value,
            min,
            max,
        };
        let whole = |field, value: u32, min, max| number(field, f64::from(value), min, max);
        let space = &self.pose_space;
        [
            whole("epochs", self.epochs, 1.0, 1e6),
            whole("accumulate", self.accumulate, 1.0, 1e4),
            number("learning_rate", self.learning_rate, 1e-9, 1.0),
            number("weight_decay", self.weight_decay, 0.0, 1e3),
            number("epsilon", self.epsilon, 1e-30, 1.0),
            number("mean_of_weights", self.mean_of_weights, 0.0, 0.999_999),
            whole("warm_up", self.warm_up, 0.0, 1e9),
            number("max_gradient", self.max_gradient, 0.0, 1e9),
            whole("patience", self.patience, 0.0, 1e9),
            whole("save_every", self.save_every, 0.0, 1e9),
            whole("pose_space.shapes", space.shapes, 1.0, 1024.0),
            whole("pose_space.scenes", space.scenes, 1.0, 2e4),
            whole("pose_space.searched", space.searched, 1.0, 2e4),
            whole("pose_space.rounds", space.rounds, 0.0, 1e3),
            whole("pose_space.folds", space.folds, 0.0, MOST_FOLDS),
            whole("pose_space.ensemble", space.ensemble, 1.0, 64.0),
            whole("pose_space.region_shapes", space.region_shapes, 1.0, 1024.0),
            whole(
                "pose_space.region_searched",
                space.region_searched,
                1.0,
                2e4,
            ),
            whole("pose_space.hidden", space.hidden, 1.0, 4096.0),
            whole("pose_space.passes", space.passes, 1.0, 1e5),
        ]
    }

    /// The preset, with what differs; without what a garment decides.
    ///
    /// # Errors
    ///
    /// [`TrainError::ConfigText`] for a field that networks do not have, [`TrainError::Net`] for an
    /// unknown preset.
    pub fn network_config(&self) -> Result<GarNetConfig, TrainError> {
        let preset = GarNetConfig::preset(&self.preset)?.with_variant(self.kind, 0);
        let unusable = |reason: String| TrainError::ConfigText {
            path: None,
            reason: format!("[network]: {reason}"),
        };
        let mut table =
            toml::Table::try_from(&preset).map_err(|error| unusable(error.to_string()))?;
        overlay(&mut table, &self.network);
        table.try_into().map_err(|error: toml::de::Error| {
            // With the field, on a line of its own.
            let text = error.to_string();
            unusable(text.trim_end().replace('\n', " "))
        })
    }
}

/// No configuration is larger, in bytes.
const MOST_TEXT: u64 = 1 << 24;

fn text_of(path: &Path) -> Result<String, TrainError> {
    let bytes = read_bounded(path, MOST_TEXT);
    let no_text = |_| io::Error::new(io::ErrorKind::InvalidData, "it is no text in UTF-8");
    let text = bytes.and_then(|bytes| String::from_utf8(bytes).map_err(no_text));
    text.map_err(|source| TrainError::Read {
        path: path.to_path_buf(),
        source,
    })
}

/// Replaces the values that `changes` names, table by table.
fn overlay(table: &mut toml::Table, changes: &toml::Table) {
    for (key, change) in changes {
        match (table.get_mut(key), change) {
            (Some(toml::Value::Table(inner)), toml::Value::Table(change)) => {
                overlay(inner, change);
            }
            _ => {
                table.insert(key.clone(), change.clone());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_comes_back() {
        let config = TrainConfig {
            seed: 9,
            ..TrainConfig::parse("[network.body]\npoints = 300").unwrap()
        };
        assert_eq!(
            TrainConfig::parse(&config.to_text().unwrap()).unwrap(),
            config
        );
        assert_eq!(config.network_config().unwrap().body.points, 300);
    }

    #[test]
    fn the_paper_is_a_preset() {
        let paper = TrainConfig::parse("preset = \"paper\"\n[loss]\nnormal = 0.5").unwrap();
        let expected = LossConfig {
            normal: 0.5,
            ..LossConfig::paper()
        };
        assert_eq!(paper.loss, expected);
        assert_eq!(paper.schedule, Schedule::Constant);
        assert!(!paper.mirror && !paper.standardize && paper.mean_of_weights <= 0.0);
        let usual = TrainConfig::parse("[loss]\nnormal = 0.5").unwrap();
        let expected = LossConfig {
            normal: 0.5,
            ..LossConfig::nearer()
        };
        assert_eq!((usual.loss, usual.mirror), (expected, true));
        for name in ["paper", "small"] {
            let config = TrainConfig::of_preset(name);
            assert_eq!(
                TrainConfig::parse(&config.to_text().unwrap()).unwrap(),
                config
            );
        }
    }

    #[test]
    fn mistakes_are_named_with_their_line() {
        let error = TrainConfig::parse("epochs = 3\nepoch = 4")
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("line 2") && error.contains("epoch"),
            "{error}"
        );
        let wrong = TrainConfig::parse("[network.garment]\nhead = 4").unwrap();
        let error = wrong.validate().unwrap_err().to_string();
        assert!(error.contains("head"), "{error}");
        let wrong = TrainConfig::parse("learning_rate = nan").unwrap();
        let error = wrong.validate().unwrap_err().to_string();
        assert!(error.contains("`learning_rate` is `NaN`"), "{error}");
        assert!(
            TrainConfig::parse("preset = \"huge\"")
                .unwrap()
                .validate()
                .is_err()
        );
    }

    #[test]
    fn networks_of_regions_that_memory_has_no_room_for_are_refused() {
        for (text, is_fine) in [
            ("hidden = 4096\nensemble = 64", false),
            ("hidden = 4096\nensemble = 1", true),
            ("hidden = 384\nensemble = 64", true),
        ] {
            let config = TrainConfig::parse(&format!("[pose_space]\n{text}")).unwrap();
            match config.validate() {
                Ok(()) => assert!(is_fine, "{text}"),
                Err(error) => {
                    assert!(matches!(error, TrainError::Memory { .. }), "{error}");
                    assert!(!is_fine && error.to_string().contains("GB"), "{error}");
                }
            }
        }
    }

    #[test]
    fn a_loss_of_nothing_is_refused() {
        let loss = "[loss]\nvertex = 0\ndistance = 0\nnormal = 0\npenetration = 0\nbending = 0";
        let error = TrainConfig::parse(loss).unwrap().validate().unwrap_err();
        assert!(matches!(error, TrainError::NoLoss), "{error}");
        let alone = TrainConfig::parse(&format!("{loss}\nstrain = 1")).unwrap();
        alone.validate().unwrap();
    }
}
