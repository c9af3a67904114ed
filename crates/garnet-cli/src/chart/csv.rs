//! The numbers as CSV; units are in the heads.

use std::fmt::Write as _;

use super::report::{ChartReport, MethodReport};

type Column = (&'static str, fn(&MethodReport) -> Option<f64>);

/// The columns after name and kind.
const COLUMNS: [Column; 33] = [
    ("on_front", |m| Some(f64::from(u8::from(m.is_on_front)))),
    ("is_target", |m| Some(f64::from(u8::from(m.is_target)))),
    ("scenes", |m| Some(m.figures.scenes as f64)),
    ("failed", |m| Some(m.failed as f64)),
    ("threads", |m| Some(m.threads as f64)),
    ("ms", |m| Some(1e3 * m.figures.seconds.total.median)),
    ("ms_p95", |m| Some(1e3 * m.figures.seconds.total.p95)),
    ("warp_ms", |m| Some(1e3 * m.figures.seconds.warp.median)),
    ("warp_ms_p95", |m| Some(1e3 * m.figures.seconds.warp.p95)),
    ("network_ms", |m| {
        Some(1e3 * m.figures.seconds.network.median)
    }),
    ("network_ms_p95", |m| {
        Some(1e3 * m.figures.seconds.network.p95)
    }),
    ("untangle_ms", |m| {
        Some(1e3 * m.figures.seconds.untangle.median)
    }),
    ("untangle_ms_p95", |m| {
        Some(1e3 * m.figures.seconds.untangle.p95)
    }),
    ("simulation_ms", |m| {
        Some(1e3 * m.figures.seconds.simulation.median)
    }),
    ("simulation_ms_p95", |m| {
        Some(1e3 * m.figures.seconds.simulation.p95)
    }),
    ("e_dist_mm", |m| Some(1e3 * m.figures.after.distance)),
    ("e_dist_std_mm", |m| {
        Some(1e3 * m.figures.after.distance_std)
    }),
    ("e_dist_scene_median_mm", |m| {
        Some(1e3 * m.figures.scene_distance.median)
    }),
    ("e_dist_scene_p95_mm", |m| {
        Some(1e3 * m.figures.scene_distance.p95)
    }),
    ("e_dist_before_untangle_mm", |m| {
        Some(1e3 * m.figures.before.distance)
    }),
    ("e_norm_deg", |m| Some(m.figures.after.normal.to_degrees())),
    ("l_mc", |m| Some(m.figures.after.mean_curvature)),
    ("l_rq", |m| Some(m.figures.after.rayleigh)),
    ("inside_before_untangle_percent", |m| {
        Some(1e2 * m.figures.before.inside)
    }),
    ("deepest_before_untangle_mm", |m| {
        Some(1e3 * m.figures.before.deepest)
    }),
    ("untrapped_inside", |m| Some(m.figures.left.inside as f64)),
    ("crossing_faces", |m| {
        m.figures.left.crossing_faces.map(|count| count as f64)
    }),
    ("strain_p99_percent", |m| {
        Some(1e2 * (m.figures.after.stretch_p99 - 1.0))
    }),
    ("strain_max_percent", |m| {
        Some(1e2 * (m.figures.after.stretch_max - 1.0))
    }),
    ("self_intersections", |m| {
        Some(m.figures.after.self_intersections)
    }),
    ("gflop", |m| m.flop.map(|flop| flop as f64 / 1e9)),
    ("weight_bytes", |m| m.weight_bytes.map(|bytes| bytes as f64)),
    ("peak_memory_bytes", |m| {
        m.peak_bytes.map(|bytes| bytes as f64)
    }),
];

/// One line a way to drape; what is not known is empty.
pub(super) fn methods(report: &ChartReport) -> String {
    let mut text = String::from("method,kind");
    for (head, _) in COLUMNS {
        let _ = write!(text, ",{head}");
    }
    text.push('\n');
    for method in &report.methods {
        let kind = format!("{:?}", method.kind).to_lowercase();
        let _ = write!(text, "{},{kind}", method.name);
        for (_, value) in COLUMNS {
            let value = value(method).map_or_else(String::new, short);
            let _ = write!(text, ",{value}");
        }
        text.push('\n');
    }
    text
}

/// Six digits that count, without zeros at the end.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    format!("{rounded}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_keep_what_counts() {
        assert_eq!(short(12.345_678_9), "12.3457");
        assert_eq!(short(0.000_433_419_7), "0.00043342");
        assert_eq!(short(2.0), "2");
    }
}
