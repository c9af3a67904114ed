//! Advice for what can be wrong with trainings and evaluations.

use std::path::Path;

use garnet::{
    net::{CheckpointError, NetError},
    package::PackageError,
    train::{TrainError, kind_names},
};

use super::{
    data::{for_data, for_package},
    did_you_mean_or,
    mesh::{for_io, for_mesh, for_write},
    rig::for_skin,
};
use crate::failure;

/// An error of a training or evaluation, with what to do about it.
pub(crate) fn advised(error: TrainError) -> anyhow::Error {
    match advice(&error) {
        Some(advice) => failure::with_hint(error, advice),
        None => error.into(),
    }
}

/// The same of one that has to do with a data set, which is named if the error does not.
pub(crate) fn advised_on(error: TrainError, dataset: &Path) -> anyhow::Error {
    let is_nameless = matches!(error, TrainError::EmptySplit { .. });
    let advised = advised(error);
    if is_nameless {
        advised.context(format!("cannot use the data set `{}`", dataset.display()))
    } else {
        advised
    }
}

/// An error of a configuration, with what to do about it.
pub(crate) fn advised_on_config(error: TrainError) -> anyhow::Error {
    let advice = match &error {
        TrainError::Net(NetError::UnknownPreset { name, known }) => {
            let known = known.split(", ").map(|name| name.trim_matches('`'));
            did_you_mean_or(name, known, CONFIG_HINT)
        }
        _ => CONFIG_HINT.to_owned(),
    };
    failure::with_hint(error, advice)
}

/// What helps against a configuration.
pub(crate) const CONFIG_HINT: &str =
    "`garnet train --help` shows a configuration; each field has a default";

/// What helps against what is asked for.
fn advice_on_job(error: &TrainError) -> Option<String> {
    Some(match error {
        TrainError::VariantName { .. } => {
            "give another name, as in `--variant my-shirt`".to_owned()
        }
        TrainError::ReservedName { name } | TrainError::Taken { name, .. } => {
            format!("give another name, as in `--variant my-{name}`")
        }
        TrainError::NameOfKind { kind, .. } => format!(
            "leave out `--variant`, or give a name of your own, as in `--variant my-{kind}`"
        ),
        TrainError::OlderName { name, variant } => format!(
            "train that one with `--variant {variant}`, or give another name, as in `--variant my-{name}`"
        ),
        TrainError::UnknownKind { kind } => {
            let kinds: Vec<&str> = kind_names().collect();
            let all = format!(
                "the kinds are {}, and fine-tunings as local-rq",
                kinds.join(", ")
            );
            did_you_mean_or(kind, kinds, &all)
        }
        TrainError::Config { .. }
        | TrainError::ConfigText { .. }
        | TrainError::Memory { .. }
        | TrainError::NoLoss => CONFIG_HINT.to_owned(),
        TrainError::OtherKind { name, found, .. } => format!(
            "name weights of the kind `{name}`, or give another name, as in `--variant my-{found}`"
        ),
        TrainError::FewScenes { .. } => {
            "make a data set of more: `--bodies` and `--poses` of `garnet dataset`".to_owned()
        }
        TrainError::SameScenes { .. } => {
            "make another with `garnet dataset` and another `--seed`; shards of one data set belong into one folder"
                .to_owned()
        }
        _ => return None,
    })
}

fn advice(error: &TrainError) -> Option<String> {
    Some(match error {
        TrainError::UnderWay { folder, .. } => format!(
            "`--resume` goes on with it; to begin anew, remove `{}`",
            folder.display()
        ),
        TrainError::NothingToResume { .. } => "begin it without `--resume`".to_owned(),
        TrainError::OtherTraining { path, .. } => format!(
            "go on with what it was begun with, or remove `{}` to begin anew",
            path.display()
        ),
        TrainError::OtherTemplate { .. } => {
            "a network is trained on drapes of its own garment: make them with `garnet dataset`"
                .to_owned()
        }
        TrainError::EmptySplit { split } => format!(
            "make a data set with bodies in `{}`: `--bodies TRAIN/VALID/TEST` of `garnet dataset`",
            split.name()
        ),
        TrainError::Package(error) if matches!(**error, PackageError::NoVariant { .. }) => {
            "train the variant that is fine-tuned first, or name weights with `--from`".to_owned()
        }
        TrainError::OtherStart { .. } => {
            "train that network anew before it is fine-tuned".to_owned()
        }
        TrainError::NotSettled { .. } => {
            "data sets made with `--until arrival` or `midway` are for that variant alone; for all else make one \
             without"
                .to_owned()
        }
        TrainError::MoreScenes { .. } => {
            "`--more` is for deformations that networks tell, such as `--kind falling`; leave it out".to_owned()
        }
        TrainError::CannotLeaveOut { .. } => {
            "fit it on this data set, with `folds` under `[pose_space]` of its configuration above 1".to_owned()
        }
        TrainError::NotKept { .. } => {
            "make the data set anew: those of earlier versions and imported ones have drapes alone; or fit \
             `--variant pose-space`"
                .to_owned()
        }
        TrainError::NoStart { name, .. } => {
            format!("fit it first: `garnet train PACKAGE DATASET --variant {name}`")
        }
        TrainError::Diverged { .. } => {
            "train with a smaller `learning_rate`, or bound the steps with `max_gradient`"
                .to_owned()
        }
        TrainError::Scene { .. } | TrainError::NotFinite { .. } | TrainError::Count { .. } => {
            "the data set is damaged or was made by hand: simulate it anew".to_owned()
        }
        TrainError::Starts { .. } => {
            "fit the deformation anew: it is written with it".to_owned()
        }
        TrainError::State { .. } => {
            "remove the file to begin anew; the package keeps its weights".to_owned()
        }
        _ => return advice_on_job(error),
    })
}

/// Errors of a training that are those of something else, which is no link of the chain.
pub(super) fn for_train(error: &TrainError) -> Option<&'static str> {
    match error {
        TrainError::Read { source, .. } | TrainError::Folder { source, .. } => for_io(source),
        TrainError::Write(error) => for_write(error),
        TrainError::Data(error) => for_data(error),
        TrainError::Package(error) => for_package(error),
        TrainError::Checkpoint(error) => for_weights(error),
        TrainError::Net(error) => for_network(error),
        TrainError::Skin(error) => for_skin(error),
        TrainError::Mesh(error) => for_mesh(error),
        _ => None,
    }
}

pub(super) fn for_network(error: &NetError) -> Option<&'static str> {
    match error {
        NetError::OtherGarment { .. } => Some(OTHER_GARMENT),
        NetError::Mesh(error) => for_mesh(error),
        _ => None,
    }
}

pub(super) const OTHER_GARMENT: &str = "a network drapes the garment that it was trained for: train one with `garnet train`, or \
     choose `--method warp`";

pub(super) fn for_weights(error: &CheckpointError) -> Option<&'static str> {
    match error {
        CheckpointError::Io { source, .. } => for_io(source),
        CheckpointError::Write(error) => for_write(error),
        CheckpointError::Schema { .. } => {
            Some("train the variant anew with this version, or use the version that wrote it")
        }
        CheckpointError::Unfit { .. } => Some(OTHER_GARMENT),
        _ => Some("copy the file again, or train the variant anew with `garnet train`"),
    }
}
