//! Which drapes are good enough to learn from.

use std::fmt;

use garnet_sim::{DrapeReport, reference::Balance};
use serde::{Deserialize, Serialize};

/// What the simulation of a scene measured at its end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct SceneReport {
    /// Strain of the edges: length over rest length minus 1, at the median.
    pub strain_p50: f32,
    /// Strain that 1 % of the edges exceed.
    pub strain_p99: f32,
    /// The largest strain.
    pub strain_max: f32,
    /// Share of the vertices faster than 5 mm/s.
    pub moving: f32,
    /// Vertices inside the body that the simulator has [lost](garnet_sim::Lost): not those that it
    /// caught.
    pub inside: u32,
    /// The deepest of them, in metres.
    pub deepest: f32,
    /// Pairs of triangles of the garment that cross.
    pub self_intersections: u32,
    /// Such pairs where the body has no room for two layers of cloth, apart from those.
    #[serde(rename = "trapped_intersections")]
    pub squeezed_intersections: u32,
    /// How the reference solver brought the garment into balance, if it did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub balance: Option<BalanceReport>,
}

/// How the reference solver ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct BalanceReport {
    /// Whether no vertex is out of balance by a hundredth of a mean vertex's weight.
    pub is_reached: bool,
    /// The largest force left over on a free vertex, over the mean weight of a vertex.
    pub residual: f64,
    /// The root of the mean square of the same.
    pub rms_residual: f64,
    /// Steps that it took.
    pub steps: usize,
    /// Newton iterations, each with one factorisation.
    pub iterations: usize,
    /// Vertices that were held where they lay: caught between two parts of the body, or in a
    /// crease.
    pub held: usize,
    /// How far vertices moved from where the production solver had left them, in the mean, in
    /// metres.
    pub moved: f64,
}

/// Above these values a scene is not learned from.
///
/// They are for drapes that went wrong. Cloth that fits is strained by poses, too: over raised arms
/// and bent knees the way along the skin grows by more than the garment has ease, and the default
/// limit of strain leaves such drapes in. Cloth that is caught or far too small is beyond it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Vertices inside the body that the simulator has [lost](garnet_sim::Lost).
    pub inside: u32,
    /// Strain that 1 % of the edges exceed.
    pub strain_p99: f32,
    /// Share of the vertices faster than 5 mm/s.
    pub moving: f32,
    /// Pairs of triangles of the garment that cross.
    pub self_intersections: u32,
    /// Such pairs where the body has no room for two layers of cloth.
    #[serde(rename = "trapped_intersections")]
    pub squeezed_intersections: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            inside: 0,
            strain_p99: 0.25,
            moving: 0.015,
            self_intersections: 20,
            squeezed_intersections: 100,
        }
    }
}

impl From<&DrapeReport> for SceneReport {
    fn from(report: &DrapeReport) -> Self {
        Self {
            strain_p50: report.strain.p50,
            strain_p99: report.strain.p99,
            strain_max: report.strain.max,
            moving: report.speeds.share_moving,
            inside: report.lost.num as u32,
            deepest: report.lost.deepest,
            self_intersections: report.self_intersections.num_free as u32,
            squeezed_intersections: report.self_intersections.num_squeezed as u32,
            balance: report.balance.as_ref().map(BalanceReport::from),
        }
    }
}

impl From<&Balance> for BalanceReport {
    fn from(balance: &Balance) -> Self {
        let settled = &balance.settled;
        Self {
            is_reached: settled.is_settled,
            residual: settled.residual,
            rms_residual: settled.rms_residual,
            steps: settled.steps,
            iterations: settled.iterations,
            held: balance.held,
            moved: balance.moved,
        }
    }
}

impl fmt::Display for Limits {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Self::NONE {
            return formatter.write_str("that no scene exceeds");
        }
        write!(
            formatter,
            "of {} vertices inside, {} % strain, {} % moving, {} and {} pairs",
            self.inside,
            100.0 * self.strain_p99,
            100.0 * self.moving,
            self.self_intersections,
            self.squeezed_intersections
        )
    }
}

impl Limits {
    /// Limits that no scene exceeds.
    pub const NONE: Self = Self {
        inside: u32::MAX,
        strain_p99: f32::MAX,
        moving: f32::MAX,
        self_intersections: u32::MAX,
        squeezed_intersections: u32::MAX,
    };

    /// The same for cloth that has not settled: it moves, and folds that press on each other have
    /// not slid yet.
    #[must_use]
    pub const fn of_arrivals(self) -> Self {
        Self {
            strain_p99: self.strain_p99,
            ..Self::NONE
        }
    }

    /// The first limit that a scene exceeds: a short name, and what was measured.
    pub fn violation(&self, report: &SceneReport) -> Option<(&'static str, String)> {
        if report.inside > self.inside {
            let (inside, deepest) = (report.inside, 1e3 * report.deepest);
            let reason = format!("{inside} vertices inside the body, up to {deepest:.1} mm");
            return Some(("penetration", reason));
        }
        let is_beyond = |value: f32, limit: f32| value.is_nan() || value > limit;
        if is_beyond(report.strain_p99, self.strain_p99) {
            let reason = format!(
                "1 % of the edges are longer than at rest by more than {:.1} %",
                100.0 * report.strain_p99
            );
            return Some(("strain", reason));
        }
        if report.self_intersections > self.self_intersections {
            let reason = format!("{} pairs of triangles cross", report.self_intersections);
            return Some(("self-intersection", reason));
        }
        if report.squeezed_intersections > self.squeezed_intersections {
            let pairs = report.squeezed_intersections;
            let reason = format!("{pairs} pairs of triangles cross where the body has no room");
            return Some(("trapped self-intersection", reason));
        }
        if is_beyond(report.moving, self.moving) {
            let share = 100.0 * report.moving;
            let reason = format!("{share:.1} % of the vertices are faster than 5 mm/s");
            return Some(("unsettled", reason));
        }
        None
    }
}
