//! The arguments of `body`.

use std::path::PathBuf;

use clap::Args;

use crate::motion::{MotionArgs, POSES};
use garnet::{
    body::shape::{BodyParameters, Measure},
    io::PoseSource,
};

use crate::rig_args::{PoseUp, RigArgs};

/// Arguments of `body`.
#[derive(Debug, Args)]
#[command(after_long_help = LONG_HELP)]
pub(crate) struct BodyArgs {
    /// A body of your own instead of the built-in one: GLB or `*.rig.npz`, or an OBJ with its rig.
    #[arg(value_name = "BODY", conflicts_with_all = ["sample", "sex", "bmi", "Measures"])]
    pub(crate) own: Option<PathBuf>,
    /// Skeleton and weights of BODY [default: `<body>.rig.npz` beside it].
    #[arg(long, value_name = "FILE", requires = "own")]
    pub(crate) rig: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) rig_args: RigArgs,
    /// Axis that points up in a motion.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "AXIS",
        default_value = "auto",
        allow_hyphen_values = true
    )]
    pub(crate) pose_up: PoseUp,
    /// Where the OBJ goes, with `<name>.rig.npz` beside it; a folder for several, or if it ends
    /// with `/`.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// From 0 (male) to 1 (female), or `male` or `female` [default: 0.5].
    #[arg(long, value_name = "SEX", value_parser = sex, allow_negative_numbers = true)]
    pub(crate) sex: Option<f64>,
    /// Body mass index, in kg/m².
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub(crate) bmi: Option<f64>,
    /// Draw this many bodies from the population instead.
    #[arg(long, value_name = "N", conflicts_with_all = ["sex", "bmi", "Measures"],
          value_parser = clap::value_parser!(u32).range(1..=1_000_000), allow_negative_numbers = true)]
    pub(crate) sample: Option<u32>,
    /// Named seed of the draws.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "S",
        default_value = "0",
        requires = "sample",
        allow_negative_numbers = true
    )]
    pub(crate) seed: u64,
    /// A pose of the library, or a file: pose JSON, BVH, npz as in AMASS, or GLB with an animation.
    #[arg(long, help_heading = POSES, value_name = "NAME|FILE[:CLIP][:FRAMES]")]
    pub(crate) pose: Option<PoseSource>,
    /// A motion: BVH, npz as in AMASS, GLB with an animation, or pose JSON with frames.
    #[arg(long, help_heading = POSES, value_name = "FILE", conflicts_with = "pose")]
    pub(crate) motion: Option<PathBuf>,
    /// Frames of the motion, from 0, without END [default: all].
    #[arg(
        long,
        help_heading = POSES,
        hide_short_help = true,
        value_name = "FIRST:END:STEP",
        requires = "motion",
        allow_negative_numbers = true
    )]
    pub(crate) frames: Option<garnet::body::motion::FrameRange>,
    #[command(flatten)]
    pub(crate) placing: MotionArgs,
    /// Write the coarse level of the built-in body, of a quarter of its vertices.
    #[arg(long, hide_short_help = true, conflicts_with = "own")]
    pub(crate) coarse: bool,
    #[command(flatten)]
    pub(crate) measures: MeasureArgs,
}

const LONG_HELP: &str = "\
What is not given follows from what is, by the statistics of ANSUR II (Gordon et al. 2014).
With --pose or --motion the OBJ is posed, and the rig beside it holds the body at rest, so that \
`garnet drape GARMENT OUT` knows both. `garnet poses` lists the poses of the library.";

/// Measures, in centimetres.
#[derive(Debug, Args)]
#[group(id = "Measures", multiple = true)]
#[command(next_help_heading = "Measures in centimetres")]
pub(crate) struct MeasureArgs {
    /// Height of the body.
    #[arg(long, value_name = "CM", allow_negative_numbers = true)]
    stature: Option<f64>,
    /// Girth at the height of the nipples.
    #[arg(long, value_name = "CM", allow_negative_numbers = true)]
    chest: Option<f64>,
    /// Girth under the bust.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    under_bust: Option<f64>,
    /// Girth at the height of the navel.
    #[arg(long, value_name = "CM", allow_negative_numbers = true)]
    waist: Option<f64>,
    /// Largest girth over the buttocks.
    #[arg(long, value_name = "CM", allow_negative_numbers = true)]
    hip: Option<f64>,
    /// Girth of the thigh below the crotch.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    thigh: Option<f64>,
    /// Girth at the knee joint.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    knee: Option<f64>,
    /// Girth of the calf.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    calf: Option<f64>,
    /// Girth above the ankle.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    ankle: Option<f64>,
    /// Girth of the relaxed upper arm.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    upper_arm: Option<f64>,
    /// Girth of the forearm.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    forearm: Option<f64>,
    /// Girth of the wrist.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    wrist: Option<f64>,
    /// Girth of the neck.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    neck: Option<f64>,
    /// Breadth between the bony tips of the shoulders.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    shoulder_breadth: Option<f64>,
    /// Length from the tip of the shoulder to the wrist.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    arm_length: Option<f64>,
    /// Height of the crotch.
    #[arg(long, value_name = "CM", allow_negative_numbers = true)]
    inseam: Option<f64>,
    /// Height of the tips of the shoulders.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    shoulder_height: Option<f64>,
    /// Height of the nipples.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    chest_height: Option<f64>,
    /// Height of the navel.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    waist_height: Option<f64>,
    /// Height of the greatest protrusion of the buttocks.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    hip_height: Option<f64>,
    /// Height of the knee.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "CM",
        allow_negative_numbers = true
    )]
    knee_height: Option<f64>,
}

impl BodyArgs {
    /// What is known of the body.
    pub(crate) fn parameters(&self) -> BodyParameters {
        let mut parameters = BodyParameters::new(self.sex.unwrap_or(0.5));
        if let Some(bmi) = self.bmi {
            parameters = parameters.with_bmi(bmi);
        }
        for (measure, centimetres) in self.measures.given() {
            parameters = parameters.with(measure, 0.01 * centimetres);
        }
        parameters
    }
}

impl MeasureArgs {
    /// The measures that are given, in centimetres.
    fn given(&self) -> impl Iterator<Item = (Measure, f64)> {
        let all = [
            (Measure::Stature, self.stature),
            (Measure::Chest, self.chest),
            (Measure::UnderBust, self.under_bust),
            (Measure::Waist, self.waist),
            (Measure::Hip, self.hip),
            (Measure::Thigh, self.thigh),
            (Measure::Knee, self.knee),
            (Measure::Calf, self.calf),
            (Measure::Ankle, self.ankle),
            (Measure::UpperArm, self.upper_arm),
            (Measure::Forearm, self.forearm),
            (Measure::Wrist, self.wrist),
            (Measure::Neck, self.neck),
            (Measure::ShoulderBreadth, self.shoulder_breadth),
            (Measure::ArmLength, self.arm_length),
            (Measure::Inseam, self.inseam),
            (Measure::ShoulderHeight, self.shoulder_height),
            (Measure::ChestHeight, self.chest_height),
            (Measure::WaistHeight, self.waist_height),
            (Measure::HipHeight, self.hip_height),
            (Measure::KneeHeight, self.knee_height),
        ];
        all.into_iter()
            .filter_map(|(measure, value)| Some((measure, value?)))
    }
}

fn sex(text: &str) -> Result<f64, String> {
    match text {
        "male" => Ok(0.0),
        "female" => Ok(1.0),
        _ => match text.parse::<f64>() {
            Ok(sex) if (0.0..=1.0).contains(&sex) => Ok(sex),
            _ => {
                Err("expected a number from 0 (male) to 1 (female), `male` or `female`".to_owned())
            }
        },
    }
}
