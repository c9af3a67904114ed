//! Skinning, warp and networks, timed on single scenes.

use garnet_data::Split;
use garnet_mesh::Point3;
use garnet_untangle::UntangleOptions;
use serde::{Deserialize, Serialize};

use super::sample::{Sample, Seconds};
use crate::bound_candidate::BoundCandidate;
use crate::measure::Measure;
use crate::{
    Candidate, Finish, PenetrationCount, SceneName, Stage, StagedScene, Tally, TrainError,
};

/// A candidate and the scenes that it is to be measured on.
#[derive(Debug, Clone, PartialEq)]
pub struct Task {
    /// The way to drape.
    pub candidate: Candidate,
    /// The scenes.
    pub scenes: Vec<SceneName>,
}

/// What a network takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct NetworkCost {
    /// Weights.
    pub parameters: u64,
    /// Multiplications and additions of a forward pass.
    pub flops: u64,
    /// Memory that it keeps between scenes, in bytes.
    pub scratch: usize,
}

/// How drapes are timed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// How they are untangled.
    pub untangle: UntangleOptions,
    /// How often each scene is draped; its time is the median.
    pub repeats: usize,
}

/// Drapes scenes of a split one by one and gives each sample to `take`, with the number of its
/// task. Returns what the networks take, one a task.
///
/// All candidates drape a scene before the next one comes, so that a machine with other work treats
/// them alike. Each drapes it once more before, unmeasured: what it needs is then where the
/// processor finds it, as in drapes one after another, and not where the candidate before has
/// driven it.
///
/// # Errors
///
/// As [`crate::evaluate`].
pub fn time_drapes(
    stage: &Stage,
    split: Split,
    tasks: &[Task],
    timing: Timing,
    take: &mut dyn FnMut(usize, Sample),
) -> Result<Vec<Option<NetworkCost>>, TrainError> {
    let bound = tasks
        .iter()
        .map(|task| BoundCandidate::new(stage, &task.candidate));
    let mut bound: Vec<BoundCandidate<'_>> = bound.collect::<Result<_, _>>()?;
    let measure = Measure::new(stage)?;
    let is_wanted = |scene| tasks.iter().any(|task| task.scenes.contains(&scene));
    stage.for_each_of(split, is_wanted, Ok, &mut |staged: StagedScene| {
        let wanted = bound.iter_mut().enumerate();
        let wanted = wanted.filter(|(task, _)| tasks[*task].scenes.contains(&staged.name));
        for (task, candidate) in wanted {
            take(task, sample(candidate, &measure, &staged, timing)?);
        }
        Ok(())
    })?;
    Ok(bound.iter().map(cost).collect())
}

fn cost(candidate: &BoundCandidate<'_>) -> Option<NetworkCost> {
    let cost = candidate.cost()?;
    Some(NetworkCost {
        parameters: cost.parameters,
        flops: cost.flops,
        scratch: candidate.num_bytes()?,
    })
}

/// One drape.
struct Run {
    seconds: Seconds,
    before: Vec<Point3>,
    after: Vec<Point3>,
    left: PenetrationCount,
}

fn run(
    candidate: &mut BoundCandidate<'_>,
    staged: &StagedScene,
    options: &UntangleOptions,
) -> Result<Run, TrainError> {
    let finish = Finish::Untangle(*options);
    candidate.drape(staged, finish, |draper, placed, drape| {
        let before = placed.positions(draper.garment());
        let Some(drape) = drape else {
            let (after, seconds) = (before.clone(), Seconds::default());
            let left = PenetrationCount::NOTHING;
            return Ok(Run {
                seconds,
                before,
                after,
                left,
            });
        };
        Ok(Run {
            seconds: Seconds {
                warp: drape.seconds.warp,
                network: drape.seconds.predict,
                untangle: drape.seconds.untangle,
                simulation: drape.seconds.relax,
            },
            before,
            left: PenetrationCount::of(&drape),
            after: drape.positions,
        })
    })
}

/// The sample of a candidate and a scene.
fn sample(
    candidate: &mut BoundCandidate<'_>,
    measure: &Measure,
    staged: &StagedScene,
    timing: Timing,
) -> Result<Sample, TrainError> {
    let mut run = || run(candidate, staged, &timing.untangle);
    run()?;
    let runs = (0..timing.repeats.max(1)).map(|_| run());
    let mut runs: Vec<Run> = runs.collect::<Result<_, _>>()?;
    runs.sort_by(|a, b| a.seconds.total().total_cmp(&b.seconds.total()));
    let middle = runs.swap_remove(runs.len() / 2);
    let (mut before, mut after) = (Tally::default(), Tally::default());
    measure.add(&mut before, staged, &middle.before)?;
    measure.add(&mut after, staged, &middle.after)?;
    Ok(Sample {
        body: staged.name.body,
        pose: staged.name.pose,
        seconds: middle.seconds,
        before,
        after: Some(after),
        left: middle.left,
    })
}
