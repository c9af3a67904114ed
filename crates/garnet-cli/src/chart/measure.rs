//! The samples that are not there yet.

use anyhow::Context;
use garnet::{
    package::{Quality, quality_of},
    train::{
        SceneName, Stage,
        chart::{Answer, Question, Sample, Task, Timing, time_drapes, time_simulations},
    },
};

use super::{
    Job, SPLIT,
    methods::{Method, Way},
    record::{FailedScene, Keeper, NoiseRecord},
};
use crate::hints::advised;

/// Times skinning, warp and networks.
pub(super) fn drapes(job: &Job, keeper: &mut Keeper) -> anyhow::Result<()> {
    let mut tasks = Vec::new();
    let mut measured: Vec<&Method> = Vec::new();
    for method in job.methods {
        let Way::Drape(candidate) = &method.way else {
            continue;
        };
        let known = keeper.record.method(method.key());
        let missing = job.scenes.drapes.iter().copied();
        let missing: Vec<SceneName> = missing.filter(|&scene| !known.has(scene)).collect();
        if !missing.is_empty() {
            measured.push(method);
            tasks.push(Task {
                candidate: candidate.clone(),
                scenes: missing,
            });
        }
    }
    if tasks.is_empty() {
        return Ok(());
    }
    let bar = job
        .console
        .progress(tasks.iter().map(|task| task.scenes.len()).sum());
    let mut written = Ok(());
    let mut take = |task: usize, sample: Sample| {
        let method = measured[task];
        bar.set_message(method.name.clone());
        bar.inc(1);
        let known = keeper.record.method(method.key());
        known.samples.push(sample);
        if written.is_ok() {
            written = keeper.write_now_and_then();
        }
    };
    let timing = Timing {
        untangle: job.args.untangle(),
        repeats: job.args.repeat,
    };
    let costs = time_drapes(job.stage, SPLIT, &tasks, timing, &mut take);
    bar.finish_and_clear();
    written?;
    for (method, cost) in measured.iter().zip(costs.map_err(advised)?) {
        let known = keeper.record.method(method.key());
        known.cost = cost;
    }
    keeper.write()
}

/// Times the teacher and measures its noise floor.
pub(super) fn simulations(job: &Job, keeper: &mut Keeper) -> anyhow::Result<()> {
    let mut questions: Vec<(SceneName, Vec<Question>)> = Vec::new();
    for &scene in &job.scenes.simulations {
        let mut asked = Vec::new();
        for method in job.methods {
            let Way::Simulation(quality) = method.way else {
                continue;
            };
            if !keeper.record.method(method.key()).has(scene) {
                asked.push(Question::Drape(quality));
            }
        }
        let is_known = |noise: &NoiseRecord| noise.is_of(scene);
        if job.scenes.noise.contains(&scene) && !keeper.record.noise.iter().any(is_known) {
            asked.push(Question::Noise(teacher_of(job.stage)));
        }
        questions.push((scene, asked));
    }
    let total: usize = questions.iter().map(|(_, asked)| asked.len()).sum();
    if total == 0 {
        return Ok(());
    }
    job.console
        .detail(&format_args!("{total} simulations are to be made"));
    let bar = job.console.progress(total);
    let mut written = Ok(());
    let mut take = |scene: SceneName, question: Question, answer: Answer| {
        let method = method_of(job.methods, question);
        let name = method.map_or("noise floor", |method| method.name.as_str());
        bar.set_message(name.to_owned());
        bar.inc(1);
        if let Answer::Failed(reason) = &answer {
            job.console
                .warning(&format_args!("{name} came to no end on {scene}: {reason}"));
        }
        keep(keeper, scene, method, answer);
        if written.is_ok() {
            written = keeper.write();
        }
    };
    let done = time_simulations(job.stage, SPLIT, &questions, &mut take);
    bar.finish_and_clear();
    written?;
    done.map_err(advised)
        .with_context(|| format!("cannot simulate `{}`", job.args.package.display()))
}

/// The quality that made the data set.
pub(super) fn teacher_of(stage: &Stage) -> Quality {
    let name = stage.dataset.manifest.quality.as_deref();
    name.and_then(quality_of).unwrap_or(Quality::Teacher)
}

/// The simulation that a question is about; none if it is about the noise floor.
fn method_of(methods: &[Method], question: Question) -> Option<&Method> {
    let Question::Drape(asked) = question else {
        return None;
    };
    methods
        .iter()
        .find(|method| matches!(method.way, Way::Simulation(quality) if quality == asked))
}

/// Keeps what the teacher said of a simulation, or of the noise floor.
fn keep(keeper: &mut Keeper, scene: SceneName, method: Option<&Method>, answer: Answer) {
    let SceneName { body, pose, .. } = scene;
    let Some(method) = method else {
        keeper.record.noise.push(NoiseRecord {
            body,
            pose,
            distance: match answer {
                Answer::Noise(distance) => Some(distance),
                _ => None,
            },
        });
        return;
    };
    let known = keeper.record.method(method.key());
    match answer {
        Answer::Drape(sample) => known.samples.push(*sample),
        Answer::Failed(reason) => known.failed.push(FailedScene { body, pose, reason }),
        Answer::Noise(_) => {}
    }
}
