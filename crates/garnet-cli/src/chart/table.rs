//! The ways to drape as a table for the terminal.

use std::fmt::Write as _;

use super::report::{ChartReport, MethodReport};

/// Heads of the columns.
const HEADS: [&str; 13] = [
    "ms",
    "p95",
    "E_dist mm",
    "± mm",
    "median",
    "E_norm °",
    "L_RQ",
    "inside %",
    "strain p99 %",
    "GFLOP",
    "weights MB",
    "memory MB",
    "scenes",
];

/// The table, and what is below it.
pub(super) fn text(report: &ChartReport) -> String {
    let mut text = format!(
        "`{}`, {} vertices: single scenes of `{}`, {}, {} threads, {}",
        report.garment,
        report.vertices,
        report.split,
        report.protocol.title(),
        report.threads,
        report.machine
    );
    let names = report
        .methods
        .iter()
        .map(|method| method.name.chars().count());
    let width = names.max().unwrap_or(0) + 2;
    let rows: Vec<[String; 13]> = report.methods.iter().map(fields).collect();
    let widths: Vec<usize> = (0..HEADS.len())
        .map(|column| {
            let fields = rows.iter().map(|row| row[column].chars().count());
            fields.max().unwrap_or(0).max(HEADS[column].chars().count())
        })
        .collect();
    let _ = write!(text, "\n{:width$}", "");
    for (head, width) in HEADS.iter().zip(&widths) {
        let _ = write!(text, "  {head:>width$}");
    }
    for (method, row) in report.methods.iter().zip(&rows) {
        let star = if method.is_on_front { "*" } else { "" };
        let _ = write!(text, "\n{:width$}", format!("{}{star}", method.name));
        for (field, width) in row.iter().zip(&widths) {
            let _ = write!(text, "  {field:>width$}");
        }
    }
    text += "\n* no other is better in time and distance; distances and strain are those of the untangled drape, \
             `inside` is before untangling";
    if let Some(noise) = report.noise_floor_m {
        let _ = write!(text, "\nnoise floor of the teacher: {:.2} mm", 1e3 * noise);
        if let Some(scenes) = report.noise_scenes {
            let _ = write!(text, ", the mean of {scenes} scenes");
        }
    }
    for peer in &report.peers {
        let _ = write!(text, "\n{}", peer.told());
    }
    let failed = report.methods.iter().filter(|method| method.failed > 0);
    for method in failed {
        let _ = write!(
            text,
            "\n{}: {} scenes came to no end",
            method.name, method.failed
        );
    }
    text
}

fn fields(method: &MethodReport) -> [String; 13] {
    let figures = &method.figures;
    let after = &figures.after;
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
    let of_target = |text: String| {
        if method.is_target {
            "-".to_owned()
        } else {
            text
        }
    };
    let megabytes = |bytes: Option<u64>, digits: usize| {
        or_dash(bytes.map(|bytes| format!("{:.digits$}", bytes as f64 / 1e6)))
    };
    let milliseconds = |seconds: f64| format!("{:.1}", 1e3 * seconds);
    [
        milliseconds(figures.seconds.total.median),
        milliseconds(figures.seconds.total.p95),
        of_target(format!("{:.2}", 1e3 * after.distance)),
        of_target(format!("{:.2}", 1e3 * after.distance_std)),
        of_target(format!("{:.2}", 1e3 * figures.scene_distance.median)),
        of_target(format!("{:.2}", after.normal.to_degrees())),
        of_target(format!("{:.1e}", after.rayleigh)),
        format!("{:.2}", 1e2 * figures.before.inside),
        format!("{:.1}", 1e2 * (after.stretch_p99 - 1.0)),
        or_dash(method.flop.map(|flop| format!("{:.2}", flop as f64 / 1e9))),
        megabytes(method.weight_bytes, 2),
        megabytes(method.peak_bytes, 0),
        figures.scenes.to_string(),
    ]
}
