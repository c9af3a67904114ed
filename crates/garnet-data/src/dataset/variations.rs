//! Sewing parameters that are drawn for each body.

use std::{collections::BTreeMap, fmt};

use garnet_body::uniform;
use garnet_pattern::{Parameters, PatternError};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// Ranges that sewing parameters are drawn from, by name; in metres, or shares of a measure.
///
/// Draws are uniform, and depend on the seed, the body and the name alone: another range for one
/// parameter leaves the others as they are.
///
/// ```
/// use garnet_data::Variations;
/// use garnet_pattern::GarmentKind;
///
/// let sleeves = Variations::default().with("sleeve", [0.18, 0.34]);
/// let mean = GarmentKind::Tshirt.parameters();
/// let drawn = sleeves.drawn(&mean, 1, 0)?;
/// assert!((0.18..0.34).contains(&drawn.get("sleeve")?));
/// assert_eq!(drawn.get("length")?, mean.get("length")?);
/// # Ok::<(), garnet_pattern::PatternError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Variations {
    ranges: BTreeMap<String, [f64; 2]>,
}

impl Variations {
    /// The same, with a range for one parameter more.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, range: [f64; 2]) -> Self {
        self.ranges.insert(name.into(), range);
        self
    }

    /// Whether nothing is drawn.
    pub fn is_empty(&self) -> bool {
        self.ranges.is_empty()
    }

    /// Whether the pattern has these parameters and allows the ends of their ranges.
    ///
    /// # Errors
    ///
    /// [`PatternError::UnknownParameter`] or [`PatternError::ParameterOutOfRange`].
    pub fn check(&self, parameters: &Parameters) -> Result<(), PatternError> {
        let mut tried = parameters.clone();
        for (name, range) in &self.ranges {
            for &end in range {
                tried.set(name, end)?;
            }
        }
        Ok(())
    }

    /// The parameters of a body: `parameters`, but for those that are drawn.
    ///
    /// # Errors
    ///
    /// Those of [`Variations::check`].
    pub fn drawn(
        &self,
        parameters: &Parameters,
        seed: u64,
        body: u64,
    ) -> Result<Parameters, PatternError> {
        let mut drawn = parameters.clone();
        for (name, [low, high]) in &self.ranges {
            drawn.set(name, low + (high - low) * share(seed, body, name))?;
        }
        Ok(drawn)
    }
}

impl fmt::Display for Variations {
    /// As the command takes them, in centimetres or per cent.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.ranges.is_empty() {
            return formatter.write_str("none");
        }
        for (number, (name, range)) in self.ranges.iter().enumerate() {
            // Without the last digits of a product by a hundred.
            let [low, high] = range.map(|end| (1e8 * end).round() / 1e6);
            let comma = if number > 0 { ", " } else { "" };
            write!(formatter, "{comma}{name}={low}:{high}")?;
        }
        Ok(())
    }
}

/// A number from 0 to 1, without 1.
fn share(seed: u64, body: u64, name: &str) -> f64 {
    let mut bytes = [0_u8; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    bytes[8..16].copy_from_slice(&body.to_le_bytes());
    for (index, byte) in name.bytes().enumerate() {
        bytes[16 + index % 16] ^= byte.rotate_left(index as u32 / 16);
    }
    uniform(&mut ChaCha8Rng::from_seed(bytes))
}

#[cfg(test)]
mod tests {
    use garnet_pattern::GarmentKind;

    use super::*;

    #[test]
    fn draws_fill_their_range_and_depend_on_body_and_name() {
        let mean = GarmentKind::Tshirt.parameters();
        let both = Variations::default()
            .with("sleeve", [0.16, 0.36])
            .with("length", [0.6, 0.8]);
        let all: Vec<Parameters> = (0..400)
            .map(|body| both.drawn(&mean, 3, body).unwrap())
            .collect();
        for (name, low, high) in [("sleeve", 0.16, 0.36), ("length", 0.6, 0.8)] {
            let values = all.iter().map(|drawn| drawn.get(name).unwrap());
            let values: Vec<f64> = values.collect();
            assert!(values.iter().all(|value| (low..high).contains(value)));
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            // Four standard deviations of the mean of 400 uniform draws.
            assert!((mean - 0.5 * (low + high)).abs() < 4.0 * 0.2 / (12.0 * 400.0_f64).sqrt());
        }
        let one = Variations::default().with("sleeve", [0.16, 0.36]);
        let again = one.drawn(&mean, 3, 7).unwrap();
        let sleeve = |drawn: &Parameters| drawn.get("sleeve").unwrap().to_bits();
        assert_eq!(sleeve(&again), sleeve(&all[7]));
        assert_ne!(again, one.drawn(&mean, 4, 7).unwrap());
    }

    #[test]
    fn ranges_are_shown_as_they_are_given() {
        assert_eq!(Variations::default().to_string(), "none");
        let both = Variations::default().with("sleeve", [0.07, 0.34]);
        let both = both.with("length", [0.605, 0.7]);
        assert_eq!(both.to_string(), "length=60.5:70, sleeve=7:34");
    }

    #[test]
    fn what_the_pattern_does_not_allow_is_told() {
        let mean = GarmentKind::Tshirt.parameters();
        let unknown = Variations::default().with("collar", [0.1, 0.2]);
        let wide = Variations::default().with("sleeve", [0.2, 9.0]);
        for (variations, text) in [(unknown, "collar"), (wide, "sleeve")] {
            let error = variations.check(&mean).unwrap_err().to_string();
            assert!(error.contains(text), "{error}");
        }
    }
}
