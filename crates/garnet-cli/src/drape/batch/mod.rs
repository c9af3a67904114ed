//! Many drapes that a file lists, each with arguments of its own.

mod apart;
mod list;

use std::{path::Path, sync::atomic::Ordering};

use serde::Serialize;
use tracing::info_span;

use apart::Files;
use list::Options;

use super::{
    args::{DrapeArgs, Job},
    done, judge,
    outfit::{self, OutfitReport},
    publish,
    report::DrapeReport,
};
use crate::{
    console::{Console, print_data},
    failure::{ExitStatus, refused},
    interrupt::{Interrupted, stop_flag},
    stderr::Failure,
};

/// What is wrong with a job, and what helps.
#[derive(Debug, PartialEq, Eq)]
struct Problem {
    cause: String,
    hint: String,
}

impl Problem {
    fn new(cause: impl Into<String>, hint: impl Into<String>) -> Self {
        let (cause, hint) = (cause.into(), hint.into());
        Self { cause, hint }
    }

    /// The error of a job of a list.
    fn of(self, job: &str, list: &Path) -> anyhow::Error {
        let error = format!("{job} of `{}` is refused", list.display());
        refused(error, self.cause, self.hint)
    }
}

/// The report of a job, as a run of its own writes it.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Done {
    Drape(Box<DrapeReport>),
    Outfit(Box<OutfitReport>),
}

/// A line for each job.
#[derive(Debug, Serialize)]
struct LineReport {
    schema: &'static str,
    /// From 1.
    job: usize,
    output: String,
    /// As the command would have ended with it.
    exit_code: u8,
    /// What was done.
    report: Option<Done>,
    /// Why it was not.
    error: Option<Failure>,
}

/// Does one job after the other, and prints a line for each. Stopped, it ends after the job that it
/// is at.
pub(super) fn run(path: &Path, console: &Console) -> anyhow::Result<ExitStatus> {
    let jobs = read(path)?;
    let silent = Console::silent();
    let total = jobs.len();
    let stop = stop_flag()?;
    let progress = console.progress(total);
    let (mut failed, mut exceeded) = (0, 0);
    for (number, args) in jobs.into_iter().enumerate() {
        let output = args.output.display().to_string();
        let _span = info_span!("job", number = number + 1).entered();
        let (status, report, error) = match once(args, &silent) {
            Ok((status, report)) => (status, report, None),
            Err(error) if error.downcast_ref::<Interrupted>().is_some() => {
                progress.finish_and_clear();
                console.failure(&error);
                return Ok(ExitStatus::Interrupted);
            }
            Err(error) => (ExitStatus::NotDone, None, Some(Failure::new(&error))),
        };
        exceeded += usize::from(status == ExitStatus::LimitExceeded);
        failed += usize::from(status == ExitStatus::NotDone);
        let line = LineReport {
            schema: "garnet.batch-line/1",
            job: number + 1,
            output,
            exit_code: status.code(),
            report,
            error,
        };
        let line = serde_json::to_string(&line)?;
        progress.suspend(|| print_data(&line))?;
        progress.inc(1);
        if stop.load(Ordering::Relaxed) && number + 1 < total {
            progress.finish_and_clear();
            let told = format!(
                "{} of {total} jobs are done, each with its line; leave them out of `{}` and go on",
                number + 1,
                path.display()
            );
            console.failure(&anyhow::Error::new(Interrupted { told }));
            return Ok(ExitStatus::Interrupted);
        }
    }
    progress.finish_and_clear();
    let done = total - failed;
    console.summary(&format_args!(
        "{done} of {total} jobs are done, {exceeded} of them exceed a limit"
    ));
    Ok(match (failed, exceeded) {
        (1.., _) => ExitStatus::NotDone,
        (0, 1..) => ExitStatus::LimitExceeded,
        (0, 0) => ExitStatus::Done,
    })
}

fn once(args: DrapeArgs, console: &Console) -> anyhow::Result<(ExitStatus, Option<Done>)> {
    if let Some(outfit) = args.outfit()? {
        let (status, report) = outfit::run(outfit, console)?;
        return Ok((status, Some(Done::Outfit(Box::new(report)))));
    }
    let (report, job) = done(|| Job::new(args), console)?;
    publish(&report, &job, console)?;
    let status = judge(&report, &job, console);
    Ok((status, Some(Done::Drape(Box::new(report)))))
}

/// The jobs of a file, all of them checked before the first is done: their arguments, and that none
/// writes what another one reads or writes.
fn read(path: &Path) -> anyhow::Result<Vec<DrapeArgs>> {
    let options = Options::new();
    let entries = list::read(path, &options)?;
    let mut names = Vec::with_capacity(entries.len());
    let mut jobs = Vec::with_capacity(entries.len());
    for (number, entry) in entries.iter().enumerate() {
        let name = entry.name(number + 1);
        let checked = list::checked(entry, &options);
        jobs.push(checked.map_err(|problem| problem.of(&name, path))?);
        names.push(name);
    }
    let files: Vec<Files> = jobs.iter().map(Files::of).collect();
    let met = apart::first_meeting(path, &names, &files);
    met.map_or(
        Ok(jobs),
        |(job, problem)| Err(problem.of(&names[job], path)),
    )
}
