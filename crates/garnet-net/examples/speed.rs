//! Times networks: `cargo run --release -p garnet-net --example speed -- [PRESET[,PRESET]] [VERTICES] [POINTS] [CASE]`.
//!
//! Prints the median of a few runs of the whole prediction, of the network alone, and of a
//! training step without the loss. Threads are those of `RAYON_NUM_THREADS`. With `CASE`, the
//! weights and one case are written to `CASE.weights.safetensors` and `CASE.case.safetensors` for
//! `benches/python/garnet_torch.py`.
#![allow(clippy::print_stdout, reason = "a program that reports")]
#![allow(clippy::unwrap_used, reason = "a program for developers")]

use std::collections::BTreeMap;
use std::time::Instant;

use burn::optim::{AdamConfig, GradientsParams};
use burn::tensor::Device;
use garnet_mesh::primitives::{capsule, tube};
use garnet_mesh::vertex_normals;
use garnet_net::{
    BodySampling, Checkpoint, GarNetConfig, GarmentGraph, Precision, Predictor, Scene, SceneInput,
    surrogate, write_reference_case,
};
use nalgebra::{Isometry3, UnitQuaternion};

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

const RUNS: usize = 7;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let text =
        |number: usize, other: &str| arguments.get(number).map_or(other, |text| text).to_owned();
    let num_vertices: usize = text(1, "10000").parse().unwrap();
    let num_points: usize = text(2, "6890").parse().unwrap();
    for preset in text(0, "paper,medium,small,light").split(',') {
        let case = arguments.get(3).map(String::as_str);
        time(preset, num_vertices, num_points, case);
    }
}

fn time(preset: &str, num_vertices: usize, num_points: usize, case: Option<&str>) {
    let segments = (num_vertices as f32).sqrt() as usize;
    let template = tube(0.22, 0.7, segments, num_vertices / segments - 1);
    let meridians = (num_points as f32).sqrt() as usize;
    let body = capsule(0.2, 0.8, meridians, meridians / 3);
    let garment = GarmentGraph::new(&template, &[]).unwrap();
    let config = garment.configured(GarNetConfig::preset(preset).unwrap());
    let (rest, places) = (body.positions(), template.positions());
    let sampling = BodySampling::for_garment(rest, places, &config).unwrap();
    let normals = vertex_normals(body.positions(), body.faces());
    let rotations = vec![UnitQuaternion::identity(); template.num_vertices()];
    let input = SceneInput {
        warped: template.positions(),
        body: body.positions(),
        body_normals: &normals,
        world_from_root: Isometry3::identity(),
        rotations: &rotations,
        parameters: &[],
    };
    let scene = Scene::new(&config, &garment, &sampling, &input).unwrap();

    let training = Device::flex().autodiff();
    let mut net = config.init(1, &training).unwrap();
    let mut adam = AdamConfig::new().init();
    let pull = vec![1e-3; 3 * template.num_vertices()];
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
        record: serde_json::Value::Null,
        scores: BTreeMap::new(),
    };
    let folder = tempfile::tempdir().unwrap();
    let path = case.map_or(folder.path().join("weights"), |case| {
        format!("{case}.weights.safetensors").into()
    });
    checkpoint.save(&path, Precision::F32).unwrap();
    let model = Checkpoint::load(&path, &Device::flex()).unwrap().model;
    let mut predictor = Predictor::new(model, garment.clone(), sampling.clone()).unwrap();
    let whole = median(|| {
        predictor.predict(&input).unwrap();
    });
    let network = median(|| {
        predictor.translations();
    });
    if let Some(case) = case {
        let path = format!("{case}.case.safetensors");
        let translations = predictor.translations();
        write_reference_case(path, &garment, &sampling, &scene, &translations).unwrap();
    }
    let cost = config
        .cost(template.num_vertices(), body.num_vertices())
        .unwrap();
    println!(
        "{preset}: {} vertices, {} points, {:.2} GFLOP, {:.2} M weights, {} threads: \
         predict {whole:.1} ms, network {network:.1} ms ({:.0} GFLOP/s), step {step:.1} ms, kept {:.0} MB",
        template.num_vertices(),
        predictor.num_body_points(),
        cost.flops as f64 / 1e9,
        cost.parameters as f64 / 1e6,
        rayon::current_num_threads(),
        cost.flops as f64 / 1e6 / network,
        predictor.num_bytes() as f64 / 1e6,
    );
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
