//! What is known of a body, and the completion of the rest from the population.

use super::population_model::{Observation, PopulationModel};
use super::{Measure, ShapeError};

/// Body mass indices in which the shape holds, in kg/m².
pub const BMI_RANGE: [f64; 2] = [15.0, 40.0];

/// Statures in which the shape holds, in metres.
pub const STATURE_RANGE: [f64; 2] = [1.40, 2.10];

/// A measure may differ from what sex and stature let expect by this many standard deviations of
/// its logarithm.
const MAX_DEVIATIONS: f64 = 3.5;

/// And from what all other given measures let expect by this many.
const MAX_DEVIATIONS_FROM_REST: f64 = 5.0;

/// What is known of a body; everything else follows from the statistics of the population.
///
/// ```
/// use garnet_body::shape::{BodyParameters, Measure};
///
/// let parameters = BodyParameters::new(1.0)
///     .with(Measure::Stature, 1.68)
///     .with(Measure::Waist, 0.72)
///     .with(Measure::Hip, 0.98);
/// assert_eq!(parameters.measure(Measure::Waist), Some(0.72));
/// assert!(parameters.check().is_ok());
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct BodyParameters {
    sex: f64,
    bmi: Option<f64>,
    measures: [Option<f64>; Measure::COUNT],
}

impl BodyParameters {
    /// The mean body of a sex: 0 is male, 1 is female, values between are between.
    pub fn new(sex: f64) -> Self {
        Self {
            sex,
            bmi: None,
            measures: [None; Measure::COUNT],
        }
    }

    /// Sets a measure, in metres.
    #[must_use]
    pub fn with(mut self, measure: Measure, value: f64) -> Self {
        self.measures[measure as usize] = Some(value);
        self
    }

    /// Sets the body mass index, in kg/m².
    #[must_use]
    pub fn with_bmi(mut self, bmi: f64) -> Self {
        self.bmi = Some(bmi);
        self
    }

    /// The sex, 0 for male to 1 for female.
    pub fn sex(&self) -> f64 {
        self.sex
    }

    /// The body mass index in kg/m², if it is set.
    pub fn bmi(&self) -> Option<f64> {
        self.bmi
    }

    /// A measure in metres, if it is set.
    pub fn measure(&self, measure: Measure) -> Option<f64> {
        self.measures[measure as usize]
    }

    /// The measures that are set, in metres.
    pub fn given(&self) -> impl Iterator<Item = (Measure, f64)> + '_ {
        Measure::ALL
            .into_iter()
            .filter_map(|measure| Some((measure, self.measure(measure)?)))
    }

    /// Whether a girth is set.
    pub fn has_girth(&self) -> bool {
        self.given().any(|(measure, _)| measure.is_girth())
    }

    /// Checks that a body can have these values.
    ///
    /// # Errors
    ///
    /// [`ShapeError::SexOutOfRange`], [`ShapeError::BmiOutOfRange`] or
    /// [`ShapeError::MeasureOutOfRange`].
    pub fn check(&self) -> Result<(), ShapeError> {
        if !(0.0..=1.0).contains(&self.sex) {
            return Err(ShapeError::SexOutOfRange { value: self.sex });
        }
        let [low, high] = BMI_RANGE;
        if let Some(value) = self.bmi.filter(|bmi| !(low..=high).contains(bmi)) {
            return Err(ShapeError::BmiOutOfRange { value, low, high });
        }
        let population = PopulationModel::new(self.sex);
        if let Some(stature) = self.measure(Measure::Stature) {
            within(Measure::Stature, stature, STATURE_RANGE)?;
        }
        let of_stature = population
            .given(&self.observations(&population, |measure| measure == Measure::Stature));
        for (measure, value) in self
            .given()
            .filter(|&(measure, _)| measure != Measure::Stature)
        {
            within(measure, value, range(&of_stature, measure, MAX_DEVIATIONS))?;
        }
        for (measure, value) in self
            .given()
            .filter(|&(measure, _)| measure != Measure::Stature)
        {
            let mut rest = self.observations(&population, |other| other != measure);
            rest.extend(self.bmi.map(PopulationModel::bmi_observation));
            let [low, high] = range(&population.given(&rest), measure, MAX_DEVIATIONS_FROM_REST);
            let [floor, ceiling] = range(&of_stature, measure, MAX_DEVIATIONS);
            within(measure, value, [low.max(floor), high.min(ceiling)])?;
        }
        Ok(())
    }

    fn observations(
        &self,
        population: &PopulationModel,
        is_used: impl Fn(Measure) -> bool,
    ) -> Vec<Observation> {
        self.given()
            .filter(|&(measure, _)| is_used(measure))
            .map(|(measure, value)| population.observation(measure, value))
            .collect()
    }

    /// The population, given what is known of this body and a body mass index in place of its own.
    pub(crate) fn completed(&self, bmi: Option<f64>) -> PopulationModel {
        let population = PopulationModel::new(self.sex);
        let mut known = self.observations(&population, |_| true);
        known.extend(bmi.map(PopulationModel::bmi_observation));
        population.given(&known)
    }
}

/// The values of a measure within so many standard deviations, in metres.
fn range(population: &PopulationModel, measure: Measure, deviations: f64) -> [f64; 2] {
    let (expected, spread) = population.measure(measure);
    // Rounding of a typed value must not make a measure impossible that the others fix exactly.
    let factor = (deviations * spread.max(0.01)).exp();
    [expected / factor, expected * factor]
}

fn within(measure: Measure, value: f64, [low, high]: [f64; 2]) -> Result<(), ShapeError> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(ShapeError::MeasureOutOfRange {
        measure,
        value_cm: 100.0 * value,
        low_cm: 100.0 * low,
        high_cm: 100.0 * high,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(parameters: &BodyParameters) -> String {
        parameters.check().unwrap_err().to_string()
    }

    #[test]
    fn impossible_values_are_refused_with_the_range() {
        let woman = BodyParameters::new(1.0).with(Measure::Stature, 1.65);
        let text = refused(&woman.clone().with(Measure::Waist, 3.0));
        assert!(
            text.starts_with("waist of `300.0` cm is not possible"),
            "{text}"
        );
        assert!(refused(&woman.clone().with(Measure::Wrist, -0.1)).contains("wrist of `-10.0`"));
        assert!(refused(&woman.clone().with(Measure::Hip, f64::NAN)).contains("hip of `NaN`"));
        assert!(refused(&woman.clone().with_bmi(90.0)).contains("between 15 and 40"));
        assert!(refused(&BodyParameters::new(f64::NAN)).contains("sex of `NaN`"));
        assert!(
            refused(&BodyParameters::new(0.0).with(Measure::Stature, 17.5)).contains("stature")
        );
        assert!(woman.with(Measure::Waist, 0.8).check().is_ok());
    }

    #[test]
    fn bounds_that_are_printed_are_allowed() {
        for (sex, stature) in [(0.0, 1.78), (1.0, 1.65), (0.3, 1.912)] {
            let body = BodyParameters::new(sex).with(Measure::Stature, stature);
            for measure in [Measure::Chest, Measure::Hip, Measure::Thigh, Measure::Calf] {
                let text = refused(&body.clone().with(measure, 9.0));
                let bounds = text.split("which allows ").nth(1).unwrap();
                let mut bounds = bounds.trim_end_matches(" cm").split(" to ");
                for _ in 0..2 {
                    let bound: f64 = bounds.next().unwrap().parse().unwrap();
                    let allowed = body.clone().with(measure, bound / 100.0).check();
                    assert_eq!(allowed, Ok(()), "{text}");
                }
            }
        }
    }

    #[test]
    fn a_measure_that_contradicts_the_others_is_refused() {
        let slim = BodyParameters::new(0.0)
            .with(Measure::Stature, 1.80)
            .with_bmi(18.0)
            .with(Measure::Waist, 1.35);
        assert!(refused(&slim).starts_with("waist of `135.0` cm"));
    }
}
