//! What a training tells while it runs.

use std::collections::BTreeMap;

use garnet_data::Split;
use garnet_net::losses::LossValue;
use serde::{Deserialize, Serialize};

use crate::{Scores, Trouble};

/// What a training tells while it runs.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum TrainEvent {
    /// A scene was read and warped.
    Read {
        /// Its split.
        split: Split,
        /// How many are done.
        done: usize,
        /// How many there are in the split.
        total: usize,
    },
    /// A round of the search for how much each joint counts is over.
    Searched {
        /// The round, from 0 before the first.
        round: u32,
        /// How many there will be.
        rounds: u32,
        /// Mean error of scenes whose bodies and sequences are left out, the root of the mean
        /// square over the vertices, in metres.
        left_out: f64,
    },
    /// The same of a region of the garment.
    RegionSearched {
        /// The region, from 0.
        region: u32,
        /// How many there are.
        regions: u32,
        /// The round, from 0 before the first.
        round: u32,
        /// How many there will be.
        rounds: u32,
        /// As of [`TrainEvent::Searched`].
        left_out: f64,
    },
    /// The network of a region has seen all scenes once more.
    RegionLearned {
        /// The region, from 0.
        region: u32,
        /// How many there are.
        regions: u32,
        /// The pass, from 1.
        pass: u32,
        /// How many there will be.
        passes: u32,
        /// The mean distance from what is to be told over the root of its mean square.
        loss: f64,
    },
    /// All is ready.
    Began(Began),
    /// The derivatives of a scene were computed.
    Scene {
        /// The epoch, from 1.
        epoch: u32,
        /// Scenes done in all epochs.
        done: u64,
        /// Scenes in all epochs.
        total: u64,
        /// The loss.
        loss: f64,
    },
    /// A scene gave no step.
    Skipped(Trouble),
    /// An epoch is over and was validated.
    Epoch(EpochRecord),
    /// A test scene has settled where the new weights put its cloth.
    Settled {
        /// How many are done.
        done: usize,
        /// How many there are.
        total: usize,
    },
    /// How far from the teacher settled drapes are could not be measured; the weights are published
    /// without it.
    NotSettled {
        /// What went wrong.
        why: String,
    },
}

/// What a training starts from.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Began {
    /// Scenes that are learned from.
    pub num_train: usize,
    /// Scenes that are validated by.
    pub num_valid: usize,
    /// Vertices of the garment.
    pub num_vertices: usize,
    /// Body points that the network looks at.
    pub num_body_points: usize,
    /// Weights of the network.
    pub parameters: u64,
    /// Multiplications and additions of a forward pass.
    pub flops: u64,
    /// The mean of each term over the first scenes before any step.
    pub terms: Vec<LossValue>,
    /// The validation before any step, that of the warp if the weights are new; and the epochs that
    /// an earlier run has done.
    pub past: Vec<EpochRecord>,
}

/// An epoch: its losses and its validation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct EpochRecord {
    /// The epoch, from 1; 0 before the first.
    pub epoch: u32,
    /// The last learning rate.
    pub learning_rate: f64,
    /// Mean of the weighted loss over the scenes; none before the first epoch.
    pub loss: Option<f64>,
    /// Mean of each term that has a weight, before weighting.
    pub terms: BTreeMap<String, f64>,
    /// Scenes that gave no step.
    pub skipped: u32,
    /// Mean of the weighted loss over the validation scenes.
    pub valid_loss: f64,
    /// The validation.
    pub valid: Scores,
    /// Whether no epoch before was better.
    pub is_best: bool,
}
