//! `garnet simulate`: the physics-based simulation of a scene.

use std::path::PathBuf;

use clap::Args;

use crate::{
    console::Console,
    dataset::QualityName,
    drape::{InputArgs, Job, Simulation, do_job},
    fabric,
    failure::{ExitStatus, refused},
    output,
};

/// Arguments of `simulate`.
#[derive(Debug, Args)]
#[command(after_long_help = LONG_HELP)]
pub(crate) struct SimulateArgs {
    #[command(flatten)]
    input: InputArgs,
    /// Where the simulated cloth goes: an OBJ, or a GLB with the body; for several bodies or a
    /// motion a folder of OBJ, or one file of all frames: .pc2, .mdd, .npz or .glb.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// How fine the steps are.
    #[arg(long, value_name = "QUALITY", default_value = "teacher")]
    quality: QualityName,
    /// Fabric: silk, jersey, interlock, cotton, knit or denim
    /// [default: that of the package, else cotton].
    #[arg(long, value_name = "NAME")]
    fabric: Option<String>,
    /// Write an OBJ for each frame of the way to a pose into this folder.
    #[arg(long, value_name = "DIR")]
    frames: Option<PathBuf>,
    /// Go on with a simulation along a motion that was stopped.
    #[arg(long)]
    resume: bool,
    /// Write the report as JSON; `-` is stdout.
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
}

const LONG_HELP: &str = "\
A range of frames (`--pose walk.bvh:0:240`) is simulated as a motion: the cloth comes to rest on the first frame, and is \
then stepped along at the speed of the recording. Until it is done its frames wait in the folder `OUT.part`, from which \
`--resume` goes on. `garnet drape --method sim` simulates each frame by itself.";

/// Simulates, writes and reports.
pub(crate) fn run(args: SimulateArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    do_job(|| job(args), console)
}

fn job(args: SimulateArgs) -> anyhow::Result<Job> {
    let follows = args.input.is_motion();
    let mut job = Job::of_input(args.input, args.output)?;
    job.follows = follows;
    job.resumes = args.resume;
    if args.resume && !follows {
        return Err(refused(
            "`--resume` is for simulations along a motion",
            "no range of frames is simulated",
            "name one with `--pose FILE:FIRST:END`, or leave out `--resume`",
        ));
    }
    if args.frames.is_some() && follows {
        return Err(refused(
            "`--frames` writes the way to one pose",
            "a motion is simulated, whose frames go to `-o`",
            "leave out `--frames`",
        ));
    }
    job.schema = "garnet.simulate/1";
    job.take_report(args.report)?;
    if let Some(folder) = &args.frames {
        output::check_folder(folder)?;
    }
    job.simulation = Some(Simulation {
        quality: args.quality.quality(),
        fabric: args.fabric.as_deref().map(fabric::fabric).transpose()?,
        frames: args.frames,
    });
    Ok(job)
}
