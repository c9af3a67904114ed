//! Units of length and up axes.

use std::{fmt, str::FromStr};

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Unit {
    /// 1 m.
    Metre,
    /// 0.1 m, as in MakeHuman.
    Decimetre,
    /// 0.01 m.
    Centimetre,
    /// 0.001 m.
    Millimetre,
}

/// A word that names no unit.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is not a unit; expected `m`, `dm`, `cm` or `mm`")]
pub struct UnitError {
    /// The word.
    pub text: String,
}

impl Unit {
    /// All units, the longest first.
    pub const ALL: [Self; 4] = [
        Self::Metre,
        Self::Decimetre,
        Self::Centimetre,
        Self::Millimetre,
    ];

    /// How many metres one is.
    pub fn in_metres(self) -> f32 {
        match self {
            Self::Metre => 1.0,
            Self::Decimetre => 0.1,
            Self::Centimetre => 0.01,
            Self::Millimetre => 0.001,
        }
    }

    /// Its name in the plural: `metres`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Metre => "metres",
            Self::Decimetre => "decimetres",
            Self::Centimetre => "centimetres",
            Self::Millimetre => "millimetres",
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            Self::Metre => "m",
            Self::Decimetre => "dm",
            Self::Centimetre => "cm",
            Self::Millimetre => "mm",
        })
    }
}

impl FromStr for Unit {
    type Err = UnitError;

    fn from_str(text: &str) -> Result<Self, UnitError> {
        match text {
            "m" => Ok(Self::Metre),
            "dm" => Ok(Self::Decimetre),
            "cm" => Ok(Self::Centimetre),
            "mm" => Ok(Self::Millimetre),
            _ => Err(UnitError {
                text: text.to_owned(),
            }),
        }
    }
}

/// The axis that points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum UpAxis {
    /// As in this crate and most others.
    Y,
    /// As in Blender and 3ds Max.
    Z,
}

impl fmt::Display for UpAxis {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            Self::Y => "y",
            Self::Z => "z",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_as_they_are_written() {
        for unit in Unit::ALL {
            assert_eq!(unit.to_string().parse(), Ok(unit));
        }
        assert!("inch".parse::<Unit>().is_err());
    }
}
