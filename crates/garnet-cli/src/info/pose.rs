//! What is in a pose file, without the skeleton that it is for.

use std::path::Path;

use anyhow::Context;
use serde::Serialize;
use serde_json::Value;

use super::table::Table;
use crate::{
    failure::{Hint, refused},
    input,
};

/// What is in a pose file.
#[derive(Debug, Serialize)]
pub(crate) struct PoseInfo {
    frames: usize,
    /// Joints with a rotation in the first frame, where they are named.
    joints: Vec<String>,
    /// Rotations or transforms in the first frame.
    rotations: usize,
    has_root_translation: bool,
}

impl PoseInfo {
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let document = read_json(path)?;
        let frames = document.get("frames").and_then(Value::as_array);
        let first = match frames {
            Some(frames) => frames.first(),
            None => Some(&document),
        };
        let found = first.and_then(|pose| Self::of(pose, &document));
        let found = found.ok_or_else(|| {
            refused(
                format!("cannot tell what `{}` is", path.display()),
                "it is JSON, and neither a pose, a rig, a scene nor a glTF model",
                "`garnet drape --help` shows the form of a pose file",
            )
        })?;
        Ok(Self {
            frames: frames.map_or(1, Vec::len),
            ..found
        })
    }

    fn of(pose: &Value, document: &Value) -> Option<Self> {
        let by_name = pose.get("joints").and_then(Value::as_object);
        let listed = ["local_rotation_xyzw", "joint_transforms_row_major_4x4"]
            .into_iter()
            .find_map(|key| pose.get(key).and_then(Value::as_array));
        let rotations = by_name.map(serde_json::Map::len).or(listed.map(Vec::len))?;
        let order = pose.get("joint_order").or(document.get("joint_order"));
        let order = order.and_then(Value::as_array).into_iter().flatten();
        let order = order.filter_map(|name| name.as_str().map(str::to_owned));
        Some(Self {
            frames: 1,
            joints: match by_name {
                Some(joints) => joints.keys().cloned().collect(),
                None => order.collect(),
            },
            rotations,
            has_root_translation: pose.get("root_translation").is_some(),
        })
    }

    pub(crate) fn fill(&self, table: &mut Table) {
        table.row("kind", "pose");
        table.row("frames", self.frames);
        table.row("rotations", self.rotations);
        if !self.joints.is_empty() {
            table.row("joints", self.joints.join(", "));
        }
        let shift = if self.has_root_translation {
            "yes"
        } else {
            "no"
        };
        table.row("root translation", shift);
    }
}

/// Reads JSON whatever it holds.
pub(crate) fn read_json(path: &Path) -> anyhow::Result<Value> {
    let cannot = || format!("cannot read `{}`", path.display());
    let bytes = input::bytes(path)?;
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
    let read = serde_json::from_slice(text).with_context(cannot);
    read.hint(|| "correct the line, or copy the file again, which may be cut off".to_owned())
}
