//! `garnet garment`: packages of garments, cut from a pattern or brought along.

mod args;
mod report;

use std::{path::Path, sync::atomic::AtomicBool, time::Instant};

use anyhow::Context;
use garnet::{
    Body, Rig,
    data::{
        GarmentPackage, PackageParts, StoredFabric, StoredParameters, Tailor, default_rest_body,
        usual_fabric, wearer_of,
    },
    io::{ObjFile, read_rig},
    shape::ParametricBody,
    sim::{FABRIC_NAMES, Fabric, RestShape},
};

pub(crate) use args::GarmentArgs;
use args::{GarmentSource, OwnArgs, PatternArgs};
use report::GarmentReport;

use crate::{
    body::own,
    console::{Console, print_document},
    failure::{ExitStatus, refused},
    output,
    sidecar::rig_beside,
};

/// Makes a package and tells what is in it.
pub(crate) fn run(args: &GarmentArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    let start = Instant::now();
    let (package, folder) = match &args.source {
        GarmentSource::Pattern(args) => (cut(args)?, &args.common.output),
        GarmentSource::Own(args) => (packed(args)?, &args.output),
    };
    output::make_folder(folder)?;
    let written = package.write(folder)?;
    let report = GarmentReport::new(&package, &written, start.elapsed());
    if console.is_json() {
        print_document(&report)?;
    }
    console.summary(&report);
    Ok(ExitStatus::Done)
}

/// Cuts, sews and puts on.
fn cut(args: &PatternArgs) -> anyhow::Result<GarmentPackage> {
    let common = &args.common;
    output::check_folder(&common.output)?;
    let kind = args.parameters.garment();
    let fabric = match &common.fabric {
        Some(name) => fabric(name)?,
        None => usual_fabric(kind),
    };
    let (body, parameters) = if let Some(path) = &common.body {
        (own::read(path, None)?.0, None)
    } else {
        let parameters = default_rest_body();
        let stored = StoredParameters::from(&parameters);
        let built = ParametricBody::build(&parameters)?;
        (built.into_body(), Some(stored))
    };
    let wearer = wearer_of(&body).transpose()?.ok_or_else(|| {
        refused(
            "a pattern cannot be cut for this body",
            "its measures are not known: it is not the built-in body",
            "make a garment on a body of `garnet body`, or bring one along with `from-obj`",
        )
    })?;
    let tailor = Tailor::new(args.parameters.clone(), common.vertices, fabric)?;
    let tailor = tailor.with_size(common.size);
    let worn = tailor.dress(&body, &wearer, &AtomicBool::new(false))?;
    let name = common
        .name
        .clone()
        .unwrap_or_else(|| kind.name().to_owned());
    Ok(tailor.package(name, &worn, body, parameters)?)
}

/// Makes a package of a garment of the user's own.
fn packed(args: &OwnArgs) -> anyhow::Result<GarmentPackage> {
    output::check_folder(&args.output)?;
    let template = ObjFile::read(&args.garment)?;
    let body = rest_body(args)?;
    let mesh = template.mesh()?;
    let stem = args.garment.file_stem().unwrap_or_default();
    Ok(GarmentPackage::new(PackageParts {
        name: args
            .name
            .clone()
            .unwrap_or_else(|| stem.to_string_lossy().into_owned()),
        rest: RestShape::Worn(mesh.positions().to_vec()),
        template,
        fabric: fabric(&args.fabric)?,
        pattern: None,
        body,
        parameters: None,
    })?)
}

fn rest_body(args: &OwnArgs) -> anyhow::Result<Body> {
    let beside = args.rest_body.as_deref().map(rig_beside);
    let rig = args.rig.clone().or(beside.filter(|path| path.is_file()));
    let Some(path) = rig else {
        return Err(refused(
            "there is no rig for the rest body",
            "no `--rig` is given, and there is none beside the rest body",
            "give skeleton and weights with `--rig FILE` (npz, GLB, glTF or JSON)",
        ));
    };
    let rig: Rig = read_rig(&path)?;
    let body = match &args.rest_body {
        Some(obj) => rig.into_body_with(ObjFile::read(obj)?.mesh()?),
        None => rig.into_body(),
    };
    body.with_context(|| cannot_fit(&path))
}

fn cannot_fit(path: &Path) -> String {
    format!("cannot make a body of `{}`", path.display())
}

/// The fabric of a name.
pub(crate) fn fabric(name: &str) -> anyhow::Result<StoredFabric> {
    let fabric = Fabric::named(name).ok_or_else(|| {
        refused(
            format!("there is no fabric `{name}`"),
            "it is none of the fabrics that are built in",
            format!("the fabrics are: {}", FABRIC_NAMES.join(", ")),
        )
    })?;
    Ok(StoredFabric::new(name, &fabric))
}
