//! Data sets made elsewhere.

mod list;
mod meshes;
mod problem;
mod staged;

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use garnet_drape::GarmentPackage;
use garnet_mesh::{Fingerprint, Unit};
use serde::{Deserialize, Serialize};

use super::manifest::{DATASET_SCHEMA, DatasetManifest, GENERATOR, Sizing};
use super::plan::{Counts, Protocol};
use super::record::{BodyRecord, Posed, SceneRecord, Split};
use super::shard::{Layout, Shard};
use super::variations::Variations;
use crate::{DataError, Limits, Moment, error::text_of};
use list::{List, Place};
use meshes::Reader;
use staged::Staged;

pub use problem::ImportProblem;

/// What this version reads.
pub(super) const IMPORT_SCHEMA: &str = "garnet.import/1";

/// Bodies in a shard.
const BODIES_PER_SHARD: u32 = 10;

/// The scenes of a data set made elsewhere: a JSON file beside its meshes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImportManifest {
    /// `garnet.import/1`.
    pub schema: String,
    /// Unit of all meshes: m, dm, cm or mm.
    pub units: String,
    /// The scenes.
    pub scenes: Vec<ImportScene>,
}

/// A scene made elsewhere. Meshes are OBJ, or npz with an array `vertices` `[vertex, 3]` of floats,
/// or of integers if the unit is mm; paths are relative to the manifest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImportScene {
    /// The split that its body and its sequence are in.
    pub split: Split,
    /// Name of the body; scenes with one name show one body.
    pub body: String,
    /// Name of the sequence that the pose is from; empty if it is from none.
    #[serde(default)]
    pub sequence: String,
    /// The posed body, with the vertices of the package's rest body.
    pub body_mesh: PathBuf,
    /// The draped garment, with the vertices of the package's template.
    pub garment_mesh: PathBuf,
    /// Sewing parameters of the garment.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub parameters: BTreeMap<String, f64>,
}

impl ImportManifest {
    /// Reads a manifest of drapes made elsewhere.
    ///
    /// # Errors
    ///
    /// [`DataError::Read`], [`DataError::Text`] with line and column, or [`DataError::Foreign`].
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let text = text_of(path)?;
        let manifest: Self =
            serde_json::from_str(&text).map_err(|source| DataError::json(path, &source))?;
        if manifest.schema != IMPORT_SCHEMA {
            let what = format!("its schema is `{}`, not `{IMPORT_SCHEMA}`", manifest.schema);
            return Err(DataError::foreign(path, what));
        }
        Ok(manifest)
    }

    /// The scenes of a folder laid out as the shirts of Wang et al. 2018, "Learning a shared shape
    /// space for multimodal garment design": one folder a sample, with `shirt_mesh_r_tmp.obj`, the
    /// draped shirt, and `shirt_info.txt`, whose last line has the sewing parameters. The name of
    /// the body's file in each sample has to be told, for it is not published. One sample of twenty
    /// is for the validation and one for the test.
    ///
    /// # Errors
    ///
    /// [`DataError::Read`] if the folder or a file of a sample cannot be read,
    /// [`DataError::Foreign`] if there is no sample.
    pub fn wang_2018(folder: &Path, body_file: &str, unit: Unit) -> Result<Self, DataError> {
        let failed = |source| DataError::read(folder, source);
        let mut samples = Vec::new();
        for entry in fs::read_dir(folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            let is_sample = path.join("shirt_mesh_r_tmp.obj").is_file();
            // The one sample that the authors' readers skip.
            if is_sample && !path.ends_with("P3ORMPBNJJAJ") {
                samples.push(path);
            }
        }
        samples.sort();
        if samples.is_empty() {
            let what = "no folder in it has a `shirt_mesh_r_tmp.obj`";
            return Err(DataError::foreign(folder, what));
        }
        let mut scenes = Vec::with_capacity(samples.len());
        for (number, sample) in samples.into_iter().enumerate() {
            let name = sample.file_name().unwrap_or_default();
            let name = name.to_string_lossy().into_owned();
            scenes.push(ImportScene {
                split: match number % 20 {
                    9 => Split::Valid,
                    19 => Split::Test,
                    _ => Split::Train,
                },
                body: name.clone(),
                // All stand with their arms held out: that is no sequence which could be kept for
                // the test.
                sequence: String::new(),
                body_mesh: Path::new(&name).join(body_file),
                garment_mesh: Path::new(&name).join("shirt_mesh_r_tmp.obj"),
                parameters: shirt_parameters(&sample.join("shirt_info.txt"))?,
            });
        }
        Ok(Self {
            schema: IMPORT_SCHEMA.to_owned(),
            units: unit.to_string(),
            scenes,
        })
    }
}

/// The numbers of the last line, as `p0`, `p1`, ….
fn shirt_parameters(path: &Path) -> Result<BTreeMap<String, f64>, DataError> {
    let text = text_of(path)?;
    let lines = text.lines().enumerate();
    let last = lines.filter(|(_, line)| !line.trim().is_empty()).last();
    let (number, line) = last.unwrap_or_default();
    let words = line.split_whitespace().enumerate();
    words
        .map(|(index, word)| {
            let wrong = |reason: &str| DataError::Text {
                path: path.to_path_buf(),
                reason: format!("line {}: `{word}`: {reason}", number + 1),
            };
            let value = word.parse();
            let value =
                value.map_err(|error: std::num::ParseFloatError| wrong(&error.to_string()))?;
            if !f64::is_finite(value) {
                return Err(wrong("it is not finite"));
            }
            Ok((format!("p{index}"), value))
        })
        .collect()
}

/// Makes a data set of drapes made elsewhere: reads every mesh, checks it against the package, and
/// writes shards. `path` is the manifest, or the folder that was listed. Every mesh is read twice,
/// since shards carry the fingerprint of all meshes; `observer` is told after each scene how many
/// were read, of two times as many as are listed.
///
/// The shards come to their places when all are written: a data set is whole or not there. An
/// import of the same scenes may be done again.
///
/// # Errors
///
/// [`DataError::Import`] and [`DataError::ImportScene`] for what is wrong with the list and with a
/// scene, [`DataError::OtherDataset`] and [`DataError::Foreign`] if the folder holds another data
/// set, of other scenes, say, [`DataError::InUse`], or that a file cannot be written. The folder is
/// then as it was.
pub fn import(
    package: &GarmentPackage,
    manifest: &ImportManifest,
    path: &Path,
    folder: &Path,
    observer: &mut dyn FnMut(usize),
) -> Result<DatasetManifest, DataError> {
    let unit = manifest.check().map_err(|problem| DataError::Import {
        path: path.to_path_buf(),
        problem: Box::new(problem),
    })?;
    let layout = Layout {
        folder: folder.to_path_buf(),
    };
    let base = if path.is_dir() {
        path
    } else {
        path.parent().unwrap_or(Path::new(""))
    };
    let list = List::new(manifest, path, Reader::new(package, base, unit));
    let mut dataset = described(package, &list.places, manifest);
    // What can be told before all meshes are read.
    staged::check_manifest(&layout, &dataset)?;
    let mut done = 0;
    let mut tell = || {
        done += 1;
        observer(done);
    };
    let mut meshes = Vec::with_capacity(list.places.len());
    for place in &list.places {
        meshes.push(fingerprints(&list.scene(place)?));
        tell();
    }
    dataset.imported = Some(list.fingerprint(&meshes).to_string());
    let mut staged = Staged::new(layout, &dataset)?;
    let mut meshes = meshes.into_iter();
    for places in list.places.chunk_by(|a, b| a.shard() == b.shard()) {
        let (split, number) = places[0].shard();
        let mut shard = Shard::new(split);
        // As many as there are places.
        for (place, expected) in places.iter().zip(&mut meshes) {
            let scene = list.scene(place)?;
            if fingerprints(&scene) != expected {
                return Err(list.changed(place));
            }
            if place.pose == 0 {
                shard.bodies.push(BodyRecord {
                    number: place.body,
                    parameters: None,
                    garment: manifest.scenes[place.index].parameters.clone(),
                    worn: None,
                });
            }
            shard.scenes.push(scene);
            tell();
        }
        staged.write(&shard, number, dataset.fingerprint())?;
    }
    staged.publish(&dataset)?;
    Ok(dataset)
}

/// Fingerprints of the positions of body and garment.
fn fingerprints(scene: &SceneRecord) -> [Fingerprint; 2] {
    let body = scene.mesh().unwrap_or_default();
    [body, scene.garment.as_slice()].map(Fingerprint::of_positions)
}

fn described(
    package: &GarmentPackage,
    places: &[Place],
    manifest: &ImportManifest,
) -> DatasetManifest {
    let most = places.iter().map(|place| place.pose + 1).max();
    let [train, valid, test] = Split::ALL.map(|split| {
        let of_split = places.iter().filter(|place| place.split == split);
        of_split.filter(|place| place.pose == 0).count() as u32
    });
    let has_parameters = manifest
        .scenes
        .iter()
        .any(|scene| !scene.parameters.is_empty());
    DatasetManifest {
        schema: DATASET_SCHEMA.to_owned(),
        generator: GENERATOR.to_owned(),
        garment: package.manifest.of_garment(),
        seed: 0,
        bodies: Counts { train, valid, test },
        poses: most.unwrap_or(0),
        mixed: false,
        noise: 1.0,
        protocol: Protocol::default(),
        quality: None,
        vary: Variations::default(),
        until: Moment::Rest,
        sizing: if has_parameters {
            Sizing::MadeToMeasure
        } else {
            Sizing::OneSize
        },
        limits: Limits::default(),
        bodies_per_shard: BODIES_PER_SHARD,
        imported: None,
    }
}
