//! Rigs in any of the formats.

use std::{fs::File, io::Read, path::Path};

use garnet_skin::Rig;
use serde::{Deserialize, de::IgnoredAny};

use super::{
    FileError, FileProblem,
    gltf::{self, read_rig_gltf},
    json, rig_json,
    rig_npz::read_rig_npz,
    scene_json::SceneJson,
};

/// The fields that tell JSON files apart.
#[derive(Debug, Default, Deserialize)]
struct Peek {
    schema: Option<String>,
    asset: Option<IgnoredAny>,
    joints: Option<IgnoredAny>,
}

/// Reads a rig: npz, GLB, glTF, a `drape-scene/1` scene, or a rig JSON with its OBJ and weights.
///
/// The content decides; the extension `npz`, `glb` or `gltf` decides where the content tells
/// nothing.
///
/// # Errors
///
/// [`FileError`] with what the format's reader refuses, or [`FileProblem::UnknownFormat`].
pub fn read_rig(path: impl AsRef<Path>) -> Result<Rig, FileError> {
    let path = path.as_ref();
    let failed = |problem| FileError {
        path: path.to_path_buf(),
        problem,
    };
    let mut start = Vec::new();
    File::open(path)
        .and_then(|file| file.take(64).read_to_end(&mut start))
        .map_err(|error| failed(error.into()))?;
    if start.starts_with(b"PK") {
        return read_rig_npz(path);
    }
    if start.starts_with(gltf::MAGIC) {
        return read_rig_gltf(path);
    }
    let extension = path.extension().and_then(|extension| extension.to_str());
    match extension.unwrap_or_default().to_ascii_lowercase().as_str() {
        "npz" => return read_rig_npz(path),
        "glb" | "gltf" => return read_rig_gltf(path),
        _ => {}
    }
    let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&start);
    if text.trim_ascii_start().first() != Some(&b'{') {
        return Err(failed(FileProblem::UnknownFormat));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut scene = None;
    let rig = json::read_with(path, |bytes| {
        let peek: Peek = json::parse(bytes)?;
        if peek
            .schema
            .is_some_and(|schema| schema.starts_with("drape-scene/"))
        {
            scene = Some(SceneJson::parse(bytes, folder)?);
            return Ok(None);
        }
        if peek.asset.is_some() {
            return Ok(None);
        }
        if peek.joints.is_none() {
            return Err(FileProblem::UnknownFormat);
        }
        rig_json::parse(bytes, folder).map(Some)
    })?;
    match (rig, scene) {
        (Some(rig), _) => Ok(rig),
        (None, Some(scene)) => scene.rig(),
        (None, None) => read_rig_gltf(path),
    }
}
