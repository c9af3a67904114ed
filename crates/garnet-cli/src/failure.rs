//! How the command ends, and errors with advice.

use std::{error::Error, fmt, process::ExitCode};

/// How the command ends.
///
/// An interrupted command is ended by the signal itself, which shells show as 130: outputs appear
/// whole or not at all. Where a file is being written for long, it is taken away first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ExitStatus {
    /// 0: all was done.
    Done,
    /// 1: all was done, but a limit that the user set is exceeded.
    LimitExceeded,
    /// 2: it was not done: usage, unreadable or mismatched input, disk.
    NotDone,
    /// 130: it was told to stop.
    Interrupted,
}

impl ExitStatus {
    pub(crate) const fn code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::LimitExceeded => 1,
            Self::NotDone => 2,
            Self::Interrupted => 130,
        }
    }
}

impl From<ExitStatus> for ExitCode {
    fn from(status: ExitStatus) -> Self {
        Self::from(status.code())
    }
}

/// An error with advice of what to do about it.
#[derive(Debug)]
pub(crate) struct Hinted {
    error: anyhow::Error,
    pub(crate) hint: String,
}

impl fmt::Display for Hinted {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.error.fmt(formatter)
    }
}

impl Error for Hinted {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.error.source()
    }
}

/// Adds advice to an error.
pub(crate) trait Hint<T> {
    /// The hint is shown after the error and its causes; the outermost one is shown.
    fn hint(self, hint: impl FnOnce() -> String) -> anyhow::Result<T>;
}

impl<T, E: Into<anyhow::Error>> Hint<T> for Result<T, E> {
    fn hint(self, hint: impl FnOnce() -> String) -> anyhow::Result<T> {
        self.map_err(|error| with_hint(error, hint()))
    }
}

/// An error with advice.
pub(crate) fn with_hint(error: impl Into<anyhow::Error>, hint: String) -> anyhow::Error {
    anyhow::Error::new(Hinted {
        error: error.into(),
        hint,
    })
}

/// An error with a cause and advice.
pub(crate) fn refused(
    error: impl Into<String>,
    cause: impl Into<String>,
    hint: impl Into<String>,
) -> anyhow::Error {
    let hint = hint.into();
    let error = anyhow::anyhow!(cause.into()).context(error.into());
    anyhow::Error::new(Hinted { error, hint })
}
