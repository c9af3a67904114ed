//! What the cloth of the reference solver lies on: exact shapes and triangle meshes.

use garnet_knn::{ClosestPoint, Feature, Surface};
use nalgebra::{Unit, Vector3};

use crate::Point3;

/// The nearest point of an [`Obstacle`], as contact sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Signed distance, in metres, negative inside.
    pub distance: f64,
    /// Gradient of that distance: unit length, away from the obstacle.
    pub normal: Vector3<f64>,
}

/// A solid that cloth cannot enter.
pub trait Obstacle: Sync {
    /// Before each step: where the vertices `[vertex]` are. What is shown to them may follow.
    fn follow(&self, _places: &[Vector3<f64>]) {}

    /// The nearest point of the surface to a place of `vertex`, if it is no farther than `reach`.
    ///
    /// The distance has to be continuous and 1-Lipschitz in `place`. `vertex` is there for
    /// obstacles that show different vertices different parts of themselves.
    fn nearest(&self, vertex: usize, place: &Vector3<f64>, reach: f64) -> Option<Nearest>;
}

/// Empty space, without an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Nothing;

impl Obstacle for Nothing {
    fn nearest(&self, _: usize, _: &Vector3<f64>, _: f64) -> Option<Nearest> {
        None
    }
}

/// All that lies below a plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// A point of the plane, in metres.
    pub origin: Vector3<f64>,
    /// Direction out of the solid.
    pub normal: Unit<Vector3<f64>>,
}

impl Obstacle for Plane {
    fn nearest(&self, _: usize, place: &Vector3<f64>, reach: f64) -> Option<Nearest> {
        let distance = self.normal.dot(&(place - self.origin));
        within(reach, distance, self.normal.into_inner())
    }
}

/// A ball as an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Center, in metres.
    pub center: Vector3<f64>,
    /// Radius, in metres.
    pub radius: f64,
}

impl Obstacle for Sphere {
    fn nearest(&self, _: usize, place: &Vector3<f64>, reach: f64) -> Option<Nearest> {
        round(place - self.center, self.radius, reach)
    }
}

/// A cylinder without ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    /// A point of the axis, in metres.
    pub center: Vector3<f64>,
    /// Direction of the axis.
    pub axis: Unit<Vector3<f64>>,
    /// Radius, in metres.
    pub radius: f64,
}

impl Obstacle for Cylinder {
    fn nearest(&self, _: usize, place: &Vector3<f64>, reach: f64) -> Option<Nearest> {
        let offset = place - self.center;
        let across = offset - self.axis.into_inner() * self.axis.dot(&offset);
        round(across, self.radius, reach)
    }
}

/// A thin horizontal disc, as the pedestal of a drape tester.
///
/// Distances are those from the disc itself; the thickness of contact rounds its rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc {
    /// Center, in metres.
    pub center: Vector3<f64>,
    /// Radius, in metres.
    pub radius: f64,
}

impl Obstacle for Disc {
    fn nearest(&self, _: usize, place: &Vector3<f64>, reach: f64) -> Option<Nearest> {
        let offset = place - self.center;
        let level = Vector3::new(offset.x, 0.0, offset.z);
        let share = (self.radius / level.norm()).min(1.0);
        round(offset - level * share, 0.0, reach)
    }
}

impl Obstacle for Surface {
    fn nearest(&self, _: usize, place: &Vector3<f64>, reach: f64) -> Option<Nearest> {
        let point = Point3::from(place.cast::<f32>());
        let closest = self.closest_within(point, reach as f32)?;
        exactly(self, &closest, place, reach)
    }
}

/// The closest point of a surface to a place, as contact sees it.
///
/// The query rounds to `f32`, which at a stiffness of 500 N/m is the weight of a vertex: the
/// feature is found there, the distance to it here.
pub(super) fn exactly(
    surface: &Surface,
    closest: &ClosestPoint,
    place: &Vector3<f64>,
    reach: f64,
) -> Option<Nearest> {
    let corners = surface.faces()[closest.face as usize];
    let [a, b, c] = corners.map(|vertex| surface.positions()[vertex as usize].coords.cast::<f64>());
    let outward = surface.pseudonormal(closest).cast::<f64>();
    let offset = match closest.feature {
        Feature::Face => {
            let normal = (b - a).cross(&(c - a)).normalize();
            normal * normal.dot(&(place - a))
        }
        Feature::Edge(corner) => {
            let corners = [a, b, c];
            let start = usize::from(corner % 3);
            let along = corners[(start + 1) % 3] - corners[start];
            let offset = place - corners[start];
            let share = (offset.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            offset - along * share
        }
        Feature::Vertex(corner) => place - [a, b, c][usize::from(corner % 3)],
    };
    let length = offset.norm();
    if length < MIN_OFFSET {
        return (outward.norm_squared() > 0.5).then_some(Nearest {
            distance: 0.0,
            normal: outward,
        });
    }
    let side = if outward.dot(&offset) < 0.0 {
        -1.0
    } else {
        1.0
    };
    within(reach, side * length, offset * (side / length))
}

/// Below this distance, in metres, an offset has no direction.
const MIN_OFFSET: f64 = 1e-9;

fn within(reach: f64, distance: f64, normal: Vector3<f64>) -> Option<Nearest> {
    (distance <= reach).then_some(Nearest { distance, normal })
}

/// The nearest point at `radius` around the origin of `offset`.
fn round(offset: Vector3<f64>, radius: f64, reach: f64) -> Option<Nearest> {
    let length = offset.norm();
    let normal = if length < MIN_OFFSET {
        Vector3::y()
    } else {
        offset / length
    };
    within(reach, length - radius, normal)
}
