//! Units of length and up axes, which OBJ files do not name, guessed from the size.

use std::{fmt, str::FromStr};

use crate::Vector3;

/// Heights of bodies that a unit must lead to, in metres.
const BODY_HEIGHTS: [f32; 2] = [0.5, 2.6];

/// Largest extents of garments that a unit must lead to, in metres: a sock to a long dress.
const GARMENT_EXTENTS: [f32; 2] = [0.15, 2.4];

/// How much longer the height of a body must be than its depth to tell the two apart.
const CLEAR_RATIO: f32 = 1.5;

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

/// The unit in which a body of this height is 0.5 to 2.6 m tall, if there is one.
///
/// Each height fits one unit at most: the range spans less than a factor of ten.
pub fn guess_body_unit(height: f32) -> Option<Unit> {
    units_within(height, BODY_HEIGHTS).first().copied()
}

/// The units in which a garment of this largest extent is 0.15 to 2.4 m long, the longest first.
///
/// Two may fit (a dress in decimetres, a cuff in metres); the unit of the body then decides.
pub fn guess_garment_units(largest_extent: f32) -> Vec<Unit> {
    units_within(largest_extent, GARMENT_EXTENTS)
}

/// The up axis of a body with these extents along x, y and z: the longer of y and z.
///
/// Nothing if they are too alike, as of a crouching body.
pub fn guess_up_axis(extent: Vector3) -> Option<UpAxis> {
    if extent.y > CLEAR_RATIO * extent.z {
        return Some(UpAxis::Y);
    }
    (extent.z > CLEAR_RATIO * extent.y).then_some(UpAxis::Z)
}

fn units_within(length: f32, [shortest, longest]: [f32; 2]) -> Vec<Unit> {
    let fits = |unit: &Unit| (shortest..=longest).contains(&(length * unit.in_metres()));
    Unit::ALL.into_iter().filter(fits).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_body_of_usual_height_has_one_unit() {
        for (height, unit) in [1.7, 17.0, 170.0, 1700.0].into_iter().zip(Unit::ALL) {
            assert_eq!(guess_body_unit(height), Some(unit));
        }
        for height in [0.0, 0.2, 3e4, f32::NAN, f32::INFINITY] {
            assert_eq!(guess_body_unit(height), None);
        }
    }

    #[test]
    fn a_garment_may_fit_two_units() {
        assert_eq!(guess_garment_units(0.7), [Unit::Metre]);
        assert_eq!(guess_garment_units(2.0), [Unit::Metre, Unit::Decimetre]);
        assert_eq!(guess_garment_units(70.0), [Unit::Centimetre]);
    }

    #[test]
    fn the_up_axis_is_the_longer_of_two() {
        let guess = |x, y, z| guess_up_axis(Vector3::new(x, y, z));
        assert_eq!(guess(1.6, 1.7, 0.3), Some(UpAxis::Y));
        assert_eq!(guess(1.6, 0.3, 1.7), Some(UpAxis::Z));
        assert_eq!(guess(0.5, 0.7, 0.8), None);
    }

    #[test]
    fn units_are_read_as_they_are_written() {
        for unit in Unit::ALL {
            assert_eq!(unit.to_string().parse(), Ok(unit));
        }
        assert!("inch".parse::<Unit>().is_err());
    }

    proptest! {
        #[test]
        fn no_height_fits_two_units(height in 1e-3_f32..1e4) {
            prop_assert!(units_within(height, BODY_HEIGHTS).len() <= 1);
        }
    }
}
