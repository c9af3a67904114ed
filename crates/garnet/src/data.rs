//! Garments cut and put on, simulated scenes and data sets.

pub use garnet_data::{
    BalanceReport, BodyRecord, Counts, CutOptions, DATASET_SCHEMA, DataError, Dataset,
    DatasetEvent, DatasetManifest, DatasetOptions, ImportManifest, ImportProblem, ImportScene,
    Limits, Moment, NOISE_TURN, Plan, Posed, Protocol, Rejection, SceneRecord, SceneReport, Shard,
    Sizing, Split, Tailor, Tally, Variations, Worn, body_of_size, default_rest_body,
    finished_girths, generate, import, moved_by_turn, noise_floor, noise_joint, recut, sampler,
    sequences, usual_fabric, usual_package, wearer_of,
};
