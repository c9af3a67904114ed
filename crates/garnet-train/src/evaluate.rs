//! Networks beside the skinning and the warp that they start from, on one split.

use std::path::PathBuf;
use std::time::Instant;

use garnet_data::Split;
use garnet_mesh::{Point3, Topology};
use garnet_net::losses::{LossBody, LossConfig, Losses};
use garnet_net::{Checkpoint, GarNetConfig, NetError, Predictor, SceneInput, Start, Variant};
use garnet_skin::{Warp, WarpedGarment};
use garnet_untangle::{Binding, UntangleOptions, untangle};
use serde::Serialize;

use crate::curves::Counts;
use crate::scores::{Compared, Errors, Tally};
use crate::{Curves, Scores, Stage, StagedScene, TrainError, warp_of};

/// A way to drape that is measured.
#[derive(Debug, Clone, PartialEq)]
pub enum Candidate {
    /// Dual-quaternion skinning: pose only.
    Skinning,
    /// Dual-quaternion skinning and the change of the body's shape.
    Warp,
    /// A network.
    Model {
        /// What it is called in tables.
        name: String,
        /// Its weights.
        weights: PathBuf,
    },
}

/// What is done to drapes before they are measured a second time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Finish {
    /// Nothing: they are measured once.
    None,
    /// They are freed of penetrations.
    Untangle(UntangleOptions),
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
pub struct Evaluation {
    /// The split.
    pub split: Split,
    /// Scenes of it.
    pub scenes: usize,
    /// One a candidate, in their order.
    pub rows: Vec<Row>,
}

/// What was measured of a candidate.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// `dqs`, `warp`, or the name of the model.
    pub name: String,
    /// What the network is made of; none for skinning and warp.
    pub config: Option<GarNetConfig>,
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
    /// Vertices inside the body that are not caught where it runs through itself, in all scenes.
    pub inside: usize,
    /// Vertices that are caught there, in all scenes.
    pub trapped: usize,
}

/// Times of the stages of a drape, in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StageSeconds {
    /// Skinning or warp.
    pub warp: Percentiles,
    /// The network with all that it needs of a scene.
    pub network: Percentiles,
    /// Untangling.
    pub untangle: Percentiles,
}

/// Median and 95th percentile.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Percentiles {
    /// Half are below.
    pub median: f64,
    /// 95 of 100 are below.
    pub p95: f64,
}

impl Percentiles {
    fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let at = |percent: usize| {
            let last = values.len().saturating_sub(1);
            values
                .get((last * percent).div_ceil(100))
                .copied()
                .unwrap_or(0.0)
        };
        Self {
            median: at(50),
            p95: at(95),
        }
    }
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
    let total = stage.num_scenes(split)?;
    let mut contenders: Vec<Contender> = (candidates.iter())
        .map(|candidate| Contender::new(stage, candidate))
        .collect::<Result<_, _>>()?;
    let measure = Measure {
        losses: Losses::new(&stage.package.mesh, &LossConfig::paper())?,
        edges: Topology::new(
            stage.package.mesh.num_vertices(),
            stage.package.mesh.faces(),
        )
        .edges()
        .to_vec(),
        finish,
    };
    let mut done = 0;
    let mut first_error = None;
    stage.for_each(split, Ok, &mut |staged: StagedScene| {
        if first_error.is_none() {
            first_error = measure.scene(&mut contenders, &staged).err();
        }
        done += 1;
        observer(EvalEvent::Scene { done, total });
    })?;
    match first_error {
        Some(error) => Err(error),
        None => Ok(Evaluation {
            split,
            scenes: total,
            rows: contenders.into_iter().map(Contender::into_row).collect(),
        }),
    }
}

/// A candidate with what it has measured so far.
struct Contender {
    name: String,
    start: Start,
    predictor: Option<Predictor>,
    parameters: u64,
    flops: u64,
    tally: Tally,
    distances: Counts,
    angles: Counts,
    untangled: Option<Tally>,
    inside: usize,
    trapped: usize,
    times: [Vec<f64>; 3],
}

/// What all candidates are measured with.
struct Measure {
    losses: Losses,
    edges: Vec<[u32; 2]>,
    finish: Finish,
}

impl Contender {
    fn new(stage: &Stage, candidate: &Candidate) -> Result<Self, TrainError> {
        let package = &stage.package;
        let (name, start, predictor) = match candidate {
            Candidate::Skinning => ("dqs", Start::DualQuaternion, None),
            Candidate::Warp => ("warp", Start::Shape, None),
            Candidate::Model { name, weights } => {
                let graph = stage.template().graph.clone();
                let config = Checkpoint::header(weights)?.config;
                // Sewing parameters may be those of bodies alone.
                let zeros = vec![0.0; config.num_sewing_parameters];
                let graph = graph.with_sewing_parameters(&zeros)?;
                let rest = package.body.rest().positions();
                let template = package.mesh.positions();
                let predictor = Predictor::load(weights, graph, template, rest)?;
                (name.as_str(), config.start, Some(predictor))
            }
        };
        let cost = predictor.as_ref().map(|predictor| {
            let config = predictor.model().config();
            config.cost(package.mesh.num_vertices(), predictor.num_body_points())
        });
        let cost = cost.transpose()?;
        Ok(Self {
            name: name.to_owned(),
            start,
            predictor,
            parameters: cost.map_or(0, |cost| cost.parameters),
            flops: cost.map_or(0, |cost| cost.flops),
            tally: Tally::default(),
            distances: Counts::of_distances(),
            angles: Counts::of_angles(),
            untangled: None,
            inside: 0,
            trapped: 0,
            times: Default::default(),
        })
    }

    /// Drapes without untangling; gives the times of the warp and of the network.
    fn drape(&mut self, staged: &StagedScene) -> Result<Vec<Point3>, TrainError> {
        let worn = &staged.worn;
        let Some(predictor) = &mut self.predictor else {
            let warp: Warp = warp_of(self.start);
            let start = Instant::now();
            let nodes = worn.garment.warped(&staged.posed, warp)?;
            self.times[0].push(start.elapsed().as_secs_f64());
            return Ok(worn.garment.weld().scatter(&nodes));
        };
        let config = predictor.model().config().clone();
        let graph = worn.graph.clone();
        let graph = match config.num_sewing_parameters {
            0 => graph.with_sewing_parameters(&[])?,
            _ => graph,
        };
        predictor.rebind(graph)?;
        let start = Instant::now();
        let warped: WarpedGarment = staged.warped(self.start)?;
        self.times[0].push(start.elapsed().as_secs_f64());
        let start = Instant::now();
        let parameters = match config.variant {
            Variant::GlobalParams => worn.body.pose_and_shape(&staged.posed),
            _ => Vec::new(),
        };
        let predicted = predictor.predict(&SceneInput {
            warped: &warped.positions,
            body: staged.posed.skin().positions(),
            body_normals: &warped.body_normals,
            world_from_root: warped.world_from_root,
            rotations: &warped.rotations,
            parameters: &parameters,
        })?;
        self.times[1].push(start.elapsed().as_secs_f64());
        Ok(predicted)
    }

    fn into_row(self) -> Row {
        let [warp, network, untangle] = self.times.map(Percentiles::of);
        Row {
            name: self.name,
            config: self
                .predictor
                .map(|predictor| predictor.model().config().clone()),
            parameters: self.parameters,
            flops: self.flops,
            scores: self.tally.scores(),
            curves: Curves {
                distance: self.distances.curve(),
                normal: self.angles.curve(),
            },
            untangled: self.untangled.map(|tally| Untangled {
                scores: tally.scores(),
                inside: self.inside,
                trapped: self.trapped,
            }),
            seconds: StageSeconds {
                warp,
                network,
                untangle,
            },
        }
    }
}

impl Measure {
    fn scene(&self, contenders: &mut [Contender], staged: &StagedScene) -> Result<(), TrainError> {
        let garment = &staged.worn.garment;
        let binding = match self.finish {
            Finish::None => None,
            Finish::Untangle(options) => Some((Binding::new(garment)?, options)),
        };
        for contender in contenders {
            let drape = contender.drape(staged);
            let predicted = drape.map_err(|source| TrainError::Scene {
                scene: staged.name,
                source: Box::new(source),
            })?;
            let mut tally = std::mem::take(&mut contender.tally);
            let Errors { distances, angles } = self.add(&mut tally, staged, &predicted)?;
            contender.tally = tally;
            contender.distances.add(&distances);
            contender.angles.add(&angles);
            let Some((binding, options)) = &binding else {
                continue;
            };
            let nodes = garment.weld().gather(&predicted);
            let start = Instant::now();
            let untangled = untangle(garment, binding, &staged.posed, &nodes, options)?;
            contender.times[2].push(start.elapsed().as_secs_f64());
            contender.inside += untangled.report.inside;
            contender.trapped += untangled.report.trapped;
            let positions = garment.weld().scatter(&untangled.positions);
            let mut tally = contender.untangled.take().unwrap_or_default();
            self.add(&mut tally, staged, &positions)?;
            contender.untangled = Some(tally);
        }
        Ok(())
    }

    fn add(
        &self,
        tally: &mut Tally,
        staged: &StagedScene,
        predicted: &[Point3],
    ) -> Result<Errors, TrainError> {
        let mesh = staged.worn.garment.mesh();
        let skin = staged.posed.skin();
        let body = staged
            .worn
            .body
            .rest()
            .with_positions(skin.positions().to_vec())?;
        let target = self.losses.target(&staged.draped)?;
        let losses = self
            .losses
            .measure(predicted, &target, &LossBody::new(&body)?);
        let losses = losses.map_err(|error: NetError| TrainError::Scene {
            scene: staged.name,
            source: Box::new(error.into()),
        })?;
        tally.add(&Compared {
            predicted,
            draped: &staged.draped,
            rest: mesh.positions(),
            faces: mesh.faces(),
            edges: &self.edges,
            skin,
            losses: &losses,
        })
    }
}
