//! The chart as a picture.

use garnet_view::{Axis, Chart, Entry, Key, Level, Line, Mark, Rgb, Shape, Stroke, Symbol, safe};

use super::{
    methods::Kind,
    peers::Peer,
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
pub(super) fn chart(report: &ChartReport) -> Chart {
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
    Chart {
        title: format!(
            "{}: time and distance of every way to drape",
            report.garment
        ),
        subtitle: subtitle(report),
        x: Axis::logarithmic("time of one drape, median, ms"),
        y: Axis::logarithmic("E_dist, mean distance from the teacher, mm"),
        marks: (shown.iter().map(|&(method, at)| mark(method, at)))
            .chain(report.peers.iter().map(mark_of_peer))
            .collect(),
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

const PEER: Symbol = Symbol {
    shape: Shape::Diamond,
    color: safe::PURPLE,
    is_filled: false,
};

fn mark_of_peer(peer: &Peer) -> Mark {
    Mark {
        at: in_milli([peer.seconds, peer.distance_m]),
        reach: None,
        name: peer.name.clone(),
        is_strong: false,
        symbol: PEER,
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
    if let Some(peer) = report.peers.first() {
        let text = format!("other programs until the cloth rests, pose `{}`", peer.pose);
        entries.push(entry(Key::Mark(PEER), &text));
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

fn in_milli(point: [f64; 2]) -> [f64; 2] {
    point.map(|value| 1e3 * value)
}
