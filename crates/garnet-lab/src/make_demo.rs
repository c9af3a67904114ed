//! Writes the files of `models/demo` anew.

use std::path::PathBuf;

use clap::Args;
use garnet::io::write_atomically;
use garnet_tests::demo::{Demo, people_obj, write_fine};

use crate::Outcome;

/// Without options the files of `models/demo`; else what is asked for alone.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A folder for the scene that the times of the command are stated for: a tunic of 10 000
    /// vertices on a mannequin of 13 000.
    #[arg(long, value_name = "FOLDER")]
    fine: Option<PathBuf>,
    /// A file for ten bodies side by side, at rest and in poses.
    #[arg(long, value_name = "FILE")]
    people: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    if let Some(folder) = &arguments.fine {
        std::fs::create_dir_all(folder)?;
        write_fine(folder)?;
    }
    if let Some(file) = &arguments.people {
        let text = people_obj()?;
        write_atomically(file, |out| out.write_all(text.as_bytes()))?;
    }
    if arguments.fine.is_none() && arguments.people.is_none() {
        Demo::new()?.write()?;
    }
    Ok(())
}
