//! Many drapes that a file lists, each with arguments of its own.

use std::path::Path;

use anyhow::Context;
use clap::Parser;
use garnet::mesh::{MOST_BYTES, read_bounded};
use serde::Serialize;
use serde_json::{Map, Value};

use super::{
    args::{DrapeArgs, Job},
    done, judge, outfit, publish,
    report::DrapeReport,
};
use crate::{
    console::{Console, print_data},
    failure::{ExitStatus, Hint, refused},
    interrupt::Interrupted,
    stderr::Failure,
};

/// The arguments of `drape` that a job stands for.
#[derive(Debug, Parser)]
#[command(name = "garnet drape", no_binary_name = true)]
struct Line {
    #[command(flatten)]
    args: DrapeArgs,
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
    /// What was done; none of outfits.
    report: Option<DrapeReport>,
    /// Why it was not.
    error: Option<Failure>,
}

/// Does one job after the other, and prints a line for each.
pub(super) fn run(path: &Path, console: &Console) -> anyhow::Result<ExitStatus> {
    let jobs = read(path)?;
    let silent = Console::silent();
    let total = jobs.len();
    let progress = console.progress(total);
    let (mut failed, mut exceeded) = (0, 0);
    for (number, args) in jobs.into_iter().enumerate() {
        let output = args.output.display().to_string();
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

fn once(args: DrapeArgs, console: &Console) -> anyhow::Result<(ExitStatus, Option<DrapeReport>)> {
    if let Some(outfit) = args.outfit()? {
        return Ok((outfit::run(outfit, console)?, None));
    }
    let (report, job) = done(|| Job::new(args), console)?;
    publish(&report, &job, console)?;
    Ok((judge(&report, &job, console), Some(report)))
}

/// The jobs of a file, all of them checked as arguments before the first is done.
fn read(path: &Path) -> anyhow::Result<Vec<DrapeArgs>> {
    let name = path.display();
    let bytes = read_bounded(path, MOST_BYTES).with_context(|| format!("cannot read `{name}`"))?;
    let jobs: Vec<Map<String, Value>> = serde_json::from_slice(&bytes)
        .with_context(|| format!("`{name}` is no list of jobs"))
        .hint(|| {
            "a list of objects as {\"garment\": \"models/tshirt\", \"bodies\": [\"a.obj\"], \
             \"output\": \"a/shirt.obj\"}, with options of `garnet drape` as further keys"
                .to_owned()
        })?;
    if jobs.is_empty() {
        return Err(refused(
            format!("`{name}` has no jobs"),
            "its list is empty",
            "give an object for each drape",
        ));
    }
    let mut checked: Vec<DrapeArgs> = Vec::with_capacity(jobs.len());
    for (number, job) in jobs.iter().enumerate() {
        let number = number + 1;
        let args = arguments(job)
            .and_then(|arguments| {
                Line::try_parse_from(arguments).map_err(|error| {
                    let text = error.render().to_string();
                    let first = text.lines().find(|line| !line.trim().is_empty());
                    let first = first.unwrap_or_default().trim_start_matches("error: ");
                    first.to_owned()
                })
            })
            .map_err(|cause| {
                refused(
                    format!("job {number} of `{name}` is refused"),
                    cause,
                    "its keys are `garment`, `bodies`, and the options of `garnet drape` without \
                     the dashes",
                )
            })?
            .args;
        let same = checked.iter().position(|other| other.output == args.output);
        if let Some(same) = same {
            return Err(refused(
                format!("job {number} of `{name}` is refused"),
                format!(
                    "job {} has the output `{}`, too",
                    same + 1,
                    args.output.display()
                ),
                "give each job an output of its own",
            ));
        }
        checked.push(args);
    }
    Ok(checked)
}

/// What the keys of a job are on the command line; an error says what is wrong with one.
fn arguments(job: &Map<String, Value>) -> Result<Vec<String>, String> {
    let mut options = Vec::new();
    let (mut garments, mut bodies) = (Vec::new(), Vec::new());
    for (key, value) in job {
        match key.as_str() {
            "garment" => garments = texts(key, value)?,
            "bodies" | "body" => bodies = texts(key, value)?,
            "batch" => return Err("a job has no jobs of its own".to_owned()),
            "report" if value == "-" => {
                return Err("`report` cannot be stdout: the lines have the reports".to_owned());
            }
            _ => match value {
                Value::Bool(true) => options.push(format!("--{key}")),
                Value::Bool(false) | Value::Null => {}
                Value::Number(number) => options.push(format!("--{key}={number}")),
                Value::String(text) => options.push(format!("--{key}={text}")),
                Value::Array(_) | Value::Object(_) => {
                    return Err(format!(
                        "`{key}` is neither a text, a number nor true or false"
                    ));
                }
            },
        }
    }
    options.push("--".to_owned());
    options.extend(garments);
    options.extend(bodies);
    Ok(options)
}

/// A text, or a list of texts.
fn texts(key: &str, value: &Value) -> Result<Vec<String>, String> {
    let of_list = |value: &Value| value.as_str().map(str::to_owned);
    let found = match value {
        Value::Array(values) => values.iter().map(of_list).collect(),
        value => of_list(value).map(|text| vec![text]),
    };
    found.ok_or_else(|| format!("`{key}` is neither a path nor a list of paths"))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use clap::CommandFactory;
    use serde_json::json;

    use super::super::args::OF_A_JOB;

    use super::*;

    fn arguments_of(job: Value) -> Result<Vec<String>, String> {
        let Value::Object(job) = job else {
            panic!("an object")
        };
        arguments(&job)
    }

    #[test]
    fn all_other_options_are_of_a_job() {
        let command = Line::command();
        let others = command
            .get_arguments()
            .map(|argument| argument.get_id().as_str());
        let others: BTreeSet<&str> = others
            .filter(|id| !["batch", "help"].contains(id))
            .collect();
        assert_eq!(OF_A_JOB.into_iter().collect::<BTreeSet<_>>(), others);
    }

    #[test]
    fn keys_are_options() {
        let found = arguments_of(json!({
            "garment": "a", "bodies": ["b", "c"], "output": "o/", "settle": 4,
            "no-untangle": true, "place": false, "pose": null,
        }));
        let expected = [
            "--no-untangle",
            "--output=o/",
            "--settle=4",
            "--",
            "a",
            "b",
            "c",
        ];
        assert_eq!(found.unwrap(), expected);
        assert!(arguments_of(json!({"garment": 3})).is_err());
        assert!(arguments_of(json!({"units": ["m"]})).is_err());
        assert!(arguments_of(json!({"batch": "again"})).is_err());
        assert!(arguments_of(json!({"report": "-"})).is_err());
    }
}
