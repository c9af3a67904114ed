//! Files with random edits never make a reader panic or go on for ever.

#![allow(clippy::unwrap_used, reason = "tests")]
#![allow(clippy::print_stdout, reason = "how many files were read")]

mod edits;
#[path = "../cli/glb.rs"]
mod glb;
mod seeds;

use std::{
    env, fs,
    path::Path,
    sync::LazyLock,
    time::{Duration, Instant},
};

use garnet::body::motion::{ReadOptions, RetargetOptions};
use garnet::io::{SceneJson, Take, read_mesh, read_pose, read_rig};
use garnet::net::ModelFile;
use garnet::train::TrainConfig;
use garnet_data::Dataset;
use garnet_drape::{GarmentPackage, MANIFEST_FILE, Package};
use garnet_tests::capsules::arm;
use proptest::prelude::{any, prop_assert};
use proptest::sample::Index;
use proptest::test_runner::{Config, RngAlgorithm, TestError, TestRng, TestRunner};

use edits::{Edit, edited, edits};
use seeds::{Seeds, write_companions, write_dataset, write_package};

/// No file takes longer to read.
const MOST: Duration = Duration::from_secs(10);

/// Files between two looks at the clock.
const ROUND: u32 = 16;

/// Written once.
static SEEDS: LazyLock<Seeds> = LazyLock::new(Seeds::new);

/// A number from the environment.
fn number(name: &str, usual: u64) -> u64 {
    env::var(name).map_or(usual, |text| text.parse().expect(name))
}

/// Lets a reader read edited files until its time is over.
fn fuzz(reader: &str, file: &str, read: impl Fn(&Path)) {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join(file);
    write_companions(folder.path());
    // Of the reader's own kind as often as of all others.
    let own = SEEDS.of(reader);
    let others = SEEDS.all();
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&number("GARNET_FUZZ_SEED", 1).to_le_bytes());
    let config = Config {
        cases: ROUND,
        failure_persistence: None,
        max_shrink_iters: 2000,
        ..Config::default()
    };
    let random = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
    let mut runner = TestRunner::new_with_rng(config.clone(), random);
    let file_of = |(from, is_own, edits): &(Index, bool, Vec<Edit>)| {
        let is_own = *is_own && !own.is_empty();
        edited(
            from.get::<Vec<u8>>(if is_own { &own } else { &others }),
            edits,
        )
    };
    let end = Instant::now() + Duration::from_secs(number("GARNET_FUZZ_SECONDS", 1));
    let mut count = 0;
    while Instant::now() < end {
        let strategy = (any::<Index>(), any::<bool>(), edits());
        let outcome = runner.run(&strategy, |case| {
            fs::write(&place, file_of(&case)).unwrap();
            let start = Instant::now();
            read(&place);
            prop_assert!(start.elapsed() < MOST, "{:?}", start.elapsed());
            Ok(())
        });
        // A runner that has had its cases has none left.
        let random = runner.new_rng();
        runner = TestRunner::new_with_rng(config.clone(), random);
        count += ROUND;
        if let Err(TestError::Fail(reason, case)) = outcome {
            let kept = env::temp_dir().join(format!("garnet-fuzz-{reader}-{file}"));
            fs::write(&kept, file_of(&case)).unwrap();
            panic!("{reader}: {reason}; the file is kept: {}", kept.display());
        }
    }
    println!("{reader}: {count} files");
}

#[test]
fn obj() {
    fuzz("obj", "mesh.obj", |path| {
        if let Ok(file) = read_mesh(path) {
            let _either = file.mesh();
        }
    });
}

#[test]
fn rig_npz() {
    fuzz("npz", "body.rig.npz", |path| {
        if let Ok(rig) = read_rig(path) {
            let _either = rig.into_body();
        }
    });
}

#[test]
fn glb() {
    fuzz("glb", "body.glb", |path| {
        if let Ok(rig) = read_rig(path) {
            let _either = rig.into_body();
        }
        let _either = read_mesh(path);
    });
}

fn motion(name: &str) {
    let body = arm();
    let options = ReadOptions::default();
    let kind = name.rsplit('.').next().unwrap();
    fuzz(kind, name, |path| {
        if let Ok(take) = Take::read(path, &options) {
            let _either = take.notes(body.skeleton(), &RetargetOptions::default());
        }
    });
}

#[test]
fn motion_bvh() {
    motion("take.bvh");
}

#[test]
fn motion_npz() {
    motion("take.npz");
}

#[test]
fn motion_glb() {
    motion("take.glb");
}

#[test]
fn motion_json() {
    motion("take.json");
}

#[test]
fn json() {
    let body = arm();
    fuzz("json", "pose.json", |path| {
        let _either = read_pose(path, None, body.skeleton());
        let _either = read_pose(path, Some(1), body.skeleton());
        let _either = SceneJson::read(path);
    });
}

#[test]
fn package() {
    let folder = tempfile::tempdir().unwrap();
    write_package(folder.path());
    fuzz("toml", MANIFEST_FILE, |path| {
        fs::copy(path, folder.path().join(MANIFEST_FILE)).unwrap();
        if GarmentPackage::read(folder.path()).is_ok() {
            let _either = Package::open(folder.path());
        }
    });
}

#[test]
fn configuration() {
    fuzz("toml", "train.toml", |path| {
        let _either = TrainConfig::read(path);
    });
}

#[test]
fn weights() {
    fuzz("safetensors", "weights.safetensors", |path| {
        let _either = ModelFile::read(path);
    });
}

#[test]
fn dataset() {
    let folder = tempfile::tempdir().unwrap();
    write_dataset(folder.path());
    fuzz("json", "dataset.json", |path| {
        fs::copy(path, folder.path().join("dataset.json")).unwrap();
        let _either = Dataset::open(folder.path());
    });
}

#[test]
fn shard() {
    let folder = tempfile::tempdir().unwrap();
    write_dataset(folder.path());
    let dataset = Dataset::open(folder.path()).unwrap();
    let shard = folder.path().join("shards/train_0000.safetensors");
    fuzz("safetensors", "shard.safetensors", |path| {
        fs::copy(path, &shard).unwrap();
        assert_eq!(dataset.shards().count(), 1);
    });
}
