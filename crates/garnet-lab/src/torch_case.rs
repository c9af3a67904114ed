//! A case for other implementations of the network.
//!
//! Writes weights and one scene with its translations to `CASE.weights.safetensors` and
//! `CASE.case.safetensors`, and prints the median times of the network alone and of a training step
//! without the losses of garnet. `benches/python/garnet_torch.py` runs it; what users wait for is
//! measured by the bench `network`.

use std::collections::BTreeMap;
use std::time::Instant;

use burn::optim::{AdamConfig, GradientsParams};
use burn::tensor::Device;
use clap::Args;
use garnet_net::{
    Checkpoint, GarNetConfig, Precision, Predictor, ReferenceStage, Scene, surrogate,
    write_reference_case,
};

use crate::Outcome;

const RUNS: usize = 7;

/// What to time.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Size of the network, `tiny` to `paper`.
    preset: String,
    /// Vertices of the garment.
    vertices: usize,
    /// Points of the body.
    points: usize,
    /// Files, without what follows the first dot.
    case: String,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let Arguments {
        preset,
        vertices,
        points,
        case,
    } = arguments;
    let stage = ReferenceStage::new(*vertices, *points);
    let (config, garment, sampling) = stage.bound(GarNetConfig::preset(preset)?);
    let scene = Scene::new(&config, &garment, &sampling, &stage.input())?;

    let training = Device::flex().autodiff();
    let mut net = config.init(1, &training)?;
    let mut adam = AdamConfig::new().init();
    let pull = vec![1e-3; 3 * scene.num_vertices()];
    let step = median(|| {
        let output = net.forward(&garment, &sampling, &scene, &training);
        let gradients = surrogate(output, pull.clone()).backward();
        let gradients = GradientsParams::from_grads(gradients, &net);
        // So small a rate that the constant pull does not drive the weights off: a network that has
        // diverged loses digits, and could not be compared with others.
        net = adam.step(1e-5, net.clone(), gradients);
    });

    let checkpoint = Checkpoint {
        model: net,
        garment: garment.fingerprint(),
        range: None,
        pose_space: None,
        record: serde_json::Value::Null,
        scores: BTreeMap::new(),
    };
    let weights = format!("{case}.weights.safetensors");
    checkpoint.save(&weights, Precision::F32)?;
    let model = Checkpoint::load(&weights, &Device::flex())?.model;
    let mut predictor = Predictor::new(model, garment.clone(), sampling.clone())?;
    predictor.prepare(&stage.input())?;
    let network = median(|| {
        predictor.translations();
    });
    let translations = predictor.translations();
    let path = format!("{case}.case.safetensors");
    write_reference_case(path, &garment, &sampling, &scene, &translations)?;
    println!(
        "{preset}, {} vertices, {} points, {} threads: network {network:.1} ms, step {step:.1} ms",
        scene.num_vertices(),
        predictor.num_body_points(),
        rayon::current_num_threads(),
    );
    Ok(())
}

/// The median time of some runs after one to warm up, in milliseconds.
fn median(mut run: impl FnMut()) -> f64 {
    run();
    let mut times: Vec<f64> = (0..RUNS)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[RUNS / 2]
}
