//! `garnet garment`: packages of garments, cut from a pattern or brought along.

mod args;
mod fit;
mod own;
mod report;
mod wearer;

use std::{
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
    time::Instant,
};

use garnet::{
    body::shape::ParametricBody,
    data::{Tailor, default_rest_body, usual_fabric, wearer_of},
    io::rig_beside,
    package::{GarmentPackage, MANIFEST_FILE, StoredParameters},
    pattern::Size,
};

pub(crate) use args::GarmentArgs;
use args::{GarmentSource, OwnArgs, PatternArgs};
pub(crate) use own::package_of_scene;
use report::GarmentReport;

use crate::{
    console::{Console, print_document},
    cut_args::{SizeChoice, chosen_size},
    drape::WarningReport,
    fabric::fabric,
    failure::{ExitStatus, Hint, refused},
    output,
};

/// A package, and what may be wrong with it.
struct Made {
    package: GarmentPackage,
    warnings: Vec<WarningReport>,
    /// The size, and the one that comes next, if it was chosen.
    sizes: [Option<Size>; 2],
    /// What was taken for granted.
    notes: Vec<String>,
}

/// Makes a package and tells what is in it.
pub(crate) fn run(args: &GarmentArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    let start = Instant::now();
    let folder = match &args.source {
        GarmentSource::Pattern(args) => &args.common.output,
        GarmentSource::Own(args) => &args.output,
    };
    output::check_output_folder(folder)?;
    if let GarmentSource::Own(args) = &args.source {
        check_apart(folder, args)?;
    }
    check_free(folder)?;
    GarmentPackage::check_unused(folder)?;
    let made = match &args.source {
        GarmentSource::Pattern(args) => cut(args)?,
        GarmentSource::Own(args) => own::packed(args)?,
    };
    let is_new = !folder.is_dir();
    output::open_folder(folder)?;
    let written = made.package.write(folder);
    if is_new && written.is_err() {
        // What is told is why nothing was written.
        let _ = std::fs::remove_dir(folder);
    }
    for note in &made.notes {
        console.summary(&format_args!("note: {note}"));
    }
    let report = GarmentReport::new(
        &made.package,
        &written?,
        made.warnings,
        made.sizes,
        start.elapsed(),
    );
    if console.is_json() {
        print_document(&report)?;
    }
    console.summary(&report);
    for warning in &report.warnings {
        console.warning(&warning.text);
    }
    Ok(ExitStatus::Done)
}

/// Refuses a folder in which the package would take the place of what it is made from.
fn check_apart(folder: &Path, own: &OwnArgs) -> anyhow::Result<()> {
    let package = GarmentPackage::file_names().map(|name| folder.join(name));
    let package: Vec<&Path> = package.iter().map(PathBuf::as_path).collect();
    let beside = own.rest_body.as_deref().map(rig_beside);
    let bodies = own.rest_body.iter().chain(&own.rig).chain(&beside);
    let inputs = bodies.map(PathBuf::as_path).chain([own.garment.as_path()]);
    output::check_apart(&package, &inputs.collect::<Vec<_>>())
}

/// Refuses a folder with trained networks, which would be left with another garment than they have
/// learned, and one that is no package and has a file of the name of one of a package's.
pub(crate) fn check_free(folder: &Path) -> anyhow::Result<()> {
    const ADVICE: &str = "name another folder with `-o`, or remove this one first";
    if !GarmentPackage::is_at(folder) {
        let taken = GarmentPackage::file_names()
            .into_iter()
            .find(|name| folder.join(name).is_file());
        return match taken {
            None => Ok(()),
            Some(name) => Err(refused(
                format!("`{}` has a file `{name}`", folder.display()),
                "the folder is no garment package, and that file would be written over",
                ADVICE,
            )),
        };
    }
    let manifest = GarmentPackage::read_manifest(folder).hint(|| ADVICE.to_owned())?;
    let variants = manifest.variants.len();
    if variants == 0 {
        return Ok(());
    }
    Err(refused(
        format!(
            "`{}` holds a garment with trained networks",
            folder.display()
        ),
        format!(
            "`{}` lists {variants}, which have learned that garment alone",
            folder.join(MANIFEST_FILE).display()
        ),
        ADVICE,
    ))
}

/// Cuts, sews and puts on.
fn cut(args: &PatternArgs) -> anyhow::Result<Made> {
    let common = &args.common;
    let kind = args.parameters.garment();
    let fabric = match &common.fabric {
        Some(name) => fabric(name)?,
        None => usual_fabric(kind),
    };
    let (body, parameters) = if let Some(path) = &common.body {
        (wearer::read(path)?, None)
    } else {
        let parameters = default_rest_body();
        let stored = StoredParameters::from(&parameters);
        let built = ParametricBody::build(&parameters)?;
        (built.into_body(), Some(stored))
    };
    let wearer = wearer_of(&body)
        .transpose()?
        .ok_or_else(|| wearer::unknown(common.body.as_deref(), body.rest()))?;
    let tailor = Tailor::new(args.parameters.clone(), common.vertices, fabric)?;
    let (sizes, notes) = match common.size {
        Some(SizeChoice::Auto) => match chosen_size(&args.parameters, &wearer.measures) {
            Some((sizes, text)) => (sizes.map(Some), vec![text]),
            None => ([None; 2], Vec::new()),
        },
        Some(SizeChoice::Named(size)) => ([Some(size), None], Vec::new()),
        None => ([None; 2], Vec::new()),
    };
    let tailor = tailor.with_size(sizes[0]);
    let worn = tailor.dress(&body, &wearer, &AtomicBool::new(false))?;
    let name = common
        .name
        .clone()
        .unwrap_or_else(|| kind.name().to_owned());
    let package = tailor.package(name, &worn, body, parameters)?;
    let warnings = fit::warnings(&tailor, &wearer, &package, &common.output)?;
    Ok(Made {
        package,
        warnings,
        sizes,
        notes,
    })
}
