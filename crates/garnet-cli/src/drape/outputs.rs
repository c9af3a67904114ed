//! Where drapes go.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use anyhow::Context;
use garnet::io::{Target, rig_beside};

use super::{
    args::{Job, Source},
    followed::folder_of,
    prepared::Prepared,
};
use crate::{failure::refused, output};

/// Where the drape on each target goes.
///
/// A frame of a file of all frames is told by its number after a colon.
pub(super) fn outputs_on(targets: &[Target], job: &Job) -> Vec<PathBuf> {
    if let Some(cache) = &job.cache {
        if targets.len() == 1 {
            return vec![cache.path.clone()];
        }
        let path = cache.path.display();
        let frame = |number: usize| PathBuf::from(format!("{path}:{number}"));
        return (0..targets.len()).map(frame).collect();
    }
    let named = targets.iter().filter_map(|target| target.stem.as_ref());
    let folder = job.folder.as_deref().unwrap_or(Path::new(""));
    let named = named.map(|stem| folder.join(format!("{stem}.obj")));
    let named: Vec<PathBuf> = named.collect();
    if named.is_empty() {
        job.outputs.clone()
    } else {
        named
    }
}

/// Refuses outputs that would take the place of the garment, a scene, a body, a rig, a pose or a
/// part of a package that is read.
pub(super) fn check_outputs(
    prepared: &Prepared,
    outputs: &[PathBuf],
    job: &Job,
) -> anyhow::Result<()> {
    let in_package = match &job.source {
        Source::Files(files) => files
            .package
            .as_ref()
            .map_or(Ok(Vec::new()), |folder| files_in(folder)),
        Source::Scene(_) => Ok(Vec::new()),
    };
    let in_package = in_package?;
    let rest = &prepared.rest;
    let garment = prepared.garment_file.path();
    let mut inputs = vec![garment, rest.path.as_path(), &rest.rig_path];
    if let Source::Scene(scene) = &job.source {
        inputs.push(scene);
    }
    inputs.extend(prepared.targets.iter().map(|target| target.path.as_path()));
    // They may be read by a later run, if not by this one.
    let rigs: Vec<PathBuf> = (prepared.targets.iter())
        .map(|target| rig_beside(&target.path))
        .collect();
    inputs.extend(rigs.iter().map(PathBuf::as_path));
    inputs.extend(prepared.pose.iter().map(|pose| pose.path.as_path()));
    if job.follows {
        output::check_folder(&folder_of(job))?;
    }
    inputs.extend(in_package.iter().map(PathBuf::as_path));
    if let Source::Files(files) = &job.source {
        inputs.extend(files.scene.rig_options.joints.as_deref());
    }
    check_frames(&inputs, job)?;
    let bodies = bodies_out(&prepared.targets, job);
    let own = job
        .report
        .iter()
        .chain(&job.hide)
        .chain(&job.view)
        .chain(&job.export_inputs)
        .chain(&bodies);
    let beside = own.map(PathBuf::as_path);
    let all: Vec<&Path> = match &job.cache {
        Some(cache) => std::iter::once(cache.path.as_path())
            .chain(beside)
            .collect(),
        None => outputs.iter().map(PathBuf::as_path).chain(beside).collect(),
    };
    output::check_apart(&all, &inputs)
}

/// Refuses a folder of frames in which something that is read has the name of a frame, which would
/// be written over, or removed as one of an earlier run.
fn check_frames(inputs: &[&Path], job: &Job) -> anyhow::Result<()> {
    let simulation = job.simulation.as_ref();
    let Some(folder) = simulation.and_then(|simulation| simulation.frames.as_deref()) else {
        return Ok(());
    };
    let folder = output::place_of(folder);
    let is_frame = |path: &&&Path| {
        let place = output::place_of(path);
        let name = place.file_name().and_then(|name| name.to_str());
        // Those of several targets are in folders of their own.
        place
            .ancestors()
            .skip(1)
            .take(2)
            .any(|around| around == folder)
            && name.is_some_and(|name| name.starts_with("frame_"))
            && place.extension().is_some_and(|kind| kind == "obj")
    };
    match inputs.iter().find(is_frame) {
        None => Ok(()),
        Some(path) => Err(refused(
            format!("cannot write frames into `{}`", folder.display()),
            format!("`{}` is read, and has the name of a frame", path.display()),
            "name another folder with `--frames`",
        )),
    }
}

/// Where the posed bodies go.
fn bodies_out(targets: &[Target], job: &Job) -> Vec<PathBuf> {
    let Some(path) = &job.body_out else {
        return Vec::new();
    };
    if job.body_cache.is_some() {
        return vec![path.clone()];
    }
    let of_target = |target: &Target| body_out_of(path, target);
    targets.iter().map(of_target).collect()
}

/// The folder that posed bodies go to, if there are several.
pub(super) fn bodies_folder<'a>(targets: &[Target], job: &'a Job) -> Option<&'a Path> {
    let is_several = targets.iter().any(|target| target.stem.is_some());
    let folder = job.body_out.as_deref();
    folder.filter(|_| is_several && job.body_cache.is_none())
}

/// Where the posed body of a target goes, of what was named with `--body-out`.
pub(super) fn body_out_of(path: &Path, target: &Target) -> PathBuf {
    match &target.stem {
        Some(stem) => path.join(format!("{stem}.obj")),
        None => path.to_path_buf(),
    }
}

/// All files in the folder of a package.
pub(super) fn files_in(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let cannot = || format!("cannot read the folder `{}`", folder.display());
    let entries = fs::read_dir(folder).with_context(cannot)?;
    let paths: Result<Vec<PathBuf>, _> = entries.map(|entry| Ok(entry?.path())).collect();
    paths.map_err(|error: io::Error| anyhow::Error::new(error).context(cannot()))
}
