//! What networks keep in memory, and the most that a prediction or a training step takes beside
//! that.
//!
//! `cargo bench --bench memory -- [PRESET …]`: each row is measured in a process of its own. The
//! most memory of a process is what Linux tells of it; elsewhere it is not told.

#![allow(clippy::print_stdout, reason = "a program that reports")]

use std::process::Command;

use garnet_benches::NUM_BODY_POINTS;
use garnet_net::{GarNetConfig, ReferenceStage};
use garnet_train::{SceneTraining, TrainConfig};

/// The allocator of the command.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Tells a process which row it measures.
const ROW: &str = "GARNET_MEMORY_ROW";

const SIZES: [usize; 4] = [2_500, 5_000, 10_000, 20_000];

fn main() {
    if let Ok(row) = std::env::var(ROW) {
        let mut words = row.split(' ');
        let (preset, size, what) = (words.next(), words.next(), words.next());
        let size = size.and_then(|size| size.parse().ok());
        if let (Some(preset), Some(size), Some(what)) = (preset, size, what) {
            measure(preset, size, what);
        }
        return;
    }
    let chosen: Vec<String> = (std::env::args().skip(1))
        .filter(|argument| !argument.starts_with('-'))
        .collect();
    println!("                        kept by the network   most of the process, MB");
    for preset in ["paper", "medium", "small", "light"] {
        if !chosen.is_empty() && !chosen.iter().any(|name| name == preset) {
            continue;
        }
        for size in SIZES {
            for what in ["prediction", "step"] {
                let program = std::env::current_exe().expect("this program has a path");
                let row = format!("{preset} {size} {what}");
                let status = Command::new(program).env(ROW, row).status();
                assert!(status.is_ok_and(|status| status.success()));
            }
        }
    }
}

/// Prints a row.
fn measure(preset: &str, size: usize, what: &str) {
    let stage = ReferenceStage::new(size, NUM_BODY_POINTS);
    let before = peak_megabytes();
    let mut kept = None;
    if what == "prediction" {
        let config = GarNetConfig::preset(preset).expect("the preset is there");
        let predictor = stage.predictor(config);
        for _ in 0..3 {
            predictor
                .predict(&stage.input())
                .expect("the scene is sound");
        }
        kept = Some(predictor.num_bytes() as f64 / 1e6);
    } else {
        let text = format!("preset = \"{preset}\"");
        let config = TrainConfig::parse(&text).expect("the preset is there");
        let (garment, body) = (stage.template(), stage.body());
        let mut training = SceneTraining::new(&config, garment, body, &stage.draped())
            .expect("the meshes are sound");
        for _ in 0..3 {
            training.step().expect("a few steps do not diverge");
        }
    }
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.0}"));
    println!(
        "{preset:<7} {size:>6} {what:<11} {:>15} {:>17} (before it {})",
        number(kept),
        number(peak_megabytes()),
        number(before),
    );
}

/// The most memory of this process so far.
fn peak_megabytes() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes / 1024.0)
}
