//! `garnet stress`: the level at which each way to drape breaks.

mod args;
mod record;
mod report;

use std::{
    path::{Path, PathBuf},
    sync::atomic::Ordering,
};

use garnet::{
    Package,
    data::usual_package,
    mesh::{Fingerprint, MOST_BYTES, read_bounded},
    package::GarmentPackage,
    pattern::GarmentKind,
    stress::{Method, StressOptions, holds, run as stress},
};

pub(crate) use args::StressArgs;
use record::Keeper;
use report::StressReport;

use crate::{
    console::{Console, print_data, print_document},
    dataset::read_package,
    failure::ExitStatus,
    garment::{check_free, package_of_scene},
    interrupt::{Interrupted, stop_flag},
    output,
};

/// Vertices of the T-shirt that is cut where no package is given.
const VERTICES: usize = 1250;

/// The names of the variants of a package.
fn names(package: &GarmentPackage) -> Vec<String> {
    let variants = package.manifest.variants.iter();
    variants.map(|variant| variant.name.clone()).collect()
}

/// Drapes all cells, writes the table, and tells whether one of ours breaks.
pub(crate) fn run(args: &StressArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    args.check()?;
    let of_scene = (args.scene.as_deref()).map(package_of_scene).transpose()?;
    if args.package.is_none() {
        // The garment that is cut has no variants: what is misspelt is told before it is cut.
        args.options(&[])?;
    }
    if let Some(folder) = &args.package {
        // What can't be read leaves no folder behind.
        let package = read_package(folder)?;
        args.check_apart(folder, &package.manifest)?;
        args.options(&names(&package))?;
    }
    output::open_folder(&args.output)?;
    let _lock = output::lock_folder(&args.output)?;
    let folder = match &args.package {
        Some(folder) => folder.clone(),
        None => cut(&args.output, of_scene)?,
    };
    let content = read_package(&folder)?;
    let options = args.options(&names(&content))?;
    let mut keeper = Keeper::open(
        &args.output,
        &content.manifest.positions,
        fingerprints(&folder, &content, &options),
        &options,
    )?;
    let package = Package::open(&folder)?;
    let levels = options
        .axes
        .iter()
        .map(|axis| axis.levels(options.is_quick).len());
    let progress = console.progress(levels.sum::<usize>() * options.methods.len());
    let known = keeper.cells().to_vec();
    let mut unwritten = Ok(());
    let stop = stop_flag()?;
    let found = stress(
        &package,
        &options,
        &known,
        &mut |cell| {
            progress.inc(1);
            progress.set_message(cell.axis.clone());
            if unwritten.is_ok() {
                unwritten = keeper.keep(cell);
            }
        },
        &stop,
    );
    progress.finish_and_clear();
    unwritten?;
    keeper.write()?;
    if stop.load(Ordering::Relaxed) {
        let told = format!(
            "`{}` keeps what was found: the same command goes on from there",
            args.output.display()
        );
        console.failure(&anyhow::Error::new(Interrupted { told }));
        return Ok(ExitStatus::Interrupted);
    }
    let cells = found?;

    let holds = holds(&options, &cells);
    let report = StressReport::new(&content.manifest.name, &options, &holds, &cells);
    let again = again(args, &folder);
    let table = written(&report, &options, &again, &args.output)?;
    if console.is_json() {
        print_document(&report)?;
    } else {
        print_data(table.trim_end())?;
    }
    if report.failures > 0 {
        let failures = report.failures;
        console.exceeded(&[format!("{failures} of ours break at their bar or before")]);
        return Ok(ExitStatus::LimitExceeded);
    }
    Ok(ExitStatus::Done)
}

/// Writes the report, the table and the picture, and gives the table.
fn written(
    report: &StressReport,
    options: &StressOptions,
    again: &str,
    folder: &Path,
) -> anyhow::Result<String> {
    let table = report::table(report, options, again);
    let mut text = serde_json::to_string_pretty(report)?;
    text.push('\n');
    output::write(&folder.join("stress.json"), text.as_bytes())?;
    output::write(&folder.join("stress.md"), table.as_bytes())?;
    if let Some(chart) = report::picture(report, options) {
        let png = chart.to_image()?.to_png_bytes()?;
        output::write(&folder.join("stress.svg"), chart.to_svg()?.as_bytes())?;
        output::write(&folder.join("stress.png"), &png)?;
    }
    Ok(table)
}

/// The garment in the output folder: that of a scene, or the T-shirt, cut if it is not there.
fn cut(in_folder: &Path, of_scene: Option<GarmentPackage>) -> anyhow::Result<PathBuf> {
    if let Some(package) = of_scene {
        let folder = in_folder.join("scene");
        check_free(&folder)?;
        output::make_folder(&folder)?;
        package.write(&folder)?;
        return Ok(folder);
    }
    let folder = in_folder.join("tshirt");
    if !GarmentPackage::is_at(&folder) {
        output::make_folder(&folder)?;
        usual_package(GarmentKind::Tshirt, VERTICES)?.write(&folder)?;
    }
    Ok(folder)
}

/// The variants that are run, with the fingerprints of their weight files.
fn fingerprints(
    folder: &Path,
    content: &GarmentPackage,
    options: &StressOptions,
) -> Vec<(String, String)> {
    let run = options.methods.iter();
    let names = run.filter_map(|method| match method {
        Method::Variant(name) => Some(name),
        _ => None,
    });
    let with_fingerprint = names.map(|name| {
        let variant = content.manifest.variants.iter().find(|v| v.name == *name);
        let file = variant.map(|variant| folder.join(&variant.weights));
        // What cannot be read is refused where it is used.
        let bytes = file.and_then(|file| read_bounded(&file, MOST_BYTES).ok());
        let fingerprint = Fingerprint::of_bytes(&bytes.unwrap_or_default());
        (name.clone(), fingerprint.to_string())
    });
    with_fingerprint.collect()
}

/// The command that runs one axis again.
fn again(args: &StressArgs, folder: &Path) -> String {
    let quick = if args.quick { " --quick" } else { "" };
    let seed = args.seed;
    format!(
        "garnet stress {} -o again{quick} --seed {seed}",
        folder.display()
    )
}
