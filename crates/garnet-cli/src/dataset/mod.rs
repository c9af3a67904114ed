//! `garnet dataset`: many simulated scenes of one garment.

mod args;
mod progress;
mod report;

use std::{path::Path, sync::atomic::AtomicBool, time::Instant};

use garnet::data::{
    DataError, Dataset, DatasetEvent, DatasetOptions, GarmentPackage, ImportManifest, Limits,
    generate, import,
};

pub(crate) use args::{DatasetArgs, QualityName};
use progress::Progress;
use report::DatasetReport;

use crate::{
    console::{Console, print_document},
    failure::{ExitStatus, Hint, refused},
    output,
};

/// Makes a data set, goes on with one, or imports one.
pub(crate) fn run(args: &DatasetArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    let start = Instant::now();
    output::check_folder(&args.output)?;
    let package = read_package(&args.garment)?;
    output::make_folder(&args.output)?;
    let tried = match &args.import {
        Some(manifest) => {
            take(manifest, args, &package, console)?;
            None
        }
        None => Some(make(args, &package, console)?),
    };
    let dataset = Dataset::open(&args.output)?;
    let report = DatasetReport::new(&dataset, &args.output, tried, start.elapsed())?;
    if console.is_json() {
        print_document(&report)?;
    }
    console.summary(&report);
    Ok(ExitStatus::Done)
}

/// Reads a garment package, or tells how to make one.
pub(crate) fn read_package(path: &Path) -> anyhow::Result<GarmentPackage> {
    if GarmentPackage::is_at(path) {
        return Ok(GarmentPackage::read(path)?);
    }
    Err(refused(
        format!("`{}` is no garment package", path.display()),
        "it is no folder with a `garment.toml`",
        "make one with `garnet garment tshirt -o DIR`, or of your own garment with `garnet garment \
         from-obj`",
    ))
}

/// Simulates; returns how many bodies of the population were looked at.
fn make(args: &DatasetArgs, package: &GarmentPackage, console: &Console) -> anyhow::Result<u64> {
    let options = DatasetOptions {
        seed: args.seed,
        bodies: args.bodies,
        poses: args.poses,
        quality: args.quality.quality(),
        until: args.until.until(),
        sizing: args.sizing(package),
        vary: args.variations(),
        limits: if args.keep_all {
            Limits::NONE
        } else {
            Limits::default()
        },
        part: args.shard,
        threads: rayon::current_num_threads(),
    };
    let progress = Progress::new(console);
    let observer = |event: DatasetEvent| progress.tell(&event);
    let made = generate(
        package,
        &args.output,
        &options,
        &observer,
        &AtomicBool::new(false),
    );
    progress.finish();
    let hint = made.as_ref().err().and_then(hint_for);
    match hint {
        Some(hint) => made.hint(|| hint.to_owned()).map(|_| ())?,
        None => made.map(|_| ())?,
    }
    Ok(progress.tried())
}

/// What helps against an error, where that does not say it itself.
fn hint_for(error: &DataError) -> Option<&'static str> {
    match error {
        DataError::VariedTemplate => Some("leave out `--sizing one-size`, or `--vary`"),
        DataError::NoPattern => Some("leave out `--sizing made-to-measure` and `--vary`"),
        DataError::Pattern(_) => None,
        _ => Some(
            "the data set goes on where it was if the command is run again with the same arguments; \
             other arguments need another folder",
        ),
    }
}

/// Imports.
fn take(
    manifest: &Path,
    args: &DatasetArgs,
    package: &GarmentPackage,
    console: &Console,
) -> anyhow::Result<()> {
    let (scenes, base) = if manifest.is_dir() {
        let body = args.body_file.as_deref().ok_or_else(|| {
            refused(
                format!(
                    "`{}` is a folder of shirts without bodies",
                    manifest.display()
                ),
                "the body's file in each sample is not known",
                "name it with `--body-file NAME`, or give a manifest instead of a folder",
            )
        })?;
        (
            ImportManifest::wang_2018(manifest, body, args.units)?,
            manifest,
        )
    } else {
        let base = manifest.parent().unwrap_or(Path::new(""));
        (ImportManifest::read(manifest)?, base)
    };
    let bar = console.progress(scenes.scenes.len());
    import(package, &scenes, base, &args.output, &mut |done| {
        bar.set_position(done as u64);
    })?;
    bar.finish_and_clear();
    Ok(())
}
