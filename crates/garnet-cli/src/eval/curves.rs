//! Average precision curves as CSV and pictures.

use std::{fmt::Write as _, path::Path};

use garnet::train::{Curve, Evaluation, Row};
use garnet_view::{Axis, Chart, Series};

use crate::output;

/// What is written.
pub(super) const FILES: [&str; 3] = ["ap.csv", "ap-distance.svg", "ap-normal.svg"];

/// Writes `ap.csv`, `ap-distance.svg` and `ap-normal.svg`.
pub(super) fn write(folder: &Path, found: &Evaluation) -> anyhow::Result<()> {
    let mut text = String::from("curve,threshold");
    for row in &found.rows {
        let _ = write!(text, ",{}", row.name);
    }
    text.push('\n');
    lines(
        &mut text,
        "distance_cm",
        found,
        |row| &row.curves.distance,
        100.0,
    );
    lines(
        &mut text,
        "normal_deg",
        found,
        |row| &row.curves.normal,
        1_f64.to_degrees(),
    );
    output::write(&folder.join("ap.csv"), text.as_bytes())?;

    let distances = chart(
        "distance of vertices, cm",
        found,
        |row| &row.curves.distance,
        100.0,
    );
    output::write(
        &folder.join("ap-distance.svg"),
        distances.to_svg()?.as_bytes(),
    )?;
    let unit = 1_f64.to_degrees();
    let angles = chart(
        "angle of normals, degrees",
        found,
        |row| &row.curves.normal,
        unit,
    );
    output::write(&folder.join("ap-normal.svg"), angles.to_svg()?.as_bytes())
}

fn lines(text: &mut String, name: &str, found: &Evaluation, curve: fn(&Row) -> &Curve, unit: f64) {
    let Some(first) = found.rows.first() else {
        return;
    };
    for (step, threshold) in curve(first).thresholds.iter().enumerate() {
        let _ = write!(text, "{name},{:.3}", unit * threshold);
        for row in &found.rows {
            let _ = write!(text, ",{:.5}", curve(row).shares[step]);
        }
        text.push('\n');
    }
}

fn chart(label: &str, found: &Evaluation, curve: fn(&Row) -> &Curve, unit: f64) -> Chart {
    let points = |curve: &Curve| {
        let pairs = curve.thresholds.iter().zip(&curve.shares);
        pairs
            .map(|(threshold, share)| [unit * threshold, 100.0 * share])
            .collect()
    };
    let series = found.rows.iter().map(|row| Series {
        name: row.name.clone(),
        points: points(curve(row)),
    });
    let title = format!(
        "share under a threshold, {} scenes of `{}`",
        found.scenes,
        found.split.name()
    );
    let series: Vec<Series> = series.collect();
    Chart::of_series(&title, [Axis::linear(label), Axis::linear("%")], &series)
}
