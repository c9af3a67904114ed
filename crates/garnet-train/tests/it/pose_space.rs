//! Pose-space deformations, and networks that start from them.

use std::sync::atomic::{AtomicBool, Ordering};

use garnet_data::{BodyRecord, Dataset, DatasetManifest, Moment, Split};
use garnet_drape::GarmentPackage;
use garnet_mesh::Vector3;
use garnet_net::PoseSpace;
use garnet_sim::FALLEN;
use garnet_train::{
    Candidate, Finish, PoseSpaceConfig, Precision, Predictor, Stage, StagedScene, TrainConfig,
    TrainError, TrainEvent, TrainJob, evaluate, train,
};

use crate::invented::{Invented, rippled, run, tiny};

/// Names of deformations.
const POSE_SPACE: &str = "pose-space";
const ARRIVAL: &str = "arrival";
const FALLING: &str = "falling";
const MIDWAY: &str = "midway";

/// What scenes tell.
fn by_scenes() -> TrainConfig {
    let pose_space = PoseSpaceConfig {
        predictor: Predictor::Scenes,
        ..PoseSpaceConfig::default()
    };
    TrainConfig {
        pose_space,
        ..TrainConfig::default()
    }
}

/// What small networks tell.
fn by_networks(passes: u32) -> TrainConfig {
    let pose_space = PoseSpaceConfig {
        region_shapes: 4,
        hidden: 16,
        rounds: 2,
        passes,
        ..PoseSpaceConfig::default()
    };
    TrainConfig {
        pose_space,
        ..TrainConfig::default()
    }
}

#[test]
fn networks_tell_arrivals_of_several_data_sets() {
    let [invented, other] = [(); 2].map(|()| Invented::new());
    with_arrivals(&invented);
    // The other data set ends where bodies arrive.
    let mut shards = Split::ALL.map(|split| other.read(split));
    let path = other.dataset().join("dataset.json");
    let mut manifest = DatasetManifest::read(&path).unwrap();
    manifest.until = Moment::Arrival;
    manifest.write(&path).unwrap();
    for shard in &mut shards {
        for scene in &mut shard.scenes {
            let places = scene.garment.iter();
            scene.garment = places.map(|place| place - 0.005 * Vector3::y()).collect();
        }
        other.write(shard);
    }
    let job = TrainJob {
        more: vec![other.dataset()],
        ..invented.job(ARRIVAL, by_networks(1500))
    };
    let mut learned = Vec::new();
    let mut observer = |event| {
        if let TrainEvent::RegionLearned { region, pass, .. } = event {
            learned.push((region, pass));
        }
    };
    let fitted = train(&job, &mut observer, &false.into()).unwrap();
    assert_eq!(learned.last().unwrap().1, 1500);
    // The warp is 8 mm away.
    let valid = fitted.best.valid.distance;
    println!("{:.3} mm", 1e3 * valid);
    assert!(valid < 1e-3, "{valid}");
    let space = PoseSpace::load(&fitted.weights).unwrap();
    let twice = 2 * invented.read(Split::Train).scenes.len();
    assert_eq!(space.record["scenes"], twice);
    assert_eq!(space.record["more"][0], manifest.fingerprint().to_string());
    assert!(space.parts().is_none());
    let moved = space.regions().unwrap();
    assert_eq!(moved.num_vertices(), space.num_vertices());
}

/// One after the other: the start of networks, and how often regions were learned.
fn fitted_in_folds(invented: &Invented, folds: u32) -> Vec<(u32, u32)> {
    let mut config = by_networks(40);
    config.pose_space.folds = folds;
    let mut learned = Vec::new();
    let mut observer = |event| {
        if let TrainEvent::RegionLearned { pass, passes, .. } = event {
            learned.push((pass, passes));
        }
    };
    let job = invented.job(POSE_SPACE, config);
    train(&job, &mut observer, &false.into()).unwrap();
    learned
}

#[test]
fn a_network_starts_where_networks_would_have_told_scenes_that_they_had_not_seen() {
    let invented = Invented::new();
    // Two bodies, two sequences: four folds.
    let mut shard = invented.read(Split::Train);
    let other = BodyRecord {
        number: 1,
        ..shard.bodies[0].clone()
    };
    shard.bodies.push(other);
    for scene in &mut shard.scenes {
        scene.body = u32::from(scene.pose > 2);
        scene.sequence = format!("bend {}", scene.pose % 2);
    }
    invented.write(&shard);
    let learned = fitted_in_folds(&invented, 2);
    assert_eq!(learned.last(), Some(&(5 * 40, 5 * 40)));
    let starts = "training/pose-space/starts.safetensors";
    let bytes = [starts, "pose-space.safetensors"].map(|file| invented.bytes(file));
    fitted_in_folds(&invented, 2);
    let again = [starts, "pose-space.safetensors"].map(|file| invented.bytes(file));
    assert!(bytes == again, "the same numbers come out again");

    // A network starts farther off in the training than what knows the scenes by heart.
    let mut terms = Vec::new();
    let mut observer = |event| {
        if let TrainEvent::Began(began) = event {
            terms = began.terms;
        }
    };
    let mut whole = invented.job("mine", started(1));
    whole.config.accumulate = 6;
    train(&whole, &mut observer, &false.into()).unwrap();
    let left_out = terms[0].value;
    let space = PoseSpace::load(&invented.package().join("pose-space.safetensors")).unwrap();
    let by_heart = mean_square(&invented, &space);
    println!("{left_out:.2e} left out, {by_heart:.2e} by heart");
    assert!(left_out > 1.5 * by_heart, "{left_out} and {by_heart}");

    // Other scenes, another fit and a damaged file are told.
    let path = invented.package().join(starts);
    let mut damaged = bytes[0].clone();
    let last = damaged.len() - 1;
    damaged[last] ^= 1;
    std::fs::write(&path, damaged).unwrap();
    let error = run(&invented.job("other", started(1))).unwrap_err();
    assert!(matches!(error, TrainError::Starts { .. }), "{error}");
    assert_eq!(fitted_in_folds(&invented, 0).last(), Some(&(40, 40)));
    assert!(!path.exists());
    std::fs::write(&path, &bytes[0]).unwrap();
    let error = run(&invented.job("other", started(1))).unwrap_err();
    assert!(
        matches!(error, TrainError::CannotLeaveOut { .. }),
        "{error}"
    );
}

#[test]
fn networks_may_be_told_how_the_garment_is_cut() {
    let invented = Invented::new();
    with_arrivals(&invented);
    let told = |cuts: bool| {
        let mut config = by_networks(5);
        config.pose_space.cuts = cuts;
        run(&invented.job(ARRIVAL, config)).unwrap();
        let file = format!("{ARRIVAL}.safetensors");
        PoseSpace::load(&invented.package().join(file)).unwrap()
    };
    let stage = stage(&invented);
    let cut = *stage.template().graph.cut();
    let [girth, height, width] = cut;
    assert!(girth > 0.0 && height > 0.0 && width > 0.0, "{cut:?}");
    assert!(!told(false).knows(&cut));
    let space = told(true);
    assert!(space.knows(&cut));
    assert!(!space.knows(&[1.2 * girth, height, width]));
}

/// Of the distance of the scenes of the training from what a deformation tells, in units of 0.1 m.
fn mean_square(invented: &Invented, space: &PoseSpace) -> f64 {
    let sums = std::sync::Mutex::new((0.0, 0.0));
    let take = |scene: StagedScene| {
        let worn = &scene.worn;
        let warped = scene.warped(garnet_skin::Warp::Shape, &scene.posed)?;
        let numbers = worn.body.pose_and_shape(&scene.posed);
        let shares = space.coefficients(&numbers, &[0.0; 3]).unwrap();
        let places = space.moved(&warped.positions, &warped.rotations, &shares);
        let mut sums = sums.lock().unwrap();
        for (place, draped) in places.unwrap().iter().zip(&scene.draped) {
            sums.0 += f64::from(100.0 * (place - draped).norm_squared());
            sums.1 += 1.0;
        }
        Ok(())
    };
    stage(invented)
        .for_each(Split::Train, take, &mut |()| Ok(()))
        .unwrap();
    let (sum, count) = sums.into_inner().unwrap();
    sum / count
}

#[test]
fn cloth_that_has_not_settled_is_no_drape() {
    let invented = Invented::new();
    let path = invented.dataset().join("dataset.json");
    let shards = Split::ALL.map(|split| invented.read(split));
    let mut manifest = DatasetManifest::read(&path).unwrap();
    manifest.until = Moment::Arrival;
    manifest.write(&path).unwrap();
    for shard in &shards {
        invented.write(shard);
    }
    for name in [POSE_SPACE, "local"] {
        let error = run(&invented.job(name, tiny(1))).unwrap_err();
        assert!(matches!(error, TrainError::NotSettled { .. }), "{error}");
    }
    let evaluated = evaluate(
        &stage(&invented),
        Split::Test,
        &[],
        Finish::None,
        &mut |_| {},
    );
    assert!(matches!(evaluated, Err(TrainError::NotSettled { .. })));
    run(&invented.job(ARRIVAL, by_networks(2))).unwrap();
}

#[test]
fn a_fit_that_is_stopped_while_scenes_settle_is_in_its_package() {
    let invented = Invented::new();
    let job = invented.job(POSE_SPACE, by_scenes());
    let stop = AtomicBool::new(false);
    let mut why = None;
    let mut observer = |event| match event {
        // The fit is done when the test scenes are read; then they settle.
        TrainEvent::Read {
            split: Split::Test, ..
        } => stop.store(true, Ordering::Relaxed),
        TrainEvent::NotSettled { why: told } => why = Some(told),
        _ => {}
    };
    let fitted = train(&job, &mut observer, &stop).unwrap();
    assert_eq!(why.as_deref(), Some("stopped"));
    assert_eq!(fitted.settled, None);
    let manifest = GarmentPackage::read_manifest(&invented.package()).unwrap();
    let variant = manifest.variant(POSE_SPACE).unwrap();
    assert!(variant.distance_error.is_some() && variant.settled_error.is_none());
}

#[test]
fn scenes_of_one_data_set_tell_drapes() {
    let invented = Invented::new();
    for (name, config) in [(POSE_SPACE, by_scenes()), ("local", tiny(1))] {
        let job = TrainJob {
            more: vec![invented.dataset()],
            ..invented.job(name, config)
        };
        let error = run(&job).unwrap_err();
        assert!(matches!(error, TrainError::MoreScenes { .. }), "{error}");
    }
}

#[test]
fn scenes_are_learned_from_once() {
    let invented = Invented::new();
    with_arrivals(&invented);
    let job = TrainJob {
        more: vec![invented.dataset()],
        ..invented.job(ARRIVAL, by_networks(2))
    };
    let error = run(&job).unwrap_err();
    assert!(matches!(error, TrainError::SameScenes { .. }), "{error}");
    assert!(!invented.package().join("arrival.safetensors").exists());
}

#[test]
fn one_scene_tells_no_deformation() {
    let invented = Invented::new();
    with_arrivals(&invented);
    let mut shard = invented.read(Split::Train);
    shard.scenes.truncate(1);
    invented.write(&shard);
    for (name, config) in [(POSE_SPACE, by_scenes()), (ARRIVAL, by_networks(2))] {
        let told = run(&invented.job(name, config)).unwrap_err().to_string();
        let expected = "the data set has 1 scene in its split `train`, at least 2 are needed";
        assert_eq!(told, expected);
    }
}

#[test]
fn what_was_not_validated_has_no_scores() {
    let invented = Invented::new();
    let mut shard = invented.read(Split::Valid);
    shard.scenes.clear();
    invented.write(&shard);
    let fitted = run(&invented.job(POSE_SPACE, by_scenes())).unwrap();
    assert!(fitted.valid.is_none() && fitted.test.is_some());
    let space = PoseSpace::load(&fitted.weights).unwrap();
    assert!(!space.scores.contains_key("valid.distance_m"));
}

/// Tells where the garment arrives: 5 mm below where it rests.
fn with_arrivals(invented: &Invented) {
    for split in Split::ALL {
        let mut shard = invented.read(split);
        for scene in &mut shard.scenes {
            let places = scene.garment.iter();
            scene.arrived = Some(places.map(|place| place - 0.005 * Vector3::y()).collect());
        }
        invented.write(&shard);
    }
}

#[test]
fn arrivals_are_learned_where_the_data_set_has_them() {
    let invented = Invented::new();
    let job = invented.job(ARRIVAL, by_scenes());
    let error = run(&job).unwrap_err();
    assert!(
        matches!(error, TrainError::NotKept { scene, .. } if scene.split == Split::Train),
        "{error}"
    );
    assert!(!invented.package().join("arrival.safetensors").exists());

    with_arrivals(&invented);
    let fitted = run(&job).unwrap();
    let valid = fitted.best.valid.distance;
    assert!(valid < 2e-4, "{valid}");
    assert_eq!(
        PoseSpace::load(&fitted.weights).unwrap().moment,
        Moment::Arrival
    );
    let manifest = GarmentPackage::read_manifest(&invented.package()).unwrap();
    let variant = manifest.variant(ARRIVAL).unwrap();
    assert_eq!(variant.distance_error, None);
    // The sleeve is no garment of the teacher: it is known whether it settles, not where.
    let settled = fitted.settled.map(|settled| settled.distance);
    assert_eq!(variant.settled_error, settled);

    // The same data tell the rest, and what is most of the way there.
    let rest = run(&invented.job(POSE_SPACE, by_scenes())).unwrap();
    let falling = run(&invented.job(FALLING, by_scenes())).unwrap();
    let all = [&fitted.weights, &rest.weights, &falling.weights];
    let [arrives, rests, falls] = all.map(|weights| {
        let candidates = Candidate::of_weights("it", weights, Some(0)).unwrap();
        let stage = stage(&invented);
        let found = evaluate(&stage, Split::Test, &candidates, Finish::None, &mut |_| {});
        found.unwrap().rows[0].scores.distance
    });
    assert!((arrives - 0.005).abs() < 3e-4, "{arrives}");
    assert!(rests < 3e-4, "{rests}");
    let left = f64::from(1.0 - FALLEN) * 0.005;
    assert!((falls - left).abs() < 3e-4, "{falls}");
}

/// Tells where the garment is midway: as where the arm is bent half as far.
fn with_midways(invented: &Invented) {
    let package = GarmentPackage::read(&invented.package()).unwrap();
    for split in Split::ALL {
        let mut shard = invented.read(split);
        for scene in &mut shard.scenes {
            scene.midway = Some(rippled(&package, 0.5 * scene.pose as f32));
        }
        invented.write(&shard);
    }
}

#[test]
fn where_cloth_is_midway_is_learned_on_the_body_midway() {
    let invented = Invented::new();
    let job = invented.job(MIDWAY, by_scenes());
    let error = run(&job).unwrap_err();
    let told = error.to_string();
    assert!(told.ends_with("when its body was midway"), "{told}");
    with_midways(&invented);
    let fitted = run(&job).unwrap();
    let valid = fitted.best.valid.distance;
    assert!(valid < 2e-4, "{valid}");
    assert_eq!(
        PoseSpace::load(&fitted.weights).unwrap().moment,
        Moment::Midway
    );
    let manifest = GarmentPackage::read_manifest(&invented.package()).unwrap();
    assert_eq!(manifest.variant(MIDWAY).unwrap().distance_error, None);

    // The rest of the motion is simulated, however briefly the cloth settles. (The sleeve slides
    // off.)
    for asked in [None, Some(0)] {
        let candidates = Candidate::of_weights("it", &fitted.weights, asked).unwrap();
        let frames = asked.unwrap_or(Moment::Midway.settle_frames());
        assert!(
            matches!(candidates[..], [Candidate::Model { settle, .. }] if settle == frames),
            "{candidates:?}"
        );
        let stage = stage(&invented);
        let found = evaluate(&stage, Split::Test, &candidates, Finish::None, &mut |_| {});
        let row = &found.unwrap().rows[0];
        assert_eq!(
            (row.moment, row.settle, row.unsettled),
            (Moment::Midway, frames, 0)
        );
        assert!(row.seconds.settle.median > 0.0);
    }

    // A data set that ends there is for nothing else.
    let path = invented.dataset().join("dataset.json");
    let mut shards = Split::ALL.map(|split| invented.read(split));
    let mut manifest = DatasetManifest::read(&path).unwrap();
    manifest.until = Moment::Midway;
    manifest.write(&path).unwrap();
    for shard in &mut shards {
        for scene in &mut shard.scenes {
            scene.garment = scene.midway.take().unwrap();
        }
        invented.write(shard);
    }
    let error = run(&invented.job(ARRIVAL, by_scenes())).unwrap_err();
    assert!(matches!(error, TrainError::NotSettled { .. }), "{error}");
    let again = run(&job).unwrap();
    assert_eq!(again.best.valid.distance.to_bits(), valid.to_bits());
}

#[test]
fn what_arrives_is_measured_settled_alone() {
    let invented = Invented::new();
    with_arrivals(&invented);
    let settles = |name: &str, asked: Option<u32>| -> Vec<u32> {
        let weights = run(&invented.job(name, by_scenes())).unwrap().weights;
        let candidates = Candidate::of_weights(name, &weights, asked).unwrap();
        let settle = |candidate: &Candidate| match candidate {
            Candidate::Model { settle, .. } => *settle,
            Candidate::Skinning | Candidate::Warp => 0,
        };
        candidates.iter().map(settle).collect()
    };
    let [at_rest, at_arrival, falling] =
        [Moment::Rest, Moment::Arrival, Moment::Falling].map(Moment::settle_frames);
    assert_eq!(settles(POSE_SPACE, None), [0, at_rest]);
    assert_eq!(settles(POSE_SPACE, Some(0)), [0]);
    assert_eq!(settles(ARRIVAL, None), [at_arrival]);
    assert_eq!(settles(ARRIVAL, Some(12)), [12]);
    assert_eq!(settles(FALLING, None), [falling]);
}

/// A tiny network that starts from the deformation.
fn started(epochs: u32) -> TrainConfig {
    TrainConfig {
        network: toml::from_str("start = \"pose-space\"").unwrap(),
        ..tiny(epochs)
    }
}

fn candidate(invented: &Invented, name: &str) -> Candidate {
    Candidate::Model {
        name: name.to_owned(),
        weights: invented.package().join(format!("{name}.safetensors")),
        settle: 0,
    }
}

fn stage(invented: &Invented) -> Stage {
    let package = GarmentPackage::read(&invented.package()).unwrap();
    Stage::new(package, Dataset::open(&invented.dataset()).unwrap()).unwrap()
}

#[test]
fn a_ripple_that_grows_with_the_pose_is_found() {
    let invented = Invented::new();
    let mut errors = Vec::new();
    let mut observer = |event| {
        if let TrainEvent::Searched { left_out, .. } = event {
            errors.push(left_out);
        }
    };
    let job = invented.job(POSE_SPACE, by_scenes());
    let fitted = train(&job, &mut observer, &false.into()).unwrap();
    let config = &job.config.pose_space;
    assert_eq!(errors.len(), config.rounds as usize + 1);
    assert!(errors.is_sorted_by(|a, b| a >= b), "{errors:?}");
    // The warp is 8 mm away; the pose of the validation lies between those that were seen.
    let valid = fitted.best.valid.distance;
    println!("{:.3} mm", 1e3 * valid);
    assert!(valid < 2e-4, "{valid}");
    let space = PoseSpace::load(&fitted.weights).unwrap();
    assert!((space.scores["valid.distance_m"] - valid).abs() < 1e-12);

    let manifest = GarmentPackage::read_manifest(&invented.package()).unwrap();
    assert_eq!(
        manifest.variant(POSE_SPACE).unwrap().weights,
        "pose-space.safetensors"
    );
    let models = [candidate(&invented, POSE_SPACE)];
    let found = evaluate(
        &stage(&invented),
        Split::Test,
        &models,
        Finish::None,
        &mut |_| {},
    );
    let row = &found.unwrap().rows[0];
    assert_eq!(
        (Some(row.scores), row.config.is_none()),
        (fitted.test, true)
    );
    assert!(row.flops > 0 && row.parameters > 0);

    // Half of the bits are enough for most of the numbers.
    let half = TrainConfig {
        precision: Precision::F16,
        ..by_scenes()
    };
    let halved = run(&invented.job(POSE_SPACE, half)).unwrap();
    assert!((halved.best.valid.distance - valid).abs() < 5e-5);
    run(&job).unwrap();

    // The same numbers come out again.
    let bytes = invented.bytes("pose-space.safetensors");
    run(&job).unwrap();
    assert!(invented.bytes("pose-space.safetensors") == bytes);
}

#[test]
fn a_network_goes_on_from_where_the_deformation_ends() {
    let invented = Invented::new();
    let error = run(&invented.job("mine", started(3))).unwrap_err();
    assert!(matches!(error, TrainError::NoStart { .. }), "{error}");

    // One shape that is known badly leaves something to learn.
    let mut coarse = by_scenes();
    coarse.pose_space.rounds = 0;
    let fitted = run(&invented.job(POSE_SPACE, coarse)).unwrap();
    let mut began = None;
    let mut observer = |event| {
        if let TrainEvent::Began(start) = event {
            began = Some(start);
        }
    };
    let job = invented.job("mine", started(3));
    let trained = train(&job, &mut observer, &false.into()).unwrap();
    let start = began.unwrap().past[0].valid.distance;
    assert!((start - fitted.best.valid.distance).abs() < 1e-7);
    let models = [candidate(&invented, "mine")];
    let found = evaluate(
        &stage(&invented),
        Split::Test,
        &models,
        Finish::None,
        &mut |_| {},
    );
    let (found, expected) = (found.unwrap().rows[0].scores, trained.test.unwrap());
    assert!((found.distance - expected.distance).abs() < 1e-9);

    // Another deformation is not the one that it was trained on.
    let mut other = by_scenes();
    other.pose_space.shapes = 1;
    run(&invented.job(POSE_SPACE, other)).unwrap();
    let found = evaluate(
        &stage(&invented),
        Split::Test,
        &models,
        Finish::None,
        &mut |_| {},
    );
    let told = found.unwrap_err().to_string();
    assert!(
        told.contains("start from the pose-space deformation"),
        "{told}"
    );
}
