//! Times the steps of trainings:
//! `cargo run --release -p garnet-train --example step -- [PRESET[,PRESET]|FILE.toml] [VERTICES] [POINTS]`.
//!
//! Prints the median step and where it goes. Threads are those of `RAYON_NUM_THREADS`.
#![allow(clippy::print_stdout, reason = "a program that reports")]
#![allow(clippy::unwrap_used, reason = "a program for developers")]

use garnet_mesh::Point3;
use garnet_mesh::primitives::{capsule, tube};
use garnet_train::{Exercise, StepSeconds, TrainConfig};

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

const WARM_UP: usize = 3;
const RUNS: usize = 25;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let text =
        |number: usize, other: &str| arguments.get(number).map_or(other, |text| text).to_owned();
    let num_vertices: usize = text(1, "5000").parse().unwrap();
    let num_points: usize = text(2, "6890").parse().unwrap();
    for preset in text(0, "paper,medium,small,light").split(',') {
        time(preset, num_vertices, num_points);
    }
}

fn time(preset: &str, num_vertices: usize, num_points: usize) {
    let config = if std::path::Path::new(preset).is_file() {
        TrainConfig::read(preset.as_ref()).unwrap()
    } else {
        TrainConfig::parse(&format!("preset = \"{preset}\"")).unwrap()
    };
    let segments = (num_vertices as f32).sqrt() as usize;
    let garment = tube(0.22, 0.7, segments, num_vertices / segments - 1);
    let meridians = (num_points as f32).sqrt() as usize;
    let body = capsule(0.2, 0.8, meridians, meridians / 3);
    // A teacher that lets the tube hang a little wider and lower.
    let draped: Vec<Point3> = (garment.positions().iter())
        .map(|place| Point3::new(1.04 * place.x, place.y - 0.01, 1.04 * place.z))
        .collect();
    let mut exercise = Exercise::new(&config, &garment, &body, &draped).unwrap();
    let steps: Vec<StepSeconds> = (0..WARM_UP + RUNS)
        .map(|_| exercise.step().unwrap().1)
        .skip(WARM_UP)
        .collect();
    let median = |part: fn(&StepSeconds) -> f64| {
        let mut times: Vec<f64> = steps.iter().map(part).collect();
        times.sort_by(f64::total_cmp);
        1e3 * times[RUNS / 2]
    };
    println!(
        "{preset}: {} vertices, {} body vertices, {:.2} GFLOP, {} threads: step {:.1} ms \
         = prepare {:.1} + forward {:.1} + loss {:.1} + backward {:.1} + update {:.1}",
        garment.num_vertices(),
        body.num_vertices(),
        exercise.flops().unwrap() as f64 / 1e9,
        rayon::current_num_threads(),
        median(StepSeconds::total),
        median(|seconds| seconds.prepare),
        median(|seconds| seconds.forward),
        median(|seconds| seconds.loss),
        median(|seconds| seconds.backward),
        median(|seconds| seconds.update),
    );
}
