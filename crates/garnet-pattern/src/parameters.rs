//! Parameters of a garment: names, values, units and ranges.

use crate::PatternError;
use crate::garments::GarmentKind;

/// What a parameter counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterUnit {
    /// A length in metres, on the reference wearer; a grade scales it.
    Metre,
    /// A share of a measure or of another length: 0.1 is 10 %.
    Share,
}

/// The name, range and default of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterSpec {
    /// The name, in lower case with hyphens.
    pub name: &'static str,
    /// What it changes, as a clause.
    pub help: &'static str,
    /// Its unit.
    pub unit: ParameterUnit,
    /// Smallest and largest value.
    pub range: [f64; 2],
    /// The value of the mean pattern.
    pub default: f64,
}

impl ParameterSpec {
    pub(crate) const fn metres(
        name: &'static str,
        default: f64,
        range: [f64; 2],
        help: &'static str,
    ) -> Self {
        let unit = ParameterUnit::Metre;
        Self {
            name,
            help,
            unit,
            range,
            default,
        }
    }

    pub(crate) const fn share(
        name: &'static str,
        default: f64,
        range: [f64; 2],
        help: &'static str,
    ) -> Self {
        let unit = ParameterUnit::Share;
        Self {
            name,
            help,
            unit,
            range,
            default,
        }
    }

    /// A value in centimetres or per cent, for messages.
    pub fn shown(&self, value: f64) -> String {
        match self.unit {
            ParameterUnit::Metre => format!("{:.1} cm", 100.0 * value),
            ParameterUnit::Share => format!("{:.1} %", 100.0 * value),
        }
    }
}

/// A parameter and its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name, unit and range.
    pub spec: &'static ParameterSpec,
    /// The value, in metres or a share.
    pub value: f64,
}

/// Parameters that are less than this share of the way to the end of the range from the default are
/// not blamed.
const FAR: f64 = 0.5;

/// The values of all parameters of one garment, each within its range.
///
/// ```
/// use garnet_pattern::{GarmentKind, Parameters};
///
/// let mut parameters = Parameters::new(GarmentKind::Tshirt);
/// parameters.set("sleeve", 0.30)?;
/// assert_eq!(parameters.get("sleeve")?, 0.30);
/// let error = parameters.set("sleeve", 3.0).unwrap_err();
/// assert!(error.to_string().starts_with("sleeve of `300.0 cm` is not possible"));
/// # Ok::<(), garnet_pattern::PatternError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    garment: GarmentKind,
    values: Vec<f64>,
}

impl Parameters {
    /// The mean pattern of a garment.
    pub fn new(garment: GarmentKind) -> Self {
        let values = garment.specs().iter().map(|spec| spec.default).collect();
        Self { garment, values }
    }

    /// The garment that these are parameters of.
    pub fn garment(&self) -> GarmentKind {
        self.garment
    }

    /// All parameters with their values, in the order of [`GarmentKind::specs`].
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Parameter> {
        let pairs = self.garment.specs().iter().zip(&self.values);
        pairs.map(|(spec, &value)| Parameter { spec, value })
    }

    /// The value of a parameter, in metres or a share.
    ///
    /// # Errors
    ///
    /// [`PatternError::UnknownParameter`].
    pub fn get(&self, name: &str) -> Result<f64, PatternError> {
        Ok(self.values[self.index(name)?])
    }

    /// Sets a parameter, in metres or a share.
    ///
    /// # Errors
    ///
    /// [`PatternError::UnknownParameter`] or [`PatternError::ParameterOutOfRange`].
    pub fn set(&mut self, name: &str, value: f64) -> Result<(), PatternError> {
        let index = self.index(name)?;
        let spec = &self.garment.specs()[index];
        // A value that was typed in centimetres may miss the end of the range by rounding.
        let [low, high] = spec.range;
        if !(low - 1e-9..=high + 1e-9).contains(&value) {
            return Err(PatternError::ParameterOutOfRange { spec, value });
        }
        self.values[index] = value.clamp(low, high);
        Ok(())
    }

    /// The names of parameters that lie far from their defaults, the farthest first.
    pub(crate) fn far(&self) -> Vec<&'static str> {
        // Of the way from the default to the end of the range.
        let away = |parameter: &Parameter| {
            let ([low, high], default) = (parameter.spec.range, parameter.spec.default);
            let way = parameter.value - default;
            let whole = if way < 0.0 {
                default - low
            } else {
                high - default
            };
            way.abs() / whole.max(f64::MIN_POSITIVE)
        };
        let mut far: Vec<Parameter> = self.iter().filter(|found| away(found) >= FAR).collect();
        far.sort_by(|a, b| away(b).total_cmp(&away(a)));
        far.iter().map(|parameter| parameter.spec.name).collect()
    }

    fn index(&self, name: &str) -> Result<usize, PatternError> {
        let mut specs = self.garment.specs().iter();
        specs
            .position(|spec| spec.name == name)
            .ok_or_else(|| PatternError::UnknownParameter {
                garment: self.garment,
                name: name.to_owned(),
            })
    }

    /// The value of a parameter that the garment has.
    ///
    /// # Panics
    ///
    /// If it has not, which is a fault of the draft.
    pub(crate) fn at(&self, name: &str) -> f64 {
        let found = self
            .garment
            .specs()
            .iter()
            .position(|spec| spec.name == name);
        self.values[found.expect("a draft asks for parameters of its garment")]
    }
}
