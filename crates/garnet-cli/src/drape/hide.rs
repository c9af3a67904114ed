//! Which faces of the body the garment covers, as a file.

use std::path::{Path, PathBuf};

use garnet::{
    Drape, PosedBody,
    drape::{Coverage, CoverageOptions},
};
use serde::Serialize;

use super::Bound;
use crate::output;

/// What is written.
#[derive(Debug, Serialize)]
struct HideReport<'a> {
    schema: &'static str,
    garment: String,
    body: String,
    /// Faces of the body.
    faces: usize,
    /// How many drapes they are covered in.
    drapes: usize,
    /// The faces that may be hidden, from 0, in the order of the body's file.
    hidden: &'a [usize],
}

/// What is covered in all drapes so far.
pub(super) struct Hiding {
    path: PathBuf,
    coverage: Coverage,
    num_drapes: usize,
}

impl Hiding {
    pub(super) fn new(path: &Path, bound: &Bound) -> Self {
        Self {
            path: path.to_path_buf(),
            coverage: Coverage::at_rest(&bound.garment, CoverageOptions::default()),
            num_drapes: 0,
        }
    }

    pub(super) fn see(&mut self, bound: &Bound, drape: &Drape, body: &PosedBody) {
        self.coverage.see(&bound.garment, body, &drape.positions);
        self.num_drapes += 1;
    }

    /// Writes the faces, and tells how many there are.
    pub(super) fn finish(self, bound: &Bound) -> anyhow::Result<usize> {
        let is_hidden = self.coverage.into_hidden();
        let (hidden, faces) = match &bound.rest.file {
            None => (numbers(is_hidden.iter().copied()), is_hidden.len()),
            Some(file) => {
                let mut is_whole = vec![true; file.num_polygons()];
                for (polygon, is_hidden) in file.triangle_polygon().iter().zip(&is_hidden) {
                    is_whole[*polygon as usize] &= is_hidden;
                }
                (numbers(is_whole.iter().copied()), is_whole.len())
            }
        };
        let is_text = self
            .path
            .extension()
            .is_some_and(|kind| kind.eq_ignore_ascii_case("txt"));
        let text = if is_text {
            let lines = hidden
                .iter()
                .map(|face| [face.to_string(), "\n".to_owned()]);
            lines.flatten().collect()
        } else {
            let report = HideReport {
                schema: "garnet.hide/1",
                garment: bound.garment_file.path().display().to_string(),
                body: bound.rest.path.display().to_string(),
                faces,
                drapes: self.num_drapes,
                hidden: &hidden,
            };
            serde_json::to_string(&report)? + "\n"
        };
        output::write(&self.path, text.as_bytes())?;
        Ok(hidden.len())
    }
}

/// The numbers of what is set.
fn numbers(are_set: impl Iterator<Item = bool>) -> Vec<usize> {
    let numbered = are_set.enumerate().filter(|(_, is_set)| *is_set);
    numbered.map(|(number, _)| number).collect()
}
