//! How a failure ends the command and what is told about it.

use std::{error::Error, fmt, process::ExitCode};

use serde::Serialize;

use crate::{console::tell, hints};

/// How the command ends.
///
/// An interrupted command is ended by the signal itself, which shells show as 130; since outputs
/// appear whole or not at all, nothing needs to be put in order before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ExitStatus {
    /// 0: all was done.
    Done,
    /// 1: all was done, but a limit that the user set is exceeded.
    LimitExceeded,
    /// 2: it was not done: usage, unreadable or mismatched input, disk.
    NotDone,
}

impl From<ExitStatus> for ExitCode {
    fn from(status: ExitStatus) -> Self {
        Self::from(match status {
            ExitStatus::Done => 0,
            ExitStatus::LimitExceeded => 1,
            ExitStatus::NotDone => 2,
        })
    }
}

/// An error with advice of what to do about it.
#[derive(Debug)]
struct Hinted {
    error: anyhow::Error,
    hint: String,
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

/// What is told about an error.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Failure {
    schema: &'static str,
    /// The clause that says what was not done.
    pub(crate) error: String,
    /// Why, from the outside in.
    pub(crate) causes: Vec<String>,
    /// What to do about it.
    pub(crate) hint: Option<String>,
}

impl Failure {
    pub(crate) fn new(error: &anyhow::Error) -> Self {
        let mut texts: Vec<String> = Vec::new();
        for text in error.chain().map(|link| one_line(&link.to_string())) {
            // A wrapper that says nothing of its own repeats its source.
            if texts.last() != Some(&text) {
                texts.push(text);
            }
        }
        let given = error.chain().find_map(|link| link.downcast_ref::<Hinted>());
        Self {
            schema: "garnet.error/1",
            hint: match given {
                Some(hinted) => Some(hinted.hint.clone()),
                None => hints::for_error(error),
            },
            causes: texts.split_off(1.min(texts.len())),
            error: texts.pop().unwrap_or_default(),
        }
    }
}

impl Failure {
    /// A failure that needs no explanation.
    pub(crate) fn without_cause(error: String) -> Self {
        Self {
            schema: "garnet.error/1",
            error,
            causes: Vec::new(),
            hint: None,
        }
    }
}

/// Texts of systems and parsers may have several lines.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Prints a failure as JSON to stderr.
pub(crate) fn tell_json(failure: &Failure) {
    let text = serde_json::to_string(failure).unwrap_or_else(|_| failure.error.clone());
    tell(&text);
}

/// Prints what clap found, which is help, the version, or an error of usage.
pub(crate) fn usage(found: &clap::Error) -> ExitStatus {
    if !found.use_stderr() {
        // A reader that has gone away is no error.
        let _ = found.print();
        return ExitStatus::Done;
    }
    if std::env::args_os().any(|argument| argument == "--json") {
        let text = found.render().to_string();
        let first = text.lines().next().unwrap_or_default();
        let error = first.trim_start_matches("error: ").to_owned();
        tell_json(&Failure {
            hint: Some("`garnet --help` lists the arguments".to_owned()),
            ..Failure::without_cause(error)
        });
    } else {
        let _ = found.print();
    }
    ExitStatus::NotDone
}

#[cfg(test)]
mod tests {
    use anyhow::Context;

    use super::*;

    #[test]
    fn causes_follow_from_the_outside_in() {
        let refused: anyhow::Result<()> = Err(anyhow::anyhow!("the line\n is bad"));
        let error = refused
            .hint(|| "mend it".to_owned())
            .context("cannot read `a`")
            .unwrap_err();
        let failure = Failure::new(&error);
        assert_eq!(failure.error, "cannot read `a`");
        assert_eq!(failure.causes, ["the line is bad"]);
        assert_eq!(failure.hint.as_deref(), Some("mend it"));
    }

    #[test]
    fn a_refusal_has_all_three() {
        let failure = Failure::new(&refused("a", "b", "c"));
        assert_eq!((failure.error.as_str(), failure.causes.len()), ("a", 1));
        assert_eq!(failure.hint.as_deref(), Some("c"));
    }
}
