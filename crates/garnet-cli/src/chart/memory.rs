//! The most memory of a process that drapes once.

use std::{
    env,
    path::Path,
    process::{Command, Stdio},
};

use anyhow::Context;
use garnet::{
    io::write_obj,
    package::{Quality, quality_name},
    train::{Candidate, chart::targets},
};

use super::{
    Job, SPLIT,
    args::ChartArgs,
    methods::{Method, Way, shown},
    record::Keeper,
};
use crate::{hints::advised, input, machine};

/// Drapes one scene by each method in a process of its own.
pub(super) fn measure(job: &Job, keeper: &mut Keeper) -> anyhow::Result<()> {
    let missing = |method: &&Method| {
        let known = keeper.record.find(&method.name);
        known.is_some_and(|known| known.peak_bytes.is_none()) && arguments(method).is_some()
    };
    let missing: Vec<&Method> = job.methods.iter().filter(missing).collect();
    let first = job.scenes.drapes.first().copied();
    if missing.is_empty() || machine::peak_bytes().is_none() {
        return Ok(());
    }
    let bodies = targets(job.stage, SPLIT, first.as_slice()).map_err(advised)?;
    let Some(body) = bodies.first() else {
        return Ok(());
    };
    let folder = tempfile::tempdir().context("cannot make a temporary folder")?;
    let target = folder.path().join("body.obj");
    let rest = job.stage.package.body.rest();
    write_obj(
        &target,
        &rest.with_positions(body.skin().positions().to_vec())?,
    )?;
    let bar = job.console.progress(missing.len());
    let mut of_simulations = None;
    for method in missing {
        bar.set_message(format!("memory of {}", method.name));
        let peak = || peak_of(job.args, method, &target, folder.path());
        let found = match method.way {
            Way::Drape(_) => peak(),
            Way::Simulation(_) => *of_simulations.get_or_insert_with(peak),
        };
        let known = keeper.record.method(method.key());
        known.peak_bytes = found;
        bar.inc(1);
    }
    bar.finish_and_clear();
    keeper.write()
}

/// The subcommand of a method, and its options; none for weights that are not in the package.
fn arguments(method: &Method) -> Option<Vec<String>> {
    let words = match &method.way {
        Way::Drape(Candidate::Model { name, settle, .. }) => {
            let frames = settle.to_string();
            let words = ["drape", "--method", name, "--settle", &frames];
            return (*name == shown(name)).then(|| words.map(str::to_owned).to_vec());
        }
        Way::Drape(_) => ["drape", "--method", &method.name],
        // How fine the steps are does not show in the memory.
        Way::Simulation(_) => ["simulate", "--quality", quality_name(Quality::Fast)],
    };
    Some(words.map(str::to_owned).to_vec())
}

/// The peak that the process itself reports; none if it comes to no end.
fn peak_of(args: &ChartArgs, method: &Method, body: &Path, folder: &Path) -> Option<u64> {
    let words = arguments(method)?;
    let (command, options) = words.split_first()?;
    let report = folder.join("report.json");
    let status = Command::new(env::current_exe().ok()?)
        .args([command, "--quiet", "--threads"])
        .arg(rayon::current_num_threads().to_string())
        .arg(&args.package)
        .arg(body)
        .args(options)
        .arg("--report")
        .arg(&report)
        .arg("-o")
        .arg(folder.join("draped.obj"))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    if !status.ok()?.success() {
        return None;
    }
    let text = input::bytes(&report).ok()?;
    let report: serde_json::Value = serde_json::from_slice(&text).ok()?;
    report["peak_bytes"].as_u64()
}
