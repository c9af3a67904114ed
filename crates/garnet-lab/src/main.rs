//! The authors' instruments, not for users: they measure bodies, the teacher and networks, draw the
//! pictures of README and cards, make files that the crates hold, and print the tables of the docs.
//!
//! ```text
//! cargo run --release -p garnet-lab -- help
//! cargo run --release -p garnet-lab -- check-shapes 500 all
//! cargo bench -p garnet-benches && cargo run --release -p garnet-lab -- report benches
//! ```
//!
//! Threads are those of `RAYON_NUM_THREADS`, or all.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "programs that print what they measure"
)]

mod body_sheet;
mod branching;
mod check_poses;
mod check_shapes;
mod compare;
mod costs;
mod drape_sheet;
mod expect;
mod gallery;
mod hidden_skin;
mod instructions;
#[allow(dead_code, reason = "the command asks for more of it")]
#[path = "../../garnet-cli/src/machine.rs"]
mod machine;
mod make_demo;
mod make_joints;
mod make_template;
mod noise_floor;
mod pattern_sheet;
mod physics;
mod pose_sheet;
mod posed_measures;
mod repack;
mod report;
mod sampled;
mod sewing;
mod sheet;
mod sim_scene;
mod sizes;
mod spread;
mod torch_case;
mod wardrobe;

use std::{error::Error, process::ExitCode};

use clap::{Parser, Subcommand};

/// As `garnet` allocates, so that times are those of the command.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// How an instrument ends.
type Outcome = Result<(), Box<dyn Error>>;

/// The authors' instruments, not for users.
#[derive(Debug, Parser)]
#[command(name = "garnet-lab", version)]
struct Lab {
    #[command(subcommand)]
    instrument: Instrument,
}

/// What there is to measure, to draw, to make and to print.
#[derive(Debug, Subcommand)]
enum Instrument {
    /// Measure built-in bodies against their bars.
    CheckShapes(check_shapes::Arguments),
    /// Measure what posing does to built-in bodies.
    CheckPoses(check_poses::Arguments),
    /// Print what the physics tests measure, beside what theory says.
    Physics,
    /// Measure how much of a drape of the teacher is a matter of chance.
    Branching(branching::Arguments),
    /// Measure the noise floor of the teacher for each garment and fabric.
    NoiseFloor(noise_floor::Arguments),
    /// Measure how much bodies and poses of a data set differ.
    Spread(spread::Arguments),
    /// Measure drapes of the same scenes by several methods against the simulator's.
    Compare(compare::Arguments),
    /// Measure what drapes of the variants of a package cost here, and store it in the package.
    Costs(costs::Arguments),
    /// Fit how far from the simulation drapes of a package probably are, store it, and try it.
    Expect(expect::Arguments),
    /// Measure how far drapes differ between the vector instructions of the processor.
    Instructions(instructions::Arguments),
    /// Measure what deleting the skin under clothes does to drapes.
    HiddenSkin(hidden_skin::Arguments),
    /// Measure how far off the measures of posed bodies are that are told from their skin.
    PosedMeasures(posed_measures::Arguments),
    /// Time a network, and write a case of it for other implementations.
    TorchCase(torch_case::Arguments),
    /// Measure networks that are told sewing parameters against a regression onto principal shapes.
    Sewing(sewing::Arguments),
    /// Draw bodies at rest or in poses.
    BodySheet(body_sheet::Arguments),
    /// Draw the poses of the library, the gait, drawn poses or a motion on a body.
    PoseSheet(pose_sheet::Arguments),
    /// Draw the garments of the built-in patterns.
    PatternSheet(pattern_sheet::Arguments),
    /// Drape a garment by simulation on poses of the library, and draw it.
    SimScene(sim_scene::Arguments),
    /// Store the garments of packages in all letter sizes beside their templates.
    Sizes(sizes::Arguments),
    /// Draw the drapes of a data set.
    DrapeSheet(drape_sheet::Arguments),
    /// Draw what the variants of a package make of a data set, beside the teacher.
    Gallery(gallery::Arguments),
    /// Draw packages on four bodies in four poses.
    Wardrobe(wardrobe::Arguments),
    /// Write the files of `models/demo` anew.
    MakeDemo(make_demo::Arguments),
    /// Fit the joints of the built-in body to its vertices, and store them.
    MakeJoints(make_joints::Arguments),
    /// Make the mesh that all built-in bodies share, and store it.
    MakeTemplate(make_template::Arguments),
    /// Store the weights of variants in fewer bits.
    Repack(repack::Arguments),
    /// Print tables of the docs as Markdown.
    #[command(subcommand)]
    Report(report::Table),
}

fn main() -> ExitCode {
    let done = match Lab::parse().instrument {
        Instrument::CheckShapes(arguments) => check_shapes::run(&arguments),
        Instrument::CheckPoses(arguments) => check_poses::run(&arguments),
        Instrument::Physics => {
            physics::run();
            Ok(())
        }
        Instrument::Branching(arguments) => branching::run(arguments),
        Instrument::NoiseFloor(arguments) => noise_floor::run(&arguments),
        Instrument::Spread(arguments) => spread::run(&arguments),
        Instrument::Compare(arguments) => compare::run(&arguments),
        Instrument::Costs(arguments) => costs::run(&arguments),
        Instrument::Expect(arguments) => expect::run(&arguments),
        Instrument::Instructions(arguments) => instructions::run(&arguments),
        Instrument::HiddenSkin(arguments) => hidden_skin::run(&arguments),
        Instrument::PosedMeasures(arguments) => posed_measures::run(&arguments),
        Instrument::TorchCase(arguments) => torch_case::run(&arguments),
        Instrument::Sewing(arguments) => sewing::run(&arguments),
        Instrument::BodySheet(arguments) => body_sheet::run(&arguments),
        Instrument::PoseSheet(arguments) => pose_sheet::run(&arguments),
        Instrument::PatternSheet(arguments) => pattern_sheet::run(&arguments),
        Instrument::SimScene(arguments) => sim_scene::run(&arguments),
        Instrument::Sizes(arguments) => sizes::run(&arguments),
        Instrument::DrapeSheet(arguments) => drape_sheet::run(&arguments),
        Instrument::Gallery(arguments) => gallery::run(&arguments),
        Instrument::Wardrobe(arguments) => wardrobe::run(&arguments),
        Instrument::MakeDemo(arguments) => make_demo::run(&arguments),
        Instrument::MakeJoints(arguments) => make_joints::run(&arguments),
        Instrument::MakeTemplate(arguments) => make_template::run(&arguments),
        Instrument::Repack(arguments) => repack::run(&arguments),
        Instrument::Report(table) => report::run(&table),
    };
    let Err(error) = done else {
        return ExitCode::SUCCESS;
    };
    eprintln!("error: {error}");
    let mut cause = error.source();
    while let Some(next) = cause {
        eprintln!("  cause: {next}");
        cause = next.source();
    }
    ExitCode::from(2)
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_arguments_of_all_instruments_are_sound() {
        Lab::command().debug_assert();
    }
}
