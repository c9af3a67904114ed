//! Both charts as pictures.

use garnet_view::{Entry, Key, Level, Line, LogLog, Mark, Rgb, Shape, Stroke, Symbol, safe};

use super::{
    growth::{GrowthReport, Series},
    methods::Kind,
    report::{ChartReport, MethodReport},
};

const FRONT: Stroke = Stroke {
    color: Rgb::new(48, 50, 56),
    is_dashed: false,
};

const FLOOR: Stroke = Stroke {
    color: Rgb::new(110, 112, 118),
    is_dashed: true,
};

/// Time against distance.
pub(super) fn chart(report: &ChartReport) -> LogLog {
    let point = |method: &MethodReport| method.point(report.noise_floor_m).map(in_milli);
    let shown = report.methods.iter();
    let shown: Vec<(&MethodReport, [f64; 2])> = shown
        .filter_map(|method| Some((method, point(method)?)))
        .collect();
    let mut front: Vec<[f64; 2]> = (shown.iter())
        .filter(|(method, _)| method.is_on_front)
        .map(|&(_, point)| point)
        .collect();
    front.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let noise = report.noise_floor_m.map(|noise| Level {
        y: 1e3 * noise,
        name: format!("noise floor of the teacher, {:.2} mm", 1e3 * noise),
        stroke: FLOOR,
    });
    LogLog {
        title: format!(
            "{}: time and distance of every way to drape",
            report.garment
        ),
        subtitle: subtitle(report),
        x: "time of one drape, median, ms".to_owned(),
        y: "E_dist, mean distance from the teacher, mm".to_owned(),
        marks: shown.iter().map(|&(method, at)| mark(method, at)).collect(),
        lines: vec![Line {
            points: front,
            stroke: FRONT,
        }],
        levels: noise.into_iter().collect(),
        legend: legend(report),
    }
}

fn subtitle(report: &ChartReport) -> String {
    let simulated = match report.simulated_scenes {
        0 => String::new(),
        count => format!(", {count} simulated"),
    };
    format!(
        "{} vertices, {} test scenes{simulated}; {} threads; {}",
        report.vertices,
        report.scenes,
        report.threads,
        processor(&report.machine)
    )
}

/// The processor without what its maker adds.
fn processor(machine: &str) -> String {
    let name = machine.rsplit_once(',').map_or(machine, |(name, _)| name);
    name.replace("(R)", "").replace("(TM)", "")
}

/// Networks end up next to each other once their cloth settles: names of all would hide the rest.
fn is_nameless(method: &MethodReport) -> bool {
    method.kind == Kind::Network && !method.is_on_front && method.settle_frames > 0
}

fn mark(method: &MethodReport, at: [f64; 2]) -> Mark {
    Mark {
        at,
        reach: Some(1e3 * method.figures.seconds.total.p95),
        name: if is_nameless(method) {
            String::new()
        } else {
            method.name.clone()
        },
        is_strong: method.is_on_front,
        symbol: symbol(method.kind, method.is_on_front),
    }
}

fn symbol(kind: Kind, is_filled: bool) -> Symbol {
    let (shape, color) = match kind {
        Kind::Geometry => (Shape::Square, safe::BLUE),
        Kind::Network => (Shape::Circle, safe::VERMILLION),
        Kind::Simulation => (Shape::Triangle, safe::GREEN),
    };
    Symbol {
        shape,
        color,
        is_filled,
    }
}

fn legend(report: &ChartReport) -> Vec<Entry> {
    let entry = |key, text: &str| Entry {
        key,
        text: text.to_owned(),
    };
    let has = |kind| report.methods.iter().any(|method| method.kind == kind);
    let mut entries = Vec::new();
    for (kind, text) in [
        (Kind::Geometry, "geometry alone, untangled"),
        (Kind::Network, "learned, untangled"),
        (Kind::Simulation, "simulation"),
    ] {
        if has(kind) {
            entries.push(entry(Key::Mark(symbol(kind, true)), text));
        }
    }
    entries.push(entry(
        Key::Line(FRONT),
        "Pareto front (filled): no other is faster and nearer",
    ));
    if report.methods.iter().any(is_nameless) {
        let hollow = Key::Mark(symbol(Kind::Network, false));
        entries.push(entry(hollow, "without a name: other networks, settled"));
    }
    entries.push(entry(Key::Reach, "to the 95th percentile"));
    if let Some(target) = report.methods.iter().find(|method| method.is_target)
        && report.noise_floor_m.is_some()
    {
        let text = format!(
            "{} made the targets: its distance is the noise floor",
            target.name
        );
        entries.push(entry(Key::Line(FLOOR), &text));
    }
    entries
}

/// Colors and shapes of the series of the second chart, in order.
const LOOKS: [(Shape, Rgb); 6] = [
    (Shape::Square, safe::BLUE),
    (Shape::Diamond, safe::ORANGE),
    (Shape::Circle, safe::VERMILLION),
    (Shape::Circle, safe::PURPLE),
    (Shape::Triangle, safe::GREEN),
    (Shape::Diamond, safe::SKY),
];

/// Time against vertices.
pub(super) fn growth(report: &ChartReport, growth: &GrowthReport) -> LogLog {
    let mut chart = LogLog {
        title: format!("{}: what a drape costs with more vertices", report.garment),
        subtitle: format!(
            "medians of {} test bodies; {} threads; {}; networks with random weights",
            growth.scenes,
            report.threads,
            processor(&report.machine)
        ),
        x: "vertices of the garment".to_owned(),
        y: "time of one drape, ms".to_owned(),
        marks: Vec::new(),
        lines: Vec::new(),
        levels: Vec::new(),
        legend: Vec::new(),
    };
    for (number, series) in growth.series.iter().enumerate() {
        let (shape, color) = match series.name.as_str() {
            "simulation" => LOOKS[4],
            "settle" => LOOKS[5],
            _ => LOOKS[number % LOOKS.len()],
        };
        let symbol = Symbol {
            shape,
            color,
            is_filled: true,
        };
        chart
            .marks
            .extend(series.points.iter().map(|&[vertices, seconds]| Mark {
                at: [vertices, 1e3 * seconds],
                reach: None,
                name: String::new(),
                is_strong: false,
                symbol,
            }));
        chart.lines.extend(fitted(series, color));
        let law = series.law.map(|law| format!(" ∝ n^{:.2}", law.exponent));
        chart.legend.push(Entry {
            key: Key::Mark(symbol),
            text: format!("{}{}", series.name, law.unwrap_or_default()),
        });
    }
    let is_continued = |series: &Series| {
        let first = series.points.first();
        first.is_some_and(|point| point[0] < series.fitted_from)
    };
    let text = if growth.series.iter().any(is_continued) {
        "least squares from 5 000 vertices on (dashed: continued)"
    } else {
        "least squares"
    };
    chart.legend.push(Entry {
        key: Key::Line(FRONT),
        text: text.to_owned(),
    });
    chart
}

/// The law of a series: whole where it is fitted, broken below.
fn fitted(series: &Series, color: Rgb) -> Vec<Line> {
    let (Some(law), Some(first), Some(last)) =
        (series.law, series.points.first(), series.points.last())
    else {
        return Vec::new();
    };
    let at = |vertices: f64| [vertices, 1e3 * law.at(vertices)];
    let line = |from: f64, to: f64, is_dashed| Line {
        points: vec![at(from), at(to)],
        stroke: Stroke { color, is_dashed },
    };
    vec![
        line(first[0], series.fitted_from, true),
        line(series.fitted_from, last[0], false),
    ]
}

fn in_milli(point: [f64; 2]) -> [f64; 2] {
    point.map(|value| 1e3 * value)
}
