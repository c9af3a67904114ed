//! Poses as JSON.

use std::{fmt, marker::PhantomData, path::Path};

use garnet_body::motion::joint_named;
use garnet_skin::{Pose, Skeleton, SkinError, Vector3};
use nalgebra::{Quaternion, UnitQuaternion};
use serde::{
    Deserialize, Deserializer,
    de::{IgnoredAny, MapAccess, Visitor},
};

use super::{
    FileError, FileProblem,
    json::{self, Frame},
    scene_json::rigid_transforms,
};

/// How far the norm of a quaternion may be from 1 and still be rounding.
const NORM_ROUNDING: f64 = 1e-3;

/// How many near names an error lists.
const NUM_NEAR_NAMES: usize = 3;

/// Joints that transforms pull apart by less than this are rounded ones, or a recording's, in
/// metres. More lets poses pass that are not the file's.
const MOST_APART: f64 = 0.02;

#[derive(Debug, Deserialize)]
struct PoseFileJson {
    schema: Option<String>,
    units: Option<String>,
    up: Option<String>,
    frames: Option<Vec<PoseJson>>,
    joint_order: Option<Vec<String>>,
    joints: Option<Entries<[f64; 4]>>,
    local_rotation_xyzw: Option<Vec<[f64; 4]>>,
    joint_transforms_row_major_4x4: Option<Vec<Vec<f64>>>,
    root_translation: Option<[f64; 3]>,
}

#[derive(Debug, Deserialize)]
struct PoseJson {
    joint_order: Option<Vec<String>>,
    joints: Option<Entries<[f64; 4]>>,
    local_rotation_xyzw: Option<Vec<[f64; 4]>>,
    joint_transforms_row_major_4x4: Option<Vec<Vec<f64>>>,
    root_translation: Option<[f64; 3]>,
}

/// Reads a pose for `skeleton`.
///
/// Two forms are read. `garnet.pose/1` has rotations by joint name, `[x, y, z, w]`; joints that it
/// does not name rest. Names are those of the skeleton, or those of the built-in skeleton
/// (`left_knee`) on any human figure:
///
/// ```json
/// {"schema": "garnet.pose/1", "joints": {"left_knee": [0.5, 0, 0, 0.866025]}, "root_translation": [0, 0, 0]}
/// ```
///
/// The other has `local_rotation_xyzw` `[joint]` in the order of `joint_order`, or of the skeleton
/// without it. Where rotations are absent, `joint_transforms_row_major_4x4` gives the pose. With
/// `frames`, a list of such poses, `frame` picks one, from 0; without `frame` it is the first.
///
/// # Errors
///
/// [`FileError`] with line and column of what does not parse, the joint that the skeleton does not
/// have, the quaternion whose norm is off 1 by more than 1e-3, or the frame that is not there.
pub fn read_pose(
    path: impl AsRef<Path>,
    frame: Option<usize>,
    skeleton: &Skeleton,
) -> Result<Pose, FileError> {
    json::read_with(path.as_ref(), |bytes| parse(bytes, frame, skeleton))
}

fn parse(bytes: &[u8], frame: Option<usize>, skeleton: &Skeleton) -> Result<Pose, FileProblem> {
    let file: PoseFileJson = json::parse(bytes)?;
    if let Some(schema) = file.schema.filter(|schema| schema != "garnet.pose/1") {
        return Err(FileProblem::Field {
            field: "schema".to_owned(),
            found: schema,
            expected: "`garnet.pose/1`, or none",
        });
    }
    let is_empty = file
        .joints
        .as_ref()
        .is_some_and(|Entries(list)| list.is_empty());
    let Entries(entries) = json::parse(bytes)?;
    check_keys(&entries, is_empty, skeleton)?;
    let units = Frame {
        units: file.units,
        up: file.up,
    };
    let metres = units.metres()?;
    let mut frames = file.frames.unwrap_or_else(|| {
        vec![PoseJson {
            joint_order: None,
            joints: file.joints,
            local_rotation_xyzw: file.local_rotation_xyzw,
            joint_transforms_row_major_4x4: file.joint_transforms_row_major_4x4,
            root_translation: file.root_translation,
        }]
    });
    let frame = frame.unwrap_or(0);
    if frame >= frames.len() {
        return Err(FileProblem::FrameOutOfRange {
            frame,
            num_frames: frames.len(),
        });
    }
    let mut pose = frames.swap_remove(frame);
    pose.joint_order = pose.joint_order.or(file.joint_order);
    pose_of(pose, skeleton, metres)
}

/// The entries of an object in the order of the file, in which a key may be there twice.
#[derive(Debug)]
struct Entries<V>(Vec<(String, V)>);

impl<'de, V: Deserialize<'de>> Deserialize<'de> for Entries<V> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OfObject<V>(PhantomData<V>);

        impl<'de, V: Deserialize<'de>> Visitor<'de> for OfObject<V> {
            type Value = Entries<V>;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Entries<V>, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Entries(entries))
            }
        }

        deserializer.deserialize_map(OfObject(PhantomData))
    }
}

/// Turns joints by name.
///
/// # Errors
///
/// An unknown joint, one that is there twice, by one name or two, or a quaternion that is none.
fn turn<'a>(
    pose: &mut Pose,
    pairs: impl Iterator<Item = (&'a str, [f64; 4])>,
    field: &str,
    skeleton: &Skeleton,
) -> Result<(), FileProblem> {
    let mut names: Vec<Option<&str>> = vec![None; pose.rotations.len()];
    for (name, xyzw) in pairs {
        let joint = joint_of(name, skeleton)?;
        if let Some(first) = names[joint].replace(name) {
            return Err(FileProblem::Field {
                field: field.to_owned(),
                found: if first == name {
                    format!("{name} twice")
                } else {
                    format!("{first} and {name}, one joint of this skeleton")
                },
                expected: "each joint once",
            });
        }
        pose.rotations[joint] = unit_quaternion(name, xyzw)?;
    }
    Ok(())
}

/// Transforms that come in the order of a file, in that of the skeleton, of which each joint is
/// there.
fn in_own_order(
    matrices: Vec<Vec<f64>>,
    order: &[String],
    skeleton: &Skeleton,
) -> Result<Vec<Vec<f64>>, FileProblem> {
    let field = "joint_order".to_owned();
    if order.len() != matrices.len() {
        return Err(FileProblem::ListLength {
            field,
            found: order.len(),
            expected: matrices.len(),
        });
    }
    let mut own = vec![None; skeleton.num_joints()];
    for (name, matrix) in order.iter().zip(matrices) {
        if own[joint_of(name, skeleton)?].replace(matrix).is_some() {
            return Err(FileProblem::Field {
                field,
                found: format!("{name} twice"),
                expected: "each joint once",
            });
        }
    }
    let found = own.iter().flatten().count();
    let expected = own.len();
    let own: Option<Vec<Vec<f64>>> = own.into_iter().collect();
    own.ok_or(FileProblem::ListLength {
        field,
        found,
        expected,
    })
}

/// What a file of a pose may be, beside what is read of it.
const READ_KEYS: [&str; 9] = [
    "schema",
    "units",
    "up",
    "frames",
    "joint_order",
    "joints",
    "local_rotation_xyzw",
    "joint_transforms_row_major_4x4",
    "root_translation",
];

/// Refuses joints beside `joints`, and files that have something else in place of joints: nothing
/// of that would be turned.
fn check_keys(
    entries: &[(String, IgnoredAny)],
    is_empty: bool,
    skeleton: &Skeleton,
) -> Result<(), FileProblem> {
    let keys = entries.iter().map(|(key, _)| key);
    let mut others = keys.filter(|key| !READ_KEYS.contains(&key.as_str()));
    let wrong = others.find(|key| is_empty || joint_of(key, skeleton).is_ok());
    wrong.map_or(Ok(()), |key| {
        Err(FileProblem::Field {
            field: key.clone(),
            found: "something that is not read".to_owned(),
            expected: "rotations of joints in `joints`",
        })
    })
}

fn pose_of(json: PoseJson, skeleton: &Skeleton, metres: f64) -> Result<Pose, FileProblem> {
    let mut pose = Pose::rest(skeleton.num_joints());
    let fields = [
        ("joints", json.joints.is_some()),
        ("local_rotation_xyzw", json.local_rotation_xyzw.is_some()),
        (
            "joint_transforms_row_major_4x4",
            json.joint_transforms_row_major_4x4.is_some(),
        ),
    ];
    let fields: Vec<&str> = (fields.into_iter())
        .filter(|(_, is_there)| *is_there)
        .map(|(field, _)| field)
        .collect();
    // Rotations and the transforms that come of them are one pose, written twice.
    if fields.contains(&"joints") && fields.len() > 1 {
        return Err(FileProblem::SeveralPoses { fields });
    }
    if let Some(Entries(by_name)) = json.joints {
        let pairs = by_name.iter().map(|(name, xyzw)| (name.as_str(), *xyzw));
        turn(&mut pose, pairs, "joints", skeleton)?;
    } else if let Some(rotations) = json.local_rotation_xyzw {
        let order = json.joint_order.unwrap_or_else(|| {
            let names = skeleton.joints().iter().map(|joint| joint.name.clone());
            names.collect()
        });
        if rotations.len() != order.len() {
            return Err(FileProblem::ListLength {
                field: "local_rotation_xyzw".to_owned(),
                found: rotations.len(),
                expected: order.len(),
            });
        }
        let pairs = order.iter().map(String::as_str).zip(rotations);
        turn(&mut pose, pairs, "joint_order", skeleton)?;
    } else if let Some(matrices) = json.joint_transforms_row_major_4x4 {
        let matrices = match &json.joint_order {
            Some(order) => in_own_order(matrices, order, skeleton)?,
            None => matrices,
        };
        let posed_from_rest = rigid_transforms(&matrices, skeleton, metres)?;
        let found = Pose::from_transforms(skeleton, &posed_from_rest)?;
        let residual = f64::from(found.max_residual_m);
        if residual > MOST_APART {
            return Err(FileProblem::NotRotated { residual });
        }
        return Ok(found.pose);
    } else {
        return Err(FileProblem::NoPose);
    }
    let shift = json.root_translation.unwrap_or_default();
    if let Some(far) = shift
        .iter()
        .find(|value| (*value * metres).abs() > FARTHEST)
    {
        return Err(FileProblem::Field {
            field: "root_translation".to_owned(),
            found: format!("{far:e}"),
            expected: "a place within 900 km of the origin",
        });
    }
    let root_translation = Vector3::from(shift.map(|value| (value * metres) as f32));
    pose.root_translation = root_translation;
    // Values beyond f32 become infinite in the cast above.
    if root_translation.iter().all(|value| value.is_finite()) {
        return Ok(pose);
    }
    let root = skeleton.parents_first()[0];
    Err(FileProblem::Skin(SkinError::NonFiniteTransform {
        joint: root,
        name: skeleton.joints()[root].name.clone(),
    }))
}

/// Bodies farther from the origin than this are beyond all coordinates, in metres.
pub(super) const FARTHEST: f64 = 0.9 * garnet_mesh::MAX_COORDINATE as f64;

/// A rotation out of a file; `joint` is for the error.
pub(super) fn unit_quaternion(
    joint: &str,
    [x, y, z, w]: [f64; 4],
) -> Result<UnitQuaternion<f32>, FileProblem> {
    let quaternion = Quaternion::new(w, x, y, z);
    let norm = quaternion.norm();
    if (norm - 1.0).abs() <= NORM_ROUNDING {
        return Ok(UnitQuaternion::new_normalize(quaternion).cast());
    }
    Err(FileProblem::NotAUnitQuaternion {
        joint: joint.to_owned(),
        norm,
    })
}

fn joint_of(name: &str, skeleton: &Skeleton) -> Result<usize, FileProblem> {
    let labelled = || skeleton.labels().get(name).copied();
    let found = skeleton.find(name).or_else(labelled);
    found
        .or_else(|| joint_named(skeleton, name))
        .ok_or_else(|| FileProblem::UnknownJointName {
            name: name.to_owned(),
            near: near_names(name, skeleton),
        })
}

/// The joints whose names are at the least edit distance, up to half the length of `name`.
pub(super) fn near_names(name: &str, skeleton: &Skeleton) -> Vec<String> {
    let name: Vec<char> = name.to_lowercase().chars().take(64).collect();
    let mut near: Vec<(usize, &str)> = Vec::new();
    for joint in skeleton.joints() {
        let other: Vec<char> = joint.name.to_lowercase().chars().take(64).collect();
        let distance = edit_distance(&name, &other);
        if distance <= name.len().max(2) / 2 {
            near.push((distance, &joint.name));
        }
    }
    near.sort_unstable();
    near.dedup();
    near.truncate(NUM_NEAR_NAMES);
    near.into_iter().map(|(_, name)| name.to_owned()).collect()
}

/// Insertions, deletions and replacements that make `b` of `a` (Levenshtein).
fn edit_distance(a: &[char], b: &[char]) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
