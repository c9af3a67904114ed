//! The choice of a variant by what it costs and how far from the simulation it is, in reports.

use garnet::package::{Candidate, Choice, Limit};
use serde::Serialize;

/// Whether a garment is cut as the errors of its package are known for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum KnownCut {
    Own,
    Other,
}

/// How a variant was chosen. SI units.
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
    /// The variant; none if the garment is warped.
    chosen: Option<String>,
    /// What was looked at, in this order.
    candidates: Vec<CandidateReport>,
    /// What people are told.
    #[serde(skip)]
    pub(crate) text: String,
}

/// What is known of a variant.
#[derive(Debug, Clone, Serialize)]
struct CandidateReport {
    variant: String,
    /// Whether the cloth settles by simulation where the variant has put it.
    settles: bool,
    /// Mean distance to the teacher on the test scenes of its training.
    error_m: Option<f64>,
    /// What nine of ten of its drapes in such poses keep within; none if the package does not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    bound_m: Option<f64>,
    flop: Option<f64>,
    /// About how long a drape takes here; none if the package does not say, or if accuracy was
    /// asked for.
    seconds: Option<f64>,
}

impl From<&Candidate> for CandidateReport {
    fn from(candidate: &Candidate) -> Self {
        Self {
            variant: candidate.variant.clone(),
            settles: candidate.is_relaxed,
            error_m: candidate.distance_error,
            bound_m: candidate.bound,
            flop: candidate.flop,
            seconds: candidate.seconds,
        }
    }
}

impl ChoiceReport {
    pub(super) fn new(choice: &Choice, cut: KnownCut) -> Self {
        let chosen = choice.candidate();
        let (by, limit, text) = match choice.limit {
            Limit::Seconds(budget) => ("budget_s", budget, text_within(choice, budget, cut)),
            Limit::Distance(tolerance) => ("tolerance_m", tolerance, text_near(choice, tolerance)),
        };
        Self {
            by,
            limit,
            settles: chosen.is_some_and(|chosen| chosen.is_relaxed),
            is_met: choice.is_met,
            chosen: chosen.map(|chosen| chosen.variant.clone()),
            candidates: choice
                .candidates
                .iter()
                .map(CandidateReport::from)
                .collect(),
            text,
        }
    }
}

/// What people are told of a variant within a tolerance.
fn text_near(choice: &Choice, tolerance: f64) -> String {
    let limit = shown(tolerance);
    let Some(found) = choice.candidate() else {
        return format!(
            "no variant of the package is known to be within {limit} mm: the garment is warped and \
             untangled"
        );
    };
    let (named, described) = (named(found), described(found, KnownCut::Own));
    if choice.is_met {
        format!("{named} is chosen, the cheapest variant within {limit} mm: {described}")
    } else {
        format!(
            "no variant of the package is within {limit} mm; {named} comes nearest: {described}"
        )
    }
}

/// What people are told of a variant within a budget.
fn text_within(choice: &Choice, budget: f64, cut: KnownCut) -> String {
    let limit = shown(budget);
    let Some(chosen) = choice.candidate() else {
        let known = choice
            .candidates
            .iter()
            .any(|found| found.seconds.is_some());
        let about = match choice.warp_seconds {
            Some(seconds) => format!(", about {:.1} ms", 1e3 * seconds),
            None if known => String::new(),
            None => "; the package does not say what its variants cost".to_owned(),
        };
        return format!(
            "no variant of the package is within {limit} ms: the garment is warped and untangled{about}"
        );
    };
    let (named, described) = (named(chosen), described(chosen, cut));
    if chosen.distance_error.is_some() {
        return format!(
            "{named} is chosen, the most accurate variant within {limit} ms: {described}"
        );
    }
    // Those of which it is known come before.
    format!(
        "{named} is chosen, the first variant within {limit} ms, of which no accuracy is known: {described}"
    )
}

/// A limit in thousandths, as the user gave it.
fn shown(limit: f64) -> f32 {
    (1e3 * limit) as f32
}

fn named(candidate: &Candidate) -> String {
    let settled = if candidate.is_relaxed { " settled" } else { "" };
    format!("`{}`{settled}", candidate.variant)
}

fn described(candidate: &Candidate, cut: KnownCut) -> String {
    let cut = match cut {
        KnownCut::Own => "",
        KnownCut::Other => " in the package's own cut",
    };
    let mut parts = Vec::new();
    if let Some(bound) = candidate.bound {
        parts.push(format!(
            "nine of ten scenes in such poses were within {:.2} mm of the simulation",
            1e3 * bound
        ));
    } else if let Some(error) = candidate.distance_error {
        parts.push(format!("{:.2} mm from the simulation{cut}", 1e3 * error));
    }
    if let Some(seconds) = candidate.seconds {
        parts.push(format!("about {:.1} ms here", 1e3 * seconds));
    }
    if let Some(flop) = candidate.flop {
        parts.push(format!("{:.2} GFLOP", flop / 1e9));
    }
    parts.join(", ")
}
