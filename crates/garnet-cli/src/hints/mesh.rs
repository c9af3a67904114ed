//! Advice for what can be wrong with meshes and files.

use std::io;

use garnet::{
    io::{ObjError, ObjLineProblem, ObjParseError, WriteError},
    mesh::MeshError,
};

pub(super) fn for_obj(error: &ObjError) -> Option<&'static str> {
    match error {
        ObjError::Read { source, .. } => for_io(source),
        ObjError::Parse { source, .. } => Some(for_parse(source)),
        ObjError::Write(error) => for_write(error),
        _ => None,
    }
}

pub(super) fn for_parse(error: &ObjParseError) -> &'static str {
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

pub(super) fn for_mesh(error: &MeshError) -> Option<&'static str> {
    match error {
        MeshError::NoFaces => Some("export the mesh with its faces"),
        MeshError::FaceIndexOutOfRange { .. } | MeshError::CoordinateOutOfRange { .. } => {
            Some("export the mesh again")
        }
        _ => None,
    }
}

pub(super) fn for_write(error: &WriteError) -> Option<&'static str> {
    match error {
        WriteError::FolderMissing { folder, .. } if folder.exists() => Some("name another folder"),
        WriteError::FolderMissing { .. } => Some("create the folder first"),
        WriteError::IsFolder { .. } => Some("name a file in it"),
        WriteError::Io { source, .. } => for_io(source),
        _ => None,
    }
}

pub(super) fn for_io(error: &io::Error) -> Option<&'static str> {
    match error.kind() {
        io::ErrorKind::NotFound => Some("check the path; relative paths start in this folder"),
        io::ErrorKind::PermissionDenied => Some("check the permissions of the file"),
        io::ErrorKind::IsADirectory => Some("name a file in the folder"),
        io::ErrorKind::StorageFull => Some("make room on the disk"),
        io::ErrorKind::NotADirectory => Some("check the path: a part of it is no folder"),
        io::ErrorKind::InvalidInput => for_refused(&error.to_string()),
        io::ErrorKind::InvalidData if error.to_string().contains("UTF-8") => {
            Some("name a file of text, saved as UTF-8")
        }
        _ => None,
    }
}

/// What helps against what `read_bounded` refuses, by its text.
fn for_refused(text: &str) -> Option<&'static str> {
    if text.ends_with("are read at most") {
        Some("such files are smaller: name another one, or make it anew")
    } else if text.contains("a pipe or a device") {
        Some("save what comes from there in a file, and name that")
    } else {
        None
    }
}
