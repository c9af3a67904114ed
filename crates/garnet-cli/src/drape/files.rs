//! Reading all that a drape needs, in parallel.

use std::path::{Path, PathBuf};

use garnet::{
    Point3, Rig,
    io::{ObjFile, Scene, read_rig},
    shape::{Recognized, recognized},
};
use rayon::prelude::*;

use super::args::SourceFiles;
use crate::{
    failure::refused,
    sidecar::{built_in, rig_beside},
};

/// The files of a drape without a scene, as read.
#[derive(Debug)]
pub(crate) struct Files {
    pub(crate) garment: ObjFile,
    pub(crate) bodies: Vec<BodyFile>,
    pub(crate) rest_body: Option<ObjFile>,
    pub(crate) rig: Rig,
    pub(crate) rig_path: PathBuf,
    /// The body that the garment lies on, where that is not the one of the rig.
    pub(crate) own: Option<Rig>,
}

/// A body of which positions are kept, and the text if there is but one.
#[derive(Debug)]
pub(crate) struct BodyFile {
    pub(crate) path: PathBuf,
    /// In the unit of the file.
    pub(crate) positions: Vec<Point3>,
    /// Of its polygons.
    pub(crate) edges: Vec<[u32; 2]>,
    pub(crate) file: Option<ObjFile>,
}

impl Files {
    pub(crate) fn read(source: &SourceFiles) -> anyhow::Result<Self> {
        let rig_path = rig_path(source);
        let meshes = || {
            rayon::join(
                || ObjFile::read(&source.garment),
                || rayon::join(|| read_bodies(&source.bodies), || read_rest(source)),
            )
        };
        let rig = || rig_path.as_deref().map(read_rig).transpose();
        let ((garment, (bodies, rest_body)), rig) = rayon::join(meshes, rig);
        let (garment, bodies, rest_body) = (garment?, bodies?, rest_body?);
        let (mut rig, mut rig_path) = match (rig?, rig_path) {
            (Some(rig), Some(rig_path)) => (rig, rig_path),
            _ => built_in_rig(rest_body.as_ref(), &bodies, source)?,
        };
        let mut own = None;
        if let Some(own_rig) = &source.own_rig {
            if *own_rig != rig_path {
                own = Some(read_rig(own_rig)?);
            } else if let Some((other, path)) = rig_of_stranger(&rig, &bodies)? {
                own = Some(std::mem::replace(&mut rig, other));
                rig_path = path;
            }
        }
        Ok(Self {
            garment,
            bodies,
            rest_body,
            rig,
            rig_path,
            own,
        })
    }
}

/// The rig beside a body, if that is of another topology than the body of the package.
fn rig_of_stranger(own: &Rig, bodies: &[BodyFile]) -> anyhow::Result<Option<(Rig, PathBuf)>> {
    let (Some(rest), Some(body)) = (&own.rest, bodies.first()) else {
        return Ok(None);
    };
    let path = rig_beside(&body.path);
    if !path.is_file() {
        return Ok(None);
    }
    let other = read_rig(&path)?;
    let is_stranger = match &other.rest {
        Some(mesh) => mesh.faces() != rest.faces(),
        None => body.positions.len() != rest.num_vertices(),
    };
    Ok(is_stranger.then_some((other, path)))
}

/// The rig of a built-in body without a rig file: of the rest body, or else of the one body.
fn built_in_rig(
    rest_body: Option<&ObjFile>,
    bodies: &[BodyFile],
    source: &SourceFiles,
) -> anyhow::Result<(Rig, PathBuf)> {
    let first = bodies.first().and_then(|body| body.file.as_ref());
    let Some(file) = rest_body.or(first) else {
        return Err(no_rig(source));
    };
    let Ok(mesh) = file.mesh() else {
        return Err(no_rig(source));
    };
    match recognized(&mesh) {
        Recognized::Stranger => Err(no_rig(source)),
        _ => Ok((built_in(&mesh, file.path())?, file.path().to_path_buf())),
    }
}

fn read_rest(source: &SourceFiles) -> anyhow::Result<Option<ObjFile>> {
    Ok(source.rest_body.as_ref().map(ObjFile::read).transpose()?)
}

fn read_bodies(paths: &[PathBuf]) -> anyhow::Result<Vec<BodyFile>> {
    let is_single = paths.len() == 1;
    let read = |path: &PathBuf| -> anyhow::Result<BodyFile> {
        let file = ObjFile::read(path)?;
        Ok(BodyFile {
            path: path.clone(),
            positions: file.positions().to_vec(),
            edges: file.polygon_edges(),
            file: is_single.then_some(file),
        })
    };
    // In their order, so that of several bad files the first is told.
    let all: Vec<anyhow::Result<BodyFile>> = paths.par_iter().map(read).collect();
    all.into_iter().collect()
}

/// Where the rig is: as named, or in the package, or beside the rest body, or beside the first body.
fn rig_path(source: &SourceFiles) -> Option<PathBuf> {
    let of_package = || (source.own_rig.as_ref()).filter(|_| source.rest_body.is_none());
    if let Some(path) = source.rig.as_ref().or_else(of_package) {
        return Some(path.clone());
    }
    let beside = source.rest_body.iter().chain(source.bodies.first());
    beside
        .map(|path| rig_beside(path))
        .find(|path| path.is_file())
}

fn no_rig(source: &SourceFiles) -> anyhow::Error {
    let bodies = source.rest_body.iter().chain(source.bodies.first());
    let looked: Vec<String> = bodies
        .map(|path| format!("`{}`", rig_beside(path).display()))
        .collect();
    let body = source.bodies.first().or(source.rest_body.as_ref());
    let body = body.map_or_else(String::new, |path| format!(" for `{}`", path.display()));
    refused(
        format!("there is no rig{body}"),
        format!(
            "no `--rig` is given, and there is no {}",
            looked.join(" or ")
        ),
        "give the skeleton and weights of the body with `--rig FILE` (npz, GLB, glTF or JSON), and \
         the body on which the garment lies with `--rest-body OBJ` if the rig does not hold it",
    )
}

/// The files of a scene, as read.
#[derive(Debug)]
pub(crate) struct SceneFiles {
    pub(crate) scene: Scene,
    pub(crate) garment: ObjFile,
    pub(crate) rig: Rig,
    pub(crate) target: ObjFile,
}

impl SceneFiles {
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let scene = Scene::read(path)?;
        let meshes = || {
            rayon::join(
                || ObjFile::read(&scene.garment),
                || ObjFile::read(&scene.target_body),
            )
        };
        let ((garment, target), rig) = rayon::join(meshes, || scene.rig());
        Ok(Self {
            garment: garment?,
            target: target?,
            rig: rig?,
            scene,
        })
    }
}
