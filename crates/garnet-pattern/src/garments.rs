//! The garments and the parameters of each.

use crate::parameters::ParameterSpec as Spec;
use crate::{Parameters, PatternError};

/// A kind of garment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum GarmentKind {
    /// Front, back, two set-in sleeves and a rib around the neck.
    Tshirt,
    /// A looser shirt with long sleeves and ribs at neck, cuffs and hem.
    Sweater,
    /// A sleeveless bodice and a flared skirt.
    Dress,
    /// Two fronts, two backs and a waistband.
    Jeans,
}

impl GarmentKind {
    /// All kinds, in order.
    pub const ALL: [Self; 4] = [Self::Tshirt, Self::Sweater, Self::Dress, Self::Jeans];

    /// The name in commands, files and messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tshirt => "tshirt",
            Self::Sweater => "sweater",
            Self::Dress => "dress",
            Self::Jeans => "jeans",
        }
    }

    /// The parameters of this garment.
    pub const fn specs(self) -> &'static [Spec] {
        match self {
            Self::Tshirt => TSHIRT,
            Self::Sweater => SWEATER,
            Self::Dress => DRESS,
            Self::Jeans => JEANS,
        }
    }

    /// The parameters of the mean pattern.
    pub fn parameters(self) -> Parameters {
        Parameters::new(self)
    }
}

impl std::fmt::Display for GarmentKind {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(self.name())
    }
}

impl std::str::FromStr for GarmentKind {
    type Err = PatternError;

    fn from_str(name: &str) -> Result<Self, PatternError> {
        let mut all = Self::ALL.into_iter();
        all.find(|kind| kind.name() == name)
            .ok_or_else(|| PatternError::UnknownGarment {
                name: name.to_owned(),
            })
    }
}

const TSHIRT: &[Spec] = &[
    Spec::metres(
        "length",
        0.66,
        [0.50, 0.90],
        "from the neck's side to the hem",
    ),
    Spec::share(
        "chest-ease",
        0.20,
        [-0.05, 0.50],
        "how much wider than the chest",
    ),
    Spec::share(
        "waist-shape",
        0.0,
        [-0.12, 0.10],
        "how much wider at the waist than at the chest",
    ),
    Spec::share(
        "hem-flare",
        0.03,
        [-0.10, 0.30],
        "how much wider at the hem than at the chest",
    ),
    Spec::metres(
        "sleeve",
        0.24,
        [0.16, 0.36],
        "length of the sleeve's top from the shoulder",
    ),
    Spec::share(
        "sleeve-ease",
        0.50,
        [0.05, 0.70],
        "how much wider than the upper arm at the armhole, at least",
    ),
    Spec::share(
        "cuff-ease",
        0.45,
        [0.0, 0.60],
        "how much wider than the upper arm at the cuff",
    ),
    Spec::metres("neck-width", 0.19, [0.165, 0.28], "width of the neckline"),
    Spec::metres(
        "neck-depth",
        0.085,
        [0.05, 0.20],
        "from the neck's side down to the front of the neckline",
    ),
    Spec::metres(
        "shoulder",
        0.02,
        [-0.03, 0.05],
        "how far the shoulder seam runs beyond the acromion",
    ),
    Spec::metres(
        "armhole",
        0.05,
        [0.01, 0.09],
        "how far the armhole reaches below the armpit",
    ),
];

const SWEATER: &[Spec] = &[
    Spec::metres(
        "length",
        0.66,
        [0.50, 0.90],
        "from the neck's side to the lower edge of the hem's rib",
    ),
    Spec::share(
        "chest-ease",
        0.30,
        [0.0, 0.60],
        "how much wider than the chest",
    ),
    Spec::share(
        "waist-shape",
        0.0,
        [-0.12, 0.10],
        "how much wider at the waist than at the chest",
    ),
    Spec::share(
        "hem-flare",
        0.0,
        [-0.12, 0.20],
        "how much wider at the hem than at the chest",
    ),
    Spec::metres(
        "sleeve",
        0.63,
        [0.48, 0.68],
        "length of the sleeve's top from the shoulder, with its rib",
    ),
    Spec::share(
        "sleeve-ease",
        0.65,
        [0.10, 0.80],
        "how much wider than the upper arm at the armhole, at least",
    ),
    Spec::share(
        "cuff-ease",
        0.70,
        [0.10, 0.90],
        "how much wider than the wrist at the cuff",
    ),
    Spec::metres("neck-width", 0.185, [0.165, 0.26], "width of the neckline"),
    Spec::metres(
        "neck-depth",
        0.080,
        [0.05, 0.18],
        "from the neck's side down to the front of the neckline",
    ),
    Spec::metres(
        "shoulder",
        0.03,
        [-0.03, 0.06],
        "how far the shoulder seam runs beyond the acromion",
    ),
    Spec::metres(
        "armhole",
        0.06,
        [0.01, 0.10],
        "how far the armhole reaches below the armpit",
    ),
];

const DRESS: &[Spec] = &[
    Spec::metres(
        "length",
        1.00,
        [0.75, 1.30],
        "from the neck's side to the hem",
    ),
    Spec::share(
        "chest-ease",
        0.12,
        [-0.03, 0.30],
        "how much wider than the chest",
    ),
    Spec::share(
        "waist-ease",
        0.15,
        [0.0, 0.40],
        "how much wider than the waist",
    ),
    Spec::share(
        "hip-ease",
        0.20,
        [0.04, 0.60],
        "how much wider than the hip, at least",
    ),
    Spec::metres(
        "hem-flare",
        0.60,
        [0.10, 1.50],
        "how much wider the hem is than the waist",
    ),
    Spec::metres("neck-width", 0.20, [0.165, 0.24], "width of the neckline"),
    Spec::metres(
        "neck-depth",
        0.11,
        [0.05, 0.20],
        "from the neck's side down to the front of the neckline",
    ),
    Spec::metres(
        "shoulder",
        -0.03,
        [-0.06, 0.0],
        "how far the shoulder seam runs beyond the acromion",
    ),
    Spec::metres(
        "armhole",
        0.03,
        [0.01, 0.06],
        "how far the armhole reaches below the armpit",
    ),
];

const JEANS: &[Spec] = &[
    Spec::metres("inseam", 0.74, [0.35, 0.84], "length of the inner leg"),
    Spec::metres(
        "rise",
        0.23,
        [0.19, 0.28],
        "from the crotch up to the upper edge of the waistband",
    ),
    Spec::share(
        "waist-ease",
        0.02,
        [-0.02, 0.12],
        "how much wider than the body under the waistband, or under a belly than 97 % of the hip",
    ),
    Spec::share(
        "hip-ease",
        0.08,
        [0.02, 0.25],
        "how much wider than the hip",
    ),
    Spec::share(
        "thigh-ease",
        0.20,
        [0.04, 0.40],
        "how much wider than the thigh",
    ),
    Spec::share(
        "knee-ease",
        0.38,
        [0.06, 0.70],
        "how much wider than the knee",
    ),
    Spec::metres("leg-opening", 0.42, [0.34, 0.70], "girth of the hem"),
    Spec::metres("waistband", 0.04, [0.025, 0.06], "height of the waistband"),
];
