//! Ctrl-C, where something has to be put in order before the command ends.

use std::{
    fmt, fs,
    path::PathBuf,
    process,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use anyhow::Context;

use crate::{console::Console, failure::ExitStatus};

/// The command was told to stop.
#[derive(Debug)]
pub(crate) struct Interrupted {
    /// What is left of it.
    pub(crate) told: String,
}

impl fmt::Display for Interrupted {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "interrupted: {}", self.told)
    }
}

impl std::error::Error for Interrupted {}

/// How often a signal is looked for that ends the command.
const BETWEEN_LOOKS: Duration = Duration::from_millis(30);

/// Ends the command on the first signal to end, where all outputs appear whole or not at all, and
/// tells what is left in the last of `folders`. Those that are not there yet are removed again if
/// they are empty.
#[expect(
    clippy::exit,
    reason = "a thread that waits for signals cannot return for the others"
)]
pub(crate) fn tell_on_interrupt(
    told: String,
    folders: Vec<PathBuf>,
    console: &Console,
) -> anyhow::Result<()> {
    let stop = stop_flag()?;
    let console = console.other();
    let is_new: Vec<bool> = folders.iter().map(|folder| !folder.exists()).collect();
    thread::spawn(move || {
        while !stop.load(Ordering::Relaxed) {
            thread::sleep(BETWEEN_LOOKS);
        }
        let holds = |folder: &PathBuf| {
            let entries = fs::read_dir(folder);
            entries.is_ok_and(|mut entries| entries.next().is_some())
        };
        let told = match folders.last() {
            Some(folder) if !holds(folder) => "nothing was written".to_owned(),
            _ => told,
        };
        for (folder, _) in folders
            .iter()
            .zip(is_new)
            .rev()
            .filter(|(_, is_new)| *is_new)
        {
            // One that holds something stays.
            let _ = fs::remove_dir(folder);
        }
        console.failure(&anyhow::Error::new(Interrupted { told }));
        process::exit(ExitStatus::Interrupted.code().into())
    });
    Ok(())
}

/// A flag that the first signal to end sets; the second one ends the command at once.
pub(crate) fn stop_flag() -> anyhow::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    #[cfg(unix)]
    {
        use signal_hook::{
            consts::{SIGHUP, SIGINT, SIGTERM},
            flag,
        };
        let hangs_up = (!ignores_hangups()).then_some(SIGHUP);
        for signal in [SIGINT, SIGTERM].into_iter().chain(hangs_up) {
            flag::register_conditional_default(signal, Arc::clone(&stop))
                .and_then(|_| flag::register(signal, Arc::clone(&stop)))
                .context("cannot wait for signals")?;
        }
    }
    Ok(stop)
}

/// Whether the command goes on when its terminal is closed, as under `nohup`; where the system does
/// not tell, a closed terminal ends it at once.
#[cfg(unix)]
fn ignores_hangups() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    // The first bit is the first signal, which is this one.
    ignored.is_none_or(|mask| mask & 1 == 1)
}
