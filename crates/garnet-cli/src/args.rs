//! The arguments of the command.

use clap::{ArgAction, Args, Parser, Subcommand};

use crate::{
    body::BodyArgs,
    chart::ChartArgs,
    console::{ColorChoice, ConsoleOptions},
    dataset::DatasetArgs,
    drape::DrapeArgs,
    eval::EvalArgs,
    garment::GarmentArgs,
    info::InfoArgs,
    lists::VariantsArgs,
    parse::thread_count,
    render::RenderArgs,
    shell::{CompletionsArgs, ManArgs},
    simulate::SimulateArgs,
    stress::StressArgs,
    train::TrainArgs,
    view::ViewArgs,
};

/// Drapes garment meshes on body meshes.
#[derive(Debug, Parser)]
#[command(name = "garnet", version, long_version = LONG_VERSION, max_term_width = 100, after_help = AFTER_HELP)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) everywhere: Everywhere,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What `--version` prints after the name: the command has all features of the library.
const LONG_VERSION: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    "\ncommit ",
    env!("GARNET_BUILT_FROM"),
    "\nfeatures package, network, train"
);

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
    /// Find the level at which each way to drape breaks.
    Stress(Box<StressArgs>),
    /// Tell what is in a file, and what is unusual about a mesh.
    Info(InfoArgs),
    /// Draw a shaded picture of meshes.
    Render(RenderArgs),
    /// Write a page that shows meshes in a browser: to turn, compare and play.
    View(ViewArgs),
    /// List the poses of the library.
    Poses,
    /// List the variants of a package, with their error and time.
    Variants(VariantsArgs),
    /// Print the script with which a shell completes this command.
    Completions(CompletionsArgs),
    /// Write pages of the manual.
    Man(ManArgs),
}

/// Options that every subcommand has.
#[derive(Debug, Args)]
#[command(next_help_heading = "Everywhere")]
pub(crate) struct Everywhere {
    /// Print one JSON document on stdout, and errors as JSON on stderr.
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// Print errors only.
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Tell what is read and done, and why, and how long each stage took; -vv tells of each step.
    #[arg(short, long, global = true, action = ArgAction::Count)]
    pub(crate) verbose: u8,
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

impl Everywhere {
    /// How the command speaks.
    pub(crate) fn console(&self) -> ConsoleOptions {
        ConsoleOptions {
            is_json: self.json,
            is_quiet: self.quiet,
            is_verbose: self.verbose > 0,
            hides_progress: self.no_progress,
            color: self.color,
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_arguments_are_consistent() {
        Cli::command().debug_assert();
    }
}
