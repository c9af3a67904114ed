//! Files that edits begin with, written by the library.

use std::{fs, path::Path, sync::atomic::AtomicBool};

use garnet::io::{CacheKind, CachePart, CacheWriter, Frame, write_obj, write_rig_npz};
use garnet::{Body, Rig};
use garnet_data::{
    Counts, DatasetOptions, Limits, Moment, Protocol, Sizing, Variations, generate, usual_package,
};
use garnet_drape::Quality;
use garnet_mesh::primitives::tube;
use garnet_pattern::GarmentKind;
use garnet_tests::capsules::arm;

use crate::glb::glb_of;

/// The bytes of files by the end of their names.
pub(crate) struct Seeds(Vec<(&'static str, Vec<u8>)>);

/// A garment with all that an OBJ may have.
const OBJ: &str = "\
# a quad, a triangle, groups, and lines of other kinds
mtllib cloth.mtl
o shirt
v 0 0 0
v 1 0 0 0.5 0.5 0.5
v 1.0e0 1 0
v 0 1 0
v 0.5 1.5 0.25
vt 0 0
vt 1 0
vt 1 1
vn 0 0 1
g front back
usemtl cotton
s 1
f 1/1/1 2/2/1 3/3/1 4/1/1
f -3//1 -2//1 -1//1
l 1 2 3
p 5
";

const BVH: &str = "\
HIERARCHY
ROOT root
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT elbow
  {
    OFFSET 0.3 0 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0.3 0 0
    }
  }
}
MOTION
Frames: 3
Frame Time: 0.0333333
0 0 0 0 0 0 0 0 0
0 0.1 0 10 0 0 20 0 0
0 0.2 0 20 0 0 40 0 0
";

const POSE: &str = r#"{"schema": "garnet.pose/1", "units": "m", "up": "y", "frames": [
  {"joints": {"elbow": [0, 0, 0.3826834, 0.9238795]}, "root_translation": [0, 0.1, 0]},
  {"joint_order": ["root", "elbow"], "local_rotation_xyzw": [[0, 0, 0, 1], [0, 0, 0, 1]]}
]}
"#;

const SCENE: &str = r#"{
  "schema": "drape-scene/1", "name": "arm", "units": "m", "up": "y",
  "garment": {"mesh": "tube.obj"},
  "body_rest": {"mesh": "tube.obj", "joints": [
    {"name": "root", "parent": -1, "position": [0, 0, 0]},
    {"name": "elbow", "parent": 0, "position": [0.3, 0, 0]}]},
  "body_target": {"mesh": "tube.obj", "pose": {
    "local_rotation_xyzw": [[0, 0, 0, 1], [0, 0, 0.3826834, 0.9238795]],
    "root_translation": [0, 0.1, 0]}},
  "weights": "weights.json"
}
"#;

const WEIGHTS: &str = r#"{"joints": 2, "joint_index": [[0, 1], [0, 1]], "weight": [[0.5, 0.5], [1.0, 0.0]]}
"#;

const TRAINING: &str = "\
preset = \"light\"
epochs = 6
learning_rate = 2e-3
precision = \"f16\"
[network]
start = \"pose-space\"
[loss]
normal = 1.0
rayleigh = [500.0, 50.0, 0.0]
[pose_space]
rounds = 3
";

impl Seeds {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let of = |name: &str| fs::read(folder.path().join(name)).unwrap();
        let body = arm();
        let rig = Rig {
            rest: Some(body.rest().clone()),
            skeleton: body.skeleton().clone(),
            weights: body.weights().clone(),
            rest_pose: None,
        };
        write_rig_npz(folder.path().join("body.rig.npz"), &rig).unwrap();
        write_obj(folder.path().join("tube.obj"), &tube(0.1, 0.3, 12, 6)).unwrap();
        let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
        let model = |name: &str| fs::read(models.join(name)).unwrap();
        let shards = folder.path().join("data");
        write_dataset(&shards);
        let shard = shards.join("shards/train_0000.safetensors");
        Self(vec![
            ("obj", OBJ.into()),
            ("obj", of("tube.obj")),
            ("npz", of("body.rig.npz")),
            ("glb", glb_of(&body)),
            (
                "glb",
                cache(&body, folder.path(), "walk.glb", CacheKind::Glb),
            ),
            (
                "npz",
                cache(&body, folder.path(), "walk.npz", CacheKind::Npz),
            ),
            ("bvh", BVH.into()),
            ("json", POSE.into()),
            ("json", SCENE.into()),
            ("json", WEIGHTS.into()),
            ("json", of("data/dataset.json")),
            ("toml", TRAINING.into()),
            ("toml", model("tshirt/garment.toml")),
            ("safetensors", model("tshirt/falling.safetensors")),
            ("safetensors", model("tshirt/local.safetensors")),
            ("safetensors", fs::read(shard).unwrap()),
        ])
    }

    /// The files of a kind; none of a kind that there is nothing of.
    pub(crate) fn of(&self, kind: &str) -> Vec<Vec<u8>> {
        let own = self.0.iter().filter(|(name, _)| *name == kind);
        own.map(|(_, bytes)| bytes.clone()).collect()
    }

    pub(crate) fn all(&self) -> Vec<Vec<u8>> {
        self.0.iter().map(|(_, bytes)| bytes.clone()).collect()
    }
}

/// Files that others name.
pub(crate) fn write_companions(folder: &Path) {
    write_obj(folder.join("tube.obj"), &tube(0.1, 0.3, 12, 6)).unwrap();
    fs::write(folder.join("weights.json"), WEIGHTS).unwrap();
}

/// A motion of two frames.
fn cache(body: &Body, folder: &Path, name: &str, kind: CacheKind) -> Vec<u8> {
    let path = folder.join(name);
    let part = CachePart::of_mesh("arm", body.rest(), Frame::OURS);
    let mut cache = CacheWriter::create(&path, kind, vec![part], 2, 30.0).unwrap();
    for _ in 0..2 {
        cache.push(&[body.rest().positions()]).unwrap();
    }
    cache.finish().unwrap();
    fs::read(path).unwrap()
}

/// A package of few vertices, without weights.
pub(crate) fn write_package(folder: &Path) {
    let package = usual_package(GarmentKind::Tshirt, 600).unwrap();
    package.write(folder).unwrap();
}

/// A data set of one scene.
pub(crate) fn write_dataset(folder: &Path) {
    let package = usual_package(GarmentKind::Tshirt, 600).unwrap();
    let options = DatasetOptions {
        seed: 1,
        bodies: Counts {
            train: 1,
            valid: 0,
            test: 0,
        },
        poses: 1,
        mixed: false,
        noise: 1.0,
        protocol: Protocol::default(),
        quality: Quality::Fast,
        until: Moment::Rest,
        sizing: Sizing::OneSize,
        vary: Variations::default(),
        // Coarse cloth in few steps: the file is what counts.
        limits: Limits {
            inside: 50,
            strain_p99: 1.0,
            moving: 1.0,
            self_intersections: 10_000,
            squeezed_intersections: 10_000,
        },
        part: (0, 1),
        threads: 1,
    };
    let stop = AtomicBool::new(false);
    let tally = generate(&package, folder, &options, &|_| {}, &stop).unwrap();
    assert_eq!(tally.accepted, 1);
}
