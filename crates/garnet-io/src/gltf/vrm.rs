//! The humanoid map of VRM files: which node is which joint.

use serde::Deserialize;
use serde_json::Value;

#[derive(Debug, Default, Deserialize)]
struct Extensions {
    #[serde(default)]
    extensions: Value,
}

/// What the joints of VRM are called in the built-in skeleton.
const NAMES: [(&str, &str); 23] = [
    ("hips", "pelvis"),
    ("spine", "spine1"),
    ("chest", "spine2"),
    ("upperChest", "spine3"),
    ("neck", "neck"),
    ("head", "head"),
    ("leftShoulder", "left_collar"),
    ("rightShoulder", "right_collar"),
    ("leftUpperArm", "left_shoulder"),
    ("rightUpperArm", "right_shoulder"),
    ("leftLowerArm", "left_elbow"),
    ("rightLowerArm", "right_elbow"),
    ("leftHand", "left_wrist"),
    ("rightHand", "right_wrist"),
    ("leftUpperLeg", "left_hip"),
    ("rightUpperLeg", "right_hip"),
    ("leftLowerLeg", "left_knee"),
    ("rightLowerLeg", "right_knee"),
    ("leftFoot", "left_ankle"),
    ("rightFoot", "right_ankle"),
    ("leftToes", "left_foot"),
    ("rightToes", "right_foot"),
    ("jaw", "jaw"),
];

/// Nodes by the names of the built-in skeleton, as the extensions `VRMC_vrm` (VRM 1) and `VRM`
/// (VRM 0) say; nothing of files without them.
pub(super) fn humanoid(text: &[u8]) -> Vec<(String, usize)> {
    let Ok(Extensions { extensions }) = serde_json::from_slice(text) else {
        return Vec::new();
    };
    let ours = |bone: &str| {
        let found = NAMES.iter().find(|(theirs, _)| *theirs == bone);
        found.map(|(_, ours)| (*ours).to_owned())
    };
    let node = |bone: &Value| usize::try_from(bone.get("node")?.as_u64()?).ok();
    let bones = |extension: &str| {
        let found = extensions.get(extension)?.get("humanoid")?;
        found.get("humanBones")
    };
    if let Some(Value::Object(bones)) = bones("VRMC_vrm") {
        let named = bones.iter();
        return named
            .filter_map(|(name, bone)| Some((ours(name)?, node(bone)?)))
            .collect();
    }
    if let Some(Value::Array(bones)) = bones("VRM") {
        let named = bones.iter();
        return named
            .filter_map(|bone| Some((ours(bone.get("bone")?.as_str()?)?, node(bone)?)))
            .collect();
    }
    Vec::new()
}
