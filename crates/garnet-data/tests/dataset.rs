//! Data sets: made, stopped, gone on with.

#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
    sync::atomic::{AtomicBool, AtomicUsize, Ordering},
};

use garnet_data::{
    Counts, DataError, Dataset, DatasetEvent, DatasetManifest, DatasetOptions, Limits, Moment,
    Protocol, Sizing, Variations, generate,
};
use garnet_drape::{GarmentPackage, Quality};
use garnet_mesh::TriMesh;
use garnet_skin::Body;

fn options(threads: usize) -> DatasetOptions {
    DatasetOptions {
        seed: 4,
        bodies: Counts {
            train: 2,
            valid: 0,
            test: 1,
        },
        poses: 2,
        mixed: false,
        noise: 1.0,
        protocol: Protocol::default(),
        quality: Quality::Fast,
        until: Moment::Rest,
        sizing: Sizing::OneSize,
        vary: Variations::default(),
        // Coarse cloth in few steps: here the files are tested, not the drapes.
        limits: Limits {
            inside: 50,
            strain_p99: 1.0,
            moving: 1.0,
            self_intersections: 10_000,
            squeezed_intersections: 10_000,
        },
        part: (0, 1),
        threads,
    }
}

fn make(package: &GarmentPackage, folder: &Path, options: &DatasetOptions) {
    generate(package, folder, options, &|_| {}, &AtomicBool::new(false)).unwrap();
}

/// The bytes of every file below a folder.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            found.insert(name, fs::read(&path).unwrap());
        }
    }
    found
}

#[test]
fn threads_and_interruptions_do_not_show() {
    let package = common::tshirt();
    let [one, two, stopped, parts] = [(); 4].map(|()| tempfile::tempdir().unwrap());
    make(&package, one.path(), &options(1));
    let expected = files(one.path());
    assert_eq!(
        expected.len(),
        3,
        "a manifest and a shard a split: {:?}",
        expected.keys()
    );

    make(&package, two.path(), &options(3));
    assert!(files(two.path()) == expected, "threads show");

    let stop = AtomicBool::new(false);
    let count = AtomicUsize::new(0);
    let stopping = |event: DatasetEvent| {
        let is_scene = !matches!(event, DatasetEvent::Planned { .. });
        if is_scene && count.fetch_add(1, Ordering::Relaxed) == 2 {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let result = generate(&package, stopped.path(), &options(1), &stopping, &stop);
    assert!(matches!(result, Err(DataError::Stopped)));
    let done = AtomicUsize::new(0);
    let planned = |event: DatasetEvent| {
        if let DatasetEvent::Planned { done: before, .. } = event {
            done.store(before, Ordering::Relaxed);
        }
    };
    generate(
        &package,
        stopped.path(),
        &options(1),
        &planned,
        &AtomicBool::new(false),
    )
    .unwrap();
    assert!(files(stopped.path()) == expected, "an interruption shows");

    for part in 0..2 {
        let options = DatasetOptions {
            part: (part, 2),
            ..options(1)
        };
        make(&package, parts.path(), &options);
    }
    assert!(files(parts.path()) == expected, "parts show");
}

#[test]
fn a_data_set_may_end_where_bodies_arrive_or_are_midway() {
    let package = common::tshirt();
    let [whole, arrivals, midways] = [(); 3].map(|()| tempfile::tempdir().unwrap());
    make(&package, whole.path(), &options(2));
    for (folder, until) in [(&arrivals, Moment::Arrival), (&midways, Moment::Midway)] {
        let options = DatasetOptions {
            until,
            ..options(2)
        };
        make(&package, folder.path(), &options);
    }
    let scenes = |folder: &Path| -> Vec<_> {
        let dataset = Dataset::open(folder).unwrap();
        let shards: Vec<_> = dataset.shards().map(Result::unwrap).collect();
        shards.into_iter().flat_map(|shard| shard.scenes).collect()
    };
    let all = [&whole, &arrivals, &midways].map(|folder| scenes(folder.path()));
    let [whole, at_arrival, at_midway] = &all;
    assert!(!whole.is_empty());
    for (index, whole) in whole.iter().enumerate() {
        let (arrived, midway) = (&at_arrival[index], &at_midway[index]);
        for part in [arrived, midway] {
            assert_eq!((whole.body, whole.pose), (part.body, part.pose));
            assert_eq!(part.arrived, None);
        }
        // On its way to the arrival the body was midway.
        assert_eq!((&arrived.midway, &midway.midway), (&whole.midway, &None));
        assert_eq!(whole.arrived.as_ref(), Some(&arrived.garment));
        assert_eq!(whole.midway.as_ref(), Some(&midway.garment));
        assert_ne!(whole.midway, whole.arrived);
    }
    for folder in [&arrivals, &midways] {
        let other = generate(&package, folder.path(), &options(2), &|_| {}, &false.into());
        assert!(
            matches!(other, Err(DataError::OtherDataset { field: "end", .. })),
            "{other:?}"
        );
        let text = other.unwrap_err().to_string();
        assert!(text.ends_with(", asked for is rest"), "{text}");
    }
    let path = midways.path().join("dataset.json");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replace("\"midway\"", "\"falling\"")).unwrap();
    let error = DatasetManifest::read(&path).unwrap_err();
    assert!(matches!(error, DataError::Text { .. }), "{error:?}");
}

#[test]
fn mixed_poses_are_others_on_the_same_bodies() {
    let package = common::tshirt();
    let scenes = [false, true].map(|mixed| {
        let folder = tempfile::tempdir().unwrap();
        let options = DatasetOptions {
            until: Moment::Midway,
            mixed,
            ..options(2)
        };
        make(&package, folder.path(), &options);
        let dataset = Dataset::open(folder.path()).unwrap();
        assert_eq!(dataset.manifest.mixed, mixed);
        let shards: Vec<_> = dataset.shards().map(Result::unwrap).collect();
        let bodies: Vec<_> = shards
            .iter()
            .flat_map(|shard| shard.bodies.clone())
            .collect();
        let scenes: Vec<_> = shards.into_iter().flat_map(|shard| shard.scenes).collect();
        (bodies, scenes)
    });
    let [(plain_bodies, plain), (mixed_bodies, mixed)] = scenes;
    assert_eq!(plain_bodies, mixed_bodies);
    assert_eq!(plain.len(), mixed.len());
    let pairs = plain.iter().zip(&mixed);
    assert!(pairs.clone().all(|(a, b)| a.sequence == b.sequence));
    assert!(pairs.clone().any(|(a, b)| a.posed != b.posed));
}

#[test]
fn noise_moves_poses_of_the_same_sequences() {
    let package = common::tshirt();
    let scenes = [1.0, 3.0].map(|noise| {
        let folder = tempfile::tempdir().unwrap();
        let options = DatasetOptions {
            until: Moment::Midway,
            noise,
            ..options(2)
        };
        make(&package, folder.path(), &options);
        let dataset = Dataset::open(folder.path()).unwrap();
        assert_eq!(dataset.manifest.noise.to_bits(), noise.to_bits());
        let shards: Vec<_> = dataset.shards().map(Result::unwrap).collect();
        let scenes = shards.into_iter().flat_map(|shard| shard.scenes);
        scenes.collect::<Vec<_>>()
    });
    let [usual, more] = scenes;
    let pairs = usual.iter().zip(&more);
    assert!(pairs.clone().all(|(a, b)| a.sequence == b.sequence));
    assert!(pairs.clone().all(|(a, b)| a.posed != b.posed));
}

#[test]
fn all_bodies_are_in_the_same_poses_by_the_protocol_of_the_paper() {
    let package = common::tshirt();
    let folder = tempfile::tempdir().unwrap();
    let options = DatasetOptions {
        until: Moment::Midway,
        protocol: Protocol::SeenPoses,
        ..options(2)
    };
    make(&package, folder.path(), &options);
    let dataset = Dataset::open(folder.path()).unwrap();
    assert_eq!(dataset.manifest.protocol, Protocol::SeenPoses);
    let shards: Vec<_> = dataset.shards().map(Result::unwrap).collect();
    let mut of_pose = BTreeMap::new();
    let mut bodies = BTreeSet::new();
    for scene in shards.iter().flat_map(|shard| &shard.scenes) {
        let known = of_pose.entry(scene.pose).or_insert(&scene.sequence);
        assert_eq!(*known, &scene.sequence);
        bodies.insert(scene.body);
    }
    assert!(bodies.len() > 1);
    let of_paper = ["walk", "yoga", "dance"];
    assert!(
        of_pose
            .values()
            .all(|name| of_paper.iter().any(|group| name.starts_with(group)))
    );
    let other = generate(
        &package,
        folder.path(),
        &DatasetOptions {
            protocol: Protocol::UnseenSequences,
            ..options
        },
        &|_| {},
        &false.into(),
    );
    assert!(
        matches!(
            other,
            Err(DataError::OtherDataset {
                field: "protocol",
                ..
            })
        ),
        "{other:?}"
    );
}

#[test]
fn scenes_have_a_body_a_pose_and_a_garment() {
    let package = common::tshirt();
    let folder = tempfile::tempdir().unwrap();
    let options = DatasetOptions {
        sizing: Sizing::MadeToMeasure,
        ..options(2)
    };
    make(&package, folder.path(), &options);
    let dataset = Dataset::open(folder.path()).unwrap();
    let mut scenes = 0;
    for shard in dataset.shards() {
        let shard = shard.unwrap();
        scenes += shard.scenes.len() + shard.rejections.len();
        for body in &shard.bodies {
            assert!(body.parameters.as_ref().unwrap().parameters().is_ok());
            assert_eq!(
                body.worn.as_ref().unwrap().len(),
                package.mesh.num_vertices()
            );
            assert!(body.garment.contains_key("sleeve"));
        }
        for scene in &shard.scenes {
            assert_eq!(scene.garment.len(), package.mesh.num_vertices());
            assert_eq!(scene.pose().unwrap().rotations.len(), 22);
            assert!(!scene.sequence.is_empty());
        }
    }
    assert_eq!(scenes, 6);
}

#[test]
fn sewing_parameters_are_drawn_for_each_body() {
    let package = common::tshirt();
    let folder = tempfile::tempdir().unwrap();
    let vary = Variations::default().with("sleeve", [0.18, 0.34]);
    let options = DatasetOptions {
        poses: 1,
        sizing: Sizing::MadeToMeasure,
        vary: vary.clone(),
        ..options(2)
    };
    make(&package, folder.path(), &options);
    let dataset = Dataset::open(folder.path()).unwrap();
    let bodies = dataset.shards().flat_map(|shard| shard.unwrap().bodies);
    let sleeves: Vec<f64> = bodies.map(|body| body.garment["sleeve"]).collect();
    assert_eq!(sleeves.len(), 3);
    assert!(sleeves.iter().all(|sleeve| (0.18..0.34).contains(sleeve)));
    let differ = |pair: &[f64]| (pair[0] - pair[1]).abs() > 1e-4;
    assert!(sleeves.windows(2).all(differ));

    let refused = |options: DatasetOptions| {
        let folder = tempfile::tempdir().unwrap();
        let stop = AtomicBool::new(false);
        generate(&package, folder.path(), &options, &|_| {}, &stop).unwrap_err()
    };
    let one_size = DatasetOptions {
        sizing: Sizing::OneSize,
        ..options.clone()
    };
    assert!(matches!(refused(one_size), DataError::VariedTemplate));
    let unknown = DatasetOptions {
        vary: vary.with("collar", [0.0, 0.1]),
        ..options
    };
    assert!(refused(unknown).to_string().contains("collar"));
}

#[test]
fn another_data_set_is_not_overwritten() {
    let package = common::tshirt();
    let folder = tempfile::tempdir().unwrap();
    let options = DatasetOptions {
        bodies: Counts {
            train: 0,
            valid: 0,
            test: 1,
        },
        poses: 1,
        ..options(1)
    };
    make(&package, folder.path(), &options);
    let before = files(folder.path());
    let other = DatasetOptions { seed: 5, ..options };
    let error = generate(
        &package,
        folder.path(),
        &other,
        &|_| {},
        &AtomicBool::new(false),
    );
    let error = error.unwrap_err().to_string();
    assert!(error.contains("seed 4, asked for is 5"), "{error}");
    assert!(files(folder.path()) == before);

    // Nor are its shards without their manifest.
    fs::remove_file(folder.path().join("dataset.json")).unwrap();
    let before = files(folder.path());
    let error = generate(&package, folder.path(), &other, &|_| {}, &false.into()).unwrap_err();
    assert!(matches!(error, DataError::Foreign { .. }), "{error}");
    assert!(files(folder.path()) == before);
}

#[test]
fn a_copy_of_a_shard_under_another_name_is_refused() {
    let package = common::tshirt();
    let folder = tempfile::tempdir().unwrap();
    let options = DatasetOptions {
        poses: 1,
        ..options(1)
    };
    make(&package, folder.path(), &options);
    let shard = |name: &str| folder.path().join("shards").join(name);
    fs::copy(
        shard("test_0000.safetensors"),
        shard("train_0000.safetensors"),
    )
    .unwrap();
    let dataset = Dataset::open(folder.path()).unwrap();
    let error = dataset.shards().find_map(Result::err).unwrap();
    assert!(
        matches!(&error, DataError::MisnamedShard { name, .. } if name == "test_0000.safetensors"),
        "{error}"
    );
}

#[test]
fn two_runs_do_not_make_the_same_shards_at_once() {
    let package = common::tshirt();
    let folder = tempfile::tempdir().unwrap();
    let run = |part, observer: &(dyn Fn(DatasetEvent) + Sync)| {
        let options = DatasetOptions {
            part,
            poses: 1,
            ..options(1)
        };
        let stop = AtomicBool::new(false);
        let made = generate(&package, folder.path(), &options, observer, &stop);
        made.map_err(Box::new)
    };
    let tried = AtomicUsize::new(0);
    let beside = |event: DatasetEvent| {
        if !matches!(event, DatasetEvent::Planned { .. }) {
            return;
        }
        // The run around this one has the first part.
        for part in [(0, 2), (0, 1)] {
            let error = run(part, &|_| {}).unwrap_err();
            assert!(matches!(*error, DataError::InUse { .. }), "{error}");
        }
        run((1, 2), &|_| {}).unwrap();
        tried.store(1, Ordering::Relaxed);
    };
    let tally = run((0, 2), &beside).unwrap();
    assert_eq!(tried.into_inner(), 1);
    assert_eq!(tally.accepted + tally.rejected, 3);
    assert!(!folder.path().join("unfinished").exists());
}

#[test]
fn a_garment_on_another_body_is_refused_before_anything_is_written() {
    let package = common::tshirt();
    let body = &package.body;
    // The same body without its last face.
    let mut faces = body.rest().faces().to_vec();
    faces.pop();
    let rest = TriMesh::new(body.rest().positions().to_vec(), faces).unwrap();
    let vertices = rest.num_vertices();
    let skeleton = body.skeleton().clone();
    let body = Body::new(rest, skeleton, body.weights().clone()).unwrap();
    let package = GarmentPackage { body, ..package };
    let folder = tempfile::tempdir().unwrap();
    let result = generate(&package, folder.path(), &options(1), &|_| {}, &false.into());
    assert!(
        matches!(result, Err(DataError::ForeignBody { vertices: found }) if found == vertices),
        "{result:?}"
    );
    assert!(files(folder.path()).is_empty());
}

#[test]
fn damaged_shards_are_named() {
    let package = common::tshirt();
    let folder = tempfile::tempdir().unwrap();
    let options = DatasetOptions {
        bodies: Counts {
            train: 1,
            valid: 0,
            test: 0,
        },
        poses: 1,
        ..options(1)
    };
    make(&package, folder.path(), &options);
    let path = folder.path().join("shards/train_0000.safetensors");
    let whole = fs::read(&path).unwrap();
    for bytes in [&whole[..whole.len() - 4], &whole[..20], &[]] {
        fs::write(&path, bytes).unwrap();
        let dataset = Dataset::open(folder.path()).unwrap();
        let error = dataset.shards().next().unwrap().unwrap_err().to_string();
        assert!(error.contains("train_0000.safetensors"), "{error}");
    }
}
