//! What can be wrong with a pattern.

use crate::{GarmentKind, ParameterSpec};

/// Why a garment cannot be cut, sewn or written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PatternError {
    /// There is no garment of that name.
    #[error("there is no garment `{name}`; hint: {}", names(&GarmentKind::ALL.map(GarmentKind::name)))]
    UnknownGarment {
        /// The name that was given.
        name: String,
    },
    /// There is no size of that name.
    #[error("there is no size `{name}`; hint: {}", names(&crate::Size::ALL.map(crate::Size::name)))]
    UnknownSize {
        /// The name that was given.
        name: String,
    },
    /// The garment has no such parameter.
    #[error("a {garment} has no parameter `{name}`; hint: {}", names(&spec_names(*garment)))]
    UnknownParameter {
        /// The garment.
        garment: GarmentKind,
        /// The name that was given.
        name: String,
    },
    /// The value of a parameter is out of its range.
    #[error("{} of `{}` is not possible: it lies between {} and {}; hint: {}",
        spec.name, spec.shown(*value), spec.shown(spec.range[0]), spec.shown(spec.range[1]), spec.help)]
    ParameterOutOfRange {
        /// The parameter.
        spec: &'static ParameterSpec,
        /// The value that was given, in metres or a share.
        value: f64,
    },
    /// Each parameter is possible, but not all of them on this wearer.
    #[error(
        "{what} of {found_cm:.1} cm is not possible: it must be at least {least_cm:.1} cm; hint: {hint}"
    )]
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
    #[error(
        "{what} of the wearer is `{value}`, which no body has; hint: measures and joints are in metres, Y up, feet on y = 0"
    )]
    BadWearer {
        /// The measure or landmark.
        what: &'static str,
        /// Its value, in metres.
        value: f64,
    },
    /// The pattern would hold triangles that are folded over or too thin.
    #[error("{folded} of {faces} triangles of the pattern would be folded or thinner than {least_degrees:.0} degrees ({share:.2} %); hint: {hint}", share = 100.0 * *folded as f64 / *faces as f64)]
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
    #[error("a garment of {asked} vertices is not possible: it lies between {least} and {most}; hint: the default is 5000", least = crate::VERTEX_RANGE[0], most = crate::VERTEX_RANGE[1])]
    VertexCount {
        /// How many were asked for.
        asked: usize,
    },
    /// The parameters belong to another garment.
    #[error(
        "parameters of a {given} do not fit the template of a {expected}; hint: make the template from the same garment"
    )]
    WrongGarment {
        /// The garment of the parameters.
        given: GarmentKind,
        /// The garment of the template.
        expected: GarmentKind,
    },
    /// The triangulation failed, which is a fault of this library.
    #[error(
        "the panel `{panel}` cannot be triangulated: {reason}; hint: this is a fault of the program, report it with the parameters"
    )]
    Triangulation {
        /// The panel.
        panel: &'static str,
        /// What happened.
        reason: String,
    },
}

fn names(names: &[&str]) -> String {
    format!("one of {}", names.join(", "))
}

fn spec_names(garment: GarmentKind) -> Vec<&'static str> {
    garment.specs().iter().map(|spec| spec.name).collect()
}
