//! The joint distribution of body dimensions, and what to expect of those that are not given.
//!
//! The logarithms of all dimensions are jointly normal about the mean of the sex, so a body of
//! which some measures are known has a most likely completion: the conditional mean. With the
//! observation matrix `H`, the known logarithms `y`, the mean `μ` and the covariance `Σ`:
//!
//! ```text
//! x = μ + Σ Hᵀ (H Σ Hᵀ)⁻¹ (y - H μ)
//! ```
//!
//! Two girths are not in the survey and are added as further variables:
//!
//! - Knee girth: the geometric mean of lower thigh and calf girth, scaled so that the mean is 0.99
//!   of the mean calf girth, spread 0.03 about that. An assumption: at the middle of the patella
//!   the leg is about as thick as at the calf.
//! - Under-bust girth: `chest^0.6 waist^0.4`, scaled so that the mean is 0.93 (men) or 0.86 (women)
//!   of the mean chest girth, spread 0.025 about that. An assumption too.
//!
//! The survey's upper arm and forearm girths are of the flexed arm; the hanging arm is taken as
//! 0.93 and 0.96 of them.

use nalgebra::{DMatrix, DVector};

use super::anthropometry::{Dimension, NUM_DIMENSIONS, ROWS, correlation};
use super::measure::Measure;

/// Relaxed over flexed girth of the upper arm; an assumption.
const RELAXED_UPPER_ARM: f64 = 0.93;
/// Relaxed over flexed girth of the forearm; an assumption.
const RELAXED_FOREARM: f64 = 0.96;

const KNEE: usize = NUM_DIMENSIONS;
const UNDER_BUST: usize = NUM_DIMENSIONS + 1;
const NUM_VARIABLES: usize = NUM_DIMENSIONS + 2;

/// Observed logarithms count as known to this spread.
const OBSERVATION_SPREAD: f64 = 1e-4;

/// A variable made of others: `scale · a^share_a · b^share_b`, with a spread of its own.
struct Derived {
    parts: [(Dimension, f64); 2],
    spread: f64,
    over: Dimension,
    /// Mean over the mean of `over`: men, women.
    ratio: [f64; 2],
}

const DERIVED: [Derived; 2] = [
    Derived {
        parts: [(Dimension::LowerThigh, 0.5), (Dimension::Calf, 0.5)],
        spread: 0.03,
        over: Dimension::Calf,
        ratio: [0.99, 0.99],
    },
    Derived {
        parts: [(Dimension::Chest, 0.6), (Dimension::Waist, 0.4)],
        spread: 0.025,
        over: Dimension::Chest,
        ratio: [0.93, 0.86],
    },
];

/// A known sum of logarithms: `Σ factor · ln variable = value`.
#[derive(Debug, Clone)]
pub(crate) struct Observation {
    factors: Vec<(usize, f64)>,
    value: f64,
}

/// The distribution for one sex value, 0 for men to 1 for women.
#[derive(Debug, Clone)]
pub(crate) struct PopulationModel {
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
}

impl PopulationModel {
    pub(crate) fn new(sex: f64) -> Self {
        let mix = |male: f64, female: f64| (1.0 - sex) * male.ln() + sex * female.ln();
        let mut mean = DVector::zeros(NUM_VARIABLES);
        let mut covariance = DMatrix::zeros(NUM_VARIABLES, NUM_VARIABLES);
        for (index, row) in ROWS.iter().enumerate() {
            mean[index] = mix(row.male, row.female);
            for (other, column) in ROWS.iter().enumerate() {
                covariance[(index, other)] =
                    correlation(index, other) * row.log_spread * column.log_spread;
            }
        }
        for (offset, derived) in DERIVED.iter().enumerate() {
            let index = NUM_DIMENSIONS + offset;
            mean[index] = mean[derived.over as usize] + mix(derived.ratio[0], derived.ratio[1]);
            for other in 0..index {
                let shared: f64 = derived
                    .parts
                    .iter()
                    .map(|&(part, share)| share * covariance[(part as usize, other)])
                    .sum();
                covariance[(index, other)] = shared;
                covariance[(other, index)] = shared;
            }
            let parts = derived.parts.iter();
            let variance: f64 = parts
                .map(|&(part, share)| share * covariance[(part as usize, index)])
                .sum();
            covariance[(index, index)] = variance + derived.spread.powi(2);
        }
        Self { mean, covariance }
    }

    /// What a measure says about the variables, as a function of its logarithm.
    fn factors(&self, measure: Measure) -> (Vec<(usize, f64)>, f64) {
        let one = |dimension: Dimension| (vec![(dimension as usize, 1.0)], 0.0);
        match measure {
            Measure::Stature => one(Dimension::Stature),
            Measure::Chest => one(Dimension::Chest),
            Measure::UnderBust => (vec![(UNDER_BUST, 1.0)], 0.0),
            Measure::Waist => one(Dimension::Waist),
            Measure::Hip => one(Dimension::Hip),
            Measure::Thigh => one(Dimension::Thigh),
            Measure::Knee => (vec![(KNEE, 1.0)], 0.0),
            Measure::Calf => one(Dimension::Calf),
            Measure::Ankle => one(Dimension::Ankle),
            Measure::UpperArm => (
                vec![(Dimension::FlexedBiceps as usize, 1.0)],
                RELAXED_UPPER_ARM.ln(),
            ),
            Measure::Forearm => (
                vec![(Dimension::FlexedForearm as usize, 1.0)],
                RELAXED_FOREARM.ln(),
            ),
            Measure::Wrist => one(Dimension::Wrist),
            Measure::Neck => one(Dimension::Neck),
            Measure::ShoulderBreadth => one(Dimension::BiacromialBreadth),
            Measure::ArmLength => self.arm_length(),
            Measure::Inseam => one(Dimension::CrotchHeight),
            Measure::ShoulderHeight => one(Dimension::AcromialHeight),
            Measure::ChestHeight => one(Dimension::ChestHeight),
            Measure::WaistHeight => one(Dimension::WaistHeight),
            Measure::HipHeight => one(Dimension::ButtockHeight),
            Measure::KneeHeight => one(Dimension::KneeHeight),
        }
    }

    /// The logarithm of the sum of upper arm and forearm, to first order about the mean.
    fn arm_length(&self) -> (Vec<(usize, f64)>, f64) {
        let parts =
            [Dimension::AcromionRadiale, Dimension::RadialeStylion].map(|part| part as usize);
        let lengths = parts.map(|part| self.mean[part].exp());
        let sum = lengths[0] + lengths[1];
        let factors: Vec<(usize, f64)> = (0..2)
            .map(|part| (parts[part], lengths[part] / sum))
            .collect();
        let linear: f64 = factors
            .iter()
            .map(|&(part, share)| share * self.mean[part])
            .sum();
        (factors, sum.ln() - linear)
    }

    /// The observation that `measure` is `value`, in metres.
    pub(crate) fn observation(&self, measure: Measure, value: f64) -> Observation {
        let (factors, offset) = self.factors(measure);
        Observation {
            factors,
            value: value.ln() - offset,
        }
    }

    /// The observation that mass over squared stature is `bmi`, in kg/m².
    pub(crate) fn bmi_observation(bmi: f64) -> Observation {
        Observation {
            factors: vec![
                (Dimension::Mass as usize, 1.0),
                (Dimension::Stature as usize, -2.0),
            ],
            value: bmi.ln(),
        }
    }

    /// The distribution once `observations` are known.
    pub(crate) fn given(&self, observations: &[Observation]) -> Self {
        if observations.is_empty() {
            return self.clone();
        }
        let mut observed = DMatrix::zeros(observations.len(), NUM_VARIABLES);
        let mut difference = DVector::zeros(observations.len());
        for (row, observation) in observations.iter().enumerate() {
            difference[row] = observation.value;
            for &(variable, factor) in &observation.factors {
                observed[(row, variable)] += factor;
                difference[row] -= factor * self.mean[variable];
            }
        }
        let crossed = &self.covariance * observed.transpose();
        let mut inner = &observed * &crossed;
        for row in 0..observations.len() {
            inner[(row, row)] += OBSERVATION_SPREAD.powi(2);
        }
        let factor = inner
            .cholesky()
            .expect("a covariance plus a positive diagonal is positive definite");
        let mean = &self.mean + &crossed * factor.solve(&difference);
        let covariance = &self.covariance - &crossed * factor.solve(&crossed.transpose());
        Self { mean, covariance }
    }

    /// The most likely value of a dimension, in metres (kilograms for the mass).
    pub(crate) fn expected(&self, dimension: Dimension) -> f64 {
        self.mean[dimension as usize].exp()
    }

    /// The most likely value of a measure, in metres, and the standard deviation of its logarithm.
    pub(crate) fn measure(&self, measure: Measure) -> (f64, f64) {
        let (factors, offset) = self.factors(measure);
        let mean: f64 = factors
            .iter()
            .map(|&(part, share)| share * self.mean[part])
            .sum();
        let mut variance = 0.0;
        for &(a, share_a) in &factors {
            for &(b, share_b) in &factors {
                variance += share_a * share_b * self.covariance[(a, b)];
            }
        }
        ((mean + offset).exp(), variance.max(0.0).sqrt())
    }

    /// A body drawn from the distribution: `normals` are independent standard normal numbers.
    pub(crate) fn drawn(&self, normals: &[f64]) -> Self {
        let factor = self
            .covariance
            .clone()
            .cholesky()
            .expect("the covariance of the population is positive definite");
        let normals = DVector::from_column_slice(&normals[..NUM_VARIABLES]);
        Self {
            mean: &self.mean + factor.l() * normals,
            covariance: DMatrix::zeros(NUM_VARIABLES, NUM_VARIABLES),
        }
    }

    /// Mass over squared stature, in kg/m².
    pub(crate) fn bmi(&self) -> f64 {
        self.expected(Dimension::Mass) / self.expected(Dimension::Stature).powi(2)
    }

    /// How many numbers [`PopulationModel::drawn`] takes.
    pub(crate) const NUM_NORMALS: usize = NUM_VARIABLES;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Measured values come back to this relative accuracy.
    const ROUNDING: f64 = 1e-3;

    #[test]
    fn known_measures_are_kept_and_others_follow() {
        let men = PopulationModel::new(0.0);
        let known = [
            men.observation(Measure::Stature, 1.90),
            men.observation(Measure::Waist, 1.10),
            men.observation(Measure::ArmLength, 0.65),
        ];
        let tall = men.given(&known);
        for (measure, value) in [
            (Measure::Stature, 1.90),
            (Measure::Waist, 1.10),
            (Measure::ArmLength, 0.65),
        ] {
            approx::assert_relative_eq!(tall.measure(measure).0, value, max_relative = ROUNDING);
        }
        assert!(tall.measure(Measure::Inseam).0 > men.measure(Measure::Inseam).0);
        assert!(tall.measure(Measure::Hip).0 > men.measure(Measure::Hip).0);
        assert!(tall.measure(Measure::Waist).1 < ROUNDING);
    }

    #[test]
    fn body_mass_index_is_the_ratio_asked_for() {
        let women = PopulationModel::new(1.0);
        let heavy = women.given(&[PopulationModel::bmi_observation(33.0)]);
        let stature = heavy.expected(Dimension::Stature);
        let bmi = heavy.expected(Dimension::Mass) / stature.powi(2);
        approx::assert_relative_eq!(bmi, 33.0, max_relative = ROUNDING);
        assert!(heavy.measure(Measure::Waist).0 > women.measure(Measure::Waist).0 * 1.1);
    }
}
