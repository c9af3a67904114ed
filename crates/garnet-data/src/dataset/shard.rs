//! Shards: the files that bodies and their scenes are kept in.

use std::path::{Path, PathBuf};

use garnet_drape::StoredParameters;
use garnet_drape::tensors::{Array, Contents, to_bytes};
use garnet_mesh::{Fingerprint, MOST_BYTES, Point3, read_bounded, write_atomically};
use garnet_skin::Pose;
use serde::{Deserialize, Serialize};

use super::record::{BodyRecord, Posed, Rejection, SceneRecord, Split};
use crate::{DataError, SceneReport};

/// What this version writes and reads.
const SCHEMA: &str = "garnet.shard/1";

/// How a text without its checksum says so.
const UNSIGNED: &str = concat!(r#""checksum":"#, r#""""#);

/// The tensors that a shard may have, and the axes of each.
const TENSORS: [(&str, usize); 7] = [
    ("garment", 3),
    ("arrived", 3),
    ("midway", 3),
    ("rotations", 3),
    ("root_translation", 2),
    ("worn", 3),
    ("body", 3),
];

/// Places of a garment that a scene may have.
type PlacesOf = fn(&SceneRecord) -> Option<&[Point3]>;

/// Some bodies of one split with their scenes: a file of its own.
///
/// Tensors, all `f32`, with `n` scenes, `b` bodies, `V` vertices of the garment, `J` joints:
///
/// | name | shape | what |
/// |---|---|---|
/// | `garment` | `[n, V, 3]` | draped garment, metres |
/// | `arrived` | `[n, V, 3]` | the garment when the body came to its last place, metres |
/// | `midway` | `[n, V, 3]` | the garment when the body was midway, metres |
/// | `rotations` | `[n, J, 4]` | local rotation of each joint, x y z w |
/// | `root_translation` | `[n, 3]` | shift of the root, metres |
/// | `worn` | `[b, V, 3]` | the garment cut for each body, on the body at rest, metres |
/// | `body` | `[n, B, 3]` | posed bodies made elsewhere, metres |
///
/// The text of the file is JSON: schema, checksum, fingerprint of the data set, split, bodies,
/// scenes and rejected scenes. The checksum is that of the text without it and of the tensors;
/// shards of earlier versions have none.
#[derive(Debug, Clone, PartialEq)]
pub struct Shard {
    /// The split.
    pub split: Split,
    /// Bodies, by number.
    pub bodies: Vec<BodyRecord>,
    /// Scenes, by body and number.
    pub scenes: Vec<SceneRecord>,
    /// Scenes that were rejected, by body and number.
    pub rejections: Vec<Rejection>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Text {
    schema: String,
    #[serde(default)]
    checksum: String,
    dataset: String,
    split: Split,
    bodies: Vec<BodyText>,
    scenes: Vec<SceneText>,
    rejections: Vec<Rejection>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyText {
    number: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    parameters: Option<StoredParameters>,
    #[serde(default, skip_serializing_if = "std::collections::BTreeMap::is_empty")]
    garment: std::collections::BTreeMap<String, f64>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneText {
    body: u32,
    pose: u32,
    sequence: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    report: Option<SceneReport>,
}

impl Shard {
    /// A shard without bodies.
    pub const fn new(split: Split) -> Self {
        Self {
            split,
            bodies: Vec::new(),
            scenes: Vec::new(),
            rejections: Vec::new(),
        }
    }

    /// Takes over the contents of another shard of the same split; a body that both have is kept
    /// once. All stay in order.
    pub fn merge(&mut self, other: Self) {
        for body in other.bodies {
            let place = self
                .bodies
                .binary_search_by_key(&body.number, |body| body.number);
            if let Err(place) = place {
                self.bodies.insert(place, body);
            }
        }
        self.scenes.extend(other.scenes);
        self.scenes.sort_by_key(|scene| (scene.body, scene.pose));
        self.rejections.extend(other.rejections);
        self.rejections
            .sort_by_key(|rejection| (rejection.body, rejection.pose));
    }

    /// Writes the file of a data set.
    ///
    /// # Errors
    ///
    /// [`DataError::Write`] or [`DataError::Tensors`].
    pub fn write(&self, path: &Path, dataset: Fingerprint) -> Result<(), DataError> {
        let bytes = self.to_bytes(path, dataset)?;
        Ok(write_atomically(path, |writer| writer.write_all(&bytes))?)
    }

    fn to_bytes(&self, path: &Path, dataset: Fingerprint) -> Result<Vec<u8>, DataError> {
        let text = Text {
            schema: SCHEMA.to_owned(),
            checksum: String::new(),
            dataset: dataset.to_string(),
            split: self.split,
            bodies: self.bodies.iter().map(BodyText::from).collect(),
            scenes: self.scenes.iter().map(SceneText::from).collect(),
            rejections: self.rejections.clone(),
        };
        let text = serde_json::to_string(&text).map_err(|source| DataError::json(path, &source))?;
        let mut arrays: Vec<(&str, Array)> = Vec::new();
        if let Some(first) = self.scenes.first() {
            let garments = self.scenes.iter().map(|scene| scene.garment.as_slice());
            arrays.push(("garment", Array::of_points(garments, first.garment.len())));
            // Of all scenes or of none: an earlier version may have made some of a set.
            let on_way: [(&str, PlacesOf); 2] = [
                ("arrived", |scene| scene.arrived.as_deref()),
                ("midway", |scene| scene.midway.as_deref()),
            ];
            for (name, places) in on_way {
                let all = self.scenes.iter().map(places);
                if let Some(all) = all.collect::<Option<Vec<_>>>() {
                    arrays.push((name, Array::of_points(all.into_iter(), first.garment.len())));
                }
            }
        }
        let poses: Vec<&Pose> = self.scenes.iter().filter_map(SceneRecord::pose).collect();
        if let Some(first) = poses.first() {
            let rotations = poses.iter().flat_map(|pose| &pose.rotations);
            let rotations = rotations.flat_map(|q| q.coords.iter().copied().collect::<Vec<_>>());
            arrays.push((
                "rotations",
                Array {
                    shape: vec![poses.len(), first.rotations.len(), 4],
                    values: rotations.collect(),
                },
            ));
            let shifts = poses.iter().flat_map(|pose| pose.root_translation.iter());
            arrays.push((
                "root_translation",
                Array {
                    shape: vec![poses.len(), 3],
                    values: shifts.copied().collect(),
                },
            ));
        }
        let meshes: Vec<_> = self.scenes.iter().filter_map(SceneRecord::mesh).collect();
        if let Some(first) = meshes.first() {
            arrays.push((
                "body",
                Array::of_points(meshes.iter().copied(), first.len()),
            ));
        }
        let worn: Vec<_> = self
            .bodies
            .iter()
            .filter_map(|body| body.worn.as_deref())
            .collect();
        if let Some(first) = worn.first() {
            arrays.push(("worn", Array::of_points(worn.iter().copied(), first.len())));
        }
        let arrays: Vec<(&str, &Array)> =
            arrays.iter().map(|(name, array)| (*name, array)).collect();
        let signed = |checksum: Fingerprint| text.replacen(UNSIGNED, &signed(checksum), 1);
        to_bytes(&arrays, &text, signed).map_err(|source| DataError::tensors(path, source))
    }

    /// Reads the file of a data set.
    ///
    /// # Errors
    ///
    /// [`DataError`] that names the file: it cannot be read, is cut off, altered or damaged, is of
    /// another version or of another data set.
    pub fn read(path: &Path, dataset: Fingerprint) -> Result<Self, DataError> {
        let bytes =
            read_bounded(path, 4 * MOST_BYTES).map_err(|source| DataError::read(path, source))?;
        let contents = Contents::of(&bytes).map_err(|source| DataError::tensors(path, source))?;
        let contents =
            contents.ok_or_else(|| DataError::foreign(path, "its metadata has no `garnet`"))?;
        let text: Text = serde_json::from_str(&contents.text)
            .map_err(|source| DataError::json(path, &source))?;
        if text.schema != SCHEMA {
            let what = format!("its schema is `{}`, not `{SCHEMA}`", text.schema);
            return Err(DataError::foreign(path, what));
        }
        if !text.checksum.is_empty() {
            let unsigned = (contents.text).replacen(&signed(&text.checksum), UNSIGNED, 1);
            DataError::check(path, contents.checksum(&unsigned), &text.checksum)?;
        }
        if let Some(name) = contents.foreign(&TENSORS.map(|(name, _)| name)) {
            let what = format!("its tensor `{name}` is none of a shard");
            return Err(DataError::foreign(path, what));
        }
        if text.dataset != dataset.to_string() {
            let what = format!("it belongs to data set {}, not {dataset}", text.dataset);
            return Err(DataError::foreign(path, what));
        }
        Reading { path, contents }.shard(text)
    }

    /// Reads the file of a data set, and refuses a copy under another name, whose scenes would
    /// count twice.
    pub(super) fn read_named(
        path: &Path,
        dataset: Fingerprint,
        bodies_per_shard: u32,
    ) -> Result<Self, DataError> {
        let shard = Self::read(path, dataset)?;
        if let Some(first) = shard.bodies.first() {
            let name = shard_name(shard.split, first.number / bodies_per_shard.max(1));
            if path.file_name().is_some_and(|found| found != name.as_str()) {
                return Err(DataError::MisnamedShard {
                    path: path.to_path_buf(),
                    name,
                });
            }
        }
        Ok(shard)
    }
}

/// How a text says its checksum.
fn signed(checksum: impl std::fmt::Display) -> String {
    format!(r#""checksum":"{checksum}""#)
}

/// A file that is being read.
struct Reading<'a> {
    path: &'a Path,
    contents: Contents<'a>,
}

impl Reading<'_> {
    fn shard(&self, text: Text) -> Result<Shard, DataError> {
        let num_scenes = text.scenes.len();
        let garments = self.array("garment", num_scenes, 3)?;
        let arrived = self.array("arrived", num_scenes, 3)?;
        let midway = self.array("midway", num_scenes, 3)?;
        let rotations = self.array("rotations", num_scenes, 4)?;
        let shifts = self.array("root_translation", num_scenes, 3)?;
        let meshes = self.array("body", num_scenes, 3)?;
        // A body that nothing could be cut for has no garment, and all of its scenes are rejected.
        let is_dressed = |body: &&BodyText| !body.garment.is_empty();
        let num_dressed = match text.bodies.iter().filter(is_dressed).count() {
            // Imported garments have no parameters.
            0 => text.bodies.len(),
            count => count,
        };
        let is_any_named = num_dressed < text.bodies.len();
        let worn = self.array("worn", num_dressed, 3)?;
        let missing = |name| DataError::foreign(self.path, format!("it has no tensor `{name}`"));
        let mut scenes = Vec::with_capacity(num_scenes);
        for (row, scene) in text.scenes.into_iter().enumerate() {
            let garment = garments.as_ref().ok_or_else(|| missing("garment"))?;
            let posed = match (&rotations, &shifts, &meshes) {
                (Some(rotations), Some(shifts), None) => Posed::Pose(Pose {
                    root_translation: shifts.vector(row),
                    rotations: rotations.rotations(row),
                }),
                (None, None, Some(meshes)) => Posed::Mesh(meshes.points(row)),
                _ => return Err(missing("rotations")),
            };
            scenes.push(SceneRecord {
                body: scene.body,
                pose: scene.pose,
                sequence: scene.sequence,
                posed,
                garment: garment.points(row),
                arrived: arrived.as_ref().map(|arrived| arrived.points(row)),
                midway: midway.as_ref().map(|midway| midway.points(row)),
                report: scene.report,
            });
        }
        let mut rows = 0..;
        let bodies = text.bodies.into_iter().map(|body| {
            let is_dressed = !is_any_named || !body.garment.is_empty();
            let row = is_dressed.then(|| rows.next()).flatten();
            BodyRecord {
                worn: worn.as_ref().zip(row).map(|(worn, row)| worn.points(row)),
                number: body.number,
                parameters: body.parameters,
                garment: body.garment,
            }
        });
        Ok(Shard {
            split: text.split,
            bodies: bodies.collect(),
            scenes,
            rejections: text.rejections,
        })
    }

    /// An array, checked for its number of axes and the lengths of the first and last one.
    fn array(&self, name: &str, len: usize, last: usize) -> Result<Option<Array>, DataError> {
        let Some(array) = self.contents.array(name) else {
            return Ok(None);
        };
        let axes = TENSORS.iter().find(|(known, _)| *known == name);
        let has_axes = axes.is_some_and(|&(_, axes)| axes == array.shape.len());
        if has_axes && array.num_rows() == len && array.shape.last() == Some(&last) {
            return Ok(Some(array));
        }
        let shape = &array.shape;
        let what = format!("`{name}` has the shape {shape:?}, expected [{len}, …, {last}]");
        Err(DataError::foreign(self.path, what))
    }
}

impl SceneRecord {
    /// The pose, for built-in bodies.
    pub const fn pose(&self) -> Option<&Pose> {
        match &self.posed {
            Posed::Pose(pose) => Some(pose),
            Posed::Mesh(_) => None,
        }
    }

    /// The posed mesh, for bodies made elsewhere.
    pub fn mesh(&self) -> Option<&[Point3]> {
        match &self.posed {
            Posed::Pose(_) => None,
            Posed::Mesh(positions) => Some(positions),
        }
    }
}

impl From<&BodyRecord> for BodyText {
    fn from(body: &BodyRecord) -> Self {
        Self {
            number: body.number,
            parameters: body.parameters.clone(),
            garment: body.garment.clone(),
        }
    }
}

impl From<&SceneRecord> for SceneText {
    fn from(scene: &SceneRecord) -> Self {
        Self {
            body: scene.body,
            pose: scene.pose,
            sequence: scene.sequence.clone(),
            report: scene.report.clone(),
        }
    }
}

pub(super) fn shard_name(split: Split, number: u32) -> String {
    format!("{}_{number:04}.safetensors", split.name())
}

/// Where the files of a data set are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) folder: PathBuf,
}

impl Layout {
    pub(super) fn manifest(&self) -> PathBuf {
        self.folder.join("dataset.json")
    }

    /// Where finished shards are.
    pub(super) fn shards(&self) -> PathBuf {
        self.folder.join("shards")
    }

    /// Where scenes are until their shard is complete.
    pub(super) fn pieces(&self) -> PathBuf {
        self.folder.join("unfinished")
    }

    pub(super) fn shard(&self, split: Split, number: u32) -> PathBuf {
        self.shards().join(shard_name(split, number))
    }

    /// The shards that are there, sorted.
    pub(super) fn found(&self) -> Result<Vec<PathBuf>, DataError> {
        let shards = self.shards();
        let failed = |source| DataError::read(&shards, source);
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(&shards).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            let extension = path.extension();
            if extension.is_some_and(|extension| extension == "safetensors") {
                paths.push(path);
            }
        }
        paths.sort();
        Ok(paths)
    }

    pub(super) fn piece(&self, split: Split, body: u32, pose: u32) -> PathBuf {
        let name = format!("{}_{body:04}_{pose:03}.safetensors", split.name());
        self.pieces().join(name)
    }
}
