//! The choice of a network by what it costs and how far from the teacher it is.

use std::cmp::Ordering;

use garnet::{
    Draper,
    data::{GarmentPackage, Put, Settling, Variant},
    train::{chart::header_of, put_of},
};
use serde::Serialize;

use super::{
    Bound, Way,
    args::{Job, Limit, NetworkChoice, Source},
    drape_timed,
    learned::{Found, Learned},
    settled::Settler,
};
use crate::{console::Console, failure::refused};

/// A network is timed this often, after once to warm up; the least time counts.
const TRIALS: u32 = 3;

/// How a network was chosen. SI units.
#[derive(Debug, Serialize)]
pub(crate) struct ChoiceReport {
    /// `budget_s` or `tolerance_m`.
    by: &'static str,
    /// Seconds or metres.
    limit: f64,
    /// Whether the cloth settles by simulation where it is put.
    settles: bool,
    /// Whether what was chosen is within the limit.
    pub(crate) is_met: bool,
    /// The network; none if the garment is warped.
    chosen: Option<String>,
    /// What was looked at, in this order.
    candidates: Vec<CandidateReport>,
    /// What people are told.
    #[serde(skip)]
    pub(crate) text: String,
}

/// What is known of a network.
#[derive(Debug, Clone, Serialize)]
struct CandidateReport {
    variant: String,
    /// Whether the cloth settles by simulation where the network has put it.
    settles: bool,
    /// For how many frames of a sixtieth of a second, if it does.
    #[serde(skip)]
    settle_frames: u32,
    /// For how many such frames the body moves before, if it does.
    #[serde(skip)]
    motion_frames: u32,
    /// Mean distance to the teacher on the test scenes of its training.
    error_m: Option<f64>,
    flop: Option<f64>,
    /// Warp, network, settling and untangling on the first body; none if it was not timed.
    seconds: Option<f64>,
}

impl CandidateReport {
    fn of(variant: &Variant, put: Put, settles: bool) -> Self {
        Self {
            motion_frames: if settles { put.motion_frames() } else { 0 },
            variant: variant.name.clone(),
            settles,
            settle_frames: match variant.settle_frames {
                _ if !settles => 0,
                Some(frames) => frames,
                None => put.frames(),
            },
            error_m: if settles {
                variant.settled_error
            } else {
                variant.distance_error
            },
            flop: variant.flop,
            seconds: None,
        }
    }
}

impl ChoiceReport {
    /// Whether the cloth settles.
    pub(super) fn settles(&self) -> bool {
        self.settles
    }
}

/// Finds the cheapest network within a tolerance, or the most accurate one within a budget of time.
pub(super) fn choose(
    bound: &Bound,
    job: &Job,
    limit: Limit,
    console: &Console,
) -> anyhow::Result<(Found, ChoiceReport)> {
    let folder = match &job.source {
        Source::Files(files) => files.package.as_deref(),
        Source::Scene(_) => None,
    };
    let Some(folder) = folder else {
        return Err(refused(
            "there are no networks to choose from",
            "the garment is no garment package, which trained networks are in",
            "drape a package, or leave out `--budget` and `--tolerance`",
        ));
    };
    let variants = GarmentPackage::read_manifest(folder)?.variants;
    // With `--settle`, all settle, or none does.
    let ways = match job.settle {
        None => vec![false, true],
        Some(frames) => vec![frames > 0],
    };
    let both = variants.iter().flat_map(|variant| {
        // What cannot be read is told of when it is loaded.
        let header = header_of(&folder.join(&variant.weights));
        let put = header.map_or(Put::AtRest, |header| put_of(header.aim));
        let of = move |&settles: &bool| CandidateReport::of(variant, put, settles);
        ways.iter().map(of)
    });
    let mut candidates: Vec<CandidateReport> = both.collect();
    match limit {
        Limit::Distance(tolerance) => by_tolerance(bound, job, candidates, tolerance),
        Limit::Seconds(budget) => {
            candidates.sort_by(|a, b| ascending(a.error_m, b.error_m));
            by_budget(bound, job, candidates, budget, console)
        }
    }
}

/// What is not known comes last.
fn ascending(a: Option<f64>, b: Option<f64>) -> Ordering {
    let last = |value: Option<f64>| value.unwrap_or(f64::INFINITY);
    last(a).total_cmp(&last(b))
}

fn by_tolerance(
    bound: &Bound,
    job: &Job,
    mut candidates: Vec<CandidateReport>,
    tolerance: f64,
) -> anyhow::Result<(Found, ChoiceReport)> {
    // Simulation costs more than any network.
    let frames = |candidate: &CandidateReport| candidate.settle_frames + candidate.motion_frames;
    candidates.sort_by(|a, b| (frames(a).cmp(&frames(b))).then(ascending(a.flop, b.flop)));
    let error = |candidate: &&CandidateReport| candidate.error_m.unwrap_or(f64::INFINITY);
    let within = candidates.iter().find(|found| error(found) <= tolerance);
    let measured = candidates.iter().filter(|found| found.error_m.is_some());
    let best = measured.min_by(|a, b| ascending(a.error_m, b.error_m));
    let text = match (within, best) {
        (Some(found), _) => format!(
            "{} is chosen, the cheapest network within {} mm: {}",
            named(found),
            shown(tolerance),
            described(found)
        ),
        (None, Some(best)) => format!(
            "no network of the package is within {} mm; {} comes nearest: {}",
            shown(tolerance),
            named(best),
            described(best)
        ),
        (None, None) => format!(
            "no network of the package is known to be within {} mm: the garment is warped and \
             untangled",
            shown(tolerance)
        ),
    };
    let settles = within.or(best).is_some_and(|found| found.settles);
    let chosen = within.or(best).map(|found| found.variant.clone());
    let found = match &chosen {
        Some(name) => Learned::find(bound, &NetworkChoice::Named(name.clone()), &job.source)?,
        None => Found::NotAsked,
    };
    let report = ChoiceReport {
        by: "tolerance_m",
        limit: tolerance,
        settles,
        is_met: within.is_some(),
        chosen,
        candidates,
        text,
    };
    Ok((found, report))
}

/// Times networks, the most accurate one first, until one is fast enough.
fn by_budget(
    bound: &Bound,
    job: &Job,
    mut candidates: Vec<CandidateReport>,
    budget: f64,
    console: &Console,
) -> anyhow::Result<(Found, ChoiceReport)> {
    let mut way = Way {
        draper: Draper::with_options(job.options),
        learned: None,
        settler: None,
    };
    let of_warp = Settling::of(Put::AtRest);
    // What cannot settle is told of when it is draped.
    let mut settler = Settler::find(bound, job, of_warp).ok().flatten();
    let mut found = Found::NotAsked;
    let mut is_met = false;
    for candidate in &mut candidates {
        let named = NetworkChoice::Named(candidate.variant.clone());
        if let Found::Network(learned) = Learned::find(bound, &named, &job.source)? {
            way.learned = Some(*learned);
        }
        let settling = (way.learned.as_ref()).map_or(of_warp, Learned::settling);
        // What arrives is no drape before it has settled, and what is midway is not on the body.
        let is_drape = match settling.put {
            Put::AtRest => true,
            Put::AtArrival | Put::Falling => candidate.settles || job.settle.is_some(),
            Put::Midway | Put::OnRestBody => candidate.settles,
        };
        if !is_drape {
            continue;
        }
        let taken = settler.take_if(|_| candidate.settles);
        way.settler = taken.map(|settler| settler.of(settling, job));
        let seconds = seconds_of(bound, &mut way, console, budget)?;
        settler = settler.or(way.settler.take());
        candidate.seconds = Some(seconds);
        if seconds <= budget {
            is_met = true;
            found = (way.learned.take()).map_or(found, |learned| Found::Network(Box::new(learned)));
            break;
        }
    }
    let chosen = candidates
        .iter()
        .find(|candidate| is_met && candidate.seconds.is_some_and(|seconds| seconds <= budget));
    let text = if let Some(chosen) = chosen {
        format!(
            "{} is chosen, the most accurate network within {} ms: {}",
            named(chosen),
            shown(budget),
            described(chosen)
        )
    } else {
        way.learned = None;
        let seconds = seconds_of(bound, &mut way, console, budget)?;
        is_met = seconds <= budget;
        format!(
            "no network of the package is within {} ms: the garment is warped and untangled, {:.1} ms",
            shown(budget),
            1e3 * seconds
        )
    };
    let report = ChoiceReport {
        by: "budget_s",
        limit: budget,
        settles: chosen.is_some_and(|chosen| chosen.settles),
        is_met,
        chosen: chosen.map(|chosen| chosen.variant.clone()),
        candidates,
        text,
    };
    Ok((found, report))
}

/// What takes so many times the budget to warm up is not within it later.
const HOPELESS: f64 = 4.0;

/// The least time of some drapes on the first body: warp, network, settling and untangling. What is
/// far beyond the budget is draped once.
fn seconds_of(bound: &Bound, way: &mut Way, console: &Console, budget: f64) -> anyhow::Result<f64> {
    let Some(target) = bound.targets.first() else {
        return Ok(0.0);
    };
    let mut least = f64::INFINITY;
    for trial in 0..=TRIALS {
        let seconds = drape_timed(bound, way, target, console)?.time.of_drape();
        if trial > 0 || seconds > HOPELESS * budget {
            least = least.min(seconds);
        }
        if seconds > HOPELESS * budget {
            break;
        }
    }
    Ok(least)
}

/// A limit in thousandths, as the user gave it.
fn shown(limit: f64) -> f32 {
    (1e3 * limit) as f32
}

fn named(candidate: &CandidateReport) -> String {
    let settled = if candidate.settles { " settled" } else { "" };
    format!("`{}`{settled}", candidate.variant)
}

fn described(candidate: &CandidateReport) -> String {
    let mut parts = Vec::new();
    if let Some(error) = candidate.error_m {
        parts.push(format!("{:.2} mm from the teacher", 1e3 * error));
    }
    if let Some(seconds) = candidate.seconds {
        parts.push(format!("{:.1} ms on the first body", 1e3 * seconds));
    }
    if let Some(flop) = candidate.flop {
        parts.push(format!("{:.2} GFLOP", flop / 1e9));
    }
    parts.join(", ")
}
