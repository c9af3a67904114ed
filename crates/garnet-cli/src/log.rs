//! What `--verbose` tells on stderr of how the command works: events of the library and its own.

use std::{io, thread};

use tracing::{Level, info, subscriber};
use tracing_subscriber::{
    filter::Targets,
    fmt,
    layer::{Layer, SubscriberExt},
    registry,
};

/// Crates whose events are told: those of this workspace.
const OURS: &str = "garnet";

/// Tells events from now on: of what is done and why if `verbosity` is 1, of each step if it is
/// more. Without this call events cost a comparison each.
pub(crate) fn start(verbosity: u8) {
    let level = match verbosity {
        0 => return,
        1 => Level::INFO,
        _ => Level::DEBUG,
    };
    let lines = fmt::layer()
        .with_writer(io::stderr)
        .with_ansi(false)
        .with_target(false)
        .without_time();
    let ours = Targets::new().with_target(OURS, level);
    // No other one is set before.
    let _ = subscriber::set_global_default(registry().with(lines.with_filter(ours)));
}

/// Tells on what the command runs.
pub(crate) fn machine() {
    info!(
        version = env!("CARGO_PKG_VERSION"),
        commit = env!("GARNET_BUILT_FROM"),
        threads = rayon::current_num_threads(),
        cores = thread::available_parallelism().map_or(1, usize::from),
        instruction_set = instruction_set(),
        "garnet"
    );
}

/// The widest vector instructions that this machine has, of those that kernels are written for.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
fn instruction_set() -> &'static str {
    if is_x86_feature_detected!("avx512f") {
        "AVX-512"
    } else if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
        "AVX2"
    } else {
        "SSE2"
    }
}

/// Other processors have one set.
#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
fn instruction_set() -> &'static str {
    std::env::consts::ARCH
}
