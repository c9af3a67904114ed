//! Garments cut and put on, simulated scenes and data sets.
//!
//! A [`Tailor`] cuts a garment for a body and puts it on. [`generate`] drapes it on many bodies of
//! the population in many poses, and keeps what was good enough in a [`Dataset`].

mod check;
mod dataset;
mod error;
mod noise;
mod recut;
mod tailor;
mod wearer;

pub use check::{BalanceReport, Limits, SceneReport};
pub use dataset::{
    BodyRecord, Counts, DATASET_SCHEMA, Dataset, DatasetEvent, DatasetManifest, DatasetOptions,
    GENERATOR, ImportManifest, ImportProblem, ImportScene, Plan, Posed, Protocol, Rejection,
    SceneRecord, Shard, Sizing, Split, Tally, Variations, generate, import, sampler, sequences,
};
pub use error::DataError;
pub use garnet_sim::Moment;
pub use noise::{NOISE_TURN, moved_by_turn, noise_floor, noise_joint};
pub use recut::{CutOptions, body_of_size, recut};
pub use tailor::{Tailor, Worn, finished_girths, usual_fabric, usual_package};
pub use wearer::{default_rest_body, wearer_of};
