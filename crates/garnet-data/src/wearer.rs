//! A body as a tailor knows it.

use garnet_body::shape::{BodyParameters, Measure, Measures, standing, tape_measures};
use garnet_drape::GarmentPackage;

use garnet_pattern::{
    Landmarks, Measures as TailorMeasures, Parameters, PatternError, Size, Wearer,
};
use garnet_skin::Body;

use crate::{DataError, Tailor};

/// Measures and landmarks of a built-in body at rest, in the frame of built-in bodies wherever it
/// stands and faces; none for bodies of another topology.
///
/// # Errors
///
/// [`PatternError::BadWearer`] if a joint is missing.
pub fn wearer_of(body: &Body) -> Option<Result<Wearer, PatternError>> {
    let measures = tape_measures(body)?;
    let standing = standing(body);
    let body = standing.as_ref().map_or(body, |(body, _)| body);
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

/// Whom the template of a package fits.
#[derive(Debug, Clone)]
pub(crate) struct Fitting {
    parameters: Parameters,
    cut: TailorMeasures,
    rest: TailorMeasures,
}

impl Fitting {
    /// Of a package that was made from a pattern; a garment without pattern fits everybody.
    pub(crate) fn of_package(package: &GarmentPackage) -> Result<Option<Self>, DataError> {
        let Some(tailor) = Tailor::of_package(package)? else {
            return Ok(None);
        };
        let Some(wearer) = wearer_of(&package.body) else {
            return Ok(None);
        };
        let rest = wearer?.measures;
        let sized = tailor.size().map(Size::measures);
        Ok(Some(Self {
            parameters: tailor.parameters().clone(),
            cut: sized.unwrap_or(rest),
            rest,
        }))
    }

    /// Whether it fits a body that is not yet built: by the measures that its parameters give, the
    /// others being those of the rest body at its stature.
    pub(crate) fn fits(&self, parameters: &BodyParameters) -> bool {
        let stature = parameters.measure(Measure::Stature);
        let scale = stature.map_or(1.0, |stature| stature / self.rest.stature);
        let given =
            |measure: Measure, rest: f64| parameters.measure(measure).unwrap_or(scale * rest);
        let rest = &self.rest;
        let measures = TailorMeasures {
            stature: given(Measure::Stature, rest.stature),
            chest: given(Measure::Chest, rest.chest),
            waist: given(Measure::Waist, rest.waist),
            hip: given(Measure::Hip, rest.hip),
            thigh: given(Measure::Thigh, rest.thigh),
            knee: given(Measure::Knee, rest.knee),
            inseam: given(Measure::Inseam, rest.inseam),
            neck_height: scale * rest.neck_height,
            chest_height: given(Measure::ChestHeight, rest.chest_height),
            waist_height: given(Measure::WaistHeight, rest.waist_height),
            hip_height: given(Measure::HipHeight, rest.hip_height),
            ..*rest
        };
        self.parameters.fit(&self.cut, &measures).fits()
    }
}
