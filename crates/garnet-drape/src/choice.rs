//! The choice of a variant by what it costs and how far from the teacher it is.

use std::cmp::Ordering;
use std::path::Path;
use std::time::Instant;

use garnet_net::ModelHeader;
use garnet_sim::Moment;
use rayon::prelude::*;

use crate::{Manifest, Variant};

/// What a variant has to keep within.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// Time of a drape, in seconds: the most accurate variant within it is chosen.
    Seconds(f64),
    /// Mean distance to the teacher, in metres: the cheapest variant within it is chosen.
    Distance(f64),
}

/// What is asked of a choice.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ChoiceOptions {
    /// What the variant has to keep within.
    pub limit: Limit,
    /// With so many frames all variants are relaxed for as many, with 0 none is; `None` leaves that
    /// to the choice.
    pub relax_frames: Option<u32>,
    /// How far the pose is from the middle of the package's poses, in radians: the farthest of
    /// several. `None` takes the mean over all scenes of the test.
    pub far: Option<f64>,
}

impl ChoiceOptions {
    /// Nothing but a limit.
    pub const fn new(limit: Limit) -> Self {
        Self {
            limit,
            relax_frames: None,
            far: None,
        }
    }
}

/// A variant, relaxed or not, that may be chosen.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Candidate {
    /// The name of the variant.
    pub variant: String,
    /// Whether the cloth is relaxed from where the variant predicts it.
    pub is_relaxed: bool,
    /// The moment at which the variant predicts the cloth.
    pub moment: Moment,
    /// For how many frames of a sixtieth of a second the cloth is simulated, the motion included.
    pub frames: u32,
    /// Mean distance to the teacher on the test split of its training, in metres.
    pub distance_error: Option<f64>,
    /// What nine of ten drapes keep within where the pose is as far from the middle as was asked,
    /// in metres; `None` if that is not known.
    pub bound: Option<f64>,
    /// Operations of the network.
    pub flop: Option<f64>,
    /// About how long a drape takes here, in seconds: what the package says, times how much slower
    /// this machine is than the one that made it; `None` if the package does not say.
    pub seconds: Option<f64>,
}

/// Which variant was chosen, and among which.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Choice {
    /// What it has to keep within.
    pub limit: Limit,
    /// Its place among the candidates; `None` if the garment is warped.
    pub chosen: Option<usize>,
    /// Whether what was chosen keeps within the limit.
    pub is_met: bool,
    /// About how long a warp with untangling takes here, in seconds, if the package says.
    pub warp_seconds: Option<f64>,
    /// All candidates: by accuracy for a limit of time, by cost for one of distance.
    pub candidates: Vec<Candidate>,
}

impl Choice {
    /// Chooses among the variants of the package in `folder`.
    pub fn new(folder: &Path, manifest: &Manifest, options: &ChoiceOptions) -> Self {
        let ChoiceOptions {
            limit,
            relax_frames,
            far,
        } = *options;
        let factor = match (limit, manifest.cost) {
            (Limit::Seconds(_), Some(cost)) => Some(calibration() / cost.calibration),
            _ => None,
        };
        let ways: &[bool] = match relax_frames {
            None => &[false, true],
            Some(0) => &[false],
            Some(_) => &[true],
        };
        let of_variant = |variant: &Variant| {
            // What cannot be read is told of when it is loaded.
            let header = ModelHeader::read(folder.join(&variant.weights));
            let moment = header.map_or(Moment::Rest, |header| header.moment);
            let of = move |&is_relaxed: &bool| {
                let found = Candidate::of(variant, moment, is_relaxed, relax_frames, factor);
                found.expecting(variant, relax_frames, far)
            };
            ways.iter().map(of).collect::<Vec<_>>()
        };
        let candidates = manifest.variants.iter().flat_map(of_variant);
        let candidates = candidates.filter(|candidate| candidate.is_drape(relax_frames));
        let candidates = candidates.collect();
        let cost = manifest.cost.zip(factor);
        let warp_seconds = cost.map(|(cost, factor)| factor * cost.warp);
        match limit {
            Limit::Seconds(budget) => Self::by_budget(candidates, budget, warp_seconds),
            Limit::Distance(tolerance) => Self::by_tolerance(candidates, tolerance),
        }
    }

    /// The variant that was chosen; `None` if the garment is warped.
    pub fn candidate(&self) -> Option<&Candidate> {
        self.candidates.get(self.chosen?)
    }

    fn by_budget(mut candidates: Vec<Candidate>, budget: f64, warp_seconds: Option<f64>) -> Self {
        candidates.sort_by(|a, b| ascending(a.distance_error, b.distance_error));
        let is_within =
            |candidate: &Candidate| candidate.seconds.is_some_and(|seconds| seconds <= budget);
        let chosen = candidates.iter().position(is_within);
        let is_warp_within = warp_seconds.is_some_and(|seconds| seconds <= budget);
        Self {
            limit: Limit::Seconds(budget),
            is_met: chosen.is_some() || is_warp_within,
            chosen,
            warp_seconds,
            candidates,
        }
    }

    fn by_tolerance(mut candidates: Vec<Candidate>, tolerance: f64) -> Self {
        // Simulation costs more than any network.
        candidates.sort_by(|a, b| (a.frames.cmp(&b.frames)).then(ascending(a.flop, b.flop)));
        // A mean is less than what nine of ten keep within: the two are not compared.
        let knows_bounds = candidates.iter().any(|found| found.bound.is_some());
        let known = |found: &Candidate| {
            if knows_bounds {
                found.bound
            } else {
                found.distance_error
            }
        };
        let error = |found: &Candidate| known(found).unwrap_or(f64::INFINITY);
        let within = candidates
            .iter()
            .position(|found| error(found) <= tolerance);
        let measured = (candidates.iter().enumerate()).filter(|(_, found)| known(found).is_some());
        let best = measured.min_by(|(_, a), (_, b)| ascending(known(a), known(b)));
        Self {
            limit: Limit::Distance(tolerance),
            is_met: within.is_some(),
            chosen: within.or(best.map(|(place, _)| place)),
            warp_seconds: None,
            candidates,
        }
    }
}

impl Candidate {
    fn of(
        variant: &Variant,
        moment: Moment,
        is_relaxed: bool,
        relax_frames: Option<u32>,
        factor: Option<f64>,
    ) -> Self {
        let own = variant.settle_frames.unwrap_or(moment.settle_frames());
        let motion = moment.motion_frames();
        let frames = |settle: u32| if is_relaxed { motion + settle } else { 0 };
        let (measured, frames) = (frames(own), frames(relax_frames.unwrap_or(own)));
        // Nearly all of a relaxed drape is simulation.
        let share = f64::from(frames.max(1)) / f64::from(measured.max(1));
        let (distance_error, seconds) = if is_relaxed {
            (variant.settled_error, variant.settled_seconds)
        } else {
            (variant.distance_error, variant.seconds)
        };
        Self {
            variant: variant.name.clone(),
            is_relaxed,
            moment,
            frames,
            distance_error,
            bound: None,
            flop: variant.flop,
            seconds: seconds
                .zip(factor)
                .map(|(seconds, factor)| seconds * share * factor),
        }
    }

    /// The same with what is expected of the variant so far from the middle of the poses. That is
    /// known of the way alone in which the variant drapes unless told otherwise.
    fn expecting(self, variant: &Variant, relax_frames: Option<u32>, far: Option<f64>) -> Self {
        let is_usual =
            relax_frames.is_none() && variant.settling(self.moment).takes_time() == self.is_relaxed;
        let expected = variant.expected.filter(|_| is_usual).zip(far);
        Self {
            bound: expected.map(|(expected, far)| expected.bound(far)),
            ..self
        }
    }

    /// Whether it leaves the cloth where it could be worn: before it rests it has to be relaxed,
    /// unless the user says for how long, and on the way it is not on the body.
    fn is_drape(&self, relax_frames: Option<u32>) -> bool {
        match self.moment {
            Moment::Rest => true,
            Moment::Arrival | Moment::Falling => self.is_relaxed || relax_frames.is_some(),
            Moment::Start | Moment::Midway => self.is_relaxed,
        }
    }
}

/// What is not known comes last.
fn ascending(a: Option<f64>, b: Option<f64>) -> Ordering {
    let last = |value: Option<f64>| value.unwrap_or(f64::INFINITY);
    last(a).total_cmp(&last(b))
}

/// Points of the chain that [`calibration`] relaxes: more take longer and are measured more
/// exactly.
const CHAIN: usize = 20_000;

/// How often it is relaxed; the least time counts.
const ROUNDS: usize = 5;

/// How long a small piece of work takes here that is alike to a drape, in seconds: springs that are
/// relaxed, half of them by one thread and half by all that there are. It takes a few milliseconds.
pub fn calibration() -> f64 {
    let round = || {
        let start = Instant::now();
        let alone = relaxed_chain(CHAIN);
        let parts = (0..8_usize)
            .into_par_iter()
            .map(|_| relaxed_chain(CHAIN / 8));
        let together: f32 = parts.sum();
        std::hint::black_box(alone + together);
        start.elapsed().as_secs_f64()
    };
    (0..ROUNDS).map(|_| round()).fold(f64::INFINITY, f64::min)
}

/// The length of a chain of springs after a few sweeps over it.
fn relaxed_chain(num_points: usize) -> f32 {
    let place = |point: usize| {
        let turn = point as f32 * 0.7;
        [turn.sin(), turn.cos(), point as f32 * 0.01]
    };
    let mut points: Vec<[f32; 3]> = (0..num_points).map(place).collect();
    let mut length = 0.0;
    for _ in 0..4 {
        length = 0.0;
        for second in 1..points.len() {
            let (a, b) = (points[second - 1], points[second]);
            let between: [f32; 3] = std::array::from_fn(|axis| b[axis] - a[axis]);
            let norm = between.iter().map(|part| part * part).sum::<f32>().sqrt();
            let share = 0.25 * (norm - 0.5) / norm.max(1e-6);
            for axis in 0..3 {
                points[second - 1][axis] += share * between[axis];
                points[second][axis] -= share * between[axis];
            }
            length += norm;
        }
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(variant: &str, error: Option<f64>, seconds: Option<f64>) -> Candidate {
        Candidate {
            variant: variant.to_owned(),
            is_relaxed: false,
            moment: Moment::Rest,
            frames: 0,
            distance_error: error,
            bound: None,
            flop: seconds,
            seconds,
        }
    }

    fn all() -> Vec<Candidate> {
        vec![
            candidate("fast", Some(0.005), Some(0.02)),
            candidate("accurate", Some(0.002), Some(0.3)),
            candidate("unknown", None, Some(0.01)),
            candidate("unmeasured", Some(0.001), None),
        ]
    }

    #[test]
    fn the_most_accurate_variant_within_a_budget_is_chosen() {
        let chosen = |budget| {
            let choice = Choice::by_budget(all(), budget, Some(0.015));
            (
                choice.is_met,
                choice.candidate().map(|found| found.variant.clone()),
            )
        };
        assert_eq!(chosen(1.0), (true, Some("accurate".to_owned())));
        assert_eq!(chosen(0.1), (true, Some("fast".to_owned())));
        // Of which no accuracy is known, comes last.
        assert_eq!(chosen(0.018), (true, Some("unknown".to_owned())));
        assert_eq!(chosen(0.005), (false, None));
    }

    #[test]
    fn the_cheapest_variant_within_a_tolerance_is_chosen() {
        let chosen = |tolerance| {
            let choice = Choice::by_tolerance(all(), tolerance);
            (
                choice.is_met,
                choice.candidate().map(|found| found.variant.clone()),
            )
        };
        assert_eq!(chosen(0.006), (true, Some("fast".to_owned())));
        assert_eq!(chosen(0.003), (true, Some("accurate".to_owned())));
        assert_eq!(chosen(0.0001), (false, Some("unmeasured".to_owned())));
    }

    #[test]
    fn a_pose_far_from_the_middle_asks_for_a_better_variant() {
        let chosen = |fast: f64, accurate| {
            let mut all = all();
            (all[0].bound, all[1].bound) = (Some(fast), accurate);
            let choice = Choice::by_tolerance(all, 0.006);
            let name = choice.candidate().map(|found| found.variant.clone());
            (choice.is_met, name.unwrap())
        };
        assert_eq!(chosen(0.0055, Some(0.003)), (true, "fast".to_owned()));
        assert_eq!(chosen(0.007, Some(0.003)), (true, "accurate".to_owned()));
        assert_eq!(chosen(0.009, Some(0.008)), (false, "accurate".to_owned()));
        // Of `accurate` the mean alone is known, which is not what was asked for.
        assert_eq!(chosen(0.007, None), (false, "fast".to_owned()));
    }

    #[test]
    fn a_calibration_takes_milliseconds() {
        let seconds = calibration();
        assert!(seconds > 1e-6 && seconds < 1.0, "{seconds}");
    }
}
