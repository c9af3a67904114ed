//! The table, the picture, and the numbers.

use std::fmt::Write as _;

use garnet::stress::{Axis, Cell, Hold, StressOptions};
use garnet_view::{Axis as ChartAxis, Chart, Series};
use serde::Serialize;

use crate::machine;

/// The axis that is drawn if it is run; else the first is.
const DRAWN: &str = "joints";

/// What was found: `garnet.stress/1`, SI units but for the levels, whose unit each axis names.
#[derive(Debug, Serialize)]
pub(super) struct StressReport<'a> {
    schema: &'static str,
    version: &'static str,
    machine: String,
    garment: &'a str,
    is_quick: bool,
    seed: u64,
    axes: &'a [&'static Axis],
    /// How many of ours break at their bar or before.
    pub(super) failures: usize,
    pub(super) holds: &'a [Hold],
    cells: &'a [Cell],
}

impl<'a> StressReport<'a> {
    pub(super) fn new(
        garment: &'a str,
        options: &'a StressOptions,
        holds: &'a [Hold],
        cells: &'a [Cell],
    ) -> Self {
        Self {
            schema: "garnet.stress/1",
            version: env!("CARGO_PKG_VERSION"),
            machine: machine::description(),
            garment,
            is_quick: options.is_quick,
            seed: options.seed,
            axes: &options.axes,
            failures: holds.iter().filter(|hold| hold.fails).count(),
            holds,
            cells,
        }
    }
}

/// The table as Markdown: a row an axis, a column a method; `again` is the command that shows a
/// cell again, but for its axis and method.
pub(super) fn table(report: &StressReport<'_>, options: &StressOptions, again: &str) -> String {
    let methods: Vec<String> = options.methods.iter().map(ToString::to_string).collect();
    let mut text = format!(
        "`{}`, {}. A cell is the level up to which a method holds, and what breaks at the next.\n\n",
        report.garment, report.machine
    );
    let _ = writeln!(text, "| axis | bar | {} |", methods.join(" | "));
    let _ = writeln!(text, "|---|---|{}", "---|".repeat(methods.len()));
    for axis in report.axes {
        let check = if axis.is_sanity_check {
            " [^check]"
        } else {
            ""
        };
        let _ = write!(
            text,
            "| `{}`: {}{check} | {} {} |",
            axis.name, axis.title, axis.bar, axis.unit
        );
        for method in &methods {
            let hold = report.holds.iter();
            let hold = hold
                .filter(|hold| hold.axis == axis.name)
                .find(|hold| hold.method == *method);
            let _ = write!(
                text,
                " {} |",
                hold.map_or_else(
                    || "-".to_owned(),
                    |hold| cell(hold, axis.bar, report.is_quick)
                )
            );
        }
        text.push('\n');
    }
    text += "\nBold: one of ours that breaks at its bar or before. `-`: the method drapes the garment of \
             the package alone, or there is no such body. Falls back: the network is not trusted from \
             that level on, which the report of a drape tells.\n";
    if report.axes.iter().any(|axis| axis.is_sanity_check) {
        text += "\n[^check]: A sanity check: simple methods hold, too.\n";
    }
    let failing: Vec<&Hold> = report.holds.iter().filter(|hold| hold.fails).collect();
    if !failing.is_empty() {
        text += "\nFailures of ours:\n\n";
        for hold in failing {
            if let Some((level, broken)) = &hold.broke {
                let _ = writeln!(
                    text,
                    "- {}, `{}` at {level}: {broken}. `{again} --axis {}`",
                    hold.method, hold.axis, hold.axis
                );
            }
        }
    }
    text
}

fn cell(hold: &Hold, bar: f64, is_quick: bool) -> String {
    let held = hold
        .held
        .map_or_else(|| "none".to_owned(), |level| level.to_string());
    match &hold.broke {
        None if !is_quick && hold.held.is_some_and(|held| held < bar) => held + ", no body beyond",
        None => held,
        Some((_, broken)) if hold.fails => format!("**{held}: {broken}**"),
        Some((_, broken)) => format!("{held}: {broken}"),
    }
}

/// How deep cloth is inside the body along one axis; none if nothing is known of that.
pub(super) fn picture(report: &StressReport<'_>, options: &StressOptions) -> Option<Chart> {
    let drawn = report.axes.iter().find(|axis| axis.name == DRAWN);
    let axis = drawn.or_else(|| report.axes.first())?;
    let series = options.methods.iter().map(|method| {
        let name = method.to_string();
        let cells = report.cells.iter();
        let cells = cells.filter(|cell| cell.axis == axis.name && cell.method == name);
        let points = cells.filter_map(|cell| {
            let deepest = cell.measured.as_ref()?.deepest;
            Some([cell.level, 1e3 * f64::from(deepest)])
        });
        Series {
            points: points.collect(),
            name,
        }
    });
    let series: Vec<Series> = series.filter(|series| !series.points.is_empty()).collect();
    let axes = [
        ChartAxis::linear(&format!("{}, {}", axis.title, axis.unit)),
        ChartAxis::linear("deepest free vertex inside the body, mm"),
    ];
    let title = format!("{}: where each way to drape breaks", report.garment);
    (!series.is_empty()).then(|| Chart::of_series(&title, axes, &series))
}
