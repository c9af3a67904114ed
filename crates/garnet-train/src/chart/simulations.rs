//! The teacher, timed on single scenes, and how repeatable it is.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use garnet_data::{DataError, Split, noise_floor};
use garnet_drape::{Quality, Simulator};

use super::sample::{Sample, Seconds};
use crate::measure::Measure;
use crate::simulators::Simulators;
use crate::{PenetrationCount, SceneName, Stage, StagedScene, Tally, TrainError};

/// What is asked of the teacher on a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Question {
    /// Its drape of a quality.
    Drape(Quality),
    /// How far a drape of a quality moves if a joint turns by [`garnet_data::NOISE_TURN`].
    Noise(Quality),
}

/// What the teacher answers.
#[derive(Debug)]
pub enum Answer {
    /// A drape.
    Drape(Box<Sample>),
    /// The mean distance of the vertices of two drapes, in metres.
    Noise(f64),
    /// The simulation came to no end, or the scene does not say how the body stands.
    Failed(String),
}

/// Answers the questions about each scene of a split, one by one; each answer is given to `take`
/// with its scene and question. Simulations look for contacts on all threads; the teacher's
/// substeps run on one.
///
/// # Errors
///
/// Those of the data set, or of a garment that cannot be simulated at all.
pub fn time_simulations(
    stage: &Stage,
    split: Split,
    questions: &[(SceneName, Vec<Question>)],
    take: &mut dyn FnMut(SceneName, Question, Answer),
) -> Result<(), TrainError> {
    let measure = Measure::new(stage)?;
    let asked = |name| questions.iter().find(|(scene, _)| *scene == name);
    let mut simulators = Simulators::new(stage);
    let keep = |name| asked(name).is_some_and(|(_, questions)| !questions.is_empty());
    stage.for_each_of(split, keep, Ok, &mut |staged: StagedScene| {
        let simulator = simulators.of(&staged)?;
        for &question in asked(staged.name).map_or(&[][..], |(_, questions)| questions) {
            let answer = answer(&simulator, &measure, &staged, question)?;
            take(staged.name, question, answer);
        }
        Ok(())
    })
}

fn answer(
    simulator: &Simulator,
    measure: &Measure,
    staged: &StagedScene,
    question: Question,
) -> Result<Answer, TrainError> {
    let stop = AtomicBool::new(false);
    let quality = match question {
        Question::Drape(quality) => quality,
        Question::Noise(quality) => {
            let Some((_, pose)) = &staged.own else {
                let reason = "the data set does not say the pose of its body";
                return Ok(Answer::Failed(reason.to_owned()));
            };
            let found = noise_floor(simulator, &staged.worn.body, pose, quality, &stop);
            let failed = |error: DataError| Answer::Failed(error.to_string());
            return Ok(found.map_or_else(failed, Answer::Noise));
        }
    };
    let start = Instant::now();
    let path = staged.path()?;
    let drape = match simulator.drape(&path, quality, &stop, &mut |_| {}) {
        Ok(drape) => drape,
        Err(error) => return Ok(Answer::Failed(error.to_string())),
    };
    let simulation = start.elapsed().as_secs_f64();
    let mut before = Tally::default();
    measure.add(&mut before, staged, &drape.positions)?;
    let penetration = &drape.report.penetration;
    Ok(Answer::Drape(Box::new(Sample {
        body: staged.name.body,
        pose: staged.name.pose,
        seconds: Seconds {
            simulation,
            ..Seconds::default()
        },
        before,
        after: None,
        left: PenetrationCount {
            inside: penetration.num_inside,
            trapped: penetration.num_trapped,
            crossing_faces: None,
        },
    })))
}
