//! The arguments of `train`.

use std::path::PathBuf;

use clap::Args;
use garnet::train::{Begin, Precision, Recipe, TrainConfig, TrainJob, training_folder};

use super::followed;
use crate::hints::{advised, advised_on_config};

/// Arguments of `train`.
#[derive(Debug, Args)]
#[command(after_long_help = LONG_HELP)]
pub(crate) struct TrainArgs {
    /// Garment package; the variant is added to it.
    #[arg(value_name = "PACKAGE")]
    pub(crate) package: PathBuf,
    /// Data set of the garment.
    #[arg(value_name = "DATASET")]
    pub(crate) dataset: PathBuf,
    /// Name of the variant [default: that of its kind].
    ///
    /// A name of your own needs `--kind`, unless the package has it, the configuration says the
    /// `kind`, or `--from` does.
    #[arg(long, value_name = "NAME")]
    variant: Option<String>,
    /// What is trained, as `midway`, `falling` or `local` [default: what the name says, else
    /// local].
    ///
    /// By pose and shape alone, midway, arrival and falling predict where cloth is on its way and
    /// pose-space where it rests; the paper's networks are naive, global, local, global-params and
    /// local-params, which -rq, -mc, -mcrq or -umc after the name fine-tunes.
    #[arg(long, value_name = "KIND", conflicts_with = "resume")]
    pub(super) kind: Option<String>,
    /// Make the variant the default of the package, whichever is the best on validation.
    #[arg(long)]
    default: bool,
    /// Read the configuration from a TOML file.
    #[arg(long, value_name = "FILE")]
    pub(super) config: Option<PathBuf>,
    /// Size of the network: paper, medium, small, light or tiny.
    #[arg(long, value_name = "NAME", conflicts_with = "resume")]
    pub(super) preset: Option<String>,
    /// See each scene this often.
    #[arg(
        long,
        value_name = "N",
        conflicts_with = "resume",
        allow_negative_numbers = true
    )]
    pub(super) epochs: Option<u32>,
    /// Seed of the first weights and of the order of the scenes.
    #[arg(
        long,
        value_name = "S",
        conflicts_with = "resume",
        allow_negative_numbers = true
    )]
    seed: Option<u64>,
    /// Store the weights in so many bits: f32, f16 for half the file, or i8 for a quarter.
    #[arg(long, value_name = "BITS", value_parser = precision, conflicts_with = "resume")]
    precision: Option<Precision>,
    /// Start from these weights, in their size.
    #[arg(long, value_name = "WEIGHTS", conflicts_with_all = ["resume", "preset"])]
    pub(super) from: Option<PathBuf>,
    /// Learn from the training bodies of this data set, too.
    ///
    /// For kinds of deformations, of another seed, and of `garnet dataset --until` that moment or
    /// later; may be given several times.
    #[arg(long, value_name = "DATASET")]
    more: Vec<PathBuf>,
    /// Go on with a training that was interrupted.
    #[arg(long)]
    pub(super) resume: bool,
}

const LONG_HELP: &str = "\
In the package, the folder `training/NAME` has the loss curves (`losses.csv`, `losses.svg`), the log \
(`log.json`), the configuration (`config.toml`, to train again with) and the state from which \
`--resume` goes on. The weights are added to the package when the training is done: those of the \
epoch that is best on the validation split. The variant whose drapes are best there becomes the \
default of the package, which `garnet drape` takes; scenes that fall back do not count.

A configuration names what differs from the defaults:

  kind = \"local\"            # where the name of the variant does not say it
  preset = \"small\"          # size of the network
  epochs = 100
  learning_rate = 3e-3
  schedule = \"cosine\"       # or constant, steps
  accumulate = 1            # scenes a step
  weight_decay = 0.01       # of AdamW; 0 is Adam
  mean_of_weights = 0.999   # what is validated and published; 0 takes the last weights
  mirror = true             # whether every other scene is seen in a mirror
  standardize = true        # inputs by their mean and spread
  precision = \"f32\"         # of the weights in the package, or f16, i8
  patience = 0              # stop after so many epochs without a better one
  [loss]                    # weights of the terms
  distance = 0.25           # or vertex, its square, as the paper has it
  normal = 0.3
  [network.garment]         # what differs from the preset
  heads = 4";

fn precision(text: &str) -> Result<Precision, String> {
    match text {
        "f32" => Ok(Precision::F32),
        "f16" => Ok(Precision::F16),
        "i8" => Ok(Precision::I8),
        _ => Err("expected f32, f16 or i8".to_owned()),
    }
}

impl TrainArgs {
    /// What is to be done, checked as far as that goes without reading data.
    pub(crate) fn job(&self) -> anyhow::Result<TrainJob> {
        let mut recipe = self.recipe()?;
        followed::check(self, &mut recipe)?;
        let saved = training_folder(&self.package, &recipe.name).join("config.toml");
        let mut config = match &self.config {
            Some(path) => TrainConfig::read(path).map_err(advised)?,
            None if self.resume && saved.is_file() => TrainConfig::read(&saved).map_err(advised)?,
            None => match &self.preset {
                Some(preset) => TrainConfig::of_preset(preset),
                None => TrainConfig::default(),
            },
        };
        // What was saved has all that the name asks for.
        let is_saved = self.resume && self.config.is_none();
        if !is_saved && (self.config.is_none() || recipe.fine_tuned.is_none()) {
            recipe.apply(&mut config);
        }
        if let (Some(_), Some((_, losses))) = (&self.config, &recipe.fine_tuned)
            && config.loss == TrainConfig::default().loss
        {
            // The file names no losses: those that the fine-tuning is called by.
            config.loss = losses.clone();
        }
        if !self.resume {
            if let Some(preset) = &self.preset {
                config.preset.clone_from(preset);
            }
            config.epochs = self.epochs.unwrap_or(config.epochs);
            config.seed = self.seed.unwrap_or(config.seed);
            config.precision = self.precision.unwrap_or(config.precision);
        }
        config.validate().map_err(advised_on_config)?;
        Ok(TrainJob {
            package: self.package.clone(),
            dataset: self.dataset.clone(),
            more: self.more.clone(),
            recipe,
            config,
            base: self.from.clone(),
            begin: if self.resume {
                Begin::WhereSaved
            } else {
                Begin::Anew
            },
            makes_default: self.default,
        })
    }

    /// What is trained, and its name.
    fn recipe(&self) -> anyhow::Result<Recipe> {
        let recipe = match (&self.kind, &self.variant) {
            (Some(kind), name) => Recipe::of_kind(kind, name.as_ref().unwrap_or(kind)),
            (None, Some(name)) => Recipe::of_name(name),
            (None, None) => Recipe::of_name("local"),
        };
        recipe.map_err(advised)
    }
}
