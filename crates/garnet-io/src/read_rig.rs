//! Rigs in any of the formats.

use std::{
    collections::BTreeMap,
    fmt,
    fs::File,
    io::Read,
    iter::successors,
    path::{Path, PathBuf},
};

use garnet_body::motion::{Role, joint_named};
use garnet_skin::{Rig, Skeleton};
use serde::{Deserialize, de::IgnoredAny};

use super::{
    FileError, FileProblem,
    gltf::{self, RigPart, read_gltf},
    json,
    pose_json::near_names,
    rig_json,
    rig_npz::read_rig_npz_with,
    scene_json::SceneJson,
};

/// The fields that tell JSON files apart.
#[derive(Debug, Default, Deserialize)]
struct Peek {
    schema: Option<String>,
    asset: Option<IgnoredAny>,
    joints: Option<IgnoredAny>,
}

/// How a rig is read; the default takes what the file says.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct RigOptions {
    /// Of a GLB, glTF or VRM: the meshes that are the body, by the names of their nodes, meshes or
    /// materials.
    pub meshes: Vec<String>,
    /// Of a model of the SMPL family: the shape, in units of its shape directions.
    pub betas: Vec<f64>,
    /// A JSON file that tells which joint is which: `{"head": "J_Bip_C_Head", …}`, for joints whose
    /// names do not.
    pub joints: Option<PathBuf>,
}

/// A rig and what its file holds besides.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ReadRig {
    /// The rig.
    pub rig: Rig,
    /// The meshes of a GLB, glTF or VRM: those that are the body, and those that are left out.
    pub parts: Vec<RigPart>,
}

impl ReadRig {
    /// What was joined and left out, for the user to read; nothing where there is but one mesh.
    pub fn note(&self, path: &Path) -> Option<PartsNote> {
        PartsNote::of(path, self.parts.clone())
    }
}

/// Which meshes of a file are the body.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct PartsNote {
    /// The file.
    pub path: PathBuf,
    /// Its meshes.
    pub parts: Vec<RigPart>,
    /// Whether they are the body of a skeleton; all meshes of a file without any are read.
    pub has_skeleton: bool,
}

impl PartsNote {
    /// A note of the meshes of a skeleton; none of a single mesh.
    pub(crate) fn of(path: &Path, parts: Vec<RigPart>) -> Option<Self> {
        let path = path.to_path_buf();
        let has_skeleton = true;
        (parts.len() > 1).then_some(Self {
            path,
            parts,
            has_skeleton,
        })
    }

    /// A note of the meshes of a file without skeletons; none of a single mesh.
    pub(crate) fn of_bare(path: &Path, parts: Vec<RigPart>) -> Option<Self> {
        let has_skeleton = false;
        let note = Self::of(path, parts)?;
        Some(Self {
            has_skeleton,
            ..note
        })
    }

    /// Whether a mesh is left out.
    pub fn leaves_out(&self) -> bool {
        self.parts.iter().any(|part| part.left_out.is_some())
    }
}

impl fmt::Display for PartsNote {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = |part: &RigPart| format!("`{}`", part.name);
        let (out, body): (Vec<_>, Vec<_>) =
            self.parts.iter().partition(|part| part.left_out.is_some());
        let body: Vec<String> = body.into_iter().map(named).collect();
        let path = self.path.display();
        let read = match (self.has_skeleton, &body[..]) {
            (true, _) => "the body is",
            (false, [_]) => "the mesh is",
            (false, _) => "the meshes are",
        };
        write!(formatter, "of `{path}` {read} {}", body.join(", "))?;
        if out.is_empty() {
            return Ok(());
        }
        let told = |part: &RigPart| {
            let reason = part.left_out.map_or("", gltf::LeftOut::name);
            format!("`{}` ({reason})", part.name)
        };
        let is_mesh = |part: &&RigPart| part.left_out != Some(gltf::LeftOut::NoFaces);
        let can_choose = self.has_skeleton && out.iter().any(is_mesh);
        let out: Vec<String> = out.into_iter().map(told).collect();
        write!(formatter, "; left out: {}", out.join(", "))?;
        if can_choose {
            formatter.write_str("; `--mesh NAME` chooses")?;
        }
        Ok(())
    }
}

/// Reads a rig: npz, GLB, glTF, VRM, a `drape-scene/1` scene, or a rig JSON with its OBJ and
/// weights.
///
/// The content decides; the extension `npz`, `glb`, `gltf` or `vrm` decides where the content tells
/// nothing.
///
/// # Errors
///
/// [`FileError`] with what the format's reader refuses, or [`FileProblem::UnknownFormat`].
pub fn read_rig(path: impl AsRef<Path>) -> Result<Rig, FileError> {
    Ok(read_rig_with(path, &RigOptions::default())?.rig)
}

/// Reads a rig as [`read_rig`] does, with a choice of what is read, and tells what was left out.
///
/// # Errors
///
/// Those of [`read_rig`], a mesh or a joint of a name that is not there, and
/// [`FileProblem::NoBetas`] for a shape of a rig that has none.
pub fn read_rig_with(path: impl AsRef<Path>, options: &RigOptions) -> Result<ReadRig, FileError> {
    let path = path.as_ref();
    let mut read = read_any(path, options)?;
    if let (Some(name), true) = (options.meshes.first(), read.parts.is_empty()) {
        return Err(FileError {
            path: path.to_path_buf(),
            problem: FileProblem::NoMeshes { name: name.clone() },
        });
    }
    if let Some(map) = &options.joints {
        read.rig.skeleton = labelled(read.rig.skeleton, map)?;
    }
    Ok(read)
}

/// A skeleton whose joints a JSON file names.
fn labelled(skeleton: Skeleton, map: &Path) -> Result<Skeleton, FileError> {
    let named: BTreeMap<String, String> = json::read_with(map, json::parse)?;
    let mut labels = Vec::with_capacity(named.len());
    for (role, name) in named {
        let failed = |problem| FileError {
            path: map.to_path_buf(),
            problem,
        };
        if !is_library_name(&role) {
            return Err(failed(FileProblem::Field {
                field: role,
                found: name,
                expected: "joints as the library names them: head, left_hip, right_elbow …",
            }));
        }
        let Some(joint) = skeleton.find(&name) else {
            let near = near_names(&name, &skeleton);
            return Err(failed(FileProblem::UnknownJointName { name, near }));
        };
        if let Some((first, _)) = labels.iter().find(|(_, other)| *other == joint) {
            return Err(failed(FileProblem::JointNamedTwice {
                first: String::clone(first),
                second: role,
                name,
            }));
        }
        labels.push((role, joint));
    }
    let roles: Vec<String> = labels.iter().map(|(role, _)| role.clone()).collect();
    let skeleton = skeleton.with_labels(labels);
    check_roles(&skeleton, &roles).map_err(|problem| FileError {
        path: map.to_path_buf(),
        problem,
    })?;
    Ok(skeleton)
}

/// Joints of a body, each with the next one below it.
const CHAINS: [&[&str]; 5] = [
    &["pelvis", "head"],
    &["left_hip", "left_knee", "left_ankle", "left_foot"],
    &["right_hip", "right_knee", "right_ankle", "right_foot"],
    &["left_collar", "left_shoulder", "left_elbow", "left_wrist"],
    &[
        "right_collar",
        "right_shoulder",
        "right_elbow",
        "right_wrist",
    ],
];

/// Refuses `roles` that two of them have one joint for, or that hang above what they are below.
fn check_roles(skeleton: &Skeleton, roles: &[String]) -> Result<(), FileProblem> {
    let named = |role: &'static str| {
        let labelled = skeleton.labels().get(role).copied();
        Some((role, labelled.or_else(|| joint_named(skeleton, role))?))
    };
    let joints: BTreeMap<&str, usize> = CHAINS
        .into_iter()
        .flatten()
        .copied()
        .filter_map(named)
        .collect();
    let name = |joint: usize| skeleton.joints()[joint].name.clone();
    let wrong = |role: &str, reason: String| FileProblem::JointRole {
        role: role.to_owned(),
        name: name(joints[role]),
        reason,
    };
    for role in roles {
        let Some(joint) = joints.get(role.as_str()) else {
            continue;
        };
        let mut others = joints.iter().filter(|(other, _)| *other != role);
        if let Some((same, _)) = others.find(|(_, other)| *other == joint) {
            return Err(wrong(role, format!("is `{same}`, too")));
        }
    }
    let is_below = |joint: usize, other: usize| {
        let parent = |&joint: &usize| skeleton.joints()[joint].parent;
        successors(parent(&joint), parent).any(|above| above == other)
    };
    // What lies between may be unknown.
    let known = CHAINS.map(|chain| {
        let known = chain
            .iter()
            .copied()
            .filter_map(|role| joints.get_key_value(role));
        known.collect::<Vec<_>>()
    });
    let pairs = known.iter().flat_map(|chain| chain.windows(2));
    for ((&upper, &above), (&lower, &below)) in pairs.map(|pair| (pair[0], pair[1])) {
        // Hips of some rigs hang beside the spine, but the bones of a limb hang together.
        let is_limb = upper != "pelvis";
        let is_wrong = is_below(above, below) || (is_limb && !is_below(below, above));
        if is_wrong && roles.iter().any(|role| role == upper || role == lower) {
            let reason = format!("does not hang below `{upper}` (`{}`)", name(above));
            return Err(wrong(lower, reason));
        }
    }
    Ok(())
}

fn is_library_name(name: &str) -> bool {
    let others = ["pelvis", "spine1", "spine2", "spine3", "neck"];
    others.contains(&name) || Role::ALL.iter().any(|role| role.name() == name)
}

fn read_any(path: &Path, options: &RigOptions) -> Result<ReadRig, FileError> {
    let plain = |rig: Rig| ReadRig {
        rig,
        parts: Vec::new(),
    };
    let failed = |problem| FileError {
        path: path.to_path_buf(),
        problem,
    };
    let mut start = Vec::new();
    File::open(path)
        .and_then(|file| file.take(64).read_to_end(&mut start))
        .map_err(|error| failed(error.into()))?;
    if start.is_empty() {
        return Err(failed(FileProblem::Empty));
    }
    if start.starts_with(b"PK") {
        return read_rig_npz_with(path, &options.betas).map(plain);
    }
    if start.starts_with(gltf::MAGIC) {
        return read_gltf(path, options);
    }
    let extension = path.extension().and_then(|extension| extension.to_str());
    match extension.unwrap_or_default().to_ascii_lowercase().as_str() {
        "npz" => return read_rig_npz_with(path, &options.betas).map(plain),
        "glb" | "gltf" | "vrm" => return read_gltf(path, options),
        _ => {}
    }
    if is_pickle(&start) {
        return Err(failed(FileProblem::Pickle));
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
        (Some(rig), _) => Ok(plain(rig)),
        (None, Some(scene)) => scene.rig().map(plain),
        (None, None) => read_gltf(path, options),
    }
}

/// Whether the bytes start as a pickle of Python does, of protocol 2 or later, or of a dictionary
/// of an earlier one.
pub(super) fn is_pickle(start: &[u8]) -> bool {
    matches!(start, [0x80, 2..=5, ..]) || start.starts_with(b"(dp")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::smpl_skeleton;

    #[test]
    fn a_map_calls_no_joint_what_it_cannot_be() {
        let skeleton = smpl_skeleton().unwrap();
        let error = |map: &[(&str, &str)]| {
            let label =
                |(role, name): &(&str, &str)| ((*role).to_owned(), skeleton.find(name).unwrap());
            let labels: Vec<(String, usize)> = map.iter().map(label).collect();
            let roles: Vec<String> = labels.iter().map(|(role, _)| role.clone()).collect();
            let labelled = skeleton.clone().with_labels(labels);
            check_roles(&labelled, &roles).map_err(|error| error.to_string())
        };
        assert_eq!(
            error(&[("head", "head"), ("left_knee", "left_knee")]),
            Ok(())
        );
        let knee = "`left_knee` cannot be `right_knee`, which";
        let both = error(&[("left_knee", "right_knee")]);
        assert_eq!(both, Err(format!("{knee} is `right_knee`, too")));
        let swapped = error(&[("left_knee", "right_knee"), ("right_knee", "left_knee")]);
        let hip = "does not hang below `left_hip` (`left_hip`)";
        assert_eq!(swapped, Err(format!("{knee} {hip}")));
        let turned = error(&[("pelvis", "head"), ("head", "pelvis")]);
        let reason = "`head` cannot be `pelvis`, which does not hang below `pelvis` (`head`)";
        assert_eq!(turned, Err(reason.to_owned()));
    }
}
