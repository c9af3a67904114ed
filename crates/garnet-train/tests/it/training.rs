//! Trainings end well, and the same whatever happens to them on the way.

use std::sync::atomic::{AtomicBool, Ordering};

use burn::tensor::Device;
use garnet_drape::GarmentPackage;
use garnet_net::Checkpoint;
use garnet_train::{Begin, Precision, TrainConfig, TrainError, TrainEvent, train};

use crate::invented::{Invented, run, tiny};

#[test]
fn a_tiny_network_is_better_than_the_warp_on_poses_that_it_has_not_seen() {
    let invented = Invented::new();
    let mut began = None;
    let mut losses = Vec::new();
    let mut observer = |event| match event {
        TrainEvent::Began(start) => began = Some(start),
        TrainEvent::Epoch(record) => losses.push(record.loss.unwrap()),
        _ => {}
    };
    let job = invented.job("local", tiny(60));
    let trained = train(&job, &mut observer, &AtomicBool::new(false)).unwrap();
    let began = began.unwrap();
    let start = began.past[0].valid.distance;
    let [first, last] = [losses[0], losses[losses.len() - 1]];
    let valid = trained.best.valid.distance;
    println!(
        "validation {:.2} mm, of the warp {:.2} mm",
        1e3 * valid,
        1e3 * start
    );
    assert_eq!((losses.len(), trained.epochs), (60, 60));
    assert!(last < 0.2 * first, "{first} to {last}");
    assert!(start > 5e-3 && valid < 0.5 * start, "{start} and {valid}");
    assert_eq!(began.terms.len(), 13);

    // The network is in the package, with its scores.
    let manifest = GarmentPackage::read_manifest(&invented.package()).unwrap();
    let variant = manifest.default_variant().unwrap();
    assert_eq!(
        (variant.name.as_str(), variant.weights.as_str()),
        ("local", "local.safetensors")
    );
    assert_eq!(
        variant.distance_error,
        trained.test.map(|test| test.distance)
    );
    let loaded = Checkpoint::load(&trained.weights, &Device::flex()).unwrap();
    assert!((loaded.scores["valid.distance_m"] - valid).abs() < 1e-15);
    assert_eq!(loaded.record["best_epoch"], trained.best.epoch);

    // The curves have a line for each epoch and one for the start.
    let csv = String::from_utf8(invented.bytes("training/local/losses.csv")).unwrap();
    assert_eq!(csv.lines().count(), 62);
    let log: serde_json::Value =
        serde_json::from_slice(&invented.bytes("training/local/log.json")).unwrap();
    assert_eq!(log["epochs"].as_array().unwrap().len(), 61);
    assert_eq!(log["first_terms"][0]["term"], "vertex");

    // The configuration that was written can be trained with.
    let config = invented.package().join("training/local/config.toml");
    assert_eq!(TrainConfig::read(&config).unwrap(), job.config);
}

#[test]
fn an_interrupted_training_gives_the_same_numbers() {
    let straight = Invented::new();
    let config = TrainConfig {
        accumulate: 2,
        max_gradient: 0.5,
        mean_of_weights: 0.9,
        mirror: true,
        ..tiny(3)
    };
    run(&straight.job("local", config.clone())).unwrap();

    let stopped = Invented::new();
    let mut job = stopped.job("local", config);
    // Six scenes an epoch: in the middle of the first, at the end of the second.
    for last in [2, 12] {
        let stop = AtomicBool::new(false);
        let mut watch = |event| {
            if let TrainEvent::Scene { done, .. } = event {
                stop.store(done >= last, Ordering::Relaxed);
            }
        };
        let error = train(&job, &mut watch, &stop).unwrap_err();
        assert!(matches!(error, TrainError::Stopped), "{error}");
        assert!(!stopped.package().join("local.safetensors").exists());
        job.begin = Begin::WhereSaved;
    }
    run(&job).unwrap();
    let files = [
        "local.safetensors",
        "training/local/losses.csv",
        "training/local/log.json",
    ];
    for file in files {
        assert!(
            straight.bytes(file) == stopped.bytes(file),
            "{file} differs"
        );
    }
}

#[test]
fn trainings_from_one_seed_are_one_and_from_another_are_others() {
    let [one, two, other] = [(); 3].map(|()| Invented::new());
    let in_pool = |invented: &Invented, threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let job = invented.job("local", TrainConfig { seed, ..tiny(2) });
        pool.install(|| run(&job)).unwrap();
        invented.bytes("local.safetensors")
    };
    let first = in_pool(&one, 1, 7);
    assert!(first == in_pool(&two, 2, 7));
    assert!(first != in_pool(&other, 2, 8));
}

#[test]
fn a_variant_is_fine_tuned_with_curvature_losses() {
    let invented = Invented::new();
    run(&invented.job("local", tiny(20))).unwrap();
    for name in ["local-rq", "local-mc", "local-mcrq", "local-umc"] {
        let mut job = invented.job(name, tiny(3));
        job.config.learning_rate = 1e-3;
        job.recipe.apply(&mut job.config);
        let mut start = None;
        let mut watch = |event| {
            if let TrainEvent::Began(began) = event {
                start = Some(began.past[0].valid_loss);
            }
        };
        let trained = train(&job, &mut watch, &AtomicBool::new(false)).unwrap();
        assert!(trained.best.epoch > 0, "{name} learned nothing");
        assert!(trained.best.valid_loss < start.unwrap(), "{name}");
    }
    let manifest = GarmentPackage::read_manifest(&invented.package()).unwrap();
    assert_eq!(manifest.variants.len(), 5);
    assert_eq!(
        manifest
            .variants
            .iter()
            .filter(|variant| variant.default)
            .count(),
        1
    );
}

#[test]
fn patience_ends_a_training_that_does_not_get_better() {
    let invented = Invented::new();
    let config = TrainConfig {
        // Far too large: the warp stays the best.
        learning_rate: 1.0,
        patience: 2,
        ..tiny(50)
    };
    let trained = run(&invented.job("global-params", config)).unwrap();
    assert_eq!(
        (trained.best.epoch, trained.epochs, trained.epochs_asked),
        (0, 2, 50)
    );
}

#[test]
fn weights_of_half_precision_drape_the_same() {
    let invented = Invented::new();
    let config = |precision| TrainConfig {
        precision,
        ..tiny(8)
    };
    let whole = run(&invented.job("whole", config(Precision::F32))).unwrap();
    let half = run(&invented.job("half", config(Precision::F16))).unwrap();
    let [big, small] = [&whole, &half].map(|trained| std::fs::read(&trained.weights).unwrap());
    assert!(small.len() < big.len() * 7 / 10);
    // Of one seed, so that nothing but the rounding of the weights differs.
    assert_eq!(whole.best, half.best);
    let [whole, half] = [whole, half].map(|trained| trained.test.unwrap().distance);
    assert!((whole - half).abs() < 2e-5, "{whole} and {half}");
    assert!((whole - half).abs() > 0.0);
}
