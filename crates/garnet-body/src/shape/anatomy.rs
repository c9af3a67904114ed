//! The measures of one body, complete, and where its joints lie.

use super::Measure;
use super::anthropometry::Dimension;
use super::measure::Measures;
use super::population_model::PopulationModel;
use super::primitives::Vec3;

/// The stature at which lengths of the recipe are stated, in metres.
pub(crate) const REFERENCE_STATURE: f64 = 1.75;

// Where joints lie against the landmarks of the measures, in metres at the reference stature. The
// tape finds the landmarks of a body by its joints.
pub(crate) const PELVIS_ABOVE_HIP_HEIGHT: f64 = 0.045;
pub(crate) const SPINE1_BELOW_WAIST: f64 = 0.010;
pub(crate) const SPINE3_ABOVE_CHEST: f64 = 0.025;
pub(crate) const COLLAR_BELOW_ACROMION: f64 = 0.012;
pub(crate) const HIP_ABOVE_CROTCH: f64 = 0.052;
pub(crate) const KNEE_BELOW_PATELLA: f64 = 0.008;
pub(crate) const SHOULDER_INSIDE_ACROMION: f64 = 0.024;
pub(crate) const UPPER_ARM_ABOVE_JOINT: f64 = 0.030;
/// How far the under-bust lies below the chest height, in statures.
pub(crate) const UNDER_BUST_DROP: f64 = 0.05;

/// How far the legs stand apart: the thigh from the vertical, in radians.
const THIGH_ABDUCTION: f64 = 0.145;
/// How far the legs stand apart: the shank from the vertical, in radians.
const SHANK_ABDUCTION: f64 = 0.095;
/// How far the arms hang from the vertical, in radians.
const ARM_ABDUCTION: f64 = 0.785;
/// How far the elbow is bent to the front in the rest pose, in radians.
const ELBOW_FLEXION: f64 = 0.16;

/// Factors on the girths (and an offset of the crotch) that make the finished mesh meet its
/// measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Corrections {
    girths: Measures,
    /// Added to the height of the crotch, in metres.
    pub(crate) crotch: f64,
}

impl Default for Corrections {
    fn default() -> Self {
        Self {
            girths: Measures::from_fn(|_| 1.0),
            crotch: 0.0,
        }
    }
}

impl std::ops::Index<Measure> for Corrections {
    type Output = f64;

    fn index(&self, measure: Measure) -> &f64 {
        &self.girths[measure]
    }
}

impl std::ops::IndexMut<Measure> for Corrections {
    fn index_mut(&mut self, measure: Measure) -> &mut f64 {
        &mut self.girths[measure]
    }
}

/// Joint positions of the middle and the left side; the right side is the mirror image.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Joints {
    pub(crate) pelvis: Vec3,
    pub(crate) spine: [Vec3; 3],
    pub(crate) neck: Vec3,
    pub(crate) head: Vec3,
    pub(crate) collar: Vec3,
    pub(crate) shoulder: Vec3,
    pub(crate) elbow: Vec3,
    pub(crate) wrist: Vec3,
    pub(crate) fingertip: Vec3,
    pub(crate) hip: Vec3,
    pub(crate) knee: Vec3,
    pub(crate) ankle: Vec3,
    pub(crate) foot: Vec3,
    pub(crate) toes: Vec3,
}

/// Everything that the shape of a body is made of.
#[derive(Debug, Clone)]
pub(crate) struct Anatomy {
    pub(crate) sex: f64,
    /// Stature over the reference stature.
    pub(crate) size: f64,
    /// What the tape shall measure, in metres.
    pub(crate) measures: Measures,
    pub(crate) corrections: Corrections,
    /// Of the head, in metres.
    pub(crate) head_girth: f64,
    pub(crate) hand_length: f64,
    pub(crate) foot_length: f64,
    pub(crate) cervicale_height: f64,
    pub(crate) upper_arm_length: f64,
    pub(crate) forearm_length: f64,
    pub(crate) waist_aspect: f64,
    pub(crate) hip_breadth: f64,
    pub(crate) joints: Joints,
}

impl Anatomy {
    /// The most likely body of a population that has been narrowed down to it.
    pub(crate) fn new(sex: f64, body: &PopulationModel, corrections: Corrections) -> Self {
        let measures = Measures::from_fn(|measure| body.measure(measure).0);
        let stature = measures[Measure::Stature];
        let upper = body.expected(Dimension::AcromionRadiale);
        let fore = body.expected(Dimension::RadialeStylion);
        // The arm length is met exactly; upper arm and forearm share it.
        let stretch = measures[Measure::ArmLength] / (upper + fore);
        let mut anatomy = Self {
            sex,
            size: stature / REFERENCE_STATURE,
            measures,
            corrections,
            head_girth: body.expected(Dimension::HeadCircumference),
            hand_length: body.expected(Dimension::HandLength),
            foot_length: body.expected(Dimension::FootLength),
            cervicale_height: body.expected(Dimension::CervicaleHeight),
            upper_arm_length: upper * stretch,
            forearm_length: fore * stretch,
            waist_aspect: body.expected(Dimension::WaistDepth)
                / body.expected(Dimension::WaistBreadth),
            hip_breadth: body.expected(Dimension::HipBreadth),
            joints: placeholder_joints(),
        };
        anatomy.joints = anatomy.placed_joints();
        anatomy
    }

    pub(crate) fn stature(&self) -> f64 {
        self.measures[Measure::Stature]
    }

    pub(crate) fn height(&self, measure: Measure) -> f64 {
        self.measures[measure]
    }

    /// The height of the crotch that the field is built for.
    pub(crate) fn crotch(&self) -> f64 {
        self.measures[Measure::Inseam] + self.corrections.crotch
    }

    /// The girth that the field is built for.
    pub(crate) fn girth(&self, measure: Measure) -> f64 {
        self.measures[measure] * self.corrections[measure]
    }

    /// The radius of a circle of that girth.
    pub(crate) fn radius(&self, measure: Measure) -> f64 {
        self.girth(measure) / std::f64::consts::TAU
    }

    /// The height at which the under-bust girth is taken.
    pub(crate) fn under_bust_height(&self) -> f64 {
        self.height(Measure::ChestHeight) - UNDER_BUST_DROP * self.stature()
    }

    /// Mixes a male and a female number.
    pub(crate) fn mix(&self, male: f64, female: f64) -> f64 {
        male + self.sex * (female - male)
    }

    /// The scale of the head: its girth over that of the mean man.
    pub(crate) fn head_size(&self) -> f64 {
        self.head_girth / 0.574
    }

    fn placed_joints(&self) -> Joints {
        let s = self.size;
        let stature = self.stature();
        let crotch = self.measures[Measure::Inseam];
        let waist = self.height(Measure::WaistHeight);
        let chest = self.height(Measure::ChestHeight);
        let acromion = self.height(Measure::ShoulderHeight);
        let hip_height = self.height(Measure::HipHeight);
        let head_height = stature - 0.150 * self.head_size();
        // A neck is never so short that no tape fits around it.
        let neck_base = (self.cervicale_height - 0.012 * s).min(head_height - 0.092 * s);

        let hip = Vec3::new(
            self.mix(0.0485, 0.0515) * stature,
            crotch + HIP_ABOVE_CROTCH * s,
            -0.006 * s,
        );
        let knee_height = self.height(Measure::KneeHeight) - KNEE_BELOW_PATELLA * s;
        let ankle_height = 0.076 * s;
        let knee = Vec3::new(
            hip.x + (hip.y - knee_height) * THIGH_ABDUCTION.tan(),
            knee_height,
            0.006 * s,
        );
        let ankle = Vec3::new(
            knee.x + (knee_height - ankle_height) * SHANK_ABDUCTION.tan(),
            ankle_height,
            -0.028 * s,
        );
        let foot_length = self.foot_length;
        let toes_out = Vec3::new(0.14, 0.0, 1.0).normalize();
        let mut foot = ankle + toes_out * (0.48 * foot_length);
        foot.y = 0.022 * s;
        let mut toes = ankle + toes_out * (0.74 * foot_length);
        toes.y = 0.012 * s;

        let half_breadth = 0.5 * self.measures[Measure::ShoulderBreadth];
        let shoulder = Vec3::new(
            half_breadth - SHOULDER_INSIDE_ACROMION * s,
            acromion - 0.046 * s,
            -0.022 * s,
        );
        // From the acromion to the elbow the arm's length is measured over the shoulder.
        let upper_arm = self.upper_arm_length - UPPER_ARM_ABOVE_JOINT * s;
        let (sin, cos) = ARM_ABDUCTION.sin_cos();
        let elbow = shoulder + upper_arm * Vec3::new(sin, -cos, -0.02).normalize();
        let bend = ELBOW_FLEXION.tan();
        let forward = Vec3::new(0.97 * sin, -1.03 * cos, bend).normalize();
        let wrist = elbow + self.forearm_length * forward;
        let fingertip = wrist + self.hand_length * forward;

        Joints {
            pelvis: Vec3::new(0.0, hip_height + PELVIS_ABOVE_HIP_HEIGHT * s, -0.012 * s),
            spine: [
                Vec3::new(0.0, waist - SPINE1_BELOW_WAIST * s, -0.022 * s),
                Vec3::new(0.0, 0.52 * waist + 0.48 * chest, -0.030 * s),
                Vec3::new(0.0, chest + SPINE3_ABOVE_CHEST * s, -0.042 * s),
            ],
            neck: Vec3::new(0.0, neck_base, -0.044 * s),
            head: Vec3::new(0.0, head_height, -0.012 * s),
            collar: Vec3::new(0.036 * s, acromion - COLLAR_BELOW_ACROMION * s, -0.020 * s),
            shoulder,
            elbow,
            wrist,
            fingertip,
            hip,
            knee,
            ankle,
            foot,
            toes,
        }
    }
}

fn placeholder_joints() -> Joints {
    let zero = Vec3::zeros();
    Joints {
        pelvis: zero,
        spine: [zero; 3],
        neck: zero,
        head: zero,
        collar: zero,
        shoulder: zero,
        elbow: zero,
        wrist: zero,
        fingertip: zero,
        hip: zero,
        knee: zero,
        ankle: zero,
        foot: zero,
        toes: zero,
    }
}
