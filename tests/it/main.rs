//! Whole pipelines on generated bodies, golden drapes, the architecture, the demo files, and scenes
//! from outside.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

mod architecture;
mod assets;
mod demo;
mod fit;
mod garbage;
mod golden;
mod held;
mod imports;
mod outfit;
mod package;
mod pattern;
mod pipeline;
mod stability;
mod stress;
mod take;
mod wardrobe;
mod wearers;
