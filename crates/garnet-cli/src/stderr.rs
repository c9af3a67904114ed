//! What goes to stderr: lines, and what is told about errors.

use std::{
    error::Error,
    fmt::Display,
    io::{self, Write},
};

use garnet::io::{FileProblem, MotionProblem};
use serde::Serialize;

use crate::{
    failure::{ExitStatus, Hinted},
    hints,
};

/// Longer words are cut in messages: longer than names are, and than most paths.
const LONGEST_WORD: usize = 300;

/// The same of numbers.
const LONGEST_NUMBER: usize = 40;

/// Prints a line to stderr; there is nowhere to report that this fails.
pub(crate) fn tell(text: &impl Display) {
    let _ = writeln!(io::stderr().lock(), "{text}");
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
        for text in error.chain().map(text_of) {
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

/// The text of a link of a chain of errors; in plain words where the system's are not.
fn text_of(link: &(dyn Error + 'static)) -> String {
    let of_system = link.downcast_ref::<io::Error>();
    let of_system = of_system.or_else(|| match link.downcast_ref()? {
        FileProblem::Io(error) => Some(error),
        _ => None,
    });
    let of_system = of_system.or_else(|| match link.downcast_ref()? {
        MotionProblem::Io(error) => Some(error),
        _ => None,
    });
    let is_folder = |error: &io::Error| error.kind() == io::ErrorKind::IsADirectory;
    if of_system.is_some_and(is_folder) {
        return "it is a folder, not a file".to_owned();
    }
    one_line(&link.to_string())
}

/// Texts of systems and parsers may have several lines, and quote what is in a file.
fn one_line(text: &str) -> String {
    let words: Vec<String> = text.split_whitespace().map(shortened).collect();
    words.join(" ")
}

/// A word, or what is left of one that nobody reads.
fn shortened(word: &str) -> String {
    let count = word.chars().count();
    let is_number = |c: char| c.is_ascii_digit() || "+-.eE'`\",:() \n".contains(c);
    let most = if word.chars().all(is_number) {
        LONGEST_NUMBER
    } else {
        LONGEST_WORD
    };
    if count <= most {
        return word.to_owned();
    }
    let first: String = word.chars().take(most / 2).collect();
    let last: String = word.chars().skip(count - 8).collect();
    format!("{first}… ({count} characters) …{last}")
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
        let error = one_line(first.trim_start_matches("error: "));
        let tip = text
            .lines()
            .find_map(|line| line.trim().strip_prefix("tip: "));
        let help = format!("`{} --help` lists the arguments", command_of(&text));
        // The arguments that are missing are in lines of their own.
        let named = text.lines().skip(1).take_while(|line| !line.is_empty());
        let named = named.filter(|line| line.starts_with("  ") && !line.contains("tip: "));
        tell_json(&Failure {
            causes: named.map(|line| one_line(line.trim())).collect(),
            hint: Some(one_line(tip.unwrap_or(&help))),
            ..Failure::without_cause(error)
        });
    } else {
        let text = found.render().to_string();
        let lines = text.split_inclusive('\n').map(|line| {
            let words = line.split_inclusive(' ').map(shortened);
            words.collect::<String>()
        });
        let short: String = lines.collect();
        if short == text {
            let _ = found.print();
        } else {
            tell(&short.trim_end());
        }
    }
    ExitStatus::NotDone
}

/// The command that a text of usage is about: `garnet drape`.
fn command_of(usage: &str) -> String {
    let line = usage.lines().find_map(|line| line.strip_prefix("Usage: "));
    let words = line.unwrap_or("garnet").split(' ');
    let words = words.take_while(|word| word.starts_with(|first: char| first.is_alphanumeric()));
    words.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use anyhow::Context;

    use super::*;
    use crate::failure::{Hint, refused};

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
    fn the_command_of_a_text_of_usage_is_named() {
        let text = "error: no\n\nUsage: garnet drape --output <OUT> <GARMENT>\n";
        assert_eq!(command_of(text), "garnet drape");
        assert_eq!(command_of("error: no"), "garnet");
    }

    #[test]
    fn what_nobody_reads_is_cut() {
        let (name, number) = ("ä".repeat(70_000), "1".repeat(300));
        let error = format!("no joint `{name}` at {number}: `a/path/of/usual/length.obj`");
        let told = Failure::new(&anyhow::anyhow!(error)).error;
        assert!(
            told.starts_with("no joint `ääää") && told.len() < 1000,
            "{told}"
        );
        assert!(told.contains("… (70002 characters) …ä") && told.contains("(301 characters)"));
        assert!(told.ends_with(": `a/path/of/usual/length.obj`"), "{told}");
    }

    #[test]
    fn a_refusal_has_all_three() {
        let failure = Failure::new(&refused("a", "b", "c"));
        assert_eq!((failure.error.as_str(), failure.causes.len()), ("a", 1));
        assert_eq!(failure.hint.as_deref(), Some("c"));
    }
}
