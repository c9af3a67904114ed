//! Scores of ways to drape, as `garnet eval` and `garnet chart` report them.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Deserialize;

use super::{HeadArguments, markdown::Grid};

/// `garnet.eval/1`, as far as the table needs it.
#[derive(Debug, Deserialize)]
pub(super) struct Eval {
    #[serde(flatten)]
    pub(super) setting: Setting,
    pub(super) methods: Vec<EvalMethod>,
}

/// `garnet.chart/1`, as far as the table needs it.
#[derive(Debug, Deserialize)]
pub(super) struct Chart {
    #[serde(flatten)]
    setting: Setting,
    noise_floor_m: Option<f64>,
    methods: Vec<ChartMethod>,
}

/// What was measured on what.
#[derive(Debug, Deserialize)]
pub(super) struct Setting {
    pub(super) garment: String,
    pub(super) vertices: usize,
    dataset: String,
    split: String,
    /// What is new in the scenes; files of earlier versions have none.
    pub(super) protocol: Option<String>,
    pub(super) scenes: usize,
    threads: usize,
    /// Early reports of `eval` do not tell it.
    machine: Option<String>,
}

#[derive(Debug, Deserialize)]
pub(super) struct EvalMethod {
    pub(super) name: String,
    pub(super) scores: Scores,
    pub(super) untangled: Option<Untangled>,
    /// By stage.
    pub(super) seconds: BTreeMap<String, Times>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Untangled {
    pub(super) scores: Scores,
    #[serde(flatten)]
    left: Left,
}

#[derive(Debug, Deserialize)]
struct ChartMethod {
    name: String,
    is_target: bool,
    is_on_front: bool,
    scenes: usize,
    seconds: Total,
    after: Scores,
    #[serde(flatten)]
    left: Left,
}

#[derive(Debug, Deserialize)]
struct Total {
    total: Times,
}

/// Seconds; not finite ones are none.
#[derive(Debug, Deserialize)]
pub(super) struct Times {
    pub(super) median: Option<f64>,
    p95: Option<f64>,
}

/// Scores in SI units; those that are no numbers are none.
#[derive(Debug, Clone, Copy, Deserialize)]
pub(super) struct Scores {
    pub(super) distance: Option<f64>,
    distance_std: Option<f64>,
    pub(super) normal: Option<f64>,
    pub(super) mean_curvature: Option<f64>,
    pub(super) rayleigh: Option<f64>,
    pub(super) inside: Option<f64>,
    self_intersections: Option<f64>,
    stretch_p99: Option<f64>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
struct Left {
    inside: usize,
    crossing_faces: Option<usize>,
}

/// The columns of scores.
const COLUMNS: [&str; 10] = [
    "E_dist mm",
    "± mm",
    "E_norm °",
    "L_MC",
    "L_RQ",
    "inside %",
    "free inside",
    "free crossing faces",
    "strain p99 %",
    "self-intersections",
];

/// Ways to drape as they are and untangled.
pub(super) fn of_eval(report: &Eval, head: &HeadArguments) -> String {
    let mut grid = Grid::new(&[&["method"], &COLUMNS[..], &["ms"]].concat());
    for method in &report.methods {
        let medians = |is_asked: fn(&str) -> bool| -> Option<f64> {
            let stages = method.seconds.iter();
            stages
                .filter(|(name, _)| is_asked(name))
                .map(|(_, times)| times.median)
                .sum()
        };
        let before = medians(|stage| stage != "untangle");
        let mut row = vec![method.name.clone()];
        row.extend(fields(&method.scores, None, true));
        row.push(in_milli(before, 1));
        grid.push(row);
        if let Some(untangled) = &method.untangled {
            let mut row = vec![format!("{} untangled", method.name)];
            row.extend(fields(&untangled.scores, Some(untangled.left), true));
            row.push(in_milli(medians(|_| true), 1));
            grid.push(row);
        }
    }
    head.text(&report.setting.facts()) + &grid.text()
}

/// Ways to drape as they are used, those that no other beats with a star.
pub(super) fn of_chart(report: &Chart, head: &HeadArguments) -> String {
    let mut grid = Grid::new(&[&["method"], &COLUMNS[..], &["ms", "p95", "scenes"]].concat());
    for method in &report.methods {
        let star = if method.is_on_front { "*" } else { "" };
        let mut row = vec![format!("{}{star}", method.name)];
        row.extend(fields(&method.after, Some(method.left), !method.is_target));
        row.push(in_milli(method.seconds.total.median, 1));
        row.push(in_milli(method.seconds.total.p95, 1));
        row.push(method.scenes.to_string());
        grid.push(row);
    }
    let mut text = head.text(&report.setting.facts()) + &grid.text();
    text += "\n\\* no other is faster and nearer.";
    if let Some(noise) = report.noise_floor_m {
        let noise = 1e3 * noise;
        write!(text, " Noise floor of the teacher: {noise:.2} mm.").expect("a string takes all");
    }
    text.push('\n');
    text
}

impl Setting {
    fn facts(&self) -> [String; 5] {
        [
            format!("`{}`, {} vertices", self.garment, self.vertices),
            format!("{} scenes of `{}`", self.scenes, self.dataset),
            match &self.protocol {
                Some(protocol) => format!("split `{}`, {}", self.split, protocol.replace('-', " ")),
                None => format!("split `{}`", self.split),
            },
            format!("{} threads", self.threads),
            self.machine.clone().unwrap_or_default(),
        ]
    }
}

/// The columns of scores; what made the targets has no distance from them.
fn fields(scores: &Scores, left: Option<Left>, is_compared: bool) -> [String; 10] {
    let text = |value: Option<f64>, digits: usize| {
        value.map_or_else(nothing, |value| format!("{value:.digits$}"))
    };
    let compared = |text: String| if is_compared { text } else { nothing() };
    let count = |count: Option<usize>| count.map_or_else(nothing, |count| count.to_string());
    [
        compared(in_milli(scores.distance, 2)),
        compared(in_milli(scores.distance_std, 2)),
        compared(text(scores.normal.map(f64::to_degrees), 2)),
        compared(text(scores.mean_curvature, 3)),
        compared((scores.rayleigh).map_or_else(nothing, |value| format!("{value:.2e}"))),
        text(scores.inside.map(|share| 1e2 * share), 2),
        count(left.map(|left| left.inside)),
        count(left.and_then(|left| left.crossing_faces)),
        text(scores.stretch_p99.map(|stretch| 1e2 * (stretch - 1.0)), 1),
        text(scores.self_intersections, 1),
    ]
}

fn in_milli(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(nothing, |value| format!("{:.digits$}", 1e3 * value))
}

fn nothing() -> String {
    "-".to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCORES: &str = r#"{"scenes": 4, "distance": 0.00512, "distance_std": 0.002, "normal": 0.1,
        "mean_curvature": 1.5, "rayleigh": null, "inside": 0.01, "self_intersections": 3.0,
        "stretch_p99": 1.05}"#;

    fn head() -> HeadArguments {
        HeadArguments {
            commit: Some("abc".to_owned()),
        }
    }

    fn setting(machine: &str) -> String {
        format!(
            r#""schema": "of no matter", "garment": "tee", "vertices": 100, "dataset": "data",
            "split": "test", "protocol": "seen-poses", "scenes": 4, "threads": 2 {machine}"#
        )
    }

    #[test]
    fn an_evaluation_has_two_lines_a_method() {
        let text = format!(
            r#"{{{}, "methods": [{{"name": "warp", "scores": {SCORES},
            "untangled": {{"scores": {SCORES}, "inside": 0, "trapped": 1, "crossing_faces": 2}},
            "seconds": {{"warp": {{"median": 0.001, "p95": 0.002}},
                "untangle": {{"median": 0.01, "p95": null}}}}}}]}}"#,
            setting("")
        );
        let table = of_eval(&serde_json::from_str(&text).unwrap(), &head());
        let lines: Vec<&str> = table.lines().collect();
        let expected = "`tee`, 100 vertices; 4 scenes of `data`; split `test`, seen poses; 2 threads; commit abc.";
        assert_eq!(lines[0], expected);
        assert_eq!(lines.len(), 6, "{table}");
        assert!(lines[4].starts_with("| warp ") && lines[4].ends_with(" 1.0 |"));
        let untangled: Vec<&str> = lines[5].split('|').map(str::trim).collect();
        assert_eq!(untangled[1..4], ["warp untangled", "5.12", "2.00"]);
        assert_eq!(untangled[7..11], ["1.00", "0", "2", "5.0"]);
        assert_eq!(untangled[12], "11.0");
    }

    #[test]
    fn what_made_the_targets_has_no_distance() {
        let text = format!(
            r#"{{{}, "noise_floor_m": 0.0005, "methods": [{{"name": "simulation teacher",
            "is_target": true, "is_on_front": true, "scenes": 2,
            "seconds": {{"total": {{"median": 1.25, "p95": 1.5}}}},
            "after": {SCORES}, "inside": 0, "crossing_faces": null}}]}}"#,
            setting(r#", "machine": "a processor""#)
        );
        let table = of_chart(&serde_json::from_str(&text).unwrap(), &head());
        assert!(table.contains("a processor; commit abc."), "{table}");
        let row = table
            .lines()
            .find(|line| line.contains("teacher*"))
            .unwrap();
        let fields: Vec<&str> = row.split('|').map(str::trim).collect();
        assert_eq!(fields[2], "-");
        assert_eq!(fields[12..15], ["1250.0", "1500.0", "2"]);
        assert!(table.contains("0.50 mm"), "{table}");
    }
}
