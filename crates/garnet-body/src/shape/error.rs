//! What can be wrong with the measures of a body.

use super::Measure;

/// The next tenth at or above a bound (`side` 1), or at or below it (-1): what is printed is
/// allowed.
fn within(bound: f64, side: f64) -> f64 {
    side * (side * bound * 10.0).ceil() / 10.0
}

/// Why a body cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A measure is not a number, or no body of this sex and stature has it.
    #[error(
        "{measure} of `{value_cm:.1}` cm is not possible for this body, which allows {:.1} to {:.1} cm", within(*low_cm, 1.0), within(*high_cm, -1.0)
    )]
    MeasureOutOfRange {
        /// The measure.
        measure: Measure,
        /// Its value, in centimetres.
        value_cm: f64,
        /// The smallest value that the body allows, in centimetres.
        low_cm: f64,
        /// The largest value that the body allows, in centimetres.
        high_cm: f64,
    },

    /// The sex is not a number from 0 (male) to 1 (female).
    #[error("sex of `{value}` is not between 0 (male) and 1 (female)")]
    SexOutOfRange {
        /// What was given.
        value: f64,
    },

    /// The body mass index is not a number, or outside the range in which the shape holds.
    #[error("body mass index of `{value:.1}` kg/m² is not between {low:.0} and {high:.0}")]
    BmiOutOfRange {
        /// What was given, in kg/m².
        value: f64,
        /// The smallest allowed, in kg/m².
        low: f64,
        /// The largest allowed, in kg/m².
        high: f64,
    },

    /// The measures are possible one by one, but no body has them together.
    #[error(
        "{measure} of `{value_cm:.1}` cm does not fit the other measures: the closest this body comes is {closest_cm:.1} cm"
    )]
    MeasuresConflict {
        /// The measure that could not be met.
        measure: Measure,
        /// What was asked for, in centimetres.
        value_cm: f64,
        /// What came closest, in centimetres.
        closest_cm: f64,
    },

    /// The skin of the body runs through itself, and could not be freed of that.
    #[error(
        "the skin of this body runs through itself (pairs of faces: {pairs}), mostly where its measures contradict each other"
    )]
    SelfIntersecting {
        /// How many pairs of faces intersect.
        pairs: usize,
    },
}
