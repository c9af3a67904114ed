//! Whole pipelines on generated bodies, the architecture, the demo files, and scenes from outside.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

mod architecture;
mod assets;
mod demo;
mod garbage;
mod held;
mod imports;
mod package;
mod pattern;
mod pipeline;
mod stability;
