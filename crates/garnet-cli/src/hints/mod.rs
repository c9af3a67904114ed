//! Advice for what can be wrong, by the type of the error.

mod data;
mod mesh;
mod nearest;
mod pattern;
mod rig;
mod scene;
mod train;

use std::{error::Error as StdError, io};

use garnet::{
    Error,
    body::motion::RetargetError,
    data::DataError,
    io::{FileError, FileProblem, MotionError, ObjError, ObjParseError, WriteError},
    mesh::MeshError,
    net::CheckpointError,
    package::PackageError,
    pattern::PatternError,
    sim::SimError,
    skin::SkinError,
    train::TrainError,
};

use data::{for_data, for_package, for_sim};
use mesh::{for_io, for_mesh, for_obj, for_parse, for_write};
use rig::{for_file, for_joints, for_motion, for_names, for_retarget, for_skin};
use train::{for_train, for_weights};

pub(crate) use data::Hinting;
pub(crate) use nearest::{did_you_mean, did_you_mean_or};
pub(crate) use pattern::for_pattern;
pub(crate) use train::{advised, advised_on, advised_on_config};

/// The advice of the innermost cause that has one.
pub(crate) fn for_error(error: &anyhow::Error) -> Option<String> {
    let links: Vec<&(dyn StdError + 'static)> = error.chain().collect();
    let hint = |link| {
        let own = for_pattern_link(link).or_else(|| scene::for_link(link));
        let joints = || link.downcast_ref::<RetargetError>().and_then(for_joints);
        own.or_else(|| for_names(link))
            .or_else(joints)
            .or_else(|| for_link(link).map(str::to_owned))
    };
    links.into_iter().rev().find_map(hint)
}

fn for_pattern_link(link: &(dyn StdError + 'static)) -> Option<String> {
    match link.downcast_ref::<DataError>() {
        Some(DataError::Pattern(error)) => for_pattern(error),
        _ => link.downcast_ref::<PatternError>().and_then(for_pattern),
    }
}

fn for_link(link: &(dyn StdError + 'static)) -> Option<&'static str> {
    if let Some(error) = link.downcast_ref::<Error>() {
        return for_garnet(error);
    }
    if let Some(error) = link.downcast_ref::<ObjError>() {
        return for_obj(error);
    }
    if let Some(error) = link.downcast_ref::<ObjParseError>() {
        return Some(for_parse(error));
    }
    if let Some(error) = link.downcast_ref::<FileError>() {
        return for_file(&error.problem);
    }
    if let Some(problem) = link.downcast_ref::<FileProblem>() {
        return for_file(problem);
    }
    if let Some(error) = link.downcast_ref::<MotionError>() {
        return for_motion(&error.problem);
    }
    if let Some(error) = link.downcast_ref::<RetargetError>() {
        return for_retarget(error);
    }
    if let Some(error) = link.downcast_ref::<SkinError>() {
        return for_skin(error);
    }
    if let Some(error) = link.downcast_ref::<MeshError>() {
        return for_mesh(error);
    }
    if let Some(error) = link.downcast_ref::<TrainError>() {
        return for_train(error);
    }
    if let Some(error) = link.downcast_ref::<DataError>() {
        return for_data(error);
    }
    if let Some(error) = link.downcast_ref::<PackageError>() {
        return for_package(error);
    }
    if let Some(error) = link.downcast_ref::<SimError>() {
        return for_sim(error);
    }
    if let Some(error) = link.downcast_ref::<CheckpointError>() {
        return for_weights(error);
    }
    if let Some(error) = link.downcast_ref::<WriteError>() {
        return for_write(error);
    }
    link.downcast_ref::<io::Error>().and_then(for_io)
}

fn for_garnet(error: &Error) -> Option<&'static str> {
    match error {
        Error::Obj(error) => for_obj(error),
        Error::File(error) => for_file(&error.problem),
        Error::Mesh(error) => for_mesh(error),
        Error::Skin(error) => for_skin(error),
        Error::Weights(error) => for_weights(error),
        Error::Package(error) => for_package(error),
        Error::Misplaced(problem) => Some(scene::for_misplaced(problem)),
        _ => None,
    }
}

/// What helps while another run has a folder.
const WAIT: &str = "wait until that process ends, or end it; what it leaves holds nobody up";
