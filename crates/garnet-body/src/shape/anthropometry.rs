//! Body dimensions of the US Army survey ANSUR II: means, spreads and correlations.
//!
//! Source: C. C. Gordon et al., *2012 Anthropometric Survey of U.S. Army Personnel: Methods and
//! Summary Statistics*, NATICK/TR-15/007, 2014, and its public working databases (4,082 men, 1,986
//! women, 93 dimensions, lengths in millimetres). The names in the docs of [`Dimension`] are the
//! column names there.
//!
//! How the numbers of this file were computed:
//!
//! - **Means.** Of 18 dimensions over the whole survey (stature; chest, waist, buttock, thigh,
//!   calf, neck, head, flexed biceps and flexed forearm circumference; biacromial and hip breadth;
//!   chest depth; radiale-stylion length; acromial, cervicale, waist and mid-patella height). The
//!   other 14 by regression on those 18 within the sample below, which is what the survey's mean
//!   would be if the sample's regressions hold.
//! - **Spread and correlation** of the logarithms, about the mean of each sex and pooled over both:
//!   from a sample of 60 records: one run of 28 women and one of 32 men, each with a few records
//!   skipped (58 degrees of freedom). The correlations are shrunk by 0.92 towards zero, so that no
//!   conditional mean leans on noise. The standard error of a correlation of 0.5 is 0.1.
//!
//! Checks against the whole survey's 1st and 99th percentiles: buttock circumference has a spread
//! of 0.071 (women) and 0.075 (men) there and 0.072 here, calf 0.080 and 0.075 against 0.065, ankle
//! 0.070 and 0.066 against 0.052, wrist 0.050 and 0.051 against 0.045.
//!
//! ANSUR II measures flexed arms and has neither a knee nor an under-bust girth. What is assumed
//! for those stands at [`super::population_model`].

/// A dimension of the survey.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dimension {
    /// weightkg
    Mass,
    /// stature
    Stature,
    /// neckcircumference
    Neck,
    /// chestcircumference
    Chest,
    /// waistcircumference, at the navel (omphalion)
    Waist,
    /// buttockcircumference
    Hip,
    /// thighcircumference, at the gluteal furrow
    Thigh,
    /// lowerthighcircumference, above the patella
    LowerThigh,
    /// calfcircumference
    Calf,
    /// anklecircumference
    Ankle,
    /// bicepscircumferenceflexed
    FlexedBiceps,
    /// forearmcircumferenceflexed
    FlexedForearm,
    /// wristcircumference
    Wrist,
    /// biacromialbreadth
    BiacromialBreadth,
    /// acromialheight
    AcromialHeight,
    /// chestheight
    ChestHeight,
    /// waistheightomphalion
    WaistHeight,
    /// buttockheight
    ButtockHeight,
    /// crotchheight
    CrotchHeight,
    /// kneeheightmidpatella
    KneeHeight,
    /// acromionradialelength
    AcromionRadiale,
    /// radialestylionlength
    RadialeStylion,
    /// handlength
    HandLength,
    /// footlength
    FootLength,
    /// headcircumference
    HeadCircumference,
    /// cervicaleheight
    CervicaleHeight,
    /// chestbreadth
    ChestBreadth,
    /// chestdepth
    ChestDepth,
    /// waistbreadth
    WaistBreadth,
    /// waistdepth
    WaistDepth,
    /// hipbreadth
    HipBreadth,
    /// buttockdepth
    ButtockDepth,
}

/// How many dimensions are taken from the survey.
pub(crate) const NUM_DIMENSIONS: usize = 32;

/// One dimension's statistics.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row {
    #[cfg_attr(
        not(test),
        expect(dead_code, reason = "names the row; a test holds the order")
    )]
    pub(crate) dimension: Dimension,
    /// Mean of men, in metres (kilograms for the mass).
    pub(crate) male: f64,
    /// Mean of women, in metres (kilograms for the mass).
    pub(crate) female: f64,
    /// Standard deviation of the logarithm within a sex.
    pub(crate) log_spread: f64,
}

impl Row {
    const fn new(dimension: Dimension, male: f64, female: f64, log_spread: f64) -> Self {
        Self {
            dimension,
            male,
            female,
            log_spread,
        }
    }
}

/// Means and spreads, in the order of [`Dimension`].
pub(crate) const ROWS: [Row; NUM_DIMENSIONS] = [
    Row::new(Dimension::Mass, 84.6, 67.6, 0.1449),
    Row::new(Dimension::Stature, 1.7562, 1.6285, 0.0356),
    Row::new(Dimension::Neck, 0.3976, 0.3298, 0.0560),
    Row::new(Dimension::Chest, 1.0587, 0.9469, 0.0840),
    Row::new(Dimension::Waist, 0.9406, 0.8609, 0.1226),
    Row::new(Dimension::Hip, 1.0195, 1.0212, 0.0722),
    Row::new(Dimension::Thigh, 0.6251, 0.6161, 0.0903),
    Row::new(Dimension::LowerThigh, 0.4120, 0.3865, 0.0707),
    Row::new(Dimension::Calf, 0.3923, 0.3733, 0.0645),
    Row::new(Dimension::Ankle, 0.2289, 0.2129, 0.0520),
    Row::new(Dimension::FlexedBiceps, 0.3581, 0.3056, 0.0839),
    Row::new(Dimension::FlexedForearm, 0.3101, 0.2641, 0.0649),
    Row::new(Dimension::Wrist, 0.1777, 0.1547, 0.0453),
    Row::new(Dimension::BiacromialBreadth, 0.4157, 0.3653, 0.0469),
    Row::new(Dimension::AcromialHeight, 1.4407, 1.3351, 0.0384),
    Row::new(Dimension::ChestHeight, 1.2935, 1.1682, 0.0446),
    Row::new(Dimension::WaistHeight, 1.0565, 0.9801, 0.0500),
    Row::new(Dimension::ButtockHeight, 0.8803, 0.8472, 0.0496),
    Row::new(Dimension::CrotchHeight, 0.8395, 0.7788, 0.0564),
    Row::new(Dimension::KneeHeight, 0.4884, 0.4490, 0.0511),
    Row::new(Dimension::AcromionRadiale, 0.3329, 0.3073, 0.0559),
    Row::new(Dimension::RadialeStylion, 0.2679, 0.2413, 0.0513),
    Row::new(Dimension::HandLength, 0.1944, 0.1802, 0.0475),
    Row::new(Dimension::FootLength, 0.2705, 0.2464, 0.0444),
    Row::new(Dimension::HeadCircumference, 0.5744, 0.5611, 0.0335),
    Row::new(Dimension::CervicaleHeight, 1.5173, 1.3957, 0.0377),
    Row::new(Dimension::ChestBreadth, 0.2857, 0.2779, 0.0632),
    Row::new(Dimension::ChestDepth, 0.2538, 0.2474, 0.1044),
    Row::new(Dimension::WaistBreadth, 0.3294, 0.3064, 0.1082),
    Row::new(Dimension::WaistDepth, 0.2394, 0.2150, 0.1576),
    Row::new(Dimension::HipBreadth, 0.3457, 0.3538, 0.0735),
    Row::new(Dimension::ButtockDepth, 0.2460, 0.2275, 0.1033),
];

/// Correlations of the logarithms below the diagonal, row by row, in hundredths.
#[rustfmt::skip]
const CORRELATIONS: [i8; NUM_DIMENSIONS * (NUM_DIMENSIONS - 1) / 2] = [
    19,
    67, -3,
    81, -4, 65,
    78, -13, 57, 83,
    83, 3, 58, 73, 76,
    79, 0, 52, 67, 70, 81,
    73, 13, 41, 53, 56, 73, 72,
    72, 7, 42, 54, 56, 72, 68, 74,
    61, 35, 41, 43, 36, 51, 45, 61, 62,
    73, 6, 65, 62, 52, 62, 68, 56, 57, 41,
    69, 20, 65, 56, 41, 52, 57, 47, 52, 46, 80,
    59, 39, 55, 42, 31, 43, 38, 44, 45, 64, 52, 66,
    34, 36, 29, 16, 3, 17, 15, 30, 27, 32, 38, 40, 49,
    25, 89, 0, 4, -4, 7, 6, 15, 10, 34, 8, 22, 36, 30,
    16, 86, -4, -5, -15, -3, 1, 10, 5, 34, 4, 19, 34, 35, 86,
    6, 83, -10, -16, -30, -10, -5, 3, -5, 20, 2, 17, 31, 37, 82, 84,
    11, 78, -7, -7, -19, -7, 4, 2, -4, 11, 11, 22, 22, 27, 79, 77, 84,
    -1, 78, -14, -21, -32, -18, -11, -5, -12, 8, -4, 9, 16, 29, 78, 79, 84, 84,
    12, 80, -6, -6, -16, -5, -3, 4, -3, 16, 0, 12, 27, 34, 82, 81, 83, 82, 83,
    15, 69, 1, -2, -15, -3, 0, 4, 2, 13, 11, 19, 20, 40, 70, 69, 73, 74, 70, 71,
    19, 70, 3, -2, -16, -2, 6, 15, 14, 28, 16, 27, 36, 49, 67, 68, 73, 74, 72, 73, 69,
    29, 57, 17, 5, -7, 16, 16, 30, 27, 37, 22, 38, 45, 47, 55, 56, 60, 53, 55, 56, 53, 66,
    36, 58, 30, 14, 3, 19, 19, 30, 24, 50, 24, 43, 57, 47, 55, 54, 55, 49, 53, 54, 43, 58, 74,
    32, 28, 37, 19, 9, 13, 21, 15, 15, 37, 39, 45, 41, 39, 23, 27, 25, 25, 26, 28, 22, 40, 38, 47,
    21, 90, -1, -2, -11, 4, 3, 14, 8, 32, 7, 23, 38, 35, 90, 86, 84, 80, 80, 82, 70, 71, 58, 59, 25,
    68, 18, 51, 72, 62, 61, 47, 44, 46, 42, 47, 47, 48, 32, 21, 11, 3, 5, -4, 8, 13, 13, 12, 30, 15, 17,
    80, -3, 62, 86, 80, 71, 71, 54, 54, 41, 62, 58, 38, 6, 5, -5, -14, -3, -16, -4, -3, 0, 8, 16, 26, 0, 58,
    77, -6, 55, 81, 89, 78, 69, 58, 56, 39, 51, 38, 30, 5, 2, -10, -25, -15, -29, -12, -8, -13, -8, 3, 3, -5, 65, 77,
    72, -19, 56, 79, 89, 70, 65, 47, 50, 30, 47, 38, 27, 1, -11, -20, -35, -23, -33, -20, -20, -19, -10, 2, 13, -16, 55, 78, 83,
    76, 13, 49, 64, 67, 86, 69, 71, 68, 54, 53, 43, 41, 19, 18, 8, -1, -3, -9, 4, 3, 1, 17, 19, 8, 14, 58, 60, 72, 58,
    79, -15, 63, 78, 80, 80, 79, 63, 62, 42, 65, 57, 40, 3, -8, -17, -25, -13, -28, -17, -17, -11, 6, 14, 19, -12, 56, 78, 75, 78, 66,
];

/// The correlation of the logarithms of two dimensions.
pub(crate) fn correlation(a: usize, b: usize) -> f64 {
    if a == b {
        return 1.0;
    }
    let (row, column) = (a.max(b), a.min(b));
    f64::from(CORRELATIONS[row * (row - 1) / 2 + column]) / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_in_the_order_of_their_names() {
        for (index, row) in ROWS.iter().enumerate() {
            assert_eq!(row.dimension as usize, index);
        }
    }

    #[test]
    fn correlations_form_a_positive_definite_matrix() {
        let matrix = nalgebra::DMatrix::from_fn(NUM_DIMENSIONS, NUM_DIMENSIONS, correlation);
        assert!(matrix.cholesky().is_some());
    }
}
