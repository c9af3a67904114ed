//! The `garnet` command.
//!
//! `main` maps what [`run`] returns to an exit code and renders the failure. Each subcommand has
//! its arguments, a checked job, and one function that reads as the list of its steps.

mod args;
mod body;
mod chart;
mod console;
mod cut_args;
mod dataset;
mod drape;
mod eval;
mod fabric;
mod failure;
mod garment;
mod hints;
mod info;
mod input;
mod interrupt;
mod lists;
mod log;
mod machine;
mod models;
mod motion;
mod moving;
mod output;
mod parse;
mod render;
mod rig_args;
mod shell;
mod simulate;
mod stderr;
mod stress;
mod train;
mod view;
mod wearer_rig;
mod workers;

use std::process::ExitCode;

use anyhow::Context;
use clap::{CommandFactory, Parser};

use args::{Cli, Command, Everywhere};
use console::Console;
use failure::ExitStatus;

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(usage) => return stderr::usage(&usage).into(),
    };
    let console = Console::new(cli.everywhere.console());
    log::start(cli.everywhere.verbose);
    let status = set_threads(&cli.everywhere).and_then(|()| {
        log::machine();
        run(cli.command, &console)
    });
    match status {
        Ok(status) => status.into(),
        Err(error) => {
            console.failure(&error);
            ExitStatus::NotDone.into()
        }
    }
}

fn run(command: Command, console: &Console) -> anyhow::Result<ExitStatus> {
    match command {
        Command::Drape(args) => drape::run(*args, console),
        Command::Body(args) => body::run(&args, console),
        Command::Garment(args) => garment::run(&args, console),
        Command::Simulate(args) => simulate::run(*args, console),
        Command::Dataset(args) => dataset::run(&args, console),
        Command::Train(args) => train::run(&args, console),
        Command::Eval(args) => eval::run(&args, console),
        Command::Chart(args) => chart::run(&args, console),
        Command::Stress(args) => stress::run(&args, console),
        Command::Info(args) => info::run(&args, console),
        Command::Render(args) => render::run(&args, console),
        Command::View(args) => view::run(&args, console),
        Command::Poses => lists::poses(console),
        Command::Variants(args) => lists::variants(&args, console),
        Command::Completions(args) => shell::completions(&args, Cli::command()),
        Command::Man(args) => shell::man(&args, Cli::command(), console),
    }
}

fn set_threads(everywhere: &Everywhere) -> anyhow::Result<()> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(everywhere.threads.unwrap_or(0));
    builder.build_global().context("cannot start the threads")
}
