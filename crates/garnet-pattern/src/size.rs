//! Standard sizes.

use crate::PatternError;
use crate::reference::REFERENCE;
use crate::wearer::Measures;

/// A size of ready-made garments: by the chest girth, or of trousers by waist and inner leg.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Size {
    /// Chest of 79 cm.
    Xs,
    /// Chest of 87 cm.
    S,
    /// Chest of 95 cm: nearly the reference wearer.
    M,
    /// Chest of 103 cm.
    L,
    /// Chest of 111 cm.
    Xl,
    /// Chest of 119 cm.
    Xxl,
    /// Chest of 127 cm.
    Xxxl,
    /// Trousers, as in `32x34`: waist girth of the body and length of the inner leg, in inches.
    Trousers {
        /// Waist girth of the body, 22 to 52.
        waist: u8,
        /// Finished length of the inner leg, 24 to 38.
        inseam: u8,
    },
}

const INCH: f64 = 0.0254;

/// Waists and inner legs that there are, in inches.
const WAISTS: std::ops::RangeInclusive<u8> = 22..=52;
const INSEAMS: std::ops::RangeInclusive<u8> = 24..=38;

/// The chest girth of size M, and the steps of chest and waist from a size to the next, in metres.
const MIDDLE_CHEST: f64 = 0.95;
const CHEST_STEP: f64 = 0.08;
const WAIST_STEP: f64 = 0.085;

/// The inner leg of trousers that are cut for the reference wearer, in metres: the default of the
/// pattern.
const REFERENCE_LEG: f64 = 0.74;

impl Size {
    /// All sizes by the chest, from small to large.
    pub const ALL: [Self; 7] = [
        Self::Xs,
        Self::S,
        Self::M,
        Self::L,
        Self::Xl,
        Self::Xxl,
        Self::Xxxl,
    ];

    /// All sizes of trousers whose waists and inner legs are those that shops have most: every even
    /// inch.
    pub fn trousers() -> Vec<Self> {
        let even = |range: std::ops::RangeInclusive<u8>| range.filter(|inch| inch % 2 == 0);
        let of_waist =
            |waist: u8| even(INSEAMS).map(move |inseam| Self::Trousers { waist, inseam });
        even(WAISTS).flat_map(of_waist).collect()
    }

    /// How many sizes larger than M it is.
    fn steps(self) -> f64 {
        match self {
            Self::Xs => -2.0,
            Self::S => -1.0,
            Self::M => 0.0,
            Self::L => 1.0,
            Self::Xl => 2.0,
            Self::Xxl => 3.0,
            Self::Xxxl => 4.0,
            Self::Trousers { waist, .. } => {
                (f64::from(waist) * INCH - REFERENCE.measures.waist) / WAIST_STEP
            }
        }
    }

    /// The measures that a garment of this size is cut for.
    ///
    /// Girths grow with the chest as they do from the thin to the heavy in the built-in
    /// population; lengths grow a little. Trousers have the girths of the size with their waist,
    /// and the legs that their inner leg is for.
    pub fn measures(self) -> Measures {
        let steps = self.steps();
        let mut size = REFERENCE.measures;
        let grow = |value: &mut f64, step: f64| *value += steps * step;
        size.chest = MIDDLE_CHEST + CHEST_STEP * steps;
        grow(&mut size.waist, WAIST_STEP);
        grow(&mut size.hip, 0.065);
        grow(&mut size.thigh, 0.040);
        grow(&mut size.knee, 0.018);
        grow(&mut size.calf, 0.018);
        grow(&mut size.ankle, 0.007);
        grow(&mut size.upper_arm, 0.027);
        grow(&mut size.forearm, 0.016);
        grow(&mut size.wrist, 0.007);
        grow(&mut size.neck, 0.016);
        grow(&mut size.shoulder_breadth, 0.012);
        grow(&mut size.arm_length, 0.006);
        grow(&mut size.stature, 0.010);
        grow(&mut size.neck_height, 0.009);
        grow(&mut size.shoulder_height, 0.009);
        grow(&mut size.chest_height, 0.006);
        grow(&mut size.waist_height, 0.005);
        grow(&mut size.hip_height, 0.004);
        grow(&mut size.inseam, 0.003);
        grow(&mut size.knee_height, 0.002);
        if let Self::Trousers { inseam, .. } = self {
            size.lengthen_legs(f64::from(inseam) * INCH / REFERENCE_LEG);
        }
        size
    }
}

impl std::fmt::Display for Size {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(match self {
            Self::Xs => "xs",
            Self::S => "s",
            Self::M => "m",
            Self::L => "l",
            Self::Xl => "xl",
            Self::Xxl => "2xl",
            Self::Xxxl => "3xl",
            Self::Trousers { waist, inseam } => return write!(formatter, "{waist}x{inseam}"),
        })
    }
}

impl std::str::FromStr for Size {
    type Err = PatternError;

    fn from_str(name: &str) -> Result<Self, PatternError> {
        let unknown = || PatternError::UnknownSize {
            name: name.to_owned(),
        };
        let wanted = name.to_lowercase();
        if let Some((waist, inseam)) = wanted.split_once(['x', '/'])
            && let (Ok(waist), Ok(inseam)) = (waist.parse(), inseam.parse())
        {
            let is_made = WAISTS.contains(&waist) && INSEAMS.contains(&inseam);
            return is_made
                .then_some(Self::Trousers { waist, inseam })
                .ok_or_else(unknown);
        }
        let wanted = match wanted.as_str() {
            "xxl" => "2xl",
            "xxxl" => "3xl",
            other => other,
        };
        let mut all = Self::ALL.into_iter();
        all.find(|size| size.to_string() == wanted)
            .ok_or_else(unknown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_read_as_they_are_written_and_with_all_their_letters() {
        for size in Size::ALL {
            assert_eq!(size.to_string().parse::<Size>(), Ok(size));
            assert_eq!(size.to_string().to_uppercase().parse::<Size>(), Ok(size));
        }
        assert_eq!("XXL".parse::<Size>(), Ok(Size::Xxl));
        assert_eq!("xxxl".parse::<Size>(), Ok(Size::Xxxl));
        for wrong in ["huge", "x", "32x", "32x99", "12x30", "32x30x1", "-32x30"] {
            assert!(wrong.parse::<Size>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn trousers_are_cut_for_their_waist_and_have_their_inner_leg() {
        for size in Size::trousers() {
            let Size::Trousers { waist, inseam } = size else {
                panic!("{size} is none of trousers");
            };
            assert_eq!(size.to_string().parse::<Size>(), Ok(size));
            let measures = size.measures();
            measures.check().unwrap();
            assert!(
                (measures.waist - f64::from(waist) * INCH).abs() < 1e-9,
                "{size}"
            );
            let leg = REFERENCE_LEG * measures.inseam / REFERENCE.measures.inseam;
            // What the girths of a size add to its legs is a few millimetres.
            assert!(
                (leg - f64::from(inseam) * INCH).abs() < 0.025,
                "{size} {leg}"
            );
        }
        assert_eq!(
            "32/34".parse(),
            Ok(Size::Trousers {
                waist: 32,
                inseam: 34
            })
        );
    }
}
