//! Networks beside the skinning and the warp that they start from, on one split.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use garnet_data::Split;
use garnet_net::{GarNetConfig, ModelHeader, Moment};
use serde::Serialize;

use crate::bound_candidate::BoundCandidate;
use crate::curves::Counts;
use crate::measure::Measure;
use crate::scenes_found::ScenesFound;
use crate::scores::{Sums, Tally};
use crate::{
    Curves, Finish, PenetrationCount, Percentiles, Scores, Stage, StagedScene, TrainError,
};

/// A way to drape that is measured.
#[derive(Debug, Clone, PartialEq)]
pub enum Candidate {
    /// Dual-quaternion skinning: pose only.
    Skinning,
    /// Dual-quaternion skinning and the change of the body's shape.
    Warp,
    /// A network.
    Model {
        /// What it is called in tables, where it does not settle.
        name: String,
        /// Its weights.
        weights: PathBuf,
        /// For how many frames the cloth is simulated where the network has put it; 0 leaves it.
        settle: u32,
    },
}

impl Candidate {
    /// The model of a file of weights as it is, and with its cloth settled for so many frames, or
    /// for as long as it does by default. What a model puts where it arrives is no drape before it
    /// has settled.
    ///
    /// # Errors
    ///
    /// [`TrainError::Checkpoint`] for files that are none of a model.
    pub fn of_weights(
        name: &str,
        weights: &Path,
        settle: Option<u32>,
    ) -> Result<Vec<Self>, TrainError> {
        let moment = ModelHeader::read(weights)?.moment;
        let settled = settle.unwrap_or(moment.settle_frames());
        let mut frames = if moment.is_rest() {
            vec![0, settled]
        } else {
            vec![settled]
        };
        frames.dedup();
        let of = |settle| Self::Model {
            name: name.to_owned(),
            weights: weights.to_path_buf(),
            settle,
        };
        Ok(frames.into_iter().map(of).collect())
    }

    /// What a model is called in tables, if it settles for so many frames.
    pub fn settled_name(name: &str, settle: u32) -> String {
        match settle {
            0 => name.to_owned(),
            _ => format!("{name} settled"),
        }
    }
}

/// What an evaluation tells while it runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum EvalEvent {
    /// A scene was measured with all candidates.
    Scene {
        /// Scenes that are done.
        done: usize,
        /// Scenes that there are.
        total: usize,
    },
}

/// What was measured of all candidates.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Evaluation {
    /// The split.
    pub split: Split,
    /// Scenes of it.
    pub scenes: usize,
    /// One a candidate, in their order.
    pub rows: Vec<Row>,
    /// The teacher's drapes of the same scenes, beside themselves: their strain and folds.
    pub teacher: Scores,
}

/// What was measured of a candidate.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Row {
    /// `dqs`, `warp`, or the name of the model.
    pub name: String,
    /// What the network is made of; none for skinning and warp.
    pub config: Option<GarNetConfig>,
    /// The moment at which the network predicts the cloth.
    pub moment: Moment,
    /// For how many frames the cloth settles where the network has put it.
    pub settle: u32,
    /// Scenes whose cloth flew apart when it was to settle, and was left where the network had put
    /// it.
    pub unsettled: usize,
    /// Scenes whose bodies are unlike those that the network was trained on, or whose cloth it
    /// would have torn, and was not moved by it.
    pub fallbacks: usize,
    /// Those of them whose bodies are unlike those of the training.
    pub unfamiliar: usize,
    /// Mean distance to the teacher of all other scenes, before untangling, in metres; none if
    /// there are none.
    pub familiar_distance: Option<f64>,
    /// What was found in each scene.
    pub scenes_found: ScenesFound,
    /// Weights of the network.
    pub parameters: u64,
    /// Multiplications and additions of a forward pass.
    pub flops: u64,
    /// Before untangling.
    pub scores: Scores,
    /// Shares of vertices and normals under thresholds, before untangling.
    pub curves: Curves,
    /// After untangling, if that was asked for.
    pub untangled: Option<Untangled>,
    /// Times of one scene at a time.
    pub seconds: StageSeconds,
}

/// What was measured after untangling.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Untangled {
    /// The scores.
    pub scores: Scores,
    /// What is still not as it should be, in all scenes.
    #[serde(flatten)]
    pub left: PenetrationCount,
}

/// Times of the stages of a drape, in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct StageSeconds {
    /// Skinning or warp.
    pub warp: Percentiles,
    /// The network with all that it needs of a scene.
    pub network: Percentiles,
    /// Settling by simulation.
    pub settle: Percentiles,
    /// Untangling.
    pub untangle: Percentiles,
}

/// Measures candidates on a split, one scene after the other.
///
/// # Errors
///
/// [`TrainError::EmptySplit`], [`TrainError::Checkpoint`] for weights that cannot be read or are of
/// another garment, or those of the data set.
pub fn evaluate(
    stage: &Stage,
    split: Split,
    candidates: &[Candidate],
    finish: Finish,
    observer: &mut dyn FnMut(EvalEvent),
) -> Result<Evaluation, TrainError> {
    let never = AtomicBool::new(false);
    evaluate_until(stage, split, candidates, finish, observer, &never)
}

/// As [`evaluate`]; `stop` ends it after the scene at hand, with [`TrainError::Stopped`].
pub(crate) fn evaluate_until(
    stage: &Stage,
    split: Split,
    candidates: &[Candidate],
    finish: Finish,
    observer: &mut dyn FnMut(EvalEvent),
    stop: &AtomicBool,
) -> Result<Evaluation, TrainError> {
    stage.check_moment(Moment::Rest)?;
    let total = stage.num_scenes(split)?;
    let mut entrants: Vec<Entrant<'_>> = (candidates.iter())
        .map(|candidate| Ok(Entrant::new(BoundCandidate::new(stage, candidate)?)))
        .collect::<Result<_, TrainError>>()?;
    let measure = Measure::new(stage)?;
    let mut teacher = Tally::default();
    let mut done = 0;
    stage.for_each(split, Ok, &mut |staged: StagedScene| {
        if stop.load(Ordering::Relaxed) {
            return Err(TrainError::Stopped);
        }
        scene(&mut entrants, &measure, finish, &staged)?;
        measure.add(&mut teacher, &staged, &staged.draped)?;
        done += 1;
        observer(EvalEvent::Scene { done, total });
        Ok(())
    })?;
    Ok(Evaluation {
        split,
        scenes: total,
        rows: entrants.into_iter().map(Entrant::into_row).collect(),
        teacher: teacher.scores(),
    })
}

/// A candidate with what it has measured so far.
struct Entrant<'a> {
    candidate: BoundCandidate<'a>,
    tally: Tally,
    distances: Counts,
    angles: Counts,
    untangled: Option<Tally>,
    left: PenetrationCount,
    unsettled: usize,
    fallbacks: usize,
    unfamiliar: usize,
    familiar: Sums,
    scenes_found: ScenesFound,
    times: [Vec<f64>; 4],
}

impl<'a> Entrant<'a> {
    fn new(candidate: BoundCandidate<'a>) -> Self {
        Self {
            candidate,
            tally: Tally::default(),
            distances: Counts::of_distances(),
            angles: Counts::of_angles(),
            untangled: None,
            left: PenetrationCount::NOTHING,
            unsettled: 0,
            fallbacks: 0,
            unfamiliar: 0,
            familiar: Sums::default(),
            scenes_found: ScenesFound::default(),
            times: Default::default(),
        }
    }

    fn into_row(self) -> Row {
        let [warp, network, settle, untangle] = self.times.map(Percentiles::of);
        let cost = self.candidate.cost();
        Row {
            name: self.candidate.name().to_owned(),
            config: self.candidate.config().cloned(),
            moment: self.candidate.moment(),
            settle: self.candidate.settle_frames(),
            unsettled: self.unsettled,
            fallbacks: self.fallbacks,
            unfamiliar: self.unfamiliar,
            familiar_distance: self.familiar.mean(),
            scenes_found: self.scenes_found,
            parameters: cost.map_or(0, |cost| cost.parameters),
            flops: cost.map_or(0, |cost| cost.flops),
            scores: self.tally.scores(),
            curves: Curves {
                distance: self.distances.curve(),
                normal: self.angles.curve(),
            },
            untangled: self.untangled.map(|tally| Untangled {
                scores: tally.scores(),
                left: self.left,
            }),
            seconds: StageSeconds {
                warp,
                network,
                settle,
                untangle,
            },
        }
    }
}

/// Measures a scene with all candidates.
fn scene(
    entrants: &mut [Entrant<'_>],
    measure: &Measure,
    finish: Finish,
    staged: &StagedScene,
) -> Result<(), TrainError> {
    for entrant in entrants {
        let Entrant {
            candidate,
            tally,
            distances,
            angles,
            untangled,
            left,
            unsettled,
            fallbacks,
            unfamiliar,
            familiar,
            scenes_found,
            times,
        } = entrant;
        let has_network = candidate.config().is_some() || candidate.cost().is_some();
        candidate.drape(staged, finish, |draper, placed, drape| {
            let (seconds, provenance) = (placed.seconds(), placed.provenance());
            times[0].push(seconds.warp);
            times[1].extend(has_network.then_some(seconds.predict));
            times[2].extend(provenance.relaxed_from.map(|_| seconds.relax));
            *unsettled += usize::from(provenance.unrelaxed.is_some());
            let is_trusted = provenance.fallback.is_none() && provenance.beyond.is_none();
            *fallbacks += usize::from(!is_trusted);
            let positions = placed.positions(draper.garment());
            let errors = measure.add(tally, staged, &positions)?;
            match &provenance.beyond {
                // A drape beyond what a network knows says little of it.
                Some(_) => *unfamiliar += 1,
                None => familiar.add(&errors.distances),
            }
            scenes_found.add(draper.garment(), &staged.posed, &errors.distances);
            distances.add(&errors.distances);
            angles.add(&errors.angles);
            let Some(drape) = drape else {
                return Ok(());
            };
            times[3].push(drape.seconds.untangle);
            left.add(PenetrationCount::of(&drape));
            let tally = untangled.get_or_insert_with(Tally::default);
            measure.add(tally, staged, &drape.positions)?;
            Ok(())
        })?;
    }
    Ok(())
}
