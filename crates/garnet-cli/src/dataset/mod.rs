//! `garnet dataset`: many simulated scenes of one garment.

mod args;
mod progress;
mod rejected;
mod report;

use std::{path::Path, sync::atomic::AtomicBool, time::Instant};

use anyhow::Context;
use garnet::{
    data::{
        DataError, Dataset, DatasetEvent, DatasetOptions, ImportManifest, Limits, Sizing, Tailor,
        generate, import,
    },
    mesh::Unit,
    package::GarmentPackage,
};

pub(crate) use args::{DatasetArgs, QualityName};
use progress::Progress;
use report::DatasetReport;

use crate::{
    console::{Console, print_document},
    cut_args::{check_size, in_size},
    failure::{ExitStatus, refused, with_hint},
    hints::Hinting,
    interrupt::tell_on_interrupt,
    output,
};

/// Makes a data set, goes on with one, or imports one.
pub(crate) fn run(args: &DatasetArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    let start = Instant::now();
    output::check_folder(&args.output)?;
    check_import(args)?;
    let package = read_in_size(args)?;
    if GarmentPackage::is_at(&args.output) {
        return Err(refused(
            format!("cannot make a data set in `{}`", args.output.display()),
            "it is a garment package",
            "name another folder with `-o`",
        ));
    }
    let tried = if let Some(manifest) = &args.import {
        take(manifest, args, &package, console)?;
        None
    } else {
        let told = format!(
            "`{}` keeps the scenes that are there: the same command goes on",
            args.output.display()
        );
        tell_on_interrupt(told, vec![args.output.clone()], console)?;
        Some(make(args, &package, console)?)
    };
    let dataset = Dataset::open(&args.output).hinting()?;
    let report = DatasetReport::new(&dataset, &args.output, tried, start.elapsed())?;
    if console.is_json() {
        print_document(&report)?;
    }
    console.summary(&report);
    match &report.mostly_rejected {
        Some(mostly) if mostly.are_all() => Err(mostly.failure()),
        Some(mostly) => {
            console.warning(mostly);
            Ok(ExitStatus::Done)
        }
        None => Ok(ExitStatus::Done),
    }
}

/// Refuses what is for an import alone: the parser does not, since the options that exclude an
/// import have defaults.
fn check_import(args: &DatasetArgs) -> anyhow::Result<()> {
    let given = [
        (args.body_file.is_some(), "--body-file"),
        (args.units.is_some(), "--units"),
    ];
    match given.into_iter().find(|(is_given, _)| *is_given) {
        Some((_, name)) if args.import.is_none() => Err(refused(
            format!("`{name}` is for a data set that is imported"),
            "`--import` is not given",
            "name the folder of shirts with `--import DIR`, or leave it out",
        )),
        _ => Ok(()),
    }
}

/// Reads the package, and takes its garment in the size that is asked for.
fn read_in_size(args: &DatasetArgs) -> anyhow::Result<GarmentPackage> {
    let package = read_package(&args.garment)?;
    let Some(size) = args.size else {
        return Ok(package);
    };
    let cannot = || {
        let shown = args.garment.display();
        format!("cannot make scenes of `{shown}` in size {size}")
    };
    if args.sizing(&package) == Sizing::MadeToMeasure {
        return Err(refused(
            cannot(),
            "each body wears a garment cut to its measures",
            "leave out `--size`, or add `--sizing one-size`",
        ));
    }
    let Some(tailor) = Tailor::of_package(&package).with_context(cannot)? else {
        return Err(refused(
            cannot(),
            "it was not made from a sewing pattern",
            "leave out `--size`",
        ));
    };
    check_size(size, tailor.parameters().garment()).with_context(cannot)?;
    in_size(&package, &args.garment, size).with_context(cannot)
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
        mixed: args.mixed,
        noise: args.noise,
        protocol: args.protocol.protocol(),
        quality: args.quality.quality(),
        until: args.until.until(),
        sizing: args.sizing(package),
        vary: args.variations()?,
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
    made.hinting()?;
    Ok(progress.tried())
}

/// What helps against a list of drapes that does not parse.
const FORM: &str = "`garnet dataset --help` shows the form of a manifest";

/// Imports.
fn take(
    manifest: &Path,
    args: &DatasetArgs,
    package: &GarmentPackage,
    console: &Console,
) -> anyhow::Result<()> {
    let scenes = if manifest.is_dir() {
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
        let unit = args.units.unwrap_or(Unit::Metre);
        ImportManifest::wang_2018(manifest, body, unit).hinting()?
    } else {
        if args.units.is_some() || args.body_file.is_some() {
            return Err(refused(
                format!("`{}` is no folder of shirts", manifest.display()),
                "`--units` and `--body-file` are for such a folder",
                "leave them out: a manifest names its unit and its meshes",
            ));
        }
        match ImportManifest::read(manifest) {
            Err(error @ DataError::Text { .. }) => return Err(with_hint(error, FORM.to_owned())),
            read => read.hinting()?,
        }
    };
    // Each is read twice.
    let bar = console.progress(2 * scenes.scenes.len());
    let taken = import(package, &scenes, manifest, &args.output, &mut |done| {
        bar.set_position(done as u64);
    });
    bar.finish_and_clear();
    taken.hinting()?;
    Ok(())
}
