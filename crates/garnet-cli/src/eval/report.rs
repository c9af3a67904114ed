//! What is told about an evaluation.

use std::{fmt, time::Duration};

use garnet::data::Protocol;
use garnet::train::{
    Curves, Evaluation, GarNetConfig, PenetrationCount, Row, Scores, Stage, StageSeconds, Untangled,
};
use serde::Serialize;

use super::EvalArgs;
use crate::machine;

/// What was measured: `garnet.eval/1`, SI units.
#[derive(Debug, Serialize)]
pub(crate) struct EvalReport {
    schema: &'static str,
    version: &'static str,
    garment: String,
    vertices: usize,
    dataset: String,
    split: &'static str,
    protocol: Protocol,
    scenes: usize,
    machine: String,
    threads: usize,
    /// Skinning, warp and networks.
    pub(crate) methods: Vec<MethodReport>,
    /// The teacher's own drapes of the same scenes.
    teacher: Scores,
    seconds: f64,
}

/// A way to drape.
#[derive(Debug, Serialize)]
pub(crate) struct MethodReport {
    pub(crate) name: String,
    /// For how many frames of a sixtieth of a second the cloth settles where the network has put
    /// it.
    pub(crate) settle_frames: u32,
    /// Whether it is a drape only once it has settled.
    pub(crate) has_to_settle: bool,
    /// Scenes that were left where the network had put them because their cloth flew apart.
    unsettled: usize,
    /// Scenes that the network was not trusted with, because of the body or because it would have
    /// torn the garment; their drapes are those of the fallback.
    fallbacks: usize,
    /// Those of them whose bodies are unlike those of the training.
    unfamiliar: usize,
    /// Weights of the network; none of skinning and warp.
    pub(crate) weights: Option<u64>,
    /// Multiplications and additions of a forward pass; none of skinning and warp.
    flop: Option<u64>,
    network: Option<GarNetConfig>,
    /// Before untangling.
    pub(crate) scores: Scores,
    untangled: Option<Untangled>,
    /// One scene at a time: median and 95th percentile.
    seconds: StageSeconds,
    curves: Curves,
}

impl EvalReport {
    pub(crate) fn new(found: &Evaluation, args: &EvalArgs, stage: &Stage, time: Duration) -> Self {
        Self {
            schema: "garnet.eval/1",
            version: env!("CARGO_PKG_VERSION"),
            garment: stage.package.manifest.name.clone(),
            vertices: stage.package.mesh.num_vertices(),
            dataset: args.dataset.display().to_string(),
            split: found.split.name(),
            protocol: stage.dataset.manifest.protocol,
            scenes: found.scenes,
            machine: machine::description(),
            threads: rayon::current_num_threads(),
            methods: found.rows.iter().map(MethodReport::from).collect(),
            teacher: found.teacher,
            seconds: time.as_secs_f64(),
        }
    }
}

impl From<&Row> for MethodReport {
    fn from(row: &Row) -> Self {
        let is_network = row.parameters > 0;
        Self {
            name: row.name.clone(),
            settle_frames: row.settle,
            has_to_settle: !row.moment.is_rest(),
            unsettled: row.unsettled,
            fallbacks: row.fallbacks,
            unfamiliar: row.unfamiliar,
            weights: is_network.then_some(row.parameters),
            flop: is_network.then_some(row.flops),
            network: row.config.clone(),
            scores: row.scores,
            untangled: row.untangled,
            seconds: row.seconds,
            curves: row.curves.clone(),
        }
    }
}

/// Least width of a column.
const LEAST: usize = 7;

/// The heads of the columns.
const COLUMNS: [&str; 12] = [
    "E_dist mm",
    "± mm",
    "E_norm °",
    "L_MC",
    "L_RQ",
    "inside %",
    "free",
    "faces",
    "strain p99 %",
    "crossings",
    "fell back",
    "ms",
];

impl fmt::Display for EvalReport {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "`{}`, {} vertices: {} scenes of `{}`, {}, {} threads",
            self.garment,
            self.vertices,
            self.scenes,
            self.split,
            self.protocol.title(),
            self.threads
        )?;
        let names = self
            .methods
            .iter()
            .map(|method| method.name.chars().count());
        let width = names.max().unwrap_or(0) + " untangled".len();
        write!(formatter, "\n{:width$}", "")?;
        for head in COLUMNS {
            write!(formatter, "  {head:>LEAST$}")?;
        }
        for method in &self.methods {
            let seconds = &method.seconds;
            let first = seconds.warp.median + seconds.network.median + seconds.settle.median;
            let fallbacks = method.weights.map(|_| method.fallbacks);
            let before = Line::of(&method.name, &method.scores).took(first);
            let before = before.fell_back(fallbacks);
            before.write(formatter, width)?;
            if let Some(untangled) = &method.untangled {
                let name = format!("{} untangled", method.name);
                let after = Line::of(&name, &untangled.scores);
                let after = after.took(first + seconds.untangle.median);
                let after = after.fell_back(fallbacks).left(untangled.left);
                after.write(formatter, width)?;
            }
        }
        // Without a time: it is not simulated here.
        Line::of("teacher", &self.teacher).write(formatter, width)?;
        if self.methods.iter().any(|method| method.untangled.is_some()) {
            write!(
                formatter,
                "\nfree: vertices inside the body in all scenes, faces: faces that cross it; both without those that it traps"
            )?;
        }
        if self.methods.iter().any(|method| method.fallbacks > 0) {
            write!(
                formatter,
                "\nfell back: scenes that the network was not trusted with; their drapes are the fallback's"
            )?;
        }
        for method in self.methods.iter().filter(|method| method.unsettled > 0) {
            let (name, count) = (&method.name, method.unsettled);
            write!(
                formatter,
                "\n{name}: {count} scenes flew apart and were left unsettled"
            )?;
        }
        Ok(())
    }
}

/// What a line of the table says.
struct Line<'a> {
    name: &'a str,
    scores: &'a Scores,
    /// The time of a scene; none of the teacher, which is not simulated here and differs from
    /// itself by nothing.
    seconds: Option<f64>,
    /// What untangling left.
    left: Option<PenetrationCount>,
    /// Scenes that fell back; none without a network.
    fallbacks: Option<usize>,
}

impl<'a> Line<'a> {
    fn of(name: &'a str, scores: &'a Scores) -> Self {
        Self {
            name,
            scores,
            seconds: None,
            left: None,
            fallbacks: None,
        }
    }

    fn took(self, seconds: f64) -> Self {
        Self {
            seconds: Some(seconds),
            ..self
        }
    }

    fn fell_back(self, fallbacks: Option<usize>) -> Self {
        Self { fallbacks, ..self }
    }

    fn left(self, left: PenetrationCount) -> Self {
        Self {
            left: Some(left),
            ..self
        }
    }

    fn write(&self, formatter: &mut fmt::Formatter<'_>, width: usize) -> fmt::Result {
        let scores = self.scores;
        let nothing = || "-".to_owned();
        let difference = |text: String| self.seconds.map_or_else(nothing, |_| text);
        let count = |of: Option<usize>| of.map_or_else(nothing, |count| count.to_string());
        let fields = [
            difference(format!("{:.2}", 1e3 * scores.distance)),
            difference(format!("{:.2}", 1e3 * scores.distance_std)),
            difference(format!("{:.2}", scores.normal.to_degrees())),
            difference(format!("{:.3}", scores.mean_curvature)),
            difference(format!("{:.2e}", scores.rayleigh)),
            format!("{:.2}", 1e2 * scores.inside),
            count(self.left.map(|left| left.inside)),
            count(self.left.and_then(|left| left.crossing_faces)),
            format!("{:.1}", 1e2 * (scores.stretch_p99 - 1.0)),
            format!("{:.1}", scores.self_intersections),
            count(self.fallbacks),
            self.seconds
                .map_or_else(nothing, |seconds| format!("{:.1}", 1e3 * seconds)),
        ];
        write!(formatter, "\n{:width$}", self.name)?;
        for (field, head) in fields.iter().zip(COLUMNS) {
            let width = head.chars().count().max(LEAST);
            write!(formatter, "  {field:>width$}")?;
        }
        Ok(())
    }
}
