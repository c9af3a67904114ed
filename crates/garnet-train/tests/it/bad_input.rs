//! What cannot be trained is told by name, and nothing is left behind.

use std::fs;
use std::sync::atomic::AtomicBool;

use garnet_data::{DatasetManifest, Split};
use garnet_drape::{GarmentPackage, Variant};
use garnet_mesh::Point3;
use garnet_train::{Begin, TrainConfig, TrainError, TrainEvent, train};

use crate::invented::{Invented, run, tiny};

fn refused(invented: &Invented) -> String {
    let error = run(&invented.job("local", tiny(1))).unwrap_err();
    assert!(!invented.package().join("local.safetensors").exists());
    assert!(!invented.package().join("training").exists());
    error.to_string()
}

#[test]
fn empty_splits_are_told() {
    for split in [Split::Train, Split::Valid] {
        let invented = Invented::new();
        let mut shard = invented.read(split);
        shard.scenes.clear();
        invented.write(&shard);
        let expected = format!("the data set has no scenes in its split `{}`", split.name());
        assert_eq!(refused(&invented), expected);
    }
}

#[test]
fn coordinates_that_are_no_numbers_are_told_with_scene_and_vertex() {
    let invented = Invented::new();
    let mut shard = invented.read(Split::Train);
    shard.scenes[3].garment[17].z = f32::NAN;
    invented.write(&shard);
    assert_eq!(
        refused(&invented),
        "scene 4 of train body 0: garment vertices 17 is not finite"
    );
}

#[test]
fn another_vertex_count_is_told() {
    let invented = Invented::new();
    let mut shard = invented.read(Split::Valid);
    for scene in &mut shard.scenes {
        scene.garment.push(Point3::origin());
    }
    invented.write(&shard);
    let found = refused(&invented);
    assert!(found.starts_with("scene 3 of valid body 0: "), "{found}");
    assert!(found.contains("garment vertices, expected"), "{found}");
}

#[test]
fn a_data_set_of_another_template_is_told() {
    let invented = Invented::new();
    let path = invented.dataset().join("dataset.json");
    let mut manifest = DatasetManifest::read(&path).unwrap();
    manifest.garment.fingerprint = "0123456789abcdef".to_owned();
    manifest.garment.name = "dress".to_owned();
    manifest.write(&path).unwrap();
    let found = refused(&invented);
    assert!(found.contains("the data set is of `dress`"), "{found}");
    assert!(
        found.ends_with("other faces or another vertex count"),
        "{found}"
    );
}

#[test]
fn a_training_under_way_is_not_overwritten() {
    let invented = Invented::new();
    let mut job = invented.job("local", tiny(2));
    job.begin = Begin::WhereSaved;
    let error = run(&job).unwrap_err();
    assert!(
        matches!(error, TrainError::NothingToResume { .. }),
        "{error}"
    );

    let stop = AtomicBool::new(true);
    job.begin = Begin::Anew;
    let error = train(&job, &mut |_| {}, &stop).unwrap_err();
    assert!(matches!(error, TrainError::Stopped), "{error}");
    let error = run(&job).unwrap_err();
    assert!(
        matches!(error, TrainError::UnderWay { epoch: 0, .. }),
        "{error}"
    );

    job.begin = Begin::WhereSaved;
    let mut other = job.clone();
    other.config.seed += 1;
    let error = run(&other).unwrap_err().to_string();
    assert!(
        error.ends_with("was begun with another configuration"),
        "{error}"
    );

    let state = invented.package().join("training/local/state.safetensors");
    let bytes = fs::read(&state).unwrap();
    fs::write(&state, &bytes[..bytes.len() / 2]).unwrap();
    let error = run(&job).unwrap_err();
    assert!(matches!(error, TrainError::State { .. }), "{error}");
    fs::write(&state, &bytes).unwrap();
    run(&job).unwrap();
}

#[test]
fn a_state_that_cannot_be_written_leaves_the_weights_as_they_were() {
    let invented = Invented::new();
    let job = invented.job("local", tiny(1));
    run(&job).unwrap();
    let before = invented.bytes("local.safetensors");
    let state = invented.package().join("training/local/state.safetensors");
    fs::remove_file(&state).unwrap();
    // A folder of that name stands for a disk without room.
    fs::create_dir(&state).unwrap();
    let again = invented.job("local", TrainConfig { seed: 5, ..tiny(1) });
    assert!(run(&again).is_err());
    assert!(before == invented.bytes("local.safetensors"));
}

#[test]
fn a_training_that_diverges_stops_and_says_where() {
    let invented = Invented::new();
    let mut shard = invented.read(Split::Train);
    for scene in &mut shard.scenes {
        // Finite, but not so the squares of the derivatives.
        scene.garment[17].z = 1e30;
    }
    invented.write(&shard);
    let mut skipped = Vec::new();
    let mut watch = |event| {
        if let TrainEvent::Skipped(trouble) = event {
            skipped.push(trouble);
        }
    };
    let mut config = tiny(200);
    // Squares of far places overflow, distances do not.
    config.loss = garnet_net::losses::LossConfig::paper();
    let job = invented.job("local", config);
    match train(&job, &mut watch, &AtomicBool::new(false)) {
        Err(TrainError::Diverged {
            epoch: 4,
            trouble,
            num_skipped: 20,
        }) => {
            let text = trouble.to_string();
            assert!(text.contains("of train body 0: weight `"), "{text}");
            assert!(text.ends_with("has no finite derivative"), "{text}");
        }
        other => panic!("{other:?}"),
    }
    assert_eq!(skipped.len(), 19);
    assert!(!invented.package().join("local.safetensors").exists());
}

#[test]
fn weights_do_not_take_the_place_of_other_files() {
    let invented = Invented::new();
    let mut manifest = GarmentPackage::read_manifest(&invented.package()).unwrap();
    manifest.add(Variant {
        aliases: Vec::new(),
        seconds: None,
        settled_seconds: None,
        name: "old".to_owned(),
        weights: "local.safetensors".to_owned(),
        weights_of_sizes: None,
        default: false,
        distance_error: None,
        settled_error: None,
        expected: None,
        settle_frames: None,
        valid_error: None,
        valid_scenes: None,
        settles: None,
        flop: None,
    });
    GarmentPackage::write_manifest(&invented.package(), &manifest).unwrap();
    let told = refused(&invented);
    assert!(told.contains("the place of `local.safetensors`"), "{told}");
}

#[test]
fn a_folder_of_other_files_is_no_data_set() {
    let invented = Invented::new();
    let mut job = invented.job("local", tiny(1));
    job.dataset = invented.package();
    let told = run(&job).unwrap_err().to_string();
    assert!(told.contains("is no data set"), "{told}");
}

#[test]
fn a_kind_does_not_start_from_another() {
    let invented = Invented::new();
    let local = run(&invented.job("local", tiny(1))).unwrap();
    let mut job = invented.job("naive", tiny(1));
    job.recipe.apply(&mut job.config);
    job.base = Some(local.weights);
    let error = run(&job).unwrap_err();
    assert!(
        matches!(error, TrainError::OtherKind { found: "local", .. }),
        "{error}"
    );
}

#[test]
fn there_is_nothing_to_fine_tune_before_a_training() {
    let invented = Invented::new();
    let error = run(&invented.job("local-rq", tiny(1))).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the package has no variant `local`; it has none"
    );
}
