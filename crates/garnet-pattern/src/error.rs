//! What can be wrong with a pattern.

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
        what: &'static str,
        /// Its value, in centimetres.
        found_cm: f64,
        /// The least value, in centimetres.
        least_cm: f64,
        /// What to change.
        hint: &'static str,
    },
    /// A measure or landmark of the wearer is missing or makes no sense.
    #[error("{what} of the wearer is `{value}`, which no body has")]
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
        /// The parameters that lie far from their defaults, and what to do with them.
        hint: String,
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

impl PatternError {
    /// What to do about it, as a clause for people.
    pub fn hint(&self) -> String {
        match self {
            Self::UnknownGarment { .. } => names(&GarmentKind::ALL.map(GarmentKind::name)),
            Self::UnknownSize { .. } => names(&crate::Size::ALL.map(crate::Size::name)),
            Self::UnknownParameter { garment, .. } => names(&spec_names(*garment)),
            Self::ParameterOutOfRange { spec, .. } => {
                format!("`{}` is this: {}", spec.name, spec.help)
            }
            Self::Impossible { hint, .. } => (*hint).to_owned(),
            Self::BadWearer { .. } => {
                "measures and joints are in metres, y up, with the feet on y = 0".to_owned()
            }
            Self::Folded { hint, .. } => hint.clone(),
            Self::VertexCount { .. } => "the default is 5000".to_owned(),
            Self::WrongGarment { .. } => "make the template from the same garment".to_owned(),
            Self::Triangulation { .. } => {
                "this is a fault of the program: report it with the parameters".to_owned()
            }
        }
    }
}

fn names(names: &[&str]) -> String {
    format!("it is one of {}", names.join(", "))
}

fn spec_names(garment: GarmentKind) -> Vec<&'static str> {
    garment.specs().iter().map(|spec| spec.name).collect()
}
