//! Rigs as JSON: joints beside an OBJ and a weights file.

use std::path::Path;

use garnet_mesh::{TriMesh, check_regular};
use garnet_skin::{Point3, Rig};
use serde::Deserialize;

use super::{
    FileProblem,
    json::{self, Frame, JointJson},
    obj::ObjFile,
    weights_json::read_weights,
};

#[derive(Debug, Deserialize)]
struct RigJson {
    units: Option<String>,
    up: Option<String>,
    mesh: Option<String>,
    joints: Vec<JointJson>,
    weights: String,
}

/// Reads `{"units", "up", "mesh", "joints": [{"name", "parent", "rest_position"}], "weights"}`;
/// paths are relative to `folder`.
pub(super) fn parse(bytes: &[u8], folder: &Path) -> Result<Rig, FileProblem> {
    let file: RigJson = json::parse(bytes)?;
    let frame = Frame {
        units: file.units,
        up: file.up,
    };
    let metres = frame.metres()?;
    let skeleton = json::skeleton(file.joints, metres)?;
    let weights_path = existing(folder, &file.weights, "the weights file")?;
    let weights = read_weights(weights_path)?;
    weights.check_joints(&skeleton)?;
    let rest = match &file.mesh {
        Some(name) => Some(read_mesh(&existing(folder, name, "the mesh")?, metres)?),
        None => None,
    };
    Ok(Rig {
        rest,
        skeleton,
        weights,
        rest_pose: None,
    })
}

/// The path of a file that another one names, which must be there.
pub(super) fn existing(
    folder: &Path,
    name: &str,
    role: &'static str,
) -> Result<std::path::PathBuf, FileProblem> {
    let path = folder.join(name);
    if path.is_file() {
        return Ok(path);
    }
    if path.exists() {
        check_regular(&path)?;
    }
    Err(FileProblem::MissingFile { role, path })
}

/// Reads an OBJ and scales it to metres.
pub(super) fn read_mesh(path: &Path, metres: f64) -> Result<TriMesh, FileProblem> {
    let mesh = ObjFile::read_regular(path)?.mesh()?;
    if (metres - 1.0).abs() < f64::EPSILON {
        return Ok(mesh);
    }
    let scaled = |point: &Point3| point * (metres as f32);
    Ok(mesh.with_positions(mesh.positions().iter().map(scaled).collect())?)
}
