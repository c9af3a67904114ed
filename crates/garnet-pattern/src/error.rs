//! What can be wrong with a pattern.

use std::fmt;

use crate::{GarmentKind, ParameterSpec};

/// Why a garment cannot be cut, sewn or written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PatternError {
    /// There is no garment of that name.
    #[error("there is no garment `{name}`")]
    UnknownGarment {
        /// The name that was given.
        name: String,
    },
    /// There is no size of that name.
    #[error("there is no size `{name}`")]
    UnknownSize {
        /// The name that was given.
        name: String,
    },
    /// A size of trousers for another garment.
    #[error("`{size}` is a size of trousers, which a {garment} is not")]
    NoTrousers {
        /// The garment.
        garment: GarmentKind,
        /// The size.
        size: String,
    },
    /// The garment has no such parameter.
    #[error("a {garment} has no parameter `{name}`")]
    UnknownParameter {
        /// The garment.
        garment: GarmentKind,
        /// The name that was given.
        name: String,
    },
    /// The value of a parameter is out of its range.
    #[error("{} of `{}` is not possible: it lies between {} and {}",
        spec.name, spec.shown(*value), spec.shown(spec.range[0]), spec.shown(spec.range[1]))]
    ParameterOutOfRange {
        /// The parameter.
        spec: &'static ParameterSpec,
        /// The value that was given, in metres or a share.
        value: f64,
    },
    /// Each parameter is possible, but not all of them on this wearer.
    #[error("{what} of {found_cm:.1} cm is not possible: it must be at least {least_cm:.1} cm")]
    Impossible {
        /// The length that is wrong.
        what: PatternLength,
        /// Its value, in centimetres.
        found_cm: f64,
        /// The least value, in centimetres.
        least_cm: f64,
    },
    /// A measure or landmark of the wearer is missing or makes no sense.
    #[error("{what} of the wearer is {value:.3} m: nothing is cut for such bodies")]
    BadWearer {
        /// The measure or landmark.
        what: &'static str,
        /// Its value, in metres.
        value: f64,
    },
    /// The pattern would hold triangles that are folded over or too thin.
    #[error("{folded} of {faces} triangles of the pattern would be folded or thinner than {least_degrees:.0} degrees ({share:.2} %)", share = 100.0 * *folded as f64 / *faces as f64)]
    Folded {
        /// How many triangles are bad.
        folded: usize,
        /// How many there are.
        faces: usize,
        /// The smallest angle that is accepted, in degrees.
        least_degrees: f64,
        /// The parameters that lie far from their defaults, the farthest first.
        far: Vec<&'static str>,
    },
    /// No mesh of so many vertices is made.
    #[error("a garment of {asked} vertices is not possible: it lies between {least} and {most}", least = crate::VERTEX_RANGE[0], most = crate::VERTEX_RANGE[1])]
    VertexCount {
        /// How many were asked for.
        asked: usize,
    },
    /// The parameters belong to another garment.
    #[error("parameters of a {given} do not fit the template of a {expected}")]
    WrongGarment {
        /// The garment of the parameters.
        given: GarmentKind,
        /// The garment of the template.
        expected: GarmentKind,
    },
    /// The triangulation failed, which is a fault of this library.
    #[error("the panel `{panel}` cannot be triangulated: {reason}")]
    Triangulation {
        /// The panel.
        panel: &'static str,
        /// What happened.
        reason: String,
    },
}

/// A length of a pattern that parameters together can make too short.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PatternLength {
    /// From the armpit to the cuff.
    Underarm,
    /// From the armpit to the hem.
    SideSeam,
    /// From the neck to the sleeve.
    Shoulder,
    /// Of a dress, below the waist.
    Skirt,
    /// Of trousers, from the hip to the waistband.
    Rise,
}

impl fmt::Display for PatternLength {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Underarm => "underarm seam of the sleeve",
            Self::SideSeam => "side seam",
            Self::Shoulder => "shoulder seam",
            Self::Skirt => "skirt",
            Self::Rise => "way from the hip to the waistband",
        })
    }
}
