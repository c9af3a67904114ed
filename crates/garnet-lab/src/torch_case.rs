//! A case for other implementations of the network.
//!
//! Writes weights and one scene with its translations to `CASE.weights.safetensors` and
//! `CASE.case.safetensors`, and prints the median times of the network alone and of a training step
//! without the losses of garnet. `benches/python/garnet_torch.py` runs it; what users wait for is
//! measured by the bench `network`.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use clap::Args;
use garnet_net::{Checkpoint, GarNetConfig, Precision, Predictor, ReferenceStage, Scene};

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

    let mut ends = vec![Instant::now()];
    let mut after_step = || ends.push(Instant::now());
    let bound = (&garment, &sampling, &scene);
    // One to warm up.
    let net = ReferenceStage::stepped(&config, bound, 1 + RUNS, &mut after_step)?;
    let steps = ends.windows(2).skip(1);
    let step = middle(steps.map(|ends| milliseconds(ends[1] - ends[0])).collect());

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
    let [template, body] = [stage.template(), stage.body()].map(garnet::TriMesh::positions);
    let mut predictor = Predictor::load(&weights, garment.clone(), template, body)?;
    predictor.prepare(&stage.input())?;
    let network = median(|| {
        predictor.translations();
    });
    let path = format!("{case}.case.safetensors");
    predictor.case(&stage.input())?.write(path, "{}")?;
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
    let timed = |_| {
        let start = Instant::now();
        run();
        milliseconds(start.elapsed())
    };
    middle((0..RUNS).map(timed).collect())
}

/// The median of times.
fn middle(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn milliseconds(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}
