//! Random bodies.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::population_model::PopulationModel;
use super::{BodyParameters, Measure, ParametricBody};

/// Statures that are drawn, in metres.
pub const SAMPLED_STATURES: [f64; 2] = [1.50, 1.95];

/// Body mass indices that are drawn, in kg/m².
pub const SAMPLED_BMI: [f64; 2] = [17.0, 36.0];

/// Draws are repeated until one fits; this many never all fail.
const MAX_DRAWS: usize = 2000;

/// A waist that is narrower beside the hip than this cannot always be built: whether it can is
/// tried.
const SAFE_HIP_OVER_WAIST: f64 = 1.32;

/// The measures that a random body is given.
const DRAWN: [Measure; 15] = [
    Measure::Stature,
    Measure::Chest,
    Measure::UnderBust,
    Measure::Waist,
    Measure::Hip,
    Measure::Thigh,
    Measure::Calf,
    Measure::Ankle,
    Measure::UpperArm,
    Measure::Forearm,
    Measure::Wrist,
    Measure::Neck,
    Measure::ShoulderBreadth,
    Measure::ArmLength,
    Measure::Inseam,
];

/// The population of both sexes, from which bodies are drawn.
///
/// Every other body is a woman. All dimensions are drawn together from their joint distribution, so
/// that slim and heavy bodies, long legs, broad shoulders, narrow waists and wide hips come as
/// often as they do; statures outside 1.50-1.95 m and body mass indices outside 17-36 are drawn
/// again.
///
/// Body `i` of a seed does not depend on how many are drawn, nor on the order.
///
/// ```
/// use garnet_body::shape::Population;
///
/// let population = Population::new(7);
/// assert_eq!(population.sample(3), population.sample(3));
/// assert_ne!(population.sample(3), population.sample(5));
/// ```
#[derive(Debug, Clone)]
pub struct Population {
    seed: u64,
    models: [PopulationModel; 2],
}

impl Population {
    /// The population, numbered by a seed.
    pub fn new(seed: u64) -> Self {
        Self {
            seed,
            models: [0.0, 1.0].map(PopulationModel::new),
        }
    }

    /// The parameters of the body of this number.
    ///
    /// # Panics
    ///
    /// Never: one of many draws lies within the limits.
    pub fn sample(&self, index: u64) -> BodyParameters {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        random.set_stream(index);
        let sex = (index % 2) as usize;
        let model = &self.models[sex];
        for _ in 0..MAX_DRAWS {
            let normals: Vec<f64> = (0..PopulationModel::NUM_NORMALS)
                .map(|_| standard_normal(&mut random))
                .collect();
            let drawn = model.drawn(&normals);
            let (stature, _) = drawn.measure(Measure::Stature);
            let bmi = drawn.bmi();
            let [shortest, tallest] = SAMPLED_STATURES;
            let [slimmest, heaviest] = SAMPLED_BMI;
            if !(shortest..=tallest).contains(&stature) || !(slimmest..=heaviest).contains(&bmi) {
                continue;
            }
            let mut parameters = BodyParameters::new(sex as f64).with_bmi(bmi);
            for measure in DRAWN {
                parameters = parameters.with(measure, drawn.measure(measure).0);
            }
            let slenderness = drawn.measure(Measure::Hip).0 / drawn.measure(Measure::Waist).0;
            let is_possible = if slenderness > SAFE_HIP_OVER_WAIST {
                ParametricBody::build(&parameters).is_ok()
            } else {
                parameters.check().is_ok()
            };
            if is_possible {
                return parameters;
            }
        }
        unreachable!("one of many draws lies within the limits")
    }
}

/// A standard normal number: Box and Muller 1958.
fn standard_normal(random: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.random::<f64>()).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawn_bodies_keep_within_the_limits_and_differ() {
        let population = Population::new(1);
        let mut slim = 0;
        let mut heavy = 0;
        for index in 0..200 {
            let body = population.sample(index);
            assert!(body.check().is_ok());
            let stature = body.measure(Measure::Stature).unwrap();
            assert!((1.50..=1.95).contains(&stature));
            let bmi = body.bmi().unwrap();
            assert!((17.0..=36.0).contains(&bmi));
            slim += i32::from(bmi < 21.0);
            heavy += i32::from(bmi > 31.0);
        }
        assert!(slim > 3 && heavy > 3);
    }
}
