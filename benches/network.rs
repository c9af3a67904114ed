//! The network: presets and variants on garments of several sizes, the step of a training, and the
//! whole drape, on one and two threads.
//!
//! `cargo bench --bench network -- TEXT` measures what has the text in its name: `predict/2
//! threads/small/10000`. Memory is told by the bench `memory`.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use garnet::{Draper, net::Network};
use garnet_benches::{NUM_BODY_POINTS, Scene, on_threads};
use garnet_net::{GarNetConfig, ReferenceStage, Variant};
use garnet_train::{SceneTraining, TrainConfig};

/// The allocator of the command.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

const SIZES: [usize; 4] = [2_500, 5_000, 10_000, 20_000];

const PRESETS: [&str; 4] = ["paper", "medium", "small", "light"];

/// Body parameters of `GlobalParams`: as many as the built-in body has.
const NUM_BODY_PARAMETERS: usize = 330;

fn preset(name: &str) -> GarNetConfig {
    GarNetConfig::preset(name).expect("the preset is there")
}

/// Neighbors, features and network, as a drape has them.
fn predict(criterion: &mut Criterion) {
    for name in PRESETS {
        for size in SIZES {
            let stage = ReferenceStage::new(size, NUM_BODY_POINTS);
            let make = || stage.predictor(preset(name));
            on_threads(
                criterion,
                "predict",
                &BenchmarkId::new(name, size),
                make,
                |predictor| {
                    predictor
                        .predict(&stage.input())
                        .expect("the scene is sound");
                },
            );
        }
    }
}

/// The variants of one preset, the network alone.
fn variants(criterion: &mut Criterion) {
    for (name, variant, num_parameters) in [
        ("naive", Variant::Naive, 0),
        ("global", Variant::Global, 0),
        ("local", Variant::Local, 0),
        ("global-params", Variant::GlobalParams, NUM_BODY_PARAMETERS),
    ] {
        for size in SIZES {
            let stage = ReferenceStage::new(size, NUM_BODY_POINTS);
            let make = || {
                let config = preset("small").with_variant(variant, num_parameters);
                let mut predictor = stage.predictor(config);
                let parameters = vec![0.0; num_parameters];
                predictor
                    .prepare(&garnet_net::SceneInput {
                        parameters: &parameters,
                        ..stage.input()
                    })
                    .expect("the scene is sound");
                predictor
            };
            on_threads(
                criterion,
                "forward",
                &BenchmarkId::new(name, size),
                make,
                |predictor| {
                    predictor.translations();
                },
            );
        }
    }
}

/// What a training repeats: preparation, network, losses, derivatives, and the step of Adam.
fn training_step(criterion: &mut Criterion) {
    for name in PRESETS {
        for size in [5_000, 10_000] {
            let stage = ReferenceStage::new(size, NUM_BODY_POINTS);
            let make = || {
                let text = format!("preset = \"{name}\"");
                let config = TrainConfig::parse(&text).expect("the preset is there");
                let (garment, body) = (stage.template(), stage.body());
                SceneTraining::new(&config, garment, body, &stage.draped())
                    .expect("the meshes are sound")
            };
            on_threads(
                criterion,
                "step",
                &BenchmarkId::new(name, size),
                make,
                |training| {
                    training.step().expect("a few steps do not diverge");
                },
            );
        }
    }
}

/// Warp, network and untangling of a bound garment.
fn drape(criterion: &mut Criterion) {
    for name in ["small", "light"] {
        for size in SIZES {
            let make = || {
                let scene = Scene::new(size);
                let bound = scene.bound();
                let network = Network::untrained(name, &bound).expect("the preset is there");
                (scene, Draper::new(bound).with_network(network, 0))
            };
            on_threads(
                criterion,
                "drape",
                &BenchmarkId::new(name, size),
                make,
                |made| {
                    let (scene, draper) = made;
                    let draped = draper.drape(&scene.posed);
                    draped.expect("the body is that of the garment");
                },
            );
        }
    }
}

/// What is done once a garment.
fn bind(criterion: &mut Criterion) {
    for size in SIZES {
        let stage = ReferenceStage::new(size, NUM_BODY_POINTS);
        on_threads(
            criterion,
            "bind network",
            &BenchmarkId::new("small", size),
            || (),
            |()| {
                stage.predictor(preset("small"));
            },
        );
    }
}

criterion_group!(benches, predict, variants, training_step, drape, bind);
criterion_main!(benches);
