//! Lists of jobs, as JSON, lines of JSON, or CSV, and the arguments that a job stands for.

use std::{collections::BTreeMap, ffi::OsStr, fmt, path::Path, str};

use anyhow::Context;
use clap::{CommandFactory, Parser};
use csv::{ReaderBuilder, StringRecord};
use serde::{
    Deserialize, Deserializer,
    de::{Error as _, MapAccess, Visitor},
};
use serde_json::{Map, Value};

use super::{super::args::DrapeArgs, Problem};
use crate::{
    failure::{Hint, refused},
    hints::did_you_mean,
    input,
};

/// The arguments of `drape` that a job stands for.
#[derive(Debug, Parser)]
#[command(name = "garnet drape", no_binary_name = true)]
struct Line {
    #[command(flatten)]
    args: DrapeArgs,
}

const KEYS: &str =
    "its keys are `garment`, `bodies`, and the options of `garnet drape` without the dashes";

/// Options whose value is a file that is read.
const READ: [&str; 6] = ["rest-body", "rig", "scene", "pose", "joints", "layer"];

/// What parts the files in one cell of a table.
const PARTS_FILES: char = ';';

/// A job as it is listed.
#[derive(Debug, PartialEq)]
pub(super) struct Entry {
    /// The line that it is in, from 1; none in a list of JSON.
    line: Option<u64>,
    keys: Map<String, Value>,
}

impl Entry {
    /// The job in words, by its number from 1.
    pub(super) fn name(&self, number: usize) -> String {
        match self.line {
            Some(line) => format!("job {number} (line {line})"),
            None => format!("job {number}"),
        }
    }
}

/// How an option takes its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Takes {
    Nothing,
    Perhaps,
    Value,
}

/// The options that a job may have, by their names.
#[derive(Debug)]
pub(super) struct Options(BTreeMap<String, Takes>);

impl Options {
    pub(super) fn new() -> Self {
        let mut command = Line::command();
        command.build();
        let options = command.get_arguments().filter_map(|argument| {
            let name = argument.get_long().filter(|name| *name != "help")?;
            let least = argument.get_num_args().map(|range| range.min_values());
            let takes = match (argument.get_action().takes_values(), least) {
                (false, _) => Takes::Nothing,
                (true, Some(0)) => Takes::Perhaps,
                (true, _) => Takes::Value,
            };
            Some((name.to_owned(), takes))
        });
        Self(options.collect())
    }

    /// Refuses a key that a job does not have, with advice.
    fn check(&self, key: &str) -> Result<(), Problem> {
        const FILES: [&str; 3] = ["garment", "bodies", "body"];
        if key == "batch" {
            return Err(Problem::new("a job has no jobs of its own", KEYS));
        }
        if FILES.contains(&key) || self.0.contains_key(key) {
            return Ok(());
        }
        let options = self.0.keys().map(String::as_str);
        let known = FILES
            .into_iter()
            .chain(options.filter(|key| *key != "batch"));
        let hint = did_you_mean(key, known).unwrap_or_else(|| KEYS.to_owned());
        Err(Problem::new(format!("there is no key `{key}`"), hint))
    }

    /// What the keys of a job are on the command line; an error says what is wrong with one, and
    /// what helps.
    fn arguments(&self, job: &Map<String, Value>) -> Result<Vec<String>, Problem> {
        let mut options = Vec::new();
        let (mut garments, mut bodies) = (Vec::new(), Vec::new());
        let with_keys = |cause: String| Problem::new(cause, KEYS);
        if job.contains_key("body") && job.contains_key("bodies") {
            let cause = "it has both `body` and `bodies`";
            return Err(Problem::new(cause, "leave out one of them"));
        }
        for (key, value) in job {
            self.check(key)?;
            match key.as_str() {
                "garment" => garments = texts(key, value).map_err(with_keys)?,
                "bodies" | "body" => bodies = texts(key, value).map_err(with_keys)?,
                "report" if value == "-" => {
                    let cause = "`report` cannot be stdout: the lines have the reports";
                    return Err(Problem::new(cause, "name a file, or leave it out"));
                }
                _ => match value {
                    Value::String(text) if self.0.get(key) == Some(&Takes::Nothing) => {
                        return Err(with_keys(format!(
                            "`{key}` is true or false, and not `{text}`"
                        )));
                    }
                    Value::Bool(true) => options.push(format!("--{key}")),
                    Value::Bool(false) | Value::Null => {}
                    Value::Number(number) => options.push(format!("--{key}={number}")),
                    Value::String(text) => options.push(format!("--{key}={text}")),
                    Value::Array(_) | Value::Object(_) => {
                        return Err(with_keys(format!(
                            "`{key}` is neither a text, a number nor true or false"
                        )));
                    }
                },
            }
        }
        let named = READ.iter().filter_map(|key| job.get(*key)?.as_str());
        let named = named.map(str::to_owned);
        for path in garments.iter().chain(&bodies).cloned().chain(named) {
            if let Err(error) = input::check_regular(Path::new(&path)) {
                let hint = "save what comes from there in a file, and name that";
                return Err(Problem::new(format!("{error:#}"), hint));
            }
        }
        options.push("--".to_owned());
        options.extend(garments);
        options.extend(bodies);
        Ok(options)
    }

    /// What the cell of a table says; none if it is empty.
    fn of_cell(&self, key: &str, cell: &str) -> Option<Value> {
        if cell.trim().is_empty() {
            return None;
        }
        let flag = match cell.trim().to_lowercase().as_str() {
            "true" | "1" | "yes" => Some(true),
            "false" | "0" | "no" => Some(false),
            _ => None,
        };
        let is_word = flag.is_some() && cell.trim().parse::<u8>().is_err();
        Some(match (key, self.0.get(key), flag) {
            ("garment" | "bodies", ..) => {
                let files = cell.split(PARTS_FILES).map(str::trim);
                files.map(Value::from).collect::<Vec<_>>().into()
            }
            (_, Some(Takes::Nothing), Some(flag)) => flag.into(),
            (_, Some(Takes::Perhaps), Some(flag)) if is_word => flag.into(),
            _ => cell.into(),
        })
    }
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

/// The arguments of a job.
pub(super) fn checked(entry: &Entry, options: &Options) -> Result<DrapeArgs, Problem> {
    let arguments = options.arguments(&entry.keys)?;
    match Line::try_parse_from(arguments) {
        Ok(line) => Ok(line.args),
        Err(error) => Err(Problem::new(cause_of(&error), KEYS)),
    }
}

/// What is wrong with arguments, in a line: without usage and help.
fn cause_of(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let lines = text.lines().map(str::trim);
    let told =
        lines.take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"));
    let told: Vec<&str> = told.filter(|line| !line.is_empty()).collect();
    told.join(" ").trim_start_matches("error: ").to_owned()
}

/// The jobs that a file lists: CSV or lines of JSON by its name, else one list of JSON.
pub(super) fn read(path: &Path, options: &Options) -> anyhow::Result<Vec<Entry>> {
    let name = path.display();
    let bytes = input::bytes(path)?;
    let kind = path
        .extension()
        .and_then(OsStr::to_str)
        .map(str::to_lowercase);
    let entries = match kind.as_deref() {
        Some("csv") => of_table(&bytes, options),
        Some("jsonl" | "ndjson") => of_lines(&bytes),
        _ => of_list(&bytes),
    };
    let entries = entries.with_context(|| format!("`{name}` is no list of jobs"))?;
    if entries.is_empty() {
        return Err(refused(
            format!("`{name}` has no jobs"),
            "its list is empty",
            "give an object, or a line, for each drape",
        ));
    }
    Ok(entries)
}

/// An object that has each key once: of two, one would be dropped without a word.
struct Keys(Map<String, Value>);

impl<'de> Deserialize<'de> for Keys {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OfObject;

        impl<'de> Visitor<'de> for OfObject {
            type Value = Keys;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Keys, A::Error> {
                let mut keys = Map::new();
                while let Some((key, value)) = map.next_entry::<String, Value>()? {
                    if keys.contains_key(&key) {
                        return Err(A::Error::custom(format_args!("`{key}` is there twice")));
                    }
                    keys.insert(key, value);
                }
                Ok(Keys(keys))
            }
        }

        deserializer.deserialize_map(OfObject)
    }
}

fn of_list(bytes: &[u8]) -> anyhow::Result<Vec<Entry>> {
    let jobs: Vec<Keys> = serde_json::from_slice(bytes).hint(|| {
        "a list of objects as {\"garment\": \"models/tshirt\", \"bodies\": [\"a.obj\"], \
         \"output\": \"a/shirt.obj\"}, with options of `garnet drape` as further keys; lines of \
         JSON are in files that end with .jsonl, tables in .csv"
            .to_owned()
    })?;
    let entry = |Keys(keys)| Entry { line: None, keys };
    Ok(jobs.into_iter().map(entry).collect())
}

/// An object in each line that is not empty.
fn of_lines(bytes: &[u8]) -> anyhow::Result<Vec<Entry>> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut entries = Vec::new();
    for (line, text) in (1..).zip(bytes.split(|byte| *byte == b'\n')) {
        if text.trim_ascii().is_empty() {
            continue;
        }
        let Keys(keys) = serde_json::from_slice(text).map_err(|error| {
            // Its own number of a line is always 1.
            let error = error.to_string();
            let what = error
                .split(" at line 1")
                .next()
                .unwrap_or_default()
                .to_owned();
            refused(
                format!("line {line}: {what}, at column {}", column_of(&error)),
                format!("`{}`", beginning(&String::from_utf8_lossy(text))),
                "each line is an object as {\"garment\": \"models/tshirt\", \"output\": \
                 \"a.obj\", \"pose\": \"wave\"}",
            )
        })?;
        entries.push(Entry {
            line: Some(line),
            keys,
        });
    }
    Ok(entries)
}

/// The column that a message of `serde_json` ends with.
fn column_of(error: &str) -> &str {
    error.rsplit("column ").next().unwrap_or_default()
}

/// As much of a line as shows which one it is.
fn beginning(text: &str) -> String {
    const SHOWN: usize = 60;
    let text = text.trim();
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// The rows of a table (RFC 4180), whose first has the keys.
fn of_table(bytes: &[u8], options: &Options) -> anyhow::Result<Vec<Entry>> {
    const FIRST: &str = "the first line names the columns, as `garment,bodies,pose,output`";
    let text = str::from_utf8(bytes).map_err(|error| {
        let before = &bytes[..error.valid_up_to()];
        let line = before.split(|byte| *byte == b'\n').count();
        refused(
            format!("line {line} is no text in UTF-8"),
            error.to_string(),
            "save the table as CSV in UTF-8",
        )
    })?;
    let reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .from_reader(text.as_bytes());
    let mut keys: Option<Vec<String>> = None;
    let mut entries = Vec::new();
    let mut rows = reader.into_records().peekable();
    // A quote that is never closed takes in all that comes after it.
    let is_closed = text.matches('"').count().is_multiple_of(2);
    while let Some(row) = rows.next() {
        let row = row.hint(|| FIRST.to_owned())?;
        let line = line_of(&row, text);
        if !is_closed && rows.peek().is_none() {
            return Err(refused(
                format!("line {line} has a quote that is not closed"),
                format!(
                    "`{}`",
                    beginning(row.iter().next_back().unwrap_or_default())
                ),
                "close the quote; one that is meant as such is written twice",
            ));
        }
        match &keys {
            None => keys = Some(columns(&row, line, options)?),
            Some(keys) => entries.extend(of_row(&row, line, keys, options)?),
        }
    }
    Ok(entries)
}

/// The line that a row begins in, from 1; its position is before the end of the line before it, and
/// before empty lines.
fn line_of(row: &StringRecord, text: &str) -> u64 {
    let (start, line) = (row.position()).map_or((0, 0), |place| (place.byte(), place.line()));
    let from_there = text.as_bytes().get(start as usize..).unwrap_or_default();
    let ends = from_there.iter().take_while(|byte| b"\r\n".contains(byte));
    line + ends.filter(|byte| **byte == b'\n').count() as u64
}

/// The keys in the first row of a table; empty ones are of columns without anything in them.
fn columns(row: &StringRecord, line: u64, options: &Options) -> anyhow::Result<Vec<String>> {
    let keys: Vec<String> = row.iter().map(|cell| cell.trim().to_owned()).collect();
    let other = keys
        .iter()
        .find_map(|key| key.find(['\t', PARTS_FILES]).map(|at| &key[at..=at]));
    if let Some(other) = other {
        return Err(refused(
            format!("line {line} does not name columns"),
            format!("its cells are parted by {other:?}"),
            "part cells by commas",
        ));
    }
    for (number, key) in keys.iter().enumerate().filter(|(_, key)| !key.is_empty()) {
        let problem = if keys[..number].contains(key) {
            let cause = format!("two columns are called `{key}`");
            Err(Problem::new(cause, "leave out one of them"))
        } else {
            options.check(key)
        };
        if let Err(Problem { cause, hint }) = problem {
            let error = format!("column {} in line {line} is refused", number + 1);
            return Err(refused(error, cause, hint));
        }
    }
    Ok(keys)
}

/// The job in a row of a table; none in one without text.
fn of_row(
    row: &StringRecord,
    line: u64,
    keys: &[String],
    options: &Options,
) -> anyhow::Result<Option<Entry>> {
    if row.iter().all(|cell| cell.trim().is_empty()) {
        return Ok(None);
    }
    if row.len() != keys.len() {
        return Err(refused(
            format!("line {line} has {} cells", row.len()),
            format!("the first line names {} columns", keys.len()),
            "close all quotes, and put cells that have commas in them into quotes",
        ));
    }
    let mut found = Map::new();
    for (number, (key, cell)) in keys.iter().zip(row).enumerate() {
        if key.is_empty() && !cell.trim().is_empty() {
            return Err(refused(
                format!(
                    "line {line} has `{}` in column {}",
                    beginning(cell),
                    number + 1
                ),
                "the first line has no name for it",
                "name the column, or leave it empty",
            ));
        }
        if let Some(value) = options.of_cell(key, cell) {
            found.insert(key.clone(), value);
        }
    }
    let line = Some(line);
    Ok(Some(Entry { line, keys: found }))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use serde_json::json;

    use super::super::super::args::OF_A_JOB;

    use super::*;

    fn arguments_of(job: Value) -> Result<Vec<String>, Problem> {
        let Value::Object(job) = job else {
            panic!("an object")
        };
        Options::new().arguments(&job)
    }

    fn table(text: &str) -> anyhow::Result<Vec<Entry>> {
        of_table(text.as_bytes(), &Options::new())
    }

    #[test]
    fn a_key_that_is_there_twice_is_refused() {
        let twice = r#"{"garment": "a.obj", "method": "warp", "method": "fast"}"#;
        for found in [
            of_lines(twice.as_bytes()),
            of_list(format!("[{twice}]").as_bytes()),
        ] {
            let error = format!("{:#}", found.unwrap_err());
            assert!(error.contains("`method` is there twice"), "{error}");
        }
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
        assert!(arguments_of(json!({"body": "a", "bodies": "b"})).is_err());
        let problem = arguments_of(json!({"setle": 4})).unwrap_err();
        assert_eq!(problem.hint, "did you mean `settle`?");
    }

    #[test]
    fn cells_are_quoted_as_in_rfc_4180() {
        let text = "\u{feff}garment, bodies ,output,settle,no-untangle,smooth,\r\n\
                    a,\"b, \"\"c\"\".obj;d.obj\",\"two\nlines\",,TRUE,1,\r\n\
                    ,,,,,,\r\n\r\n\
                    a,,o,4,0,yes,\r\n";
        let entries = table(text).unwrap();
        let lines: Vec<Option<u64>> = entries.iter().map(|entry| entry.line).collect();
        assert_eq!(lines, [Some(2), Some(6)]);
        let keys = |number: usize| Value::Object(entries[number].keys.clone());
        assert_eq!(
            keys(0),
            json!({"garment": ["a"], "bodies": ["b, \"c\".obj", "d.obj"], "output": "two\nlines",
                   "no-untangle": true, "smooth": "1"})
        );
        assert_eq!(
            keys(1),
            json!({"garment": ["a"], "output": "o", "settle": "4", "no-untangle": false,
                   "smooth": true})
        );
    }

    #[test]
    fn tables_that_are_wrong_are_told_by_their_line() {
        for (text, told) in [
            ("garment;output\na;b\n", "line 1 does not name columns"),
            ("garment,out-put\na,b\n", "column 2 in line 1 is refused"),
            ("garment,garment\na,b\n", "column 2 in line 1 is refused"),
            ("garment,output\na,b\nc\n", "line 3 has 1 cells"),
            (
                "garment,output\na,b\nc,\"d\ne,f\n",
                "line 3 has a quote that is not closed",
            ),
            ("garment,\na,b\n", "line 2 has `b` in column 2"),
        ] {
            assert_eq!(table(text).unwrap_err().to_string(), told, "{text}");
        }
        let latin = of_table(b"garment,output\na,\xe9.obj\n", &Options::new()).unwrap_err();
        assert_eq!(latin.to_string(), "line 2 is no text in UTF-8");
    }

    #[test]
    fn lines_of_json_are_jobs() {
        let entries = of_lines(b"{\"garment\": \"a\"}\n\n  {\"garment\": \"b\"}\r\n").unwrap();
        let lines: Vec<Option<u64>> = entries.iter().map(|entry| entry.line).collect();
        assert_eq!(lines, [Some(1), Some(3)]);
        let error = of_lines(b"{}\n{\"a\": }\n").unwrap_err().to_string();
        assert_eq!(error, "line 2: expected value, at column 7");
    }
}
