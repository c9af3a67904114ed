//! Whether a garment fits its wearer: ease and strain by region of the body.
//!
//! A tape is laid round the wearer and round the garment, as a tailor does who holds the finished
//! garment against the measures of a person. The girth of the wearer is that of the body at rest,
//! whatever its pose; that of the garment is measured in its pattern, flat and unstretched. What is
//! left between them is the ease. The same line of cloth, followed into the drape, tells the
//! strain.

mod lines;
mod map;
mod section;

use std::fmt;

use garnet_body::shape::{Measure, Tape};
use garnet_skin::{Body, PosedBody};

pub use lines::{FinishedGirth, FitLines};
pub use map::fit_map;

/// A part of the body that tells whether a garment fits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Region {
    /// Round the trunk below the armpits.
    Chest,
    /// Round the trunk at the navel; of trousers that do not reach it their waistband.
    Waist,
    /// Round the trunk at the widest of the buttocks.
    Hip,
    /// Round the upper arm, half-way down.
    UpperArm,
    /// Round the thigh, below the crotch.
    Thigh,
}

/// How a garment sits in a region.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FitWord {
    /// Smaller than the body: the cloth stretches.
    Tight,
    /// With the ease that breathing and moving take, and hardly more.
    Close,
    /// With the ease that most garments are cut with.
    Regular,
    /// With more.
    Loose,
}

/// From this ease on, as a share of the girth of the body, cloth is close and not tight, in every
/// region: no garment is smaller than its wearer unless it is to stretch. A higher value calls
/// garments tight that do not stretch; tried from -0.02 to 0.02.
const CLOSE_FROM: f64 = 0.0;

/// Ease as a share of the girth of the body from which a region is regular, and from which it is
/// loose, in the order of [`Region::ALL`]. Higher values call more garments close, or fewer loose.
///
/// Pattern makers give ease in centimetres for a middle size, by how a garment is to sit. Round a
/// bust of 92 cm a close-fitting blouse or dress has up to 7.5 cm, a loose-fitting one 13 cm and
/// more; round a hip of 98 cm it is 5 cm and 10 cm. A waistband has 1 to 3 cm, the waist of a
/// hanging bodice 4 cm if it is close and 12 cm and more if it hangs; a sleeve has 4 cm round an
/// arm of 29 cm where it is close and 9 cm where it is wide; the thigh of slim trousers 5 cm of 57
/// cm, that of wide ones 14 cm and more. These are those amounts over those girths.
const REGULAR_AND_LOOSE_FROM: [[f64; 2]; 5] = [
    [0.08, 0.14],
    [0.05, 0.15],
    [0.05, 0.105],
    [0.14, 0.31],
    [0.09, 0.25],
];

impl Region {
    /// All of them, from above.
    pub const ALL: [Self; 5] = [
        Self::Chest,
        Self::Waist,
        Self::Hip,
        Self::UpperArm,
        Self::Thigh,
    ];

    /// The name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Chest => "chest",
            Self::Waist => "waist",
            Self::Hip => "hip",
            Self::UpperArm => "upper arm",
            Self::Thigh => "thigh",
        }
    }

    /// The girth that is taken there.
    pub const fn measure(self) -> Measure {
        match self {
            Self::Chest => Measure::Chest,
            Self::Waist => Measure::Waist,
            Self::Hip => Measure::Hip,
            Self::UpperArm => Measure::UpperArm,
            Self::Thigh => Measure::Thigh,
        }
    }

    /// From which ease on it is close, regular and loose, as shares of the girth of the body.
    const fn bounds(self) -> [f64; 3] {
        let [regular, loose] = REGULAR_AND_LOOSE_FROM[self as usize];
        [CLOSE_FROM, regular, loose]
    }

    /// The word for an ease, as a share of the girth of the body.
    pub fn word(self, ease_share: f64) -> FitWord {
        let bounds = self.bounds().into_iter();
        FitWord::ALL[bounds.filter(|&bound| ease_share >= bound).count()]
    }
}

impl fmt::Display for Region {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

impl FitWord {
    /// All of them, from little ease to much.
    pub const ALL: [Self; 4] = [Self::Tight, Self::Close, Self::Regular, Self::Loose];

    /// The word that reports have.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tight => "tight",
            Self::Close => "close",
            Self::Regular => "regular",
            Self::Loose => "loose",
        }
    }
}

impl fmt::Display for FitWord {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// How a garment fits in one region.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RegionFit {
    /// Where.
    pub region: Region,
    /// The girth of the wearer there, in metres.
    pub body: f64,
    /// The girth of the garment there, as it was cut, in metres.
    pub garment: f64,
    /// How much longer the line round the garment is in the drape than as it was cut, as a share;
    /// none if the garment does not lie there.
    pub strain: Option<f64>,
}

impl RegionFit {
    /// Garment less body, in metres.
    pub fn ease(&self) -> f64 {
        self.garment - self.body
    }

    /// The ease as a share of the girth of the body.
    pub fn ease_share(&self) -> f64 {
        self.ease() / self.body
    }

    /// The word for the ease.
    pub fn word(&self) -> FitWord {
        self.region.word(self.ease_share())
    }
}

/// Why it cannot be told whether a garment fits.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoFit {
    /// The garment lies on another body than the built-in one.
    #[error("where the girths of its body are is known of the built-in body alone")]
    Stranger,
    /// The body is a doll or a giant: so many times as thick as a person.
    #[error("its body is {0:.3} times as thick as people, whose fit is known")]
    OtherSize(f32),
    /// The garment goes round none of the regions.
    #[error("the garment goes round neither chest, waist, hip, upper arm nor thigh")]
    NoRegion,
}

/// The tape of who wears `body`, a posed body of the built-in topology on which a garment of the
/// rest body `rest` is draped; none of other bodies.
///
/// Of a body with a shape of its own, the girths are those of its skin brought back to rest.
pub fn wearer_tape(rest: &Body, body: &PosedBody) -> Option<Tape> {
    Tape::around_posed(rest, body)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_ease_never_has_a_tighter_word() {
        for region in Region::ALL {
            let words = (-20..80).map(|percent| region.word(f64::from(percent) / 100.0));
            let words: Vec<FitWord> = words.collect();
            assert!(words.is_sorted(), "{region}");
            assert_eq!(words.first(), Some(&FitWord::Tight), "{region}");
            assert_eq!(words.last(), Some(&FitWord::Loose), "{region}");
        }
    }

    #[test]
    fn ease_is_garment_less_body() {
        let fit = RegionFit {
            region: Region::Chest,
            body: 1.0,
            garment: 1.12,
            strain: None,
        };
        assert!((fit.ease() - 0.12).abs() < 1e-12);
        assert!((fit.ease_share() - 0.12).abs() < 1e-12);
        assert_eq!(fit.word(), FitWord::Regular);
    }
}
