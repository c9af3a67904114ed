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
            consts::{SIGINT, SIGTERM},
            flag,
        };
        for signal in [SIGINT, SIGTERM] {
            flag::register_conditional_default(signal, Arc::clone(&stop))
                .and_then(|_| flag::register(signal, Arc::clone(&stop)))
                .context("cannot wait for signals")?;
        }
    }
    Ok(stop)
}
