//! What goes to the terminal: data to stdout, everything else to stderr.

use std::{
    collections::BTreeSet,
    env,
    fmt::Display,
    io::{self, IsTerminal, Write},
    sync::Mutex,
};

use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use crate::stderr::{Failure, tell, tell_json};

/// How the command speaks.
#[derive(Debug, Clone, Copy)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a flag of the command line"
)]
pub(crate) struct ConsoleOptions {
    /// Data on stdout are one JSON document, errors are JSON.
    pub(crate) is_json: bool,
    /// Errors alone are told.
    pub(crate) is_quiet: bool,
    /// What is done is told, too, and how long each stage took.
    pub(crate) is_verbose: bool,
    /// No bar is drawn.
    pub(crate) hides_progress: bool,
    /// When messages are colored.
    pub(crate) color: ColorChoice,
}

/// When messages are colored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ColorChoice {
    /// On a terminal, unless `NO_COLOR` is set.
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

/// How much is told, and in which form.
#[derive(Debug)]
pub(crate) struct Console {
    is_json: bool,
    loudness: Loudness,
    draws_progress: bool,
    is_colored: bool,
    /// Warnings that were told: of many drapes each is told once.
    told: Mutex<BTreeSet<String>>,
}

/// How much is told beside errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Loudness {
    /// Nothing.
    Quiet,
    /// What was done, and what may be wrong.
    Usual,
    /// And how long each stage took.
    Verbose,
}

const RED: &str = "\x1b[1;31m";
const YELLOW: &str = "\x1b[1;33m";
const CYAN: &str = "\x1b[1;36m";
const RESET: &str = "\x1b[0m";

impl Console {
    pub(crate) fn new(options: ConsoleOptions) -> Self {
        let is_terminal = io::stderr().is_terminal();
        let is_colored = match options.color {
            ColorChoice::Always => true,
            ColorChoice::Never => false,
            ColorChoice::Auto => {
                let refused = env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
                is_terminal && !refused
            }
        };
        Self {
            is_json: options.is_json,
            loudness: match (options.is_quiet, options.is_verbose) {
                (true, _) => Loudness::Quiet,
                // The document says it all.
                (false, false) if options.is_json => Loudness::Quiet,
                (false, false) => Loudness::Usual,
                (false, true) => Loudness::Verbose,
            },
            // Lines that others write would be drawn into it.
            draws_progress: is_terminal
                && !options.hides_progress
                && !options.is_quiet
                && !options.is_verbose,
            is_colored,
            told: Mutex::default(),
        }
    }

    /// One that tells errors alone, without color.
    pub(crate) const fn silent() -> Self {
        Self {
            is_json: false,
            loudness: Loudness::Quiet,
            draws_progress: false,
            is_colored: false,
            told: Mutex::new(BTreeSet::new()),
        }
    }

    /// Whether the data on stdout are one JSON document.
    pub(crate) fn is_json(&self) -> bool {
        self.is_json
    }

    /// Tells what was done.
    pub(crate) fn summary(&self, text: &impl Display) {
        if self.loudness >= Loudness::Usual {
            tell(text);
        }
    }

    /// Tells what only some want to know.
    pub(crate) fn detail(&self, text: &impl Display) {
        if self.loudness >= Loudness::Verbose {
            tell(text);
        }
    }

    /// Tells what may be wrong.
    pub(crate) fn warning(&self, text: &impl Display) {
        if self.loudness < Loudness::Usual {
            return;
        }
        let text = text.to_string();
        let is_new = (self.told.lock()).is_ok_and(|mut told| told.insert(text.clone()));
        if is_new {
            tell(&format_args!("{} {text}", self.label("warning:", YELLOW)));
        }
    }

    /// Another one that tells the same in the same form, for another thread.
    pub(crate) fn other(&self) -> Self {
        Self {
            is_json: self.is_json,
            loudness: self.loudness,
            draws_progress: self.draws_progress,
            is_colored: self.is_colored,
            told: Mutex::default(),
        }
    }

    /// Tells that limits of the user are exceeded, one or several.
    pub(crate) fn exceeded(&self, limits: &[String]) {
        if self.is_json {
            tell_json(&Failure::without_cause(limits.join("; ")));
            return;
        }
        for text in limits {
            tell(&format_args!("{} {text}", self.label("error:", RED)));
        }
    }

    /// Tells why something was not done.
    pub(crate) fn failure(&self, error: &anyhow::Error) {
        let failure = Failure::new(error);
        if self.is_json {
            tell_json(&failure);
            return;
        }
        tell(&format_args!(
            "{} {}",
            self.label("error:", RED),
            failure.error
        ));
        for cause in &failure.causes {
            tell(&format_args!("  cause: {cause}"));
        }
        if let Some(hint) = &failure.hint {
            tell(&format_args!("  {} {hint}", self.label("hint:", CYAN)));
        }
    }

    /// A bar over `count` items; nothing is drawn for one, or where no one looks.
    pub(crate) fn progress(&self, count: usize) -> ProgressBar {
        let bar = ProgressBar::with_draw_target(Some(count as u64), ProgressDrawTarget::stderr());
        if !self.draws_progress || count < 2 {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}, {eta} left");
        bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
    }

    fn label(&self, text: &str, color: &str) -> String {
        if self.is_colored {
            format!("{color}{text}{RESET}")
        } else {
            text.to_owned()
        }
    }
}

/// Prints data to stdout; a reader that has gone away is no error.
pub(crate) fn print_data(text: &str) -> anyhow::Result<()> {
    let mut stdout = io::stdout().lock();
    let written = writeln!(stdout, "{text}").and_then(|()| stdout.flush());
    match written {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(anyhow::Error::new(error).context("cannot write to stdout"))
        }
        _ => Ok(()),
    }
}

/// Prints a document to stdout.
pub(crate) fn print_document(document: &impl Serialize) -> anyhow::Result<()> {
    print_data(&serde_json::to_string_pretty(document)?)
}
