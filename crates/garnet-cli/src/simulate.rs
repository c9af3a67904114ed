//! `garnet simulate`: the physics-based simulation of a scene.

use std::path::PathBuf;

use clap::Args;

use crate::{
    console::Console,
    dataset::QualityName,
    drape::{InputArgs, Job, Simulation, do_job},
    failure::ExitStatus,
    garment, output,
};

/// Arguments of `simulate`.
#[derive(Debug, Args)]
pub(crate) struct SimulateArgs {
    #[command(flatten)]
    input: InputArgs,
    /// Where the simulated OBJ goes; a folder for several bodies, or if it ends with `/`.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// How fine the steps are.
    #[arg(long, value_name = "QUALITY", default_value = "teacher")]
    quality: QualityName,
    /// Fabric: silk, jersey, interlock, cotton, knit or denim
    /// [default: that of the package, else cotton].
    #[arg(long, value_name = "NAME")]
    fabric: Option<String>,
    /// Write an OBJ for each frame of the way into this folder.
    #[arg(long, value_name = "DIR")]
    frames: Option<PathBuf>,
    /// Write the report as JSON; `-` is stdout.
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
}

/// Simulates, writes and reports.
pub(crate) fn run(args: SimulateArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    do_job(|| job(args), console)
}

fn job(args: SimulateArgs) -> anyhow::Result<Job> {
    let mut job = Job::of_input(args.input, args.output)?;
    job.schema = "garnet.simulate/1";
    job.take_report(args.report)?;
    if let Some(folder) = &args.frames {
        output::check_folder(folder)?;
    }
    job.simulation = Some(Simulation {
        quality: args.quality.quality(),
        fabric: args.fabric.as_deref().map(garment::fabric).transpose()?,
        frames: args.frames,
    });
    Ok(job)
}
