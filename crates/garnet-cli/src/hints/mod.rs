//! Advice for what can be wrong with files, by the type of the error.

mod data;
mod nearest;
mod pattern;
mod scene;
mod train;

use std::{error::Error as StdError, io, path::Path};

use garnet::{
    CheckpointError, Error, MeshError, NetError, SkinError,
    data::DataError,
    io::{
        ArrayProblem, FileError, FileProblem, MotionError, MotionProblem, ObjError, ObjLineProblem,
        ObjParseError, WriteError,
    },
    motion::RetargetError,
    package::PackageError,
    pattern::PatternError,
    sim::SimError,
    train::TrainError,
};

pub(crate) use data::Hinting;
pub(crate) use nearest::nearest;
pub(crate) use pattern::for_pattern;
pub(crate) use train::{CONFIG_HINT, advised};

/// The advice of the innermost cause that has one.
pub(crate) fn for_error(error: &anyhow::Error) -> Option<String> {
    let links: Vec<&(dyn StdError + 'static)> = error.chain().collect();
    let hint = |link| {
        let own = for_pattern_link(link).or_else(|| scene::for_link(link));
        own.or_else(|| for_link(link).map(str::to_owned))
    };
    links.into_iter().rev().find_map(hint)
}

fn for_pattern_link(link: &(dyn StdError + 'static)) -> Option<String> {
    match link.downcast_ref::<DataError>() {
        Some(DataError::Pattern(error)) => for_pattern(error),
        _ => link.downcast_ref::<PatternError>().and_then(for_pattern),
    }
}

fn for_link(link: &(dyn StdError + 'static)) -> Option<&'static str> {
    if let Some(error) = link.downcast_ref::<Error>() {
        return for_garnet(error);
    }
    if let Some(error) = link.downcast_ref::<ObjError>() {
        return for_obj(error);
    }
    if let Some(error) = link.downcast_ref::<ObjParseError>() {
        return Some(for_parse(error));
    }
    if let Some(error) = link.downcast_ref::<FileError>() {
        return for_file(&error.problem);
    }
    if let Some(problem) = link.downcast_ref::<FileProblem>() {
        return for_file(problem);
    }
    if let Some(error) = link.downcast_ref::<MotionError>() {
        return for_motion(&error.problem);
    }
    if let Some(error) = link.downcast_ref::<RetargetError>() {
        return for_retarget(error);
    }
    if let Some(error) = link.downcast_ref::<SkinError>() {
        return for_skin(error);
    }
    if let Some(error) = link.downcast_ref::<MeshError>() {
        return for_mesh(error);
    }
    if let Some(error) = link.downcast_ref::<TrainError>() {
        return for_train(error);
    }
    if let Some(error) = link.downcast_ref::<DataError>() {
        return for_data(error);
    }
    if let Some(error) = link.downcast_ref::<PackageError>() {
        return for_package(error);
    }
    if let Some(error) = link.downcast_ref::<SimError>() {
        return for_sim(error);
    }
    if let Some(error) = link.downcast_ref::<CheckpointError>() {
        return for_weights(error);
    }
    if let Some(error) = link.downcast_ref::<WriteError>() {
        return for_write(error);
    }
    link.downcast_ref::<io::Error>().and_then(for_io)
}

fn for_garnet(error: &Error) -> Option<&'static str> {
    match error {
        Error::Obj(error) => for_obj(error),
        Error::File(error) => for_file(&error.problem),
        Error::Mesh(error) => for_mesh(error),
        Error::Skin(error) => for_skin(error),
        Error::Weights(error) => for_weights(error),
        Error::Package(error) => for_package(error),
        Error::Misplaced(problem) => Some(scene::for_misplaced(problem)),
        _ => None,
    }
}

/// Errors of a training that are those of something else, which is no link of the chain.
fn for_train(error: &TrainError) -> Option<&'static str> {
    match error {
        TrainError::Read { source, .. } | TrainError::Folder { source, .. } => for_io(source),
        TrainError::Write(error) => for_write(error),
        TrainError::Data(error) => for_data(error),
        TrainError::Package(error) => for_package(error),
        TrainError::Checkpoint(error) => for_weights(error),
        TrainError::Net(error) => for_network(error),
        TrainError::Skin(error) => for_skin(error),
        TrainError::Mesh(error) => for_mesh(error),
        _ => None,
    }
}

fn for_network(error: &NetError) -> Option<&'static str> {
    match error {
        NetError::OtherGarment { .. } => Some(OTHER_GARMENT),
        NetError::Mesh(error) => for_mesh(error),
        _ => None,
    }
}

const OTHER_GARMENT: &str = "a network drapes the garment that it was trained for: train one with `garnet train`, or \
     choose `--method warp`";

fn for_data(error: &DataError) -> Option<&'static str> {
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

/// What helps while another run has a folder.
const WAIT: &str = "wait until that process ends, or end it; what it leaves holds nobody up";

fn for_package(error: &PackageError) -> Option<&'static str> {
    match error {
        PackageError::Read { source, .. } | PackageError::Folder { source, .. } => for_io(source),
        PackageError::Write(error) => for_write(error),
        PackageError::Mesh(error) => for_mesh(error),
        PackageError::Obj(error) => for_obj(error),
        PackageError::Rig(error) => for_file(&error.problem),
        PackageError::Skin(error) => for_skin(error),
        PackageError::Sim(error) => for_sim(error),
        PackageError::Fabric { .. } => {
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
        PackageError::InsideAtStart { .. } => Some(
            "the garment may belong to another body: let it lie on the skin of this one, not in it",
        ),
        _ => None,
    }
}

fn is_shard(path: &Path) -> bool {
    path.parent()
        .is_some_and(|folder| folder.ends_with("shards"))
}

/// By the name of the file: a shard, a manifest of a data set or of an import, a folder of shirts, or
/// else a mesh.
fn for_foreign(path: &Path) -> &'static str {
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

fn for_sim(error: &SimError) -> Option<&'static str> {
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

fn for_weights(error: &CheckpointError) -> Option<&'static str> {
    match error {
        CheckpointError::Io { source, .. } => for_io(source),
        CheckpointError::Write(error) => for_write(error),
        CheckpointError::Schema { .. } => {
            Some("train the variant anew with this version, or use the version that wrote it")
        }
        CheckpointError::Unfit { .. } => Some(OTHER_GARMENT),
        _ => Some("copy the file again, or train the variant anew with `garnet train`"),
    }
}

fn for_motion(problem: &MotionProblem) -> Option<&'static str> {
    match problem {
        MotionProblem::Io(source) => for_io(source),
        _ => Some(
            "motions are BVH, npz with `poses` as in AMASS, or pose JSON; a file that ends early was \
             not copied whole",
        ),
    }
}

fn for_retarget(error: &RetargetError) -> Option<&'static str> {
    match error {
        RetargetError::FrameOutOfRange { .. } | RetargetError::NoFrames { .. } => {
            Some("`garnet info` tells how many frames a motion has")
        }
        RetargetError::MissingJoints { .. } if error.is_of_body() => Some(
            "poses of the library and motions find joints by the names that SMPL, CMU, MakeHuman, Mixamo and \
             Blender give them: rename those of the rig, or write a pose file for its own names",
        ),
        RetargetError::MissingJoints { .. } => Some(
            "joints are known by the names that SMPL, CMU, MakeHuman, Mixamo and Blender give them; \
             rename those of the motion",
        ),
        _ if error.is_of_body() => Some(
            "poses of the library and motions are for human figures: write a pose file for this rig",
        ),
        _ => None,
    }
}

fn for_obj(error: &ObjError) -> Option<&'static str> {
    match error {
        ObjError::Read { source, .. } => for_io(source),
        ObjError::Parse { source, .. } => Some(for_parse(source)),
        ObjError::Write(error) => for_write(error),
        _ => None,
    }
}

fn for_parse(error: &ObjParseError) -> &'static str {
    match error {
        ObjParseError::NotObj { .. } => {
            "garments and bodies are OBJ meshes; a GLB or npz file with a skeleton goes to `--rig`"
        }
        ObjParseError::Empty | ObjParseError::NoVertices | ObjParseError::NoFaces => {
            "export the mesh with its faces as OBJ"
        }
        ObjParseError::Line { problem, .. } => match problem {
            ObjLineProblem::IndexOutOfRange { .. } => {
                "the file may be cut off, or was joined from files without renumbering the faces"
            }
            ObjLineProblem::CoordinateOutOfRange { .. } => {
                "the mesh was written by a computation that failed: export it again"
            }
            ObjLineProblem::IndexZero { .. } => "add 1 to all indices of the faces",
            _ => "correct the line, or export the mesh again as OBJ",
        },
        _ => "export the mesh again as OBJ",
    }
}

fn for_file(problem: &FileProblem) -> Option<&'static str> {
    match problem {
        FileProblem::Io(error) => for_io(error),
        FileProblem::UnknownFormat => Some(
            "rigs are npz archives, GLB or glTF files with a skin, or JSON; the OBJ of the rest \
             body goes to `--rest-body`",
        ),
        FileProblem::Json { .. } | FileProblem::Field { .. } | FileProblem::ListLength { .. } => {
            Some("correct the field; `garnet drape --help` names the formats")
        }
        FileProblem::UnknownJointName { .. } => {
            Some("`garnet info RIG` lists the names of the joints")
        }
        FileProblem::NotAUnitQuaternion { .. } => {
            Some("rotations are written as `[x, y, z, w]` with norm 1")
        }
        FileProblem::FrameOutOfRange { .. } => Some("name a frame as `--pose FILE:FRAME`"),
        FileProblem::NoPose => Some("`garnet drape --help` shows the form of a pose file"),
        FileProblem::MissingFile { .. } => Some("paths in a JSON file are relative to it"),
        FileProblem::MissingKeys { .. } => Some(
            "a rig has the arrays `vertices`, `faces`, `blend_weights`, `joints` and `parents`",
        ),
        FileProblem::Archive(_) => Some("the file may be cut off: copy or save it again"),
        FileProblem::Array { problem, .. } => Some(for_array(problem)),
        FileProblem::Gltf(_) => {
            Some("the file may be cut off or have no skinned mesh: export it again with its skin")
        }
        FileProblem::Skin(error) => for_skin(error),
        FileProblem::Mesh(error) => for_mesh(error),
        FileProblem::Obj(error) => for_obj(error),
        FileProblem::Other(error) => for_file(&error.problem),
        _ => None,
    }
}

fn for_array(problem: &ArrayProblem) -> &'static str {
    match problem {
        ArrayProblem::Unpack { .. } => "the file may be cut off: copy or save it again",
        _ => "all arrays of a rig must be of the same body: save them again together",
    }
}

fn for_skin(error: &SkinError) -> Option<&'static str> {
    match error {
        SkinError::CyclicParents { .. } | SkinError::ParentOutOfRange { .. } => {
            Some("the parents of a skeleton form a tree; a root has the parent -1")
        }
        SkinError::NoWeight { .. } => {
            Some("paint weights for every vertex of the body, then export the rig again")
        }
        SkinError::VertexCount { .. } | SkinError::JointCount { .. } => {
            Some("rig and rest body must be of the same mesh")
        }
        SkinError::NoRestMesh => Some("give the rest body with `--rest-body OBJ`"),
        SkinError::RotationCount { .. } | SkinError::TransformCount { .. } => {
            Some("the pose must be made for the skeleton of the rig")
        }
        SkinError::NotRigid { .. } => Some("bake scales of joints into the mesh before export"),
        SkinError::NonFiniteWeight { .. }
        | SkinError::NegativeWeight { .. }
        | SkinError::NonFiniteJoint { .. } => Some("export the rig again"),
        SkinError::Singular(_) => Some("`garnet info` shows what is unusual about the garment"),
        _ => None,
    }
}

fn for_mesh(error: &MeshError) -> Option<&'static str> {
    match error {
        MeshError::NoFaces => Some("export the mesh with its faces"),
        MeshError::FaceIndexOutOfRange { .. } | MeshError::CoordinateOutOfRange { .. } => {
            Some("export the mesh again")
        }
        _ => None,
    }
}

fn for_write(error: &WriteError) -> Option<&'static str> {
    match error {
        WriteError::FolderMissing { .. } => Some("create the folder first"),
        WriteError::IsFolder { .. } => Some("name a file in it"),
        WriteError::Io { source, .. } => for_io(source),
        _ => None,
    }
}

fn for_io(error: &io::Error) -> Option<&'static str> {
    match error.kind() {
        io::ErrorKind::NotFound => Some("check the path; relative paths start in this folder"),
        io::ErrorKind::PermissionDenied => Some("check the permissions of the file"),
        io::ErrorKind::IsADirectory => Some("name a file in the folder"),
        io::ErrorKind::StorageFull => Some("make room on the disk"),
        io::ErrorKind::NotADirectory => Some("check the path: a part of it is no folder"),
        _ => None,
    }
}
