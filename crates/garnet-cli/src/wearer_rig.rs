//! Who wears a garment, by the rig that `garnet body` writes beside a posed body.

use std::path::Path;

use garnet::{
    Body, Point3,
    body::shape::tape_measures,
    io::{read_rig, rig_beside},
};

/// What is said of the measures of a posed body whose rig is not beside it.
pub(crate) const TOLD: &str =
    "as told from its pose, some centimetres off (its rig beside it tells them)";

/// The built-in body at rest whose rig lies beside the file of a body, if that body is the same in
/// a pose: its vertices are at `positions` `[vertex]`, in metres.
///
/// Its measures are exact, those that are found from a pose are not.
pub(crate) fn wearer_of_rig(path: &Path, positions: &[Point3]) -> Option<Body> {
    let beside = rig_beside(path);
    if !beside.is_file() {
        return None;
    }
    let body = read_rig(beside).ok()?.into_body().ok()?;
    tape_measures(&body)?;
    if body.rest().num_vertices() != positions.len() {
        return None;
    }
    let posed = body.fitted(positions).ok()?;
    posed.shape_offsets().is_none().then_some(body)
}
