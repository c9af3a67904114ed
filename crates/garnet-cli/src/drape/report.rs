//! The report of `drape` and `simulate`: `garnet.drape/1`, `garnet.simulate/1`. Lengths are metres,
//! times seconds.

use std::{collections::BTreeMap, path::Path};

use garnet::{
    Drape, TriMesh,
    body::shape::{Measure, Measures},
    data::SceneReport,
    drape::TakeFrame,
    knn::Surface,
    package::StoredFabric,
    sim,
    untangle::{UntangleReport, free_crossing_faces, penetration},
};
use serde::Serialize;

use super::{choice::ChoiceReport, fit::RegionReport, timing::Repeated};

/// What was draped, how, and what came out.
#[derive(Debug, Serialize)]
pub(crate) struct DrapeReport {
    /// `garnet.drape/1` or `garnet.simulate/1`.
    pub(crate) schema: &'static str,
    /// The version of garnet.
    pub(crate) version: &'static str,
    /// The garment.
    pub(crate) garment: GarmentReport,
    /// The body on which it lies.
    pub(crate) rest_body: BodyReport,
    /// The pose file, if there is one.
    pub(crate) pose: Option<PoseReport>,
    /// `lbs`, `dqs`, `warp`, `sim`, or the name of a network.
    pub(crate) method: String,
    /// The network; none for other methods.
    pub(crate) network: Option<NetworkReport>,
    /// How the network was chosen; none if it was not by `--budget` or `--tolerance`.
    pub(crate) choice: Option<ChoiceReport>,
    /// Quality and fabric of the simulation; none for other methods.
    pub(crate) simulation: Option<SimulationReport>,
    /// For how many frames of a sixtieth of a second the cloth was simulated where it was put.
    pub(crate) settle_frames: u32,
    /// Whether penetrations were removed.
    pub(crate) untangled: bool,
    /// Smallest distance asked for between cloth and skin; none without untangling.
    pub(crate) clearance_m: Option<f32>,
    /// The depth that was asked not to be exceeded; none without `--max-penetration`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) max_penetration_m: Option<f32>,
    /// The faces that were asked not to be exceeded; none without `--max-crossing`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) max_crossing_faces: Option<usize>,
    /// How many threads worked.
    pub(crate) threads: usize,
    /// How many of them shared a drape: 1 where each made drapes of its own.
    pub(crate) threads_a_drape: usize,
    /// How often each body was draped.
    pub(crate) repeat: u32,
    /// Drapes over the time of all of them, from the posed bodies to what is written.
    pub(crate) drapes_per_second: f64,
    /// Faces of the body that the garment covers in all drapes; none without `--hide`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) hidden_faces: Option<usize>,
    /// For whom the garment was cut; empty unless that is done for each wearer.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) cuts: Vec<CutReport>,
    /// Why it is not told whether the garment fits; none if it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) no_fit: Option<String>,
    /// What came out, in the order of the bodies.
    pub(crate) drapes: Vec<DrapeOutput>,
    /// Times of what is done once.
    pub(crate) seconds: OnceSeconds,
    /// The most memory that the process had by then, where the system tells.
    pub(crate) peak_bytes: Option<u64>,
    /// What may be wrong.
    pub(crate) warnings: Vec<WarningReport>,
}

/// The garment.
#[derive(Debug, Serialize)]
pub(crate) struct GarmentReport {
    pub(crate) path: String,
    pub(crate) vertices: usize,
    /// Polygons of the file.
    pub(crate) faces: usize,
    /// Triangles that they make.
    pub(crate) triangles: usize,
    /// Vertices at different places.
    pub(crate) nodes: usize,
    /// Those of them that lie on other cloth of the garment and follow it.
    pub(crate) layered: usize,
    /// Vertices over holes of the body: open necks, skin that was deleted under clothes.
    pub(crate) over_holes: usize,
    /// The unit it was read in: `m`, `dm`, `cm`, `mm`, `in` or `ft`.
    pub(crate) units: String,
    /// The axis that was taken as up: `y` or `z`.
    pub(crate) up: String,
}

/// How a garment was cut before it was draped. SI units.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct CutReport {
    /// The first of the bodies that it was cut for.
    pub(crate) target: String,
    /// The size, `m` or `32x34`; none if it was cut to measure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) size: Option<String>,
    /// The size that comes next, if the size was chosen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) second_size: Option<String>,
    /// Why the size was chosen, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) choice: Option<String>,
    /// Parameters of the pattern that are others than those of the package.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) parameters: BTreeMap<&'static str, f64>,
    /// Girths and inner leg of the wearer, if these are known.
    #[serde(flatten)]
    pub(crate) wearer: Option<WearerReport>,
    /// Whether these were told from the skin in a pose, and may be some centimetres off.
    #[serde(rename = "told_from_pose")]
    pub(crate) is_told: bool,
    /// How long it took to cut it and to put it on.
    pub(crate) seconds: f64,
}

/// Measures of a wearer.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct WearerReport {
    #[serde(rename = "chest_m")]
    pub(crate) chest: f64,
    #[serde(rename = "waist_m")]
    pub(crate) waist: f64,
    #[serde(rename = "hip_m")]
    pub(crate) hip: f64,
    #[serde(rename = "inseam_m")]
    pub(crate) inseam: f64,
}

impl CutReport {
    pub(super) fn new(target: &Path, measures: Option<&Measures>, seconds: f64) -> Self {
        Self {
            target: target.display().to_string(),
            size: None,
            second_size: None,
            choice: None,
            parameters: BTreeMap::new(),
            is_told: false,
            wearer: measures.map(|measures| WearerReport {
                chest: measures[Measure::Chest],
                waist: measures[Measure::Waist],
                hip: measures[Measure::Hip],
                inseam: measures[Measure::Inseam],
            }),
            seconds,
        }
    }
}

/// The rest body.
#[derive(Debug, Serialize)]
pub(crate) struct BodyReport {
    /// The file with its mesh.
    pub(crate) path: String,
    /// The file with its skeleton and weights.
    pub(crate) rig: String,
    pub(crate) vertices: usize,
    pub(crate) triangles: usize,
    pub(crate) joints: usize,
    pub(crate) units: String,
    pub(crate) up: String,
}

/// The pose file.
#[derive(Debug, Serialize)]
pub(crate) struct PoseReport {
    pub(crate) path: String,
    /// The animation of a GLB file, if it was named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) clip: Option<String>,
    /// The first frame; none if it is told in seconds.
    pub(crate) frame: Option<usize>,
    /// The range of frames, if one was named.
    pub(crate) frames: Option<String>,
    /// Whether a motion was stood on y = 0; if not, its heights are those of the recording.
    pub(crate) on_ground: bool,
    /// Whether a motion was kept above the origin; if not, it is where the recording has it, scaled
    /// by the length of the legs.
    pub(crate) in_place: bool,
    /// Frames a second that it was played anew with.
    pub(crate) fps: Option<f64>,
}

/// One draped garment.
#[derive(Debug, Serialize)]
pub(crate) struct DrapeOutput {
    /// The body, or the pose, that it was draped on.
    pub(crate) target: String,
    pub(crate) output: String,
    /// Distance between the body and the rest body in the recovered pose, at most.
    pub(crate) fit_residual_m: f32,
    /// Whether the body has another shape than the rest body.
    pub(crate) has_other_shape: bool,
    /// What untangling found and left; none without it.
    pub(crate) untangle: Option<Untangle>,
    /// What is inside the body; none after untangling, which tells more.
    pub(crate) penetration: Option<PenetrationReport>,
    /// What the simulation measured at its end, before untangling; none for other methods.
    pub(crate) simulated: Option<SceneReport>,
    /// Why the warp was taken in place of the network; none if it was not.
    pub(crate) fallback: Option<String>,
    /// What of the body is farther outside of the network's training than is trusted; none if
    /// nothing is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) beyond: Option<String>,
    /// How familiar the package is with the pose: from 0 to 1, its middle. None without a network,
    /// and on bodies of other topologies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) familiarity: Option<f64>,
    /// How far from the simulation such drapes of the variant are; none if the package does not
    /// say, or if cloth settles for another time than usual.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) expected_m: Option<f64>,
    /// Why the drape is that before it was to settle; none if it settled, or was not to.
    pub(crate) unsettled: Option<String>,
    /// How the frame goes on from the last one of its motion; none of a drape alone.
    pub(crate) steps: Option<StepsReport>,
    /// Pairs of faces of the garment that run through each other.
    pub(crate) cloth_crossings: usize,
    /// The same of the garment at rest.
    pub(crate) cloth_crossings_at_rest: usize,
    /// Limbs that are out of the cloth which is round them at rest.
    pub(crate) limbs_outside: Vec<LimbReport>,
    /// Length over rest length of the edges of the garment's polygons.
    pub(crate) stretch: Stretch,
    /// How the garment fits by region of the body; none where that is not known.
    pub(crate) fit: Option<Vec<RegionReport>>,
    /// Whether the girths of the body there were told from its skin in a pose, and may be some
    /// centimetres off.
    #[serde(rename = "fit_told_from_pose")]
    pub(crate) is_fit_told: bool,
    /// Times of this drape; of the last one, if it was repeated.
    pub(crate) seconds: DrapeSeconds,
    /// Times of all repetitions; none if there is but one.
    pub(crate) repeated: Option<RepeatedSeconds>,
}

/// A limb that is out of the cloth which is round it at rest.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct LimbReport {
    /// The joint that its skin follows.
    pub(crate) joint: String,
    /// What share of its skin that was in the cloth is not.
    pub(crate) share: f32,
}

/// How a frame of a motion goes on from the last one.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct StepsReport {
    /// The farthest that a vertex of the cloth has come; 0 in the first frame.
    pub(crate) cloth_m: f32,
    /// The farthest that a vertex of the body has come.
    pub(crate) body_m: f32,
    /// Nodes on their way to where the frame alone has them.
    pub(crate) held_back: usize,
    /// Whether it lies between two frames that were draped by themselves.
    pub(crate) is_between: bool,
}

impl StepsReport {
    pub(crate) fn of(frame: &TakeFrame) -> Self {
        Self {
            cloth_m: frame.step,
            body_m: frame.body_step,
            held_back: frame.held_back,
            is_between: frame.is_between,
        }
    }
}

/// The network that moved the warped garment.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct NetworkReport {
    pub(crate) variant: String,
    pub(crate) weights: String,
}

/// How garments were simulated.
#[derive(Debug, Serialize)]
pub(crate) struct SimulationReport {
    /// `fast`, `teacher` or `reference`.
    pub(crate) quality: &'static str,
    /// The fabric, in SI units.
    pub(crate) fabric: StoredFabric,
    /// Vertices that were simulated.
    pub(crate) vertices: usize,
}

/// Vertices inside the body.
#[derive(Debug, Serialize)]
pub(crate) struct PenetrationReport {
    pub(crate) inside: usize,
    pub(crate) deepest_m: f32,
    /// Vertices of simulated cloth that are trapped, inside or not; none of warped cloth, where all
    /// that is inside counts.
    pub(crate) trapped: Option<usize>,
    /// Trapped vertices inside the body.
    pub(crate) trapped_inside: Option<usize>,
    /// Faces of the garment that cross skin which lies in no other part of the body.
    pub(crate) crossing_faces: usize,
}

impl PenetrationReport {
    /// Of the vertices of a garment that faces name, against the skin; `scale` is that of simulated
    /// cloth, of which not all that is inside counts.
    pub(crate) fn of(garment: &TriMesh, skin: &Surface, scale: Option<f32>) -> Self {
        let mut named = garment.faces().as_flattened().to_vec();
        named.sort_unstable();
        named.dedup();
        let named = named.iter();
        let positions: Vec<_> = named.map(|&v| garment.positions()[v as usize]).collect();
        let positions = positions.as_slice();
        let crossing_faces = free_crossing_faces(&Surface::new(garment), skin).len();
        if let Some(scale) = scale {
            let found = sim::Penetration::of(positions, skin, scale);
            return Self {
                inside: found.num_inside,
                deepest_m: found.deepest,
                trapped: Some(found.num_trapped),
                trapped_inside: Some(found.num_trapped_inside),
                crossing_faces,
            };
        }
        let found = penetration(positions, skin);
        Self {
            inside: found.inside,
            deepest_m: found.deepest,
            trapped: None,
            trapped_inside: None,
            crossing_faces,
        }
    }
}

/// What untangling found and left. Vertices at one place count once.
#[derive(Debug, Serialize)]
pub(crate) struct Untangle {
    /// Vertices inside the body after the warp.
    pub(crate) inside_before: usize,
    /// The deepest of them.
    pub(crate) deepest_before_m: f32,
    /// Vertices that were moved by more than a tenth of a millimetre.
    pub(crate) moved: usize,
    /// The farthest that one was moved.
    pub(crate) max_displacement_m: f32,
    /// Vertices caught where the body runs through itself.
    pub(crate) trapped: usize,
    /// Trapped vertices inside the body.
    pub(crate) trapped_inside: usize,
    /// Other vertices inside the body: 0 unless untangling failed.
    pub(crate) inside: usize,
    /// The deepest of them.
    pub(crate) deepest_m: f32,
    /// Vertices outside, not trapped, and nearer to the skin than the clearance.
    pub(crate) below_clearance: usize,
    /// Those of them between parts of the body that leave no room.
    pub(crate) squeezed: usize,
    /// Smallest distance to the skin of vertices outside and not trapped; none if there are none.
    pub(crate) min_distance_m: Option<f32>,
    /// Faces that cross the skin, without trapped vertices.
    pub(crate) crossing_faces: usize,
    /// Faces that cross the skin, with trapped vertices.
    pub(crate) crossing_faces_trapped: usize,
    /// How often contacts were found anew.
    pub(crate) contact_rounds: usize,
    /// How often crossing faces were lifted.
    pub(crate) crossing_rounds: usize,
}

impl From<&UntangleReport> for Untangle {
    fn from(report: &UntangleReport) -> Self {
        Self {
            inside_before: report.inside_before,
            deepest_before_m: report.deepest_before,
            moved: report.moved,
            max_displacement_m: report.max_displacement,
            trapped: report.trapped,
            trapped_inside: report.trapped_inside,
            inside: report.inside,
            deepest_m: report.deepest,
            below_clearance: report.below_clearance,
            squeezed: report.squeezed,
            min_distance_m: report
                .min_distance
                .is_finite()
                .then_some(report.min_distance),
            crossing_faces: report.crossing_faces,
            crossing_faces_trapped: report.crossing_faces_trapped,
            contact_rounds: report.contact_rounds,
            crossing_rounds: report.crossing_rounds,
        }
    }
}

/// Length over rest length of the garment's own edges, without those at trapped vertices.
#[derive(Debug, Serialize)]
pub(crate) struct Stretch {
    pub(crate) p50: f32,
    pub(crate) p99: f32,
    pub(crate) max: f32,
    pub(crate) edges: usize,
    /// The largest at trapped vertices, if there are any.
    pub(crate) max_at_trapped: Option<f32>,
}

impl DrapeReport {
    /// Goes on with what another part of the targets has come to.
    pub(super) fn extend(&mut self, other: Self) {
        self.cuts.extend(other.cuts);
        self.drapes.extend(other.drapes);
        self.warnings.extend(other.warnings);
        self.seconds = other.seconds;
        self.peak_bytes = other.peak_bytes;
        self.drapes_per_second = self.drapes.len() as f64 / self.seconds.drape.max(1e-9);
    }
}

/// Times of what is done once.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(crate) struct OnceSeconds {
    /// Reading and parsing all files.
    pub(crate) read: f64,
    /// Binding the garment to the rest body, and looking for what is unusual.
    pub(crate) bind: f64,
    /// All drapes, with posing, untangling and writing.
    pub(crate) drape: f64,
    /// All of the command.
    pub(crate) total: f64,
}

/// Times of one drape.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(crate) struct DrapeSeconds {
    /// Posing the body, or recovering pose and shape from its vertices.
    pub(crate) fit: f64,
    /// Bringing the garment to the body: the warp, or the simulation.
    pub(crate) warp: f64,
    /// Zero without a network.
    pub(crate) network: f64,
    /// Zero if the cloth was left where it was put.
    pub(crate) settle: f64,
    pub(crate) untangle: f64,
    /// Zero for all but the last repetition.
    pub(crate) write: f64,
}

impl DrapeSeconds {
    /// Of a drape on a body that it took `fit` seconds to pose.
    pub(crate) fn of(drape: &Drape, fit: f64) -> Self {
        Self {
            fit,
            warp: drape.seconds.warp,
            network: drape.seconds.predict,
            settle: drape.seconds.relax,
            untangle: drape.seconds.untangle,
            write: 0.0,
        }
    }

    /// From the posed body to the drape.
    pub(crate) fn of_drape(&self) -> f64 {
        self.warp + self.network + self.settle + self.untangle
    }
}

/// Times of repeated drapes: median and 95th percentile.
#[derive(Debug, Serialize)]
pub(crate) struct RepeatedSeconds {
    pub(crate) fit: Repeated,
    pub(crate) warp: Repeated,
    pub(crate) network: Repeated,
    pub(crate) settle: Repeated,
    pub(crate) untangle: Repeated,
    /// Warp, network, settling and untangling together.
    pub(crate) drape: Repeated,
}

impl RepeatedSeconds {
    /// Of two drapes or more.
    pub(crate) fn of(times: &[DrapeSeconds]) -> Option<Self> {
        let spread =
            |stage: fn(&DrapeSeconds) -> f64| Repeated::of(times.iter().map(stage).collect());
        if times.len() < 2 {
            return None;
        }
        Some(Self {
            fit: spread(|time| time.fit)?,
            warp: spread(|time| time.warp)?,
            network: spread(|time| time.network)?,
            settle: spread(|time| time.settle)?,
            untangle: spread(|time| time.untangle)?,
            drape: spread(DrapeSeconds::of_drape)?,
        })
    }
}

/// What may be wrong.
#[derive(Debug, Serialize)]
pub(crate) struct WarningReport {
    /// The kind, as one word.
    pub(crate) kind: &'static str,
    /// The file that it is about.
    pub(crate) path: String,
    /// How many there are, where it is a number of things.
    pub(crate) count: Option<usize>,
    /// The text for people.
    pub(crate) text: String,
    /// How bad it is beside others of its kind.
    #[serde(skip)]
    pub(crate) severity: f64,
}
