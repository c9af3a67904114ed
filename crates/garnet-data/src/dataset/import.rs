//! Data sets made elsewhere.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use garnet_mesh::{ObjFile, Point3, Unit, check_range};
use garnet_skin::NpzFile;
use serde::{Deserialize, Serialize};

use super::manifest::{DATASET_SCHEMA, DatasetManifest, Sizing, Until};
use super::plan::Counts;
use super::record::{BodyRecord, Posed, SceneRecord, Split};
use super::shard::{Layout, Shard};
use super::variations::Variations;
use crate::{DataError, GarmentPackage, Limits};

/// What this version reads.
pub(super) const IMPORT_SCHEMA: &str = "garnet.import/1";

/// Bodies in a shard.
const BODIES_PER_SHARD: usize = 10;

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

/// A scene made elsewhere. Meshes are OBJ, or npz with an array `vertices` `[vertex, 3]`; paths are
/// relative to the manifest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImportScene {
    /// The split that its body is in.
    pub split: Split,
    /// Name of the body; scenes with one name show one body.
    pub body: String,
    /// Name of the sequence that the pose is from.
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
    /// Reads a manifest.
    ///
    /// # Errors
    ///
    /// [`DataError::Read`], [`DataError::Text`] with line and column, or [`DataError::Foreign`].
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let text = fs::read_to_string(path).map_err(|source| DataError::read(path, source))?;
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
    /// [`DataError::Read`] if the folder or a file of a sample cannot be read, [`DataError::Foreign`]
    /// if there is no sample.
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
                sequence: "t_pose".to_owned(),
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
    let text = fs::read_to_string(path).map_err(|source| DataError::read(path, source))?;
    let line = text.lines().rfind(|line| !line.trim().is_empty());
    let words = line.unwrap_or_default().split_whitespace().enumerate();
    words
        .map(|(index, word)| {
            let value =
                word.parse()
                    .map_err(|error: std::num::ParseFloatError| DataError::Text {
                        path: path.to_path_buf(),
                        reason: format!("line {}: `{word}`: {error}", text.lines().count()),
                    })?;
            Ok((format!("p{index}"), value))
        })
        .collect()
}

/// Makes a data set of drapes made elsewhere: reads every mesh once, checks it against the package,
/// and writes shards. `observer` is told after each scene how many are done.
///
/// # Errors
///
/// [`DataError`] that names the file; a manifest of an earlier import is replaced last, so that a
/// data set is whole or not there.
pub fn import(
    package: &GarmentPackage,
    manifest: &ImportManifest,
    base: &Path,
    folder: &Path,
    observer: &mut dyn FnMut(usize),
) -> Result<DatasetManifest, DataError> {
    let unit: Unit = manifest
        .units
        .parse()
        .map_err(|error: garnet_mesh::UnitError| DataError::foreign(base, error.to_string()))?;
    let layout = Layout {
        folder: folder.to_path_buf(),
    };
    let shards = layout.shards();
    fs::create_dir_all(&shards).map_err(|source| DataError::folder(&shards, source))?;
    let bodies = Split::ALL.map(|split| bodies_of(manifest, split));
    let dataset = described(package, &bodies, manifest);
    let fingerprint = dataset.fingerprint();
    let mut reader = Reader {
        package,
        base,
        metres: unit.in_metres(),
    };
    let mut done = 0;
    for (split, bodies) in Split::ALL.into_iter().zip(&bodies) {
        let names: Vec<&str> = bodies.keys().copied().collect();
        for (number, chunk) in names.chunks(BODIES_PER_SHARD).enumerate() {
            let mut shard = Shard::new(split);
            for (place, name) in chunk.iter().enumerate() {
                let body = (number * BODIES_PER_SHARD + place) as u32;
                let scenes = &bodies[name];
                shard.bodies.push(BodyRecord {
                    number: body,
                    parameters: None,
                    garment: scenes[0].parameters.clone(),
                    worn: None,
                });
                for (pose, scene) in scenes.iter().enumerate() {
                    shard.scenes.push(reader.scene(scene, body, pose as u32)?);
                    done += 1;
                    observer(done);
                }
            }
            shard.write(&layout.shard(split, number as u32), fingerprint)?;
        }
    }
    dataset.write(&layout.manifest())?;
    Ok(dataset)
}

fn bodies_of(manifest: &ImportManifest, split: Split) -> BTreeMap<&str, Vec<&ImportScene>> {
    let mut bodies: BTreeMap<&str, Vec<&ImportScene>> = BTreeMap::new();
    for scene in manifest.scenes.iter().filter(|scene| scene.split == split) {
        bodies.entry(&scene.body).or_default().push(scene);
    }
    bodies
}

fn described(
    package: &GarmentPackage,
    bodies: &[BTreeMap<&str, Vec<&ImportScene>>; 3],
    manifest: &ImportManifest,
) -> DatasetManifest {
    let mut garment = package.manifest.clone();
    garment.variants.clear();
    let most = bodies.iter().flat_map(BTreeMap::values).map(Vec::len).max();
    let [train, valid, test] = [0, 1, 2].map(|split: usize| bodies[split].len() as u32);
    let has_parameters = manifest
        .scenes
        .iter()
        .any(|scene| !scene.parameters.is_empty());
    DatasetManifest {
        schema: DATASET_SCHEMA.to_owned(),
        generator: env!("CARGO_PKG_VERSION").to_owned(),
        garment,
        seed: 0,
        bodies: Counts { train, valid, test },
        poses: most.unwrap_or(0) as u32,
        quality: None,
        vary: Variations::default(),
        until: Until::Rest,
        sizing: if has_parameters {
            Sizing::MadeToMeasure
        } else {
            Sizing::OneSize
        },
        limits: Limits::default(),
        bodies_per_shard: BODIES_PER_SHARD as u32,
    }
}

struct Reader<'a> {
    package: &'a GarmentPackage,
    base: &'a Path,
    metres: f32,
}

impl Reader<'_> {
    fn scene(
        &mut self,
        scene: &ImportScene,
        body: u32,
        pose: u32,
    ) -> Result<SceneRecord, DataError> {
        let num_body = self.package.body.rest().num_vertices();
        let num_garment = self.package.mesh.num_vertices();
        Ok(SceneRecord {
            body,
            pose,
            sequence: scene.sequence.clone(),
            posed: Posed::Mesh(self.points(&scene.body_mesh, num_body, "rest body")?),
            garment: self.points(&scene.garment_mesh, num_garment, "template")?,
            arrived: None,
            midway: None,
            report: None,
        })
    }

    fn points(&self, path: &Path, expected: usize, of: &str) -> Result<Vec<Point3>, DataError> {
        let path = self.base.join(path);
        let mut points = read_points(&path)?;
        if points.len() != expected {
            let what = format!(
                "it has {} vertices, the {of} of the package has {expected}",
                points.len()
            );
            return Err(DataError::foreign(&path, what));
        }
        for point in &mut points {
            *point *= self.metres;
        }
        check_range(&points).map_err(|error| DataError::foreign(&path, error.to_string()))?;
        Ok(points)
    }
}

fn read_points(path: &Path) -> Result<Vec<Point3>, DataError> {
    let is_npz = path.extension().is_some_and(|extension| extension == "npz");
    if !is_npz {
        return Ok(ObjFile::read(path)?.positions().to_vec());
    }
    let mut file = NpzFile::open(path)?;
    file.require(&["vertices"])?;
    let array = file.array("vertices")?;
    let array = array.ok_or_else(|| DataError::foreign(path, "it has no array `vertices`"))?;
    let values = array
        .floats()
        .map_err(|problem| file.wrong("vertices", problem))?;
    if values.len() % 3 != 0 {
        let what = format!("`vertices` has {} values, not three a vertex", values.len());
        return Err(DataError::foreign(path, what));
    }
    let points = values.chunks_exact(3);
    Ok(points
        .map(|p| Point3::new(p[0] as f32, p[1] as f32, p[2] as f32))
        .collect())
}
