//! What the JSON files have in common: parsing with line and column, units, axes, joints.

use std::path::Path;

use garnet_mesh::{MOST_BYTES, read_at_most};
use garnet_skin::{Joint, Point3, Skeleton, SkinError};
use serde::{Deserialize, de::DeserializeOwned};

use super::{FileError, FileProblem};

/// Reads a file and does `parse` on its bytes; errors name the file.
pub(super) fn read_with<T>(
    path: &Path,
    parse: impl FnOnce(&[u8]) -> Result<T, FileProblem>,
) -> Result<T, FileError> {
    let read = read_at_most(path, MOST_BYTES).map_err(FileProblem::from);
    read.and_then(|bytes| match bytes.as_slice() {
        [] => Err(FileProblem::Empty),
        bytes => parse(bytes),
    })
    .map_err(|problem| FileError {
        path: path.to_path_buf(),
        problem,
    })
}

pub(super) fn parse<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, FileProblem> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    serde_json::from_slice(bytes).map_err(|error| {
        let text = error.to_string();
        // serde_json appends the position, which stands in fields of its own here.
        let reason = text
            .rsplit_once(" at line ")
            .map_or(text.as_str(), |(reason, _)| reason);
        FileProblem::Json {
            line: error.line(),
            column: error.column(),
            reason: reason.to_owned(),
        }
    })
}

/// A joint as the rig and scene files write it.
#[derive(Debug, Deserialize)]
pub(super) struct JointJson {
    name: String,
    parent: Option<i64>,
    rest_position: [f64; 3],
}

/// The unit of length and the upward axis that a file declares.
#[derive(Debug, Default, Deserialize)]
pub(super) struct Frame {
    pub units: Option<String>,
    pub up: Option<String>,
}

impl Frame {
    /// Metres in one unit of the file.
    pub(super) fn metres(&self) -> Result<f64, FileProblem> {
        let up = self.up.as_deref().unwrap_or("+Y");
        if !["+y", "y"].contains(&up.to_ascii_lowercase().as_str()) {
            return Err(FileProblem::Field {
                field: "up".to_owned(),
                found: up.to_owned(),
                expected: "`+Y`",
            });
        }
        match self.units.as_deref().unwrap_or("m") {
            "m" => Ok(1.0),
            "dm" => Ok(0.1),
            "cm" => Ok(0.01),
            "mm" => Ok(0.001),
            "in" => Ok(0.0254),
            "ft" => Ok(0.3048),
            other => Err(FileProblem::Field {
                field: "units".to_owned(),
                found: other.to_owned(),
                expected: "`m`, `dm`, `cm`, `mm`, `in` or `ft`",
            }),
        }
    }
}

pub(super) fn point(coordinates: [f64; 3], metres: f64) -> Point3 {
    Point3::from(coordinates.map(|value| (value * metres) as f32))
}

/// The skeleton of a list of joints; a root has no parent or the parent -1.
pub(super) fn skeleton(joints: Vec<JointJson>, metres: f64) -> Result<Skeleton, FileProblem> {
    let num_joints = joints.len();
    let mut checked = Vec::with_capacity(num_joints);
    for (index, joint) in joints.into_iter().enumerate() {
        let parent = match joint.parent {
            None | Some(-1) => None,
            Some(parent) => match usize::try_from(parent) {
                Ok(parent) => Some(parent),
                Err(_) => {
                    return Err(FileProblem::Field {
                        field: format!("joints[{index}].parent"),
                        found: parent.to_string(),
                        expected: "a joint number, or -1 for a root",
                    });
                }
            },
        };
        checked.push(Joint {
            name: joint.name,
            parent,
            rest_position: point(joint.rest_position, metres),
        });
    }
    Skeleton::new(checked).map_err(|error: SkinError| error.into())
}
