//! Advice for what can be wrong with packages, data sets and simulations.

use std::{io, path::Path};

use garnet::{
    data::{DataError, ImportProblem},
    io::{FileProblem, ObjError, WriteError},
    mesh::MeshDifference,
    package::PackageError,
    sim::SimError,
};

use super::{
    WAIT,
    mesh::{for_io, for_mesh, for_obj, for_write},
    rig::{for_file, for_skin},
};
use crate::failure::Hint;

/// Adds what helps against an error of a data set, where the error has no advice of its own.
pub(crate) trait Hinting<T> {
    fn hinting(self) -> anyhow::Result<T>;
}

impl<T> Hinting<T> for Result<T, DataError> {
    fn hinting(self) -> anyhow::Result<T> {
        match self.as_ref().err().and_then(hint_for) {
            Some(hint) => self.hint(|| hint),
            None => Ok(self?),
        }
    }
}

const GOES_ON: &str =
    "the data set goes on where it was if the command is run again with the same arguments";

fn hint_for(error: &DataError) -> Option<String> {
    let hint = match error {
        DataError::VariedTemplate => "leave out `--sizing one-size`, or `--vary`",
        DataError::NoPattern => "leave out `--sizing made-to-measure` and `--vary`",
        DataError::ForeignBody { .. } => {
            "bring the garment to the built-in body: `garnet body -o rest.obj`, `garnet drape GARMENT \
             rest.obj -o worn.obj`, `garnet garment from-obj worn.obj --rest-body rest.obj -o DIR`"
        }
        DataError::OtherDataset {
            field: "imported content",
            ..
        } => "name another folder with `-o`: a data set keeps the drapes that it was imported from",
        DataError::OtherDataset {
            field: "scenes of the kind",
            ..
        } => "name another folder with `-o`: a data set is simulated or imported",
        DataError::OtherDataset { .. } => {
            "give the arguments that it was begun with, or name another folder with `-o`"
        }
        DataError::InUse { .. } => {
            "wait until that ends; `--shard 1/2` and `--shard 2/2` can run at the same time"
        }
        DataError::Stopped => GOES_ON,
        DataError::Write(WriteError::Io { source, .. }) | DataError::Folder { source, .. }
            if is_full(source) =>
        {
            return Some(format!("make room on the disk: {GOES_ON}"));
        }
        DataError::Text { path, .. } if path.ends_with("dataset.json") => {
            "copy it again, or make the data set anew in another folder"
        }
        DataError::Tensors { path, .. }
        | DataError::Altered { path, .. }
        | DataError::MisnamedShard { path, .. }
        | DataError::Text { path, .. }
            if path.extension().is_some_and(|name| name == "safetensors") =>
        {
            return Some(format!(
                "delete `{}`: what is missing is made anew when the command is run again",
                path.display()
            ));
        }
        DataError::Foreign { path, .. } if path.ends_with("dataset.json") => {
            "name another folder with `-o`, or use the version that made it"
        }
        DataError::Foreign { path, .. } if is_shard(path) => {
            "move it out of the folder, or name another folder with `-o`"
        }
        DataError::Import { problem, .. } => for_list(problem)?,
        DataError::ImportScene { source, .. } => for_scene(source)?,
        _ => return None,
    };
    Some(hint.to_owned())
}

fn is_full(error: &io::Error) -> bool {
    use io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull};
    matches!(error.kind(), StorageFull | QuotaExceeded | FileTooLarge)
}

fn for_list(problem: &ImportProblem) -> Option<&'static str> {
    match problem {
        ImportProblem::NoScenes => {
            Some("list drapes under `scenes`; `garnet dataset --help` shows the form")
        }
        ImportProblem::Unit(_) => Some("`units` is the unit of all meshes"),
        ImportProblem::Repeated { .. } => Some("list each drape once"),
        ImportProblem::BodyInTwoSplits { .. } | ImportProblem::SequenceInTwoSplits { .. } => Some(
            "put all its scenes into one split: a model would be judged by what it has learned from",
        ),
        _ => None,
    }
}

fn for_scene(error: &DataError) -> Option<&'static str> {
    const ARRAY: &str =
        "meshes are OBJ, or npz with an array `vertices` of floats and of the shape (N, 3)";
    const BESIDE: &str = "check the path: paths in a manifest are relative to it";
    let is_missing = |error: &io::Error| error.kind() == io::ErrorKind::NotFound;
    match error {
        DataError::Obj(ObjError::Read { source, .. }) if is_missing(source) => Some(BESIDE),
        DataError::Rig(error) => match &error.problem {
            FileProblem::Io(source) if is_missing(source) => Some(BESIDE),
            FileProblem::Archive(_) => Some("the file may be cut off: copy or save it again"),
            FileProblem::MissingKeys { .. } | FileProblem::Array { .. } => Some(ARRAY),
            _ => None,
        },
        DataError::Extent { .. } => Some(
            "its vertices may be at one place, or in another unit than `units` names for all meshes",
        ),
        DataError::Foreign { .. } => {
            Some("the mesh was written by a computation that failed: export it again")
        }
        DataError::OtherMesh {
            difference: MeshDifference::Mirrored,
            ..
        } => Some("export it again without a mirrored axis: meshes have y up and are right-handed"),
        DataError::OtherMesh { .. } => {
            Some("meshes have the vertices of the package, in the same order")
        }
        DataError::Apart { .. } => {
            Some("export garment and body of a scene from one place, in the same unit")
        }
        DataError::Changed { .. } => {
            Some("run the command again when nothing writes the meshes any more")
        }
        _ => None,
    }
}

pub(super) fn for_data(error: &DataError) -> Option<&'static str> {
    match error {
        DataError::Read { source, .. } | DataError::Folder { source, .. } => for_io(source),
        DataError::Write(error) => for_write(error),
        DataError::Mesh(error) => for_mesh(error),
        DataError::Obj(error) => for_obj(error),
        DataError::Rig(error) => for_file(&error.problem),
        DataError::Skin(error) => for_skin(error),
        DataError::Sim(error) => for_sim(error),
        DataError::Package(error) => for_package(error),
        DataError::Foreign { path, .. } => Some(for_foreign(path)),
        DataError::NoDataset { .. } => {
            Some("name the folder that has one; `garnet dataset PACKAGE -o DIR` makes a data set")
        }
        DataError::Text { path, .. } if path.ends_with("dataset.json") => {
            Some("copy it again, or make the data set anew in another folder")
        }
        DataError::Tensors { path, .. }
        | DataError::Altered { path, .. }
        | DataError::MisnamedShard { path, .. }
        | DataError::Text { path, .. }
            if is_shard(path) =>
        {
            Some(
                "copy it again from where the data set came from, or delete it and run `garnet dataset` again with the \
                 same arguments, which makes what is missing",
            )
        }
        DataError::Tensors { .. } | DataError::Altered { .. } => {
            Some("copy the file again from where it came from")
        }
        DataError::InUse { .. } => Some(WAIT),
        _ => None,
    }
}

pub(super) fn for_package(error: &PackageError) -> Option<&'static str> {
    match error {
        PackageError::Read { source, .. } | PackageError::Folder { source, .. } => for_io(source),
        PackageError::Write(error) => for_write(error),
        PackageError::Mesh(error) => for_mesh(error),
        PackageError::Obj(error) => for_obj(error),
        PackageError::Rig(error) => for_file(&error.problem),
        PackageError::Skin(error) => for_skin(error),
        PackageError::Sim(error) => for_sim(error),
        PackageError::Fabric { .. } | PackageError::Number { .. } => {
            Some("correct the value in the file, or make the package anew")
        }
        PackageError::Text { .. } => {
            Some("correct the line, copy the file again, or make the package anew")
        }
        PackageError::Foreign { .. } => Some(
            "copy the file again from where the package came from; a package of a changed garment \
             is made with `garnet garment from-obj`",
        ),
        PackageError::Tensors { .. } | PackageError::Altered { .. } => {
            Some("copy the file again from where it came from, or make the package anew")
        }
        PackageError::InUse { .. } => Some(WAIT),
        PackageError::OverHoles { .. } => Some(
            "drape it by the warp, which holes of the body do not stop; or give the body with the \
             skin below the garment",
        ),
        PackageError::InsideAtStart { .. } => Some(
            "the garment may belong to another body: let it lie on the skin of this one, not in it",
        ),
        _ => None,
    }
}

pub(super) fn is_shard(path: &Path) -> bool {
    path.parent()
        .is_some_and(|folder| folder.ends_with("shards"))
}

/// By the name of the file: a shard, a manifest of a data set or of an import, a folder of shirts,
/// or else a mesh.
pub(super) fn for_foreign(path: &Path) -> &'static str {
    let extension = path.extension().unwrap_or_default();
    if path.ends_with("dataset.json") {
        "make the data set anew with `garnet dataset` and another `-o`, or use the version that made it"
    } else if is_shard(path) {
        "move it out of the folder, or copy it again from where the data set came from"
    } else if extension == "json" {
        "`garnet dataset --help` shows the form of a manifest"
    } else if path.is_dir() {
        "name the folder that has a folder for each shirt, or a manifest, whose form `garnet dataset --help` shows"
    } else {
        "the mesh was written by a computation that failed: export it again"
    }
}

pub(super) fn for_sim(error: &SimError) -> Option<&'static str> {
    match error {
        SimError::NonManifoldEdge { .. } => Some(
            "cloth has one or two faces at an edge: delete doubled and surplus faces of the garment",
        ),
        SimError::InvertedFace { .. } => Some(
            "turn the faces of the garment to one side: recalculate its normals in a 3D program",
        ),
        SimError::NoArea { .. } => Some("dissolve faces without area; `garnet info` counts them"),
        SimError::Torn { .. } | SimError::Exploded { .. } => Some(
            "the garment may be too small for the body, or lie in it or in itself: `garnet drape --method warp` shows it on \
             the body without simulation",
        ),
        SimError::Garment(error) => for_mesh(error),
        _ => None,
    }
}
