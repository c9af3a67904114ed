//! `garnet info`: what is in files.

mod dataset;
mod mesh;
mod motion;
mod package;
mod pose;
mod rig;
mod table;

use std::path::{Path, PathBuf};

use clap::Args;
use garnet::{
    io::{FileProblem, GltfProblem, NpzFile, RigOptions},
    package::GarmentPackage,
};
use serde::Serialize;

use crate::{
    console::{Console, print_data, print_document},
    failure::{ExitStatus, refused},
    input, models,
    rig_args::RigArgs,
};
use dataset::DatasetInfo;
use mesh::MeshInfo;
use motion::MotionInfo;
use package::PackageInfo;
use pose::PoseInfo;
use rig::{RigInfo, SceneInfo};
use table::Table;

/// Arguments of `info`.
#[derive(Debug, Args)]
pub(crate) struct InfoArgs {
    /// Meshes (OBJ), rigs (npz, GLB, glTF, JSON), scenes and poses (JSON), motions (BVH, npz),
    /// folders of garment packages and data sets.
    #[arg(value_name = "FILE", required = true, value_parser = models::package_or_file)]
    files: Vec<PathBuf>,
    /// How rigs are read.
    #[command(flatten)]
    rig: RigArgs,
}

/// The document of `info`: `garnet.info/1`.
#[derive(Debug, Serialize)]
struct InfoReport {
    /// `garnet.info/1`.
    schema: &'static str,
    /// One for each file.
    files: Vec<FileInfo>,
}

/// What is in a file.
#[derive(Debug, Serialize)]
struct FileInfo {
    /// The file.
    path: String,
    /// What it holds.
    #[serde(flatten)]
    content: Content,
}

/// What a file holds.
#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Content {
    /// A mesh.
    Mesh(MeshInfo),
    /// A skeleton with weights.
    Rig(RigInfo),
    /// A garment, two bodies and a pose.
    Scene(SceneInfo),
    /// A pose, or several.
    Pose(PoseInfo),
    /// A motion with a skeleton of its own.
    Motion(MotionInfo),
    /// A garment with its body and networks.
    Package(PackageInfo),
    /// Simulated scenes.
    Dataset(DatasetInfo),
}

/// Reads each file and tells what is in it; those that cannot be read are told after the others.
pub(crate) fn run(args: &InfoArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    args.rig.check(&args.files)?;
    let options = args.rig.clone().options();
    let (mut files, mut failures) = (Vec::new(), Vec::new());
    for path in &args.files {
        match content(path, &options) {
            Ok(content) => files.push(FileInfo {
                path: path.display().to_string(),
                content,
            }),
            Err(failure) => failures.push(failure),
        }
    }
    if !files.is_empty() || failures.is_empty() {
        if console.is_json() {
            let schema = "garnet.info/1";
            print_document(&InfoReport { schema, files })?;
        } else {
            let tables: Vec<String> = files.iter().map(|file| table(file).to_string()).collect();
            print_data(&tables.join("\n\n"))?;
        }
    }
    let last = failures.pop();
    for failure in &failures {
        console.failure(failure);
    }
    last.map_or(Ok(ExitStatus::Done), Err)
}

fn table(file: &FileInfo) -> Table {
    let mut table = Table::new(&file.path);
    match &file.content {
        Content::Mesh(mesh) => mesh.fill(&mut table),
        Content::Rig(rig) => rig.fill(&mut table),
        Content::Scene(scene) => scene.fill(&mut table),
        Content::Pose(pose) => pose.fill(&mut table),
        Content::Motion(motion) => motion.fill(&mut table),
        Content::Package(package) => package.fill(&mut table),
        Content::Dataset(dataset) => dataset.fill(&mut table),
    }
    table
}

fn content(path: &Path, options: &RigOptions) -> anyhow::Result<Content> {
    Ok(match kind(path)? {
        Kind::Mesh => Content::Mesh(MeshInfo::read(path)?),
        Kind::Rig => match RigInfo::read(path, options) {
            Ok(rig) => Content::Rig(rig),
            Err(error) => match MotionInfo::read(path) {
                Ok(motion) => Content::Motion(motion),
                Err(of_motion) => match kind_of_npz(path) {
                    Some(Kind::Motion) => return Err(of_motion),
                    Some(_) => Content::Mesh(MeshInfo::read(path)?),
                    None if has_no_skin(&error) && options.meshes.is_empty() => {
                        Content::Mesh(MeshInfo::read(path)?)
                    }
                    None => return Err(error),
                },
            },
        },
        Kind::Motion => Content::Motion(MotionInfo::read(path)?),
        Kind::Scene => Content::Scene(SceneInfo::read(path)?),
        Kind::Pose => Content::Pose(PoseInfo::read(path)?),
        Kind::Package => Content::Package(PackageInfo::read(path)?),
        Kind::Dataset => Content::Dataset(DatasetInfo::read(path)?),
    })
}

/// What an archive is that is no rig: a motion of poses, or the frames of a mesh.
fn kind_of_npz(path: &Path) -> Option<Kind> {
    let keys = NpzFile::open(path).ok()?.keys();
    let has = |key: &str| keys.iter().any(|other| other == key);
    if ["poses", "body_pose", "pose_body", "trans"]
        .into_iter()
        .any(has)
    {
        return Some(Kind::Motion);
    }
    let is_rig = has("blend_weights") || has("weights");
    (has("vertices") && has("faces") && !is_rig).then_some(Kind::Mesh)
}

/// Whether a file is no rig because its meshes have no skin.
fn has_no_skin(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        let problem = cause.downcast_ref::<FileProblem>();
        matches!(problem, Some(FileProblem::Gltf(GltfProblem::NoSkin)))
    })
}

enum Kind {
    Mesh,
    Rig,
    Scene,
    Pose,
    Motion,
    Package,
    Dataset,
}

/// The content decides, and the extension where it tells nothing.
fn kind(path: &Path) -> anyhow::Result<Kind> {
    if GarmentPackage::is_at(path) {
        return Ok(Kind::Package);
    }
    if DatasetInfo::is_at(path) {
        return Ok(Kind::Dataset);
    }
    if path.is_dir() {
        return Err(refused(
            format!("cannot read `{}`", path.display()),
            "it is a folder, and no garment package or data set: it has no \
             `garment.toml` and no `dataset.json`",
            "name a file in it, or the folder of a garment package or data set",
        ));
    }
    let start = input::start(path, 64)?;
    let extension = path.extension().and_then(|extension| extension.to_str());
    let extension = extension.unwrap_or_default().to_ascii_lowercase();
    if start.starts_with(b"PK") || start.starts_with(b"glTF") {
        return Ok(Kind::Rig);
    }
    let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&start);
    let is_json = text.trim_ascii_start().first() == Some(&b'{');
    let first_word = text.trim_ascii_start().get(..9);
    if first_word.is_some_and(|word| word.eq_ignore_ascii_case(b"HIERARCHY")) {
        return Ok(Kind::Motion);
    }
    match extension.as_str() {
        "bvh" => Ok(Kind::Motion),
        "npz" | "glb" | "gltf" | "vrm" => Ok(Kind::Rig),
        _ if is_json => kind_of_json(path),
        _ => Ok(Kind::Mesh),
    }
}

fn kind_of_json(path: &Path) -> anyhow::Result<Kind> {
    let document = pose::read_json(path)?;
    let schema = document.get("schema").and_then(|schema| schema.as_str());
    let joints = document.get("joints");
    Ok(match schema {
        Some(schema) if schema.starts_with("drape-scene/") => Kind::Scene,
        _ if document.get("asset").is_some() => Kind::Rig,
        _ if joints.is_some_and(serde_json::Value::is_array) => Kind::Rig,
        _ => Kind::Pose,
    })
}
