//! The smooth surface of a body, before it is a mesh.

use garnet_skin::{Joint, Skeleton};

use super::anatomy::{Anatomy, Corrections};
use super::field::Field;
use super::guide::Guide;
use super::primitives::Vec3;
use super::skeleton;
use super::{BodyParameters, Measure, Measures, ShapeError};

/// The surface of a body as the zero set of a smooth function, with its skeleton.
///
/// A [`ParametricBody`](super::ParametricBody) is the mesh that lies on it; its template was made
/// from one of these.
#[derive(Debug, Clone)]
pub struct BodySurface {
    pub(crate) field: Field,
    pub(crate) anatomy: Anatomy,
    pub(crate) guide: Guide,
}

impl BodySurface {
    /// The surface of the most likely body of these parameters; its girths are right to a few
    /// percent.
    ///
    /// # Errors
    ///
    /// Those of [`BodyParameters::check`].
    pub fn new(parameters: &BodyParameters) -> Result<Self, ShapeError> {
        parameters.check()?;
        let body = parameters.completed(parameters.bmi());
        let anatomy = Anatomy::new(parameters.sex(), &body, Corrections::default());
        Ok(Self::of(anatomy))
    }

    pub(crate) fn of(anatomy: Anatomy) -> Self {
        let field = Field::new(&anatomy);
        Self {
            guide: Guide::new(&anatomy, &field),
            field,
            anatomy,
        }
    }

    /// The body that the template is made of: half-way between the mean man and the mean woman.
    ///
    /// # Panics
    ///
    /// Never: the mean body is a possible body.
    pub fn template() -> Self {
        Self::new(&BodyParameters::new(0.5).with_bmi(27.0)).expect("the mean body is possible")
    }

    /// The signed distance of a point of space, in metres: negative inside, exact to first order
    /// near the surface.
    pub fn distance(&self, point: [f64; 3]) -> f64 {
        self.field.distance(&Vec3::from(point))
    }

    /// The signed distance of a point and its gradient.
    pub fn distance_and_gradient(&self, point: [f64; 3]) -> (f64, [f64; 3]) {
        let (distance, gradient) = self.field.distance_and_gradient(&Vec3::from(point));
        (distance, gradient.into())
    }

    /// The signed distances of a point to trunk, head, left arm and left leg (to the right ones on
    /// the right side), each by itself.
    pub fn part_distances(&self, point: [f64; 3]) -> [f64; 4] {
        self.field.part_distances(&Vec3::from(point))
    }

    /// The most likely value of each measure, in metres.
    pub fn measures(&self) -> Measures {
        self.anatomy.measures
    }

    /// The height of the body, in metres.
    pub fn stature(&self) -> f64 {
        self.anatomy.measures[Measure::Stature]
    }

    /// The joints, in the order of [`JOINT_NAMES`](super::JOINT_NAMES).
    pub fn joints(&self) -> Vec<Joint> {
        skeleton::joints(&self.anatomy.joints)
    }

    /// The tips of the limbs, which no joint marks: fingers and toes of the left side, in metres.
    pub fn tips(&self) -> [[f64; 3]; 2] {
        let joints = &self.anatomy.joints;
        [joints.fingertip.into(), joints.toes.into()]
    }

    /// The skeleton at rest.
    pub(crate) fn skeleton(&self) -> Skeleton {
        Skeleton::new(self.joints()).expect("the built-in joints form a tree")
    }
}
