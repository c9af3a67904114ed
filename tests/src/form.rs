//! What a garment is wrapped around: a body without gaps between its legs.

use garnet::body::shape::{BodyParameters, BodySurface, ShapeError};
use garnet::{Body, Point3, Vector3};

use crate::bone::{Bone, smooth_min, union};
use crate::mannequin::{ARM_DIRECTION, SHOULDER, Shape, form_distance};

/// Over which length the skirt and the body grow together, in metres.
const BLEND: f32 = 0.04;

/// A form and where the garment ends on it.
pub struct Form {
    /// Signed distance, in metres.
    pub(crate) distance: Box<dyn Fn(Point3) -> f32>,
    /// Height of the hem, in metres.
    pub(crate) hem: f32,
    /// Height of the neckline, in metres.
    pub(crate) neck: f32,
    /// The left shoulder, in metres.
    pub(crate) shoulder: Vector3,
    /// From the left shoulder to the elbow, of length 1.
    pub(crate) arm_direction: Vector3,
}

impl std::fmt::Debug for Form {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Form").finish_non_exhaustive()
    }
}

impl Form {
    pub(crate) fn of_mannequin() -> Self {
        let shape = Shape::new();
        Self {
            distance: Box::new(move |point| form_distance(&shape, point)),
            hem: 0.66,
            neck: 1.455,
            shoulder: SHOULDER.into(),
            arm_direction: ARM_DIRECTION.into(),
        }
    }

    /// The form of a built-in body, with a cone from the hips down in place of the legs.
    ///
    /// # Errors
    ///
    /// [`ShapeError`] for parameters that no body has.
    pub fn of_body(parameters: &BodyParameters, body: &Body) -> Result<Self, ShapeError> {
        let surface = BodySurface::new(parameters)?;
        let joint = |name: &str| {
            let joints = body.skeleton().joints().iter();
            let mut found = joints.filter(|joint| joint.name == name);
            found
                .next()
                .map_or_else(Vector3::zeros, |joint| joint.rest_position.coords)
        };
        let hip = joint("left_hip").y;
        let ends = [[0.0, hip + 0.04, 0.0], [0.0, 0.5 * hip, 0.0]];
        let skirt = Bone::new(ends, [0.14, 0.24]).with_depth(0.8);
        let distance = move |point: Point3| {
            let body = surface.distance(point.coords.cast().into()) as f32;
            smooth_min(body, union(&[skirt], BLEND, point), BLEND)
        };
        Ok(Self {
            distance: Box::new(distance),
            hem: 0.72 * hip,
            neck: joint("neck").y + 0.015,
            shoulder: joint("left_shoulder"),
            arm_direction: (joint("left_elbow") - joint("left_shoulder")).normalize(),
        })
    }
}
