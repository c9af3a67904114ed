//! Estimates of criterion.

use std::{collections::BTreeMap, error::Error, fs, io, path::Path};

use serde::Deserialize;
use serde_json::Value;

use super::{BenchesArguments, markdown::Grid, read};
use crate::machine;

/// A bench, from `benchmark.json`.
#[derive(Debug, Deserialize)]
struct Bench {
    group_id: String,
    full_id: String,
    /// What an iteration works through, by its kind.
    throughput: Option<Value>,
}

/// What was found, from `estimates.json`.
#[derive(Debug, Deserialize)]
struct Estimates {
    median: Estimate,
}

/// Nanoseconds.
#[derive(Debug, Deserialize)]
struct Estimate {
    point_estimate: f64,
    confidence_interval: Interval,
}

#[derive(Debug, Deserialize)]
struct Interval {
    lower_bound: f64,
    upper_bound: f64,
}

/// A table a group.
pub(super) fn text(arguments: &BenchesArguments) -> Result<String, Box<dyn Error>> {
    let mut found = Vec::new();
    collect(&arguments.criterion, &mut found)?;
    let is_asked = |bench: &Bench| {
        let prefixes = &arguments.prefixes;
        prefixes.is_empty()
            || prefixes
                .iter()
                .any(|prefix| bench.full_id.starts_with(prefix))
    };
    found.retain(|(bench, _)| is_asked(bench));
    if found.is_empty() {
        let folder = arguments.criterion.display();
        return Err(format!("there are no such benches in `{folder}`").into());
    }
    let mut groups: BTreeMap<&str, Vec<&(Bench, Estimates)>> = BTreeMap::new();
    for entry in &found {
        groups.entry(&entry.0.group_id).or_default().push(entry);
    }
    let facts = ["Medians by criterion".to_owned(), machine::description()];
    let mut text = arguments.head.text(&facts);
    let mut is_first = true;
    for (group, mut benches) in groups {
        benches.sort_by_key(|(bench, _)| natural(&bench.full_id));
        let mut grid = Grid::new(&[group, "ms", "95 % of medians", "elements/s"]);
        for (bench, estimates) in benches {
            grid.push(row(bench, &estimates.median));
        }
        if !is_first {
            text.push('\n');
        }
        is_first = false;
        text += &grid.text();
    }
    Ok(text)
}

fn row(bench: &Bench, median: &Estimate) -> Vec<String> {
    let name = bench.full_id.strip_prefix(&bench.group_id);
    let name = name.map_or(bench.full_id.as_str(), |name| name.trim_start_matches('/'));
    let interval = &median.confidence_interval;
    let elements = bench.throughput.as_ref().map(|kinds| &kinds["Elements"]);
    let rate = elements.and_then(Value::as_f64).map_or_else(
        || "-".to_owned(),
        |count| format!("{:.2e}", 1e9 * count / median.point_estimate),
    );
    vec![
        name.to_owned(),
        milliseconds(median.point_estimate),
        format!(
            "{} to {}",
            milliseconds(interval.lower_bound),
            milliseconds(interval.upper_bound)
        ),
        rate,
    ]
}

/// Three digits that count.
fn milliseconds(nanoseconds: f64) -> String {
    let value = nanoseconds / 1e6;
    let decimals = (2.0 - value.log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.decimals$}")
}

/// The name in pieces, so that numbers come in their order.
fn natural(name: &str) -> Vec<(u64, String)> {
    let pieces = name.split(|character: char| !character.is_ascii_alphanumeric());
    pieces
        .map(|piece| (piece.parse().unwrap_or(0), piece.to_owned()))
        .collect()
}

/// All benches below a folder.
fn collect(folder: &Path, found: &mut Vec<(Bench, Estimates)>) -> io::Result<()> {
    let newest = folder.join("new");
    if newest.join("benchmark.json").is_file() {
        let bench = read(&newest.join("benchmark.json"))?;
        found.push((bench, read(&newest.join("estimates.json"))?));
    }
    let entries = fs::read_dir(folder).map_err(|error| {
        let text = format!("`{}`: {error}", folder.display());
        io::Error::new(error.kind(), text)
    })?;
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() && path != newest {
            collect(&path, found)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::HeadArguments;

    fn write(folder: &Path, name: &str, throughput: &str, nanoseconds: f64) {
        let folder = folder.join(name).join("new");
        fs::create_dir_all(&folder).unwrap();
        let bench = format!(
            r#"{{"group_id": "drape", "function_id": null, "value_str": null, "full_id": "{name}",
            "directory_name": "{name}", "title": "{name}", "throughput": {throughput}}}"#
        );
        let interval = r#"{"confidence_level": 0.95, "lower_bound": 9e5, "upper_bound": 2e6}"#;
        let estimates = format!(
            r#"{{"median": {{"confidence_interval": {interval}, "point_estimate": {nanoseconds},
            "standard_error": 1.0}}}}"#
        );
        fs::write(folder.join("benchmark.json"), bench).unwrap();
        fs::write(folder.join("estimates.json"), estimates).unwrap();
    }

    fn arguments(folder: &Path, prefix: &str) -> BenchesArguments {
        BenchesArguments {
            prefixes: vec![prefix.to_owned()],
            criterion: folder.to_owned(),
            head: HeadArguments {
                commit: Some("abc".to_owned()),
            },
        }
    }

    #[test]
    fn benches_come_by_group_and_number() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), "drape/bound/10000", "null", 12_345_678.0);
        let thousand = r#"{"Elements": 1000}"#;
        write(folder.path(), "drape/bound/1000", thousand, 1e6);
        let text = text(&arguments(folder.path(), "drape")).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[0].ends_with("commit abc."), "{text}");
        assert!(lines[2].starts_with("| drape"), "{text}");
        assert!(lines[4].contains("| bound/1000 ") && lines[4].contains("1.00e6"));
        assert!(lines[5].contains("| bound/10000 |") && lines[5].contains(" 12.3 |"));
        assert_eq!(lines.len(), 6);
    }

    #[test]
    fn nothing_measured_is_said() {
        let folder = tempfile::tempdir().unwrap();
        assert!(text(&arguments(folder.path(), "drape")).is_err());
    }
}
