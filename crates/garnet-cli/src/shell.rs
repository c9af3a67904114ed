//! `garnet completions` and `garnet man`: what shells and manuals need.

use std::path::{Path, PathBuf};

use clap::{Args, Command};
use clap_complete::Shell;

use crate::{
    console::{Console, print_data, print_document},
    failure::ExitStatus,
    output,
};

/// Arguments of `completions`.
#[derive(Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// The shell.
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// Arguments of `man`.
#[derive(Debug, Args)]
pub(crate) struct ManArgs {
    /// Folder of the pages.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

/// Prints the script with which a shell completes the command.
pub(crate) fn completions(
    args: &CompletionsArgs,
    mut command: Command,
) -> anyhow::Result<ExitStatus> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, "garnet", &mut script);
    print_data(String::from_utf8(script)?.trim_end())?;
    Ok(ExitStatus::Done)
}

/// Writes a page of the manual for the command and for each of its subcommands.
pub(crate) fn man(
    args: &ManArgs,
    command: Command,
    console: &Console,
) -> anyhow::Result<ExitStatus> {
    output::check_output_folder(&args.output)?;
    output::open_folder(&args.output)?;
    // One line of it: pages are of a version, not of a build.
    let short = command.long_version(None::<&str>);
    let mut command = short.disable_help_subcommand(true);
    command.build();
    let mut count = 0;
    write(&command, "garnet", &args.output, &mut count)?;
    console.summary(&format_args!(
        "{count} pages are in `{}`",
        args.output.display()
    ));
    if console.is_json() {
        print_document(&serde_json::json!({
            "schema": "garnet.man/1",
            "output": args.output.display().to_string(),
            "pages": count,
        }))?;
    }
    Ok(ExitStatus::Done)
}

fn write(command: &Command, name: &str, folder: &Path, count: &mut usize) -> anyhow::Result<()> {
    let mut page = Vec::new();
    clap_mangen::Man::new(command.clone())
        .title(name.to_uppercase())
        .render(&mut page)?;
    output::write(&folder.join(format!("{name}.1")), &page)?;
    *count += 1;
    for subcommand in command.get_subcommands() {
        let name = format!("{name}-{}", subcommand.get_name());
        write(subcommand, &name, folder, count)?;
    }
    Ok(())
}
