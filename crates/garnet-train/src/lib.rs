//! Training and evaluation of networks on simulated drapes.
//!
//! A [`Stage`] brings a garment package and a data set of its garment together: each scene is a
//! garment warped to a posed body, exactly as a drape finds it, beside what the teacher made of
//! it. [`train`] fits a network to the training split, chooses by the validation split, and adds
//! the variant to the package; [`evaluate`] compares networks with the skinning and the warp alone.
//!
//! Nothing is printed here: [`TrainEvent`]s tell how far a training is.
//!
//! ```no_run
//! use std::sync::atomic::AtomicBool;
//!
//! use garnet_train::{Begin, Recipe, TrainConfig, TrainEvent, TrainJob, train};
//!
//! let job = TrainJob {
//!     package: "models/tee".into(),
//!     dataset: "data/tee".into(),
//!     more: Vec::new(),
//!     recipe: Recipe::of_name("local")?,
//!     config: TrainConfig::parse("preset = \"small\"\nepochs = 50")?,
//!     base: None,
//!     begin: Begin::Anew,
//!     makes_default: false,
//! };
//! let mut distances = Vec::new();
//! let mut observer = |event| {
//!     if let TrainEvent::Epoch(record) = event {
//!         distances.push(record.valid.distance);
//!     }
//! };
//! let trained = train(&job, &mut observer, &AtomicBool::new(false))?;
//! println!("{} m from the teacher", trained.best.valid.distance);
//! # Ok::<(), garnet_train::TrainError>(())
//! ```

#![allow(clippy::doc_markdown, reason = "GarNet and PyTorch are names")]

mod bound_candidate;
pub mod chart;
mod config;
mod context;
mod curves;
mod error;
mod evaluate;
mod event;
mod examples;
mod finish;
mod gallery;
mod gradients;
mod measure;
mod mirrored;
mod network_input;
mod percentiles;
mod pose_space;
mod publish;
mod recipe;
mod run_log;
mod scene_gradients;
mod scene_training;
mod scenes_found;
mod schedule;
mod scores;
mod simulators;
mod stage;
mod state;
mod trainer;
mod validate;
mod weights_mean;

pub use config::{Choice, TrainConfig};
pub use curves::{Curve, Curves};
pub use error::{SceneName, TrainError, Trouble, TroubleKind};
pub use evaluate::{Candidate, EvalEvent, Evaluation, Row, StageSeconds, Untangled, evaluate};
pub use event::{Began, EpochRecord, TrainEvent};
pub use finish::{Finish, PenetrationCount};
pub use gallery::{DrapedScene, drape_scenes};
pub use garnet_net::losses::{LossConfig, LossValue, Term};
pub use garnet_net::{GarNetConfig, Moment, PRESET_NAMES, Precision, Variant};
pub use percentiles::Percentiles;
pub use pose_space::{LeftOut, PoseSpaceConfig, Predictor};
pub use publish::{DefaultVariant, DrapeScores, Trained, WhyDefault, scenes_found};
pub use recipe::{Recipe, kind_name, kind_names};
pub use scene_training::SceneTraining;
pub use scenes_found::ScenesFound;
pub use schedule::Schedule;
pub use scores::{Scores, Tally};
pub use stage::{Stage, StagedScene, Worn};
pub use trainer::{Begin, TrainJob, train, training_folder};
