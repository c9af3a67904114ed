//! The body that a pattern is cut for.

use std::path::Path;

use anyhow::Context;
use garnet::{
    Body, Point3, TriMesh,
    body::shape::{ParametricBody, Recognized, recognized},
    io::{Frame, ObjFile, OwnBody, largest_distance, read_rig, rig_beside},
};

use crate::failure::refused;

/// A vertex of a body at rest is no farther than this from its place in the rig, in metres.
const SAME: f32 = 2e-3;

/// Reads a rig, or an OBJ at rest.
pub(super) fn read(path: &Path) -> anyhow::Result<Body> {
    let is_obj = ObjFile::read(path).is_ok();
    let beside = rig_beside(path);
    if is_obj && !beside.is_file() {
        check_known(path)?;
    }
    if let Some(body) = elsewhere(path, &beside) {
        return Ok(body);
    }
    let OwnBody { body, shown, .. } = OwnBody::read(path, None)?;
    if is_obj && beside.is_file() {
        let shown = shown.as_ref().map(|(positions, _)| positions.as_slice());
        check_rest(path, &beside, shown.unwrap_or(body.rest().positions()))?;
    }
    Ok(body)
}

/// The built-in body at rest that an OBJ shows, if the rig beside it has it in another place: the
/// OBJ was turned or moved, and stands for itself.
fn elsewhere(path: &Path, beside: &Path) -> Option<Body> {
    let in_metres = |mesh: &TriMesh| {
        let places = Frame::detected(mesh).to_metres(mesh.positions().to_vec());
        mesh.with_positions(places).ok()
    };
    let of_rig = in_metres(&read_rig(beside).ok()?.rest?)?;
    let shown = in_metres(&ObjFile::read(path).ok()?.mesh().ok()?)?;
    let is_same = shown.num_vertices() == of_rig.num_vertices()
        && largest_distance(shown.positions(), of_rig.positions()) <= SAME;
    match recognized(&shown) {
        Recognized::Rest(body) if !is_same => Some(*body),
        _ => None,
    }
}

/// What is told of the coarse level of the built-in body, and what to do about it.
const COARSE: [&str; 2] = [
    "it is the coarse level of the built-in body, on which measures are not taken",
    "cut it for the same body made without `--coarse`; `garnet drape` puts the garment on the coarse one, too",
];

/// Whether a mesh is the coarse level of the built-in body, whatever its pose.
fn is_coarse(mesh: &TriMesh) -> bool {
    mesh.faces() == ParametricBody::coarse_faces()
}

/// The error of a body whose measures are not known, with the file that it came from if there is
/// one.
pub(super) fn unknown(path: Option<&Path>, mesh: &TriMesh) -> anyhow::Error {
    let body = path.map_or_else(
        || "this body".to_owned(),
        |path| format!("`{}`", path.display()),
    );
    let [cause, hint] = if is_coarse(mesh) {
        COARSE
    } else {
        [
            "its measures are not known: it is not the built-in body",
            "make a garment on a body of `garnet body`, or bring one along with `from-obj`",
        ]
    };
    refused(format!("a pattern cannot be cut for {body}"), cause, hint)
}

/// Refuses an OBJ without rig that is not the built-in body at rest.
fn check_known(path: &Path) -> anyhow::Result<()> {
    let mesh = ObjFile::read(path)?.mesh();
    let mesh = mesh.with_context(|| format!("cannot make a body of `{}`", path.display()))?;
    let cause = match recognized(&mesh) {
        Recognized::Rest(_) => return Ok(()),
        Recognized::Posed => {
            "it is the built-in body in a pose: its measures are not known".to_owned()
        }
        Recognized::Stranger if is_coarse(&mesh) => return Err(unknown(Some(path), &mesh)),
        Recognized::Stranger => format!(
            "it is not the built-in body, and there is no `{}`",
            rig_beside(path).display()
        ),
    };
    Err(refused(
        format!("a pattern cannot be cut for `{}`", path.display()),
        cause,
        "give an OBJ at rest of `garnet body`, or the rig of its body: `--body FILE.rig.npz`",
    ))
}

/// Refuses an OBJ that is in another pose than its rig is made for.
fn check_rest(path: &Path, beside: &Path, positions: &[Point3]) -> anyhow::Result<()> {
    let Some(rest) = read_rig(beside)?.rest else {
        return Ok(());
    };
    let frame = Frame::detected(&rest);
    let rest = frame.to_metres(rest.positions().to_vec());
    let distance = largest_distance(&rest, positions);
    if distance <= SAME {
        return Ok(());
    }
    Err(refused(
        format!(
            "a pattern cannot be cut for `{}`, which is not at rest",
            path.display()
        ),
        format!(
            "a vertex is {:.1} mm away from its place in the body at rest of `{}`",
            1e3 * distance,
            beside.display()
        ),
        format!(
            "give the body at rest: `--body {}`, or an OBJ that was made without a pose",
            beside.display()
        ),
    ))
}
