//! Ctrl-C, where something has to be put in order before the command ends.

use std::{
    fmt,
    sync::{Arc, atomic::AtomicBool},
};

use anyhow::Context;

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
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    // The first bit is the first signal, which is this one.
    ignored.is_none_or(|mask| mask & 1 == 1)
}
