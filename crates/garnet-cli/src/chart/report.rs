//! What is told about the ways to drape: `garnet.chart/1`, SI units.

use std::time::Instant;

use garnet::data::Protocol;
use garnet::train::{
    Stage,
    chart::{Figures, pareto_front},
};
use serde::Serialize;

use super::{
    Chosen, SPLIT,
    args::ChartArgs,
    measure::teacher_of,
    methods::{Kind, Method, Way},
    peers::Peer,
    record::{NoiseRecord, Record},
};

/// All ways to drape.
#[derive(Debug, Serialize)]
pub(super) struct ChartReport {
    schema: &'static str,
    version: &'static str,
    pub(super) machine: String,
    pub(super) threads: usize,
    pub(super) garment: String,
    pub(super) vertices: usize,
    dataset: String,
    pub(super) split: &'static str,
    pub(super) protocol: Protocol,
    /// Scenes that were chosen: for drapes, and for simulations.
    pub(super) scenes: usize,
    pub(super) simulated_scenes: usize,
    /// How often each scene was draped.
    repeat: usize,
    clearance_m: f32,
    /// How far drapes of the teacher move in the mean if one shoulder turns by 0.001 rad.
    pub(super) noise_floor_m: Option<f64>,
    /// Over how many scenes; none if the noise floor was given.
    pub(super) noise_scenes: Option<usize>,
    pub(super) methods: Vec<MethodReport>,
    /// Other programs, each on a scene of its own.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) peers: Vec<Peer>,
    /// Time of this run, in which only what was missing was measured.
    seconds: f64,
}

/// A way to drape.
#[derive(Debug, Serialize)]
pub(super) struct MethodReport {
    pub(super) name: String,
    pub(super) kind: Kind,
    /// For how many frames of a sixtieth of a second the cloth settles where a network has put it.
    pub(super) settle_frames: u32,
    /// Whether this simulation made the targets: it has no distance from them.
    pub(super) is_target: bool,
    /// Whether no other is better in time and distance; a target has the noise floor as its
    /// distance.
    pub(super) is_on_front: bool,
    pub(super) threads: usize,
    /// Multiplications and additions of a forward pass.
    pub(super) flop: Option<u64>,
    parameters: Option<u64>,
    /// Size of the weight file.
    pub(super) weight_bytes: Option<u64>,
    /// Memory that a network keeps between scenes.
    scratch_bytes: Option<usize>,
    /// The most memory of a process that drapes once.
    pub(super) peak_bytes: Option<u64>,
    /// Simulations that came to no end.
    pub(super) failed: usize,
    #[serde(flatten)]
    pub(super) figures: Figures,
}

impl ChartReport {
    pub(super) fn new(
        args: &ChartArgs,
        stage: &Stage,
        methods: &[Method],
        (scenes, record, peers): (&Chosen, &Record, Vec<Peer>),
        start: Instant,
    ) -> Self {
        let distances: Vec<f64> = noise(scenes, record).collect();
        let measured = distances.iter().sum::<f64>() / distances.len() as f64;
        let noise_floor = args
            .noise_floor
            .or(Some(measured).filter(|value| value.is_finite()));
        let reports = methods
            .iter()
            .filter_map(|method| MethodReport::new(method, stage, scenes, record));
        let mut reports: Vec<MethodReport> = reports.collect();
        let points = reports.iter().map(|report| report.point(noise_floor));
        let points: Vec<[f64; 2]> = points.map(|point| point.unwrap_or([f64::NAN; 2])).collect();
        for number in pareto_front(&points) {
            reports[number].is_on_front = true;
        }
        Self {
            schema: "garnet.chart/1",
            version: env!("CARGO_PKG_VERSION"),
            machine: record.setting.machine.clone(),
            threads: record.setting.threads,
            garment: stage.package.manifest.name.clone(),
            vertices: stage.package.mesh.num_vertices(),
            dataset: args.dataset.display().to_string(),
            split: SPLIT.name(),
            protocol: stage.dataset.manifest.protocol,
            scenes: scenes.drapes.len(),
            simulated_scenes: scenes.simulations.len(),
            repeat: record.setting.repeat,
            clearance_m: record.setting.clearance,
            noise_floor_m: noise_floor,
            noise_scenes: args.noise_floor.is_none().then_some(distances.len()),
            methods: reports,
            peers,
            seconds: start.elapsed().as_secs_f64(),
        }
    }
}

/// The distances of the scenes that were chosen.
fn noise<'a>(scenes: &'a Chosen, record: &'a Record) -> impl Iterator<Item = f64> + 'a {
    let is_chosen = |noise: &&NoiseRecord| scenes.noise.iter().any(|&scene| noise.is_of(scene));
    let chosen = record.noise.iter().filter(is_chosen);
    chosen.filter_map(|noise| noise.distance)
}

impl MethodReport {
    /// Of a method; none if there is no sample of it.
    fn new(method: &Method, stage: &Stage, scenes: &Chosen, record: &Record) -> Option<Self> {
        let known = record.find(&method.name)?;
        let (chosen, is_target) = match method.way {
            Way::Drape(_) => (&scenes.drapes, false),
            Way::Simulation(quality) => {
                let made = stage.dataset.manifest.quality.is_some();
                (&scenes.simulations, made && quality == teacher_of(stage))
            }
        };
        let figures = Figures::of(known.of(chosen));
        (figures.scenes > 0).then(|| Self {
            name: method.name.clone(),
            kind: method.kind(),
            settle_frames: method.settle_frames,
            is_target,
            is_on_front: false,
            threads: record.setting.threads,
            flop: known.cost.map(|cost| cost.flops),
            parameters: known.cost.map(|cost| cost.parameters),
            weight_bytes: method.weights.as_ref().map(|weights| weights.bytes),
            scratch_bytes: known.cost.map(|cost| cost.scratch),
            peak_bytes: known.peak_bytes,
            failed: known.failed.len(),
            figures,
        })
    }

    /// Median time and distance, in seconds and metres; none if the distance is not known.
    pub(super) fn point(&self, noise_floor: Option<f64>) -> Option<[f64; 2]> {
        let distance = if self.is_target {
            noise_floor?
        } else {
            self.figures.after.distance
        };
        Some([self.figures.seconds.total.median, distance])
    }
}
