//! Tables of the docs as Markdown, from what benches, `garnet eval` and `garnet chart` have
//! written.

mod benches;
mod markdown;
mod paper;
mod peers;
mod scores;

use std::{
    fs, io,
    path::{Path, PathBuf},
    process::Command,
};

use clap::{Args, Subcommand};
use serde::de::DeserializeOwned;

use crate::Outcome;

/// What a table is made of.
#[derive(Debug, Subcommand)]
pub(crate) enum Table {
    /// Of the estimates that `cargo bench -p garnet-benches` left.
    Benches(BenchesArguments),
    /// Of a report of `garnet eval --report FILE.json`.
    Eval(FileArguments),
    /// Of the `chart.json` of `garnet chart`.
    Chart(FileArguments),
    /// Of the lines that the scripts of `benches/peers` print.
    Peers(FileArguments),
    /// The tables of the paper, ours beside them, put into a text.
    Paper(PaperArguments),
}

/// Which reports, and which text.
#[derive(Debug, Args)]
pub(crate) struct PaperArguments {
    /// A folder of reports of `garnet eval --report`, `garnet chart` and `garnet-lab compare
    /// --report`, as JSON.
    folder: PathBuf,
    /// The text: lines `{{NAME}}` stand for tables.
    #[arg(long, value_name = "FILE.md")]
    text: PathBuf,
}

/// Which benches.
#[derive(Debug, Args)]
pub(crate) struct BenchesArguments {
    /// Benches whose names begin so; all without one.
    #[arg(value_name = "PREFIX")]
    prefixes: Vec<String>,
    /// Where criterion keeps its estimates.
    #[arg(long, value_name = "FOLDER", default_value = "target/criterion")]
    criterion: PathBuf,
    #[command(flatten)]
    head: HeadArguments,
}

/// Which report.
#[derive(Debug, Args)]
pub(crate) struct FileArguments {
    /// The report.
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    head: HeadArguments,
}

/// What is said above a table.
#[derive(Debug, Args)]
struct HeadArguments {
    /// The commit that was measured [default: that of the checkout].
    #[arg(long)]
    commit: Option<String>,
}

/// Prints a table.
pub(crate) fn run(table: &Table) -> Outcome {
    let text = match table {
        Table::Benches(arguments) => benches::text(arguments)?,
        Table::Eval(arguments) => scores::of_eval(&read(&arguments.file)?, &arguments.head),
        Table::Chart(arguments) => scores::of_chart(&read(&arguments.file)?, &arguments.head),
        Table::Peers(arguments) => peers::text(&arguments.file, &arguments.head)?,
        Table::Paper(arguments) => paper::filled(&arguments.folder, &arguments.text)?,
    };
    print!("{text}");
    Ok(())
}

impl HeadArguments {
    /// What was measured, where and by which commit, as a paragraph.
    fn text(&self, facts: &[String]) -> String {
        let commit = self.commit.clone().or_else(commit);
        let commit = commit.unwrap_or_else(|| "commit not known".to_owned());
        let facts = facts.iter().filter(|fact| !fact.is_empty());
        let facts: Vec<&str> = facts.map(String::as_str).collect();
        format!("{}; commit {commit}.\n\n", facts.join("; "))
    }
}

/// The commit of the checkout, and whether files differ from it.
fn commit() -> Option<String> {
    let output = Command::new("git")
        .args(["describe", "--always", "--dirty", "--abbrev=9"])
        .output()
        .ok()
        .filter(|output| output.status.success())?;
    let text = String::from_utf8(output.stdout).ok()?;
    Some(text.trim().to_owned())
}

fn read<T: DeserializeOwned>(path: &Path) -> io::Result<T> {
    let context = |error: &dyn std::fmt::Display| format!("`{}`: {error}", path.display());
    let bytes = fs::read(path).map_err(|error| io::Error::new(error.kind(), context(&error)))?;
    serde_json::from_slice(&bytes).map_err(|error| io::Error::other(context(&error)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_head_tells_what_is_known() {
        let head = HeadArguments {
            commit: Some("abc".to_owned()),
        };
        let facts = ["2 threads".to_owned(), String::new(), "`test`".to_owned()];
        assert_eq!(head.text(&facts), "2 threads; `test`; commit abc.\n\n");
    }

    #[test]
    fn a_file_that_is_no_report_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("report.json");
        fs::write(&path, "[]").unwrap();
        let error = read::<scores::Eval>(&path).unwrap_err().to_string();
        assert!(error.contains("report.json"), "{error}");
    }
}
