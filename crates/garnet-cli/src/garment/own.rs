//! Garments that the user brings along.

use std::path::Path;

use anyhow::Context;
use garnet::{
    Garment,
    io::{Frame, ObjFile, SceneFiles},
    mesh::diagnose,
    package::{GarmentPackage, PackageParts, Simulator, StoredFabric},
    sim::RestShape,
};

use super::{
    Made,
    args::{self, OwnArgs},
};
use crate::{
    cut_args::CutArgs,
    drape::{Prepared, Source, SourceFiles, warnings_of},
    fabric::fabric,
    failure::{Hint, refused},
};

/// Makes a package of a garment in metres with y up, once it is known that `drape` and `simulate`
/// take it.
pub(super) fn packed(own: &OwnArgs) -> anyhow::Result<Made> {
    if own.rest_body.is_none() && own.rig.is_none() {
        return Err(refused(
            "there is no rest body",
            "neither `--rest-body` nor `--rig` is given",
            "give the body on which the garment lies with `--rest-body OBJ`, and its skeleton and weights with \
             `--rig FILE` (npz, GLB, glTF, VRM or JSON) if they are not beside it",
        ));
    }
    let fabric = fabric(&own.fabric)?;
    let name = match &own.name {
        Some(name) => name.clone(),
        None => of_file(own)?,
    };
    let mut scene = SceneFiles::new(&own.garment);
    scene.rig.clone_from(&own.rig);
    scene.rest_body.clone_from(&own.rest_body);
    scene.rig_options = own.rig_args.clone().options();
    scene.units = own.units;
    scene.place = own.place;
    scene.up = own.up.axis();
    let prepared = Prepared::read(&Source::Files(Box::new(SourceFiles {
        package: None,
        cut: CutArgs::default(),
        scene,
    })))?;
    made_of(prepared, name, fabric, own.place)
}

/// The garment and the body of a scene as a package, of cotton.
pub(crate) fn package_of_scene(path: &Path) -> anyhow::Result<GarmentPackage> {
    let prepared = Prepared::read(&Source::Scene(path.to_path_buf()))?;
    let made = made_of(prepared, "scene".to_owned(), fabric("cotton")?, false)?;
    Ok(made.package)
}

/// A package of what was read; its template has other positions than the file where that was moved.
fn made_of(
    prepared: Prepared,
    name: String,
    fabric: StoredFabric,
    is_moved: bool,
) -> anyhow::Result<Made> {
    let Prepared {
        garment_file,
        garment_frame,
        garment,
        body,
        rest,
        notes,
        ..
    } = prepared;
    let path = garment_file.path().to_path_buf();
    let cannot = || format!("cannot make a package of `{}`", path.display());
    if diagnose(&garment).degenerate_faces.len() == garment.num_faces() {
        return Err(refused(
            cannot(),
            "no triangle of it has an area",
            "export the mesh again; `garnet info` shows its box",
        ));
    }
    let bound = Garment::new(garment.clone()).bind(&body).with_context(|| {
        let rest = rest.path.display();
        format!("cannot bind `{}` to `{rest}`", path.display())
    })?;
    let shape = RestShape::Worn(garment.positions().to_vec());
    // What cannot be simulated can be neither drawn for data sets nor settle.
    Simulator::of_garment(bound.cloth().clone(), &body, &shape, &fabric.fabric())
        .with_context(cannot)?;
    let warnings = warnings_of([&path, &rest.path], &bound);
    let template = if garment_frame == Frame::OURS && !is_moved {
        garment_file
    } else {
        let bytes = garment_file.bytes_with_positions(garment.positions())?;
        ObjFile::parse(bytes, path.clone())?
    };
    let package = GarmentPackage::new(PackageParts {
        name,
        template,
        rest: shape,
        fabric,
        pattern: None,
        body,
        parameters: None,
    })
    .with_context(cannot)?;
    Ok(Made {
        package,
        warnings,
        sizes: [None; 2],
        notes,
    })
}

/// The name of a garment after its file.
fn of_file(own: &OwnArgs) -> anyhow::Result<String> {
    let stem = own.garment.file_stem().unwrap_or_default();
    args::name(&stem.to_string_lossy())
        .map_err(|reason| anyhow::anyhow!(reason))
        .with_context(|| format!("no garment can be called after `{}`", own.garment.display()))
        .hint(|| "give it a name with `--name NAME`".to_owned())
}
