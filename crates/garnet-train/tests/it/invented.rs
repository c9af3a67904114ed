//! A sleeve on an arm that bends, with folds that somebody made up.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use garnet_data::{
    BodyRecord, Counts, DATASET_SCHEMA, DatasetManifest, Limits, Moment, Posed, Protocol,
    SceneRecord, Shard, Sizing, Split, Variations,
};
use garnet_drape::{GarmentPackage, PackageParts, StoredFabric};
use garnet_io::{ObjFile, write_obj};
use garnet_mesh::primitives::{capsule, tube};
use garnet_mesh::{Point3, Vector3};
use garnet_skin::{Body, Garment, Joint, Pose, Skeleton, SkinWeights, Warp, WarpedGarment};
use garnet_train::{Begin, Recipe, TrainConfig, TrainError, TrainJob, Trained, train};
use nalgebra::UnitQuaternion;
use tempfile::TempDir;

/// A folder with a package and a data set.
pub(crate) struct Invented {
    pub(crate) folder: TempDir,
}

fn arm() -> Body {
    let arm = capsule(0.05, 0.6, 16, 20);
    let joint = |name: &str, parent, y| Joint {
        name: name.to_owned(),
        parent,
        rest_position: Point3::new(0.0, y, 0.0),
    };
    let joints = vec![joint("shoulder", None, -0.3), joint("elbow", Some(0), 0.0)];
    let forearm = |point: &Point3| (0.5 + point.y / 0.1).clamp(0.0, 1.0);
    let rows = (arm.positions().iter()).map(|p| [(0, 1.0 - forearm(p)), (1, forearm(p))]);
    let weights = SkinWeights::from_influences(2, rows).unwrap();
    Body::new(arm, Skeleton::new(joints).unwrap(), weights).unwrap()
}

fn pose(number: f32) -> Pose {
    let mut pose = Pose::rest(2);
    let angle = 0.25 * number;
    pose.rotations[1] = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
    pose
}

impl Invented {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let invented = Self { folder };
        let sleeve = invented.path().join("sleeve.obj");
        write_obj(&sleeve, &tube(0.065, 0.4, 12, 12)).unwrap();
        let template = ObjFile::read(&sleeve).unwrap();
        let worn = template.mesh().unwrap().positions().to_vec();
        let package = GarmentPackage::new(PackageParts {
            name: "sleeve".to_owned(),
            template,
            rest: garnet_sim::RestShape::Worn(worn),
            fabric: StoredFabric {
                name: "cotton".to_owned(),
                density: 0.2,
                membrane: 1e3,
                compression: 1.0,
                bending: 1e-5,
                friction: 0.3,
                thickness: 2e-3,
            },
            pattern: None,
            body: arm(),
            parameters: None,
        });
        let package = package.unwrap();
        std::fs::create_dir(invented.package()).unwrap();
        package.write(&invented.package()).unwrap();
        std::fs::create_dir_all(invented.dataset().join("shards")).unwrap();
        let manifest = manifest(&package);
        manifest
            .write(&invented.dataset().join("dataset.json"))
            .unwrap();
        for (split, poses) in [
            (Split::Train, &[0, 1, 2, 4, 5, 6][..]),
            (Split::Valid, &[3]),
            (Split::Test, &[1]),
        ] {
            let mut shard = Shard::new(split);
            shard.bodies.push(BodyRecord {
                number: 0,
                parameters: None,
                garment: BTreeMap::new(),
                worn: None,
            });
            shard.scenes = poses
                .iter()
                .map(|&number| scene(&package, number))
                .collect();
            invented.write(&shard);
        }
        invented
    }

    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }

    pub(crate) fn package(&self) -> PathBuf {
        self.path().join("package")
    }

    pub(crate) fn dataset(&self) -> PathBuf {
        self.path().join("dataset")
    }

    /// Writes a shard in place of what is there of its split.
    pub(crate) fn write(&self, shard: &Shard) {
        let manifest = DatasetManifest::read(&self.dataset().join("dataset.json")).unwrap();
        let path = self
            .dataset()
            .join(format!("shards/{}_0000.safetensors", shard.split.name()));
        shard.write(&path, manifest.fingerprint()).unwrap();
    }

    /// Reads the shard of a split.
    pub(crate) fn read(&self, split: Split) -> Shard {
        let manifest = DatasetManifest::read(&self.dataset().join("dataset.json")).unwrap();
        let path = self
            .dataset()
            .join(format!("shards/{}_0000.safetensors", split.name()));
        Shard::read(&path, manifest.fingerprint()).unwrap()
    }

    pub(crate) fn job(&self, name: &str, config: TrainConfig) -> TrainJob {
        TrainJob {
            package: self.package(),
            dataset: self.dataset(),
            more: Vec::new(),
            recipe: Recipe::of_name(name).unwrap(),
            config,
            base: None,
            begin: Begin::Anew,
            makes_default: false,
        }
    }

    /// The bytes of a file of the package.
    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.package().join(name)).unwrap()
    }
}

/// Trains without watching.
pub(crate) fn run(job: &TrainJob) -> Result<Trained, TrainError> {
    train(job, &mut |_| {}, &AtomicBool::new(false))
}

/// A tiny network for some epochs.
pub(crate) fn tiny(epochs: u32) -> TrainConfig {
    TrainConfig {
        preset: "tiny".to_owned(),
        epochs,
        accumulate: 1,
        mean_of_weights: 0.0,
        mirror: false,
        learning_rate: 5e-3,
        warm_up: 0,
        max_gradient: 0.0,
        ..TrainConfig::default()
    }
}

fn manifest(package: &GarmentPackage) -> DatasetManifest {
    DatasetManifest {
        schema: DATASET_SCHEMA.to_owned(),
        generator: "0".to_owned(),
        garment: package.manifest.clone(),
        seed: 0,
        bodies: Counts {
            train: 1,
            valid: 1,
            test: 1,
        },
        poses: 6,
        mixed: false,
        noise: 1.0,
        protocol: Protocol::default(),
        quality: None,
        until: Moment::Rest,
        sizing: Sizing::OneSize,
        vary: Variations::default(),
        limits: Limits::NONE,
        bodies_per_shard: 1000,
        imported: None,
    }
}

/// The warp, with a ripple that grows as the arm bends `[vertex]`.
pub(crate) fn rippled(package: &GarmentPackage, number: f32) -> Vec<Point3> {
    let body = &package.body;
    let pose = pose(number);
    let garment = Garment::new(package.mesh.clone()).bind(body).unwrap();
    let posed = body.posed(&pose).unwrap();
    let warped = WarpedGarment::new(&garment, body, &posed, Warp::Shape).unwrap();
    let places = warped.positions.iter().zip(&warped.rotations);
    places
        .zip(package.mesh.positions())
        .map(|((place, turn), rest)| {
            let outward = Vector3::new(rest.x, 0.0, rest.z).normalize();
            let ripple = 0.006 + 0.004 * (25.0 * rest.y).sin() * (1.0 + 0.2 * number);
            place + turn * outward * ripple
        })
        .collect()
}

fn scene(package: &GarmentPackage, number: u32) -> SceneRecord {
    SceneRecord {
        body: 0,
        pose: number,
        sequence: "bend".to_owned(),
        posed: Posed::Pose(pose(number as f32)),
        garment: rippled(package, number as f32),
        arrived: None,
        midway: None,
        report: None,
    }
}
