//! Worn templates, garment packages, simulated scenes and data sets.
//!
//! A [`GarmentPackage`] is a garment that lies on a body at rest. A [`Teacher`] simulates it on the
//! way of the body to a pose, a [`BodyPath`]. [`generate`] does that for many bodies of the
//! population and many poses, and keeps what was good enough in a [`Dataset`].

mod body_path;
mod check;
mod dataset;
mod error;
mod ladder;
mod noise;
mod package;
mod parts;
mod rest_file;
mod settling;
mod tailor;
mod teacher;
mod tensors;
mod wearer;

pub use body_path::BodyPath;
pub use check::{BalanceReport, Limits, SceneReport};
pub use dataset::{
    BodyRecord, Counts, DATASET_SCHEMA, Dataset, DatasetEvent, DatasetManifest, DatasetOptions,
    ImportManifest, ImportProblem, ImportScene, Plan, Posed, Rejection, SceneRecord, Shard, Sizing,
    Split, StoredParameters, Tally, Variations, generate, import, sampler, sequences,
};
pub use error::{DataError, ReadAs, toml_problem};
pub use garnet_sim::Moment;
pub use ladder::Rung;
pub use noise::{NOISE_TURN, moved_by_turn, noise_floor, noise_joint};
pub use package::{
    GarmentPackage, MANIFEST_FILE, Manifest, PACKAGE_SCHEMA, PackageParts, StoredFabric,
    StoredPattern, StoredRestBody, Variant,
};
pub use settling::Settling;
pub use tailor::{Tailor, Worn, usual_fabric};
pub use teacher::{Quality, Teacher, quality_name, quality_of};
pub use wearer::{default_rest_body, wearer_of};
