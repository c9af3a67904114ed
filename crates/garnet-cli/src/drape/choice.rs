//! The choice of a network by what it costs and how far from the teacher it is.

use std::cmp::Ordering;

use garnet::{
    Draper, Moment,
    package::{GarmentPackage, Settling, Variant},
    train::chart::header_of,
};
use serde::Serialize;

use super::{
    Bound, Way,
    args::{Job, Limit, NetworkChoice, Source},
    drape_timed,
    learned::{Found, Learned},
    report::DrapeSeconds,
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
    /// The moment at which it predicts the cloth.
    #[serde(skip)]
    moment: Moment,
    /// For how many frames of a sixtieth of a second the cloth settles, if it does.
    #[serde(skip)]
    settle_frames: u32,
    /// For how many such frames the body moves before, if it does.
    #[serde(skip)]
    motion_frames: u32,
    /// Mean distance to the teacher on the test scenes of its training.
    error_m: Option<f64>,
    flop: Option<f64>,
    /// Warp, network, settling and untangling on the first body, without warming up where that takes more than four times
    /// the budget; none if it was not timed, since a more accurate one is within the budget or this one cannot be.
    seconds: Option<f64>,
}

impl CandidateReport {
    fn of(variant: &Variant, moment: Moment, settles: bool) -> Self {
        Self {
            moment,
            motion_frames: if settles { moment.motion_frames() } else { 0 },
            variant: variant.name.clone(),
            settles,
            settle_frames: match variant.settle_frames {
                _ if !settles => 0,
                Some(frames) => frames,
                None => moment.settle_frames(),
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

    /// For how many frames of a sixtieth of a second is simulated.
    fn frames(&self) -> u32 {
        self.settle_frames + self.motion_frames
    }

    /// Whether it leaves the cloth where it could be worn: what arrives is no drape before it has settled, and what is midway is not
    /// on the body.
    fn is_drape(&self, job: &Job) -> bool {
        match self.moment {
            Moment::Rest => true,
            Moment::Arrival | Moment::Falling => self.settles || job.settle.is_some(),
            Moment::Start | Moment::Midway => self.settles,
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
        let moment = header.map_or(Moment::Rest, |header| header.moment);
        let of = move |&settles: &bool| CandidateReport::of(variant, moment, settles);
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
    candidates.sort_by(|a, b| (a.frames().cmp(&b.frames())).then(ascending(a.flop, b.flop)));
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

/// Finds the most accurate network that is fast enough, unless the warp alone is far too slow.
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
    // The first drape warms up, whatever it takes: this time is told if there is no other.
    let of_warp = fastest(bound, &mut way, budget, 2, console)?.of_drape();
    let pace = Pace::new(of_warp);
    let picked = if pace.of_warp() <= budget {
        first_within(bound, job, &mut candidates, budget, (way, pace), console)?
    } else {
        None
    };
    let (chosen, found) = match picked {
        Some((place, learned)) => (candidates.get(place), Found::Network(Box::new(learned))),
        None => (None, Found::NotAsked),
    };
    let text = match chosen {
        Some(chosen) => text_within(chosen, budget),
        None => format!(
            "no network of the package is within {} ms: the garment is warped and untangled, {:.1} ms",
            shown(budget),
            1e3 * of_warp
        ),
    };
    let report = ChoiceReport {
        by: "budget_s",
        limit: budget,
        settles: chosen.is_some_and(|chosen| chosen.settles),
        is_met: chosen.is_some() || of_warp <= budget,
        chosen: chosen.map(|chosen| chosen.variant.clone()),
        candidates,
        text,
    };
    Ok((found, report))
}

/// What people are told of a network within a budget.
fn text_within(chosen: &CandidateReport, budget: f64) -> String {
    let (named, described, limit) = (named(chosen), described(chosen), shown(budget));
    if chosen.error_m.is_some() {
        return format!(
            "{named} is chosen, the most accurate network within {limit} ms: {described}"
        );
    }
    // Those of which it is known come before.
    format!(
        "{named} is chosen, the first network within {limit} ms, of which no accuracy is known: {described}"
    )
}

/// Times networks, the most accurate ones first, until one is fast enough; tells its place among the candidates. Those that
/// cannot be are left out.
fn first_within(
    bound: &Bound,
    job: &Job,
    candidates: &mut [CandidateReport],
    budget: f64,
    (mut way, mut pace): (Way, Pace),
    console: &Console,
) -> anyhow::Result<Option<(usize, Learned)>> {
    let of_warp = Settling::of(Moment::Rest);
    // What cannot settle is told of when it is draped.
    let mut settler = Settler::find(bound, job, of_warp).ok().flatten();
    for (place, candidate) in candidates.iter_mut().enumerate() {
        if !candidate.is_drape(job) || pace.least_of(candidate) > budget {
            continue;
        }
        let is_read = (way.learned.as_ref()).is_some_and(|read| read.name() == candidate.variant);
        if !is_read {
            let named = NetworkChoice::Named(candidate.variant.clone());
            way.learned = match Learned::find(bound, &named, &job.source)? {
                Found::Network(learned) => Some(*learned),
                Found::NotAsked | Found::NoneInPackage => continue,
            };
        }
        let settling = (way.learned.as_ref()).map_or(of_warp, Learned::settling);
        let taken = settler.take_if(|_| candidate.settles);
        way.settler = taken.map(|settler| settler.of(settling, job));
        let time = fastest(bound, &mut way, budget, 1, console)?;
        settler = settler.or(way.settler.take());
        candidate.seconds = Some(time.of_drape());
        if time.of_drape() <= budget {
            return Ok(way.learned.map(|learned| (place, learned)));
        }
        pace.learn(candidate, &time);
    }
    Ok(None)
}

/// Of what others have taken a candidate takes this share at least: frames are not all of one length, and untangling has
/// less to do where a network has put the cloth.
const SURE: f64 = 0.5;

/// How long the parts of a drape take here, as far as it has been seen. Seconds.
#[derive(Debug, Clone)]
struct Pace {
    /// Warp and untangling.
    warp: f64,
    /// A frame of settling, the least of those that were timed.
    frame: Option<f64>,
    /// Operations of networks and the time of each: what has more of them does not take less.
    networks: Vec<(f64, f64)>,
}

impl Pace {
    /// Of which only warp and untangling were timed.
    fn new(warp: f64) -> Self {
        Self {
            warp,
            frame: None,
            networks: Vec::new(),
        }
    }

    /// What warp and untangling take at least.
    fn of_warp(&self) -> f64 {
        SURE * self.warp
    }

    /// What a candidate takes at least.
    fn least_of(&self, candidate: &CandidateReport) -> f64 {
        let settle = f64::from(candidate.frames()) * self.frame.unwrap_or(0.0);
        let flop = candidate.flop.unwrap_or(0.0);
        let smaller = self.networks.iter().filter(|(other, _)| *other <= flop);
        let network = smaller.map(|&(_, seconds)| seconds).fold(0.0, f64::max);
        self.of_warp() + SURE * (settle + network)
    }

    fn learn(&mut self, candidate: &CandidateReport, time: &DrapeSeconds) {
        let frames = f64::from(candidate.frames());
        if frames > 0.0 && time.settle > 0.0 {
            let frame = time.settle / frames;
            self.frame = Some(self.frame.map_or(frame, |least| least.min(frame)));
        }
        if let Some(flop) = candidate.flop {
            self.networks.push((flop, time.network));
        }
    }
}

/// What takes so many times the budget is not within it when it is warm.
const HOPELESS: f64 = 4.0;

/// The fastest of some drapes on the first body. The first one warms up; of what is far beyond the budget there are no more than
/// `least`, and a single one counts.
fn fastest(
    bound: &Bound,
    way: &mut Way,
    budget: f64,
    least: u32,
    console: &Console,
) -> anyhow::Result<DrapeSeconds> {
    let Some(target) = bound.targets.first() else {
        return Ok(DrapeSeconds::default());
    };
    let mut fastest: Option<DrapeSeconds> = None;
    for trial in 0..=TRIALS {
        let time = drape_timed(bound, way, target, console)?.time;
        let is_hopeless = trial + 1 >= least && time.of_drape() > HOPELESS * budget;
        let is_best = fastest.is_none_or(|other| time.of_drape() < other.of_drape());
        if is_best && (trial > 0 || is_hopeless) {
            fastest = Some(time);
        }
        if is_hopeless {
            break;
        }
    }
    Ok(fastest.unwrap_or_default())
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

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(frames: u32, flop: Option<f64>) -> CandidateReport {
        CandidateReport {
            variant: "local".to_owned(),
            settles: frames > 0,
            moment: Moment::Rest,
            settle_frames: frames,
            motion_frames: 0,
            error_m: None,
            flop,
            seconds: Some(0.02),
        }
    }

    #[test]
    fn what_costs_more_than_what_is_too_slow_takes_no_less() {
        let mut pace = Pace::new(0.01);
        assert!(pace.least_of(&candidate(46, Some(1e9))) <= 0.01);
        let time = DrapeSeconds {
            settle: 0.3,
            network: 0.02,
            ..DrapeSeconds::default()
        };
        pace.learn(&candidate(30, Some(1e8)), &time);
        assert!(pace.least_of(&candidate(46, None)) > 0.2);
        // Few frames may take longer each, and a smaller network any time.
        assert!(pace.least_of(&candidate(6, Some(1e7))) < 0.06);
        let smaller = pace.least_of(&candidate(0, Some(1e7)));
        let larger = pace.least_of(&candidate(0, Some(1e9)));
        assert!(smaller < 0.01 && larger > smaller, "{smaller} {larger}");
    }

    #[test]
    fn a_network_of_unknown_accuracy_is_not_called_accurate() {
        let unknown = candidate(0, None);
        let text = text_within(&unknown, 0.5);
        assert!(text.contains("no accuracy is known"), "{text}");
        let known = CandidateReport {
            error_m: Some(0.004),
            ..unknown
        };
        let text = text_within(&known, 0.5);
        assert!(
            text.contains("the most accurate network within 500 ms"),
            "{text}"
        );
    }
}
