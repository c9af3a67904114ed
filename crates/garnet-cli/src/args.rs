//! The arguments of the command.

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::{
    body::BodyArgs, chart::ChartArgs, dataset::DatasetArgs, drape::DrapeArgs, eval::EvalArgs,
    garment::GarmentArgs, info::InfoArgs, render::RenderArgs, simulate::SimulateArgs,
    train::TrainArgs,
};

/// Drapes garment meshes on body meshes.
#[derive(Debug, Parser)]
#[command(name = "garnet", version, max_term_width = 100, after_help = AFTER_HELP)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) everywhere: Everywhere,
    #[command(subcommand)]
    pub(crate) command: Command,
}

const AFTER_HELP: &str = "Exit codes: 0 done; 1 done, but a limit that was asked for is exceeded; \
                          2 not done; 130 interrupted.";

/// What garnet can do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Drape a garment on a body in another pose and shape.
    Drape(Box<DrapeArgs>),
    /// Make bodies from measures, at rest or in poses.
    Body(Box<BodyArgs>),
    /// Make a garment package: cut one from a pattern, or take a garment of your own.
    Garment(Box<GarmentArgs>),
    /// Simulate a garment on a body that moves to its pose: slow, and accurate.
    Simulate(Box<SimulateArgs>),
    /// Simulate many scenes of a garment, for training and tests.
    Dataset(Box<DatasetArgs>),
    /// Train a network on a data set, and add it to its garment package.
    Train(Box<TrainArgs>),
    /// Compare the networks of a package with the warp, on a data set.
    Eval(Box<EvalArgs>),
    /// Chart time against accuracy of all ways to drape a package, on this machine.
    Chart(Box<ChartArgs>),
    /// Tell what is in a file, and what is unusual about a mesh.
    Info(InfoArgs),
    /// Draw a shaded picture of meshes.
    Render(RenderArgs),
}

/// Options that every subcommand has.
#[derive(Debug, Args)]
#[command(next_help_heading = "Everywhere")]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a flag of the command line"
)]
pub(crate) struct Everywhere {
    /// Print one JSON document on stdout, and errors as JSON on stderr.
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// Print errors only.
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Print how long each stage took.
    #[arg(short, long, global = true)]
    pub(crate) verbose: bool,
    /// Use this many threads; 0 is one for each core.
    #[arg(long, global = true, value_name = "N", value_parser = thread_count, allow_negative_numbers = true)]
    pub(crate) threads: Option<usize>,
    /// Draw no progress bar.
    #[arg(long, global = true)]
    pub(crate) no_progress: bool,
    /// Color messages.
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto")]
    pub(crate) color: ColorChoice,
}

/// When messages are colored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ColorChoice {
    /// On a terminal, unless `NO_COLOR` is set.
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

/// More threads than any machine has use for; the pool would fail on much larger numbers.
const MAX_THREADS: usize = 1024;

fn thread_count(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if count <= MAX_THREADS => Ok(count),
        _ => Err(format!("expected a number from 0 to {MAX_THREADS}")),
    }
}

/// A length in millimetres, zero or more, as metres.
pub(crate) fn millimetres(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(length) if (0.0..=1000.0).contains(&length) => Ok(length * 1e-3),
        _ => Err("expected millimetres, from 0 to 1000".to_owned()),
    }
}

/// A length in millimetres, zero or more, as metres in double precision.
pub(crate) fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(length) if (0.0..=1000.0).contains(&length) => Ok(length * 1e-3),
        _ => Err("expected millimetres, from 0 to 1000".to_owned()),
    }
}

/// A time in milliseconds, above zero, as seconds.
pub(crate) fn milliseconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(time) if time > 0.0 && time <= 1e7 => Ok(time * 1e-3),
        _ => Err("expected milliseconds, above 0".to_owned()),
    }
}

/// Frames of a sixtieth of a second that cloth settles.
pub(crate) fn settle_frames(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(frames) if frames <= MAX_SETTLE_FRAMES => Ok(frames),
        _ => Err(format!(
            "expected a number of frames, from 0 to {MAX_SETTLE_FRAMES}"
        )),
    }
}

/// Ten seconds of cloth that rests after one: more is asked for by mistake.
const MAX_SETTLE_FRAMES: u32 = 600;

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_arguments_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn lengths_are_not_negative_and_finite() {
        assert_eq!(millimetres("2"), Ok(0.002));
        for text in ["-1", "nan", "inf", "2mm", "1e9", ""] {
            assert!(millimetres(text).is_err(), "{text}");
        }
    }
}
