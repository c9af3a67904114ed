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
    /// 0.0254 m; never guessed.
    Inch,
    /// 0.3048 m; never guessed.
    Foot,
}

/// A word that names no unit.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is not a unit; expected `m`, `dm`, `cm`, `mm`, `in` or `ft`")]
#[non_exhaustive]
pub struct UnitError {
    /// The word.
    pub text: String,
}

impl Unit {
    /// All units that files may have.
    pub const ALL: [Self; 6] = [
        Self::Metre,
        Self::Decimetre,
        Self::Centimetre,
        Self::Millimetre,
        Self::Inch,
        Self::Foot,
    ];

    /// Those that are guessed from the size of a body, the longest first.
    pub const METRIC: [Self; 4] = [
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
            Self::Inch => 0.0254,
            Self::Foot => 0.3048,
        }
    }

    /// Its name in the plural: `metres`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Metre => "metres",
            Self::Decimetre => "decimetres",
            Self::Centimetre => "centimetres",
            Self::Millimetre => "millimetres",
            Self::Inch => "inches",
            Self::Foot => "feet",
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
            Self::Inch => "in",
            Self::Foot => "ft",
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
            "in" => Ok(Self::Inch),
            "ft" => Ok(Self::Foot),
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
        assert_eq!(
            (12.0 * Unit::Inch.in_metres()).to_bits(),
            Unit::Foot.in_metres().to_bits()
        );
        assert!("inch".parse::<Unit>().is_err());
    }
}
