//! From points in space to points of a view and back.

use garnet_mesh::Point3;
use nalgebra::{Matrix3, RowVector3, Vector3};

use crate::{Camera, Projection};

/// What is left free at each edge of a view, as a share of its size.
pub(crate) const MARGIN: f64 = 0.04;

/// The nearest that a camera sees, as a share of its distance.
const NEAR: f64 = 0.02;

/// A camera that has been placed.
///
/// A view has coordinates of its own: x to the right, y up, z to the viewer; the origin is where
/// the camera aims, and the unit is about half the size of what is in the frame.
#[derive(Debug, Clone)]
pub(crate) struct Lens {
    view_from_world: Matrix3<f64>,
    aim_in_world: Vector3<f64>,
    unit: f64,
    /// Z of the camera, if lines of sight meet there.
    eye: Option<f64>,
    /// Pixels for a unit, without an eye; for a unit at a distance of one unit, with an eye.
    pixels: f64,
    /// The pixel of the origin.
    center: [f64; 2],
}

impl Lens {
    /// Places a camera so that all `points` fit into `[width, height]` pixels.
    pub(crate) fn framing(
        camera: &Camera,
        points: impl Iterator<Item = Point3> + Clone,
        size: [u32; 2],
    ) -> Self {
        let view_from_world = rotation(camera);
        let turned = points.map(|point| view_from_world * point.coords.cast::<f64>());
        let mut low = Vector3::repeat(f64::INFINITY);
        let mut high = Vector3::repeat(f64::NEG_INFINITY);
        for point in turned.clone() {
            low = low.inf(&point);
            high = high.sup(&point);
        }
        if low.x > high.x {
            (low, high) = (Vector3::repeat(-1.0), Vector3::repeat(1.0));
        }
        let middle = 0.5 * (low + high);
        let unit = match 0.5 * (high - low).max() {
            unit if unit > 0.0 => unit,
            _ => 1.0,
        };
        let aim_in_world = view_from_world.transpose() * middle;
        let [width, height] = size.map(f64::from);
        let [free_width, free_height] = [width, height].map(|length| length * (1.0 - 2.0 * MARGIN));
        let mut lens = Self {
            view_from_world,
            aim_in_world,
            unit,
            eye: None,
            pixels: 1.0,
            center: [0.5 * width, 0.5 * height],
        };
        match camera.projection {
            Projection::Orthographic => {
                let half = 0.5 * (high - low) / unit;
                let fit = (0.5 * free_width / half.x).min(0.5 * free_height / half.y);
                // Nothing but a point, or a line in the direction of sight, fits at any size.
                lens.pixels = if fit.is_finite() {
                    fit
                } else {
                    0.5 * free_width.min(free_height)
                };
            }
            Projection::Perspective { field_of_view } => {
                let slope = (0.5 * f64::from(field_of_view)).tan();
                lens.pixels = 0.5 * height / slope;
                let slopes = [free_width, free_height].map(|length| 0.5 * length / lens.pixels);
                let points = turned.map(|point| (point - middle) / unit);
                let [x, y, distance] = tightest(points, slopes);
                lens.aim_in_world += view_from_world.transpose() * Vector3::new(x, y, 0.0) * unit;
                lens.eye = Some(distance);
            }
        }
        lens.pixels *= f64::from(camera.zoom);
        lens
    }

    /// The place of a point of space in the view.
    pub(crate) fn view(&self, point: &Point3) -> Vector3<f64> {
        self.view_from_world * (point.coords.cast::<f64>() - self.aim_in_world) / self.unit
    }

    /// A direction of space in the view.
    pub(crate) fn direction(&self, world: &Vector3<f32>) -> Vector3<f32> {
        self.view_from_world.cast::<f32>() * world
    }

    /// Z of the plane before which nothing is seen.
    pub(crate) fn near(&self) -> Option<f64> {
        self.eye.map(|eye| eye * (1.0 - NEAR))
    }

    /// Column, row and nearness of a point of the view behind the near plane.
    ///
    /// Nearness grows to the viewer and is linear over the picture of a plane: z without an eye,
    /// one over the distance with an eye.
    pub(crate) fn screen(&self, point: &Vector3<f64>) -> [f64; 3] {
        let (scale, nearness) = match self.eye {
            None => (self.pixels, point.z),
            Some(eye) => (self.pixels / (eye - point.z), 1.0 / (eye - point.z)),
        };
        let [x, y] = self.center;
        [x + scale * point.x, y - scale * point.y, nearness]
    }

    /// Z from nearness.
    pub(crate) fn z(&self, nearness: f64) -> f64 {
        match self.eye {
            None => nearness,
            Some(eye) => eye - 1.0 / nearness,
        }
    }

    /// How many pixels a unit has at `z`.
    pub(crate) fn pixels_at(&self, z: f64) -> f64 {
        match self.eye {
            None => self.pixels,
            Some(eye) => self.pixels / (eye - z),
        }
    }

    /// The point at `z` that is seen at a pixel.
    pub(crate) fn point(&self, pixel: [f64; 2], z: f64) -> Vector3<f64> {
        let pixels = self.pixels_at(z);
        let [x, y] = self.center;
        Vector3::new((pixel[0] - x) / pixels, (y - pixel[1]) / pixels, z)
    }

    /// The direction from a point of the view to the viewer.
    pub(crate) fn to_viewer(&self, point: &Vector3<f64>) -> Vector3<f64> {
        match self.eye {
            None => Vector3::z(),
            Some(eye) => Vector3::new(-point.x, -point.y, eye - point.z)
                .try_normalize(0.0)
                .unwrap_or_else(Vector3::z),
        }
    }

    /// Weights of the corners of a triangle where the line of sight through a pixel meets its
    /// plane, before division by their sum; the sum is positive if the front is seen.
    pub(crate) fn weights(&self, pixel: [f64; 2], corners: &[Vector3<f64>; 3]) -> Vector3<f64> {
        let Some(eye) = self.eye else {
            let here = self.point(pixel, 0.0);
            let [a, b, c] = corners.map(|corner| corner - here);
            let cross = |p: Vector3<f64>, q: Vector3<f64>| p.x * q.y - p.y * q.x;
            return Vector3::new(cross(b, c), cross(c, a), cross(a, b));
        };
        let camera = Vector3::z() * eye;
        let ray = self.point(pixel, eye - 1.0) - camera;
        let [a, b, c] = corners.map(|corner| corner - camera);
        -Vector3::new(
            ray.dot(&b.cross(&c)),
            ray.dot(&c.cross(&a)),
            ray.dot(&a.cross(&b)),
        )
    }
}

/// The rows are the directions to the right, up and to the viewer.
fn rotation(camera: &Camera) -> Matrix3<f64> {
    let (sin_azimuth, cos_azimuth) = f64::from(camera.azimuth).sin_cos();
    let (sin_elevation, cos_elevation) = f64::from(camera.elevation).sin_cos();
    let right = RowVector3::new(cos_azimuth, 0.0, -sin_azimuth);
    let to_viewer = RowVector3::new(
        sin_azimuth * cos_elevation,
        sin_elevation,
        cos_azimuth * cos_elevation,
    );
    Matrix3::from_rows(&[right, to_viewer.cross(&right), to_viewer])
}

/// The eye nearest to the points that sees all of them within the slopes of its lines of sight.
///
/// A point is in the frame if `|x - eye.x| <= slope (eye.z - z)`, which is linear in the eye: the
/// two tightest planes meet at it.
fn tightest(points: impl Iterator<Item = Vector3<f64>>, slopes: [f64; 2]) -> [f64; 3] {
    let mut reach = [[f64::NEG_INFINITY; 2]; 2];
    let mut nearest = f64::NEG_INFINITY;
    for point in points {
        for axis in 0..2 {
            let behind = slopes[axis] * point.z;
            reach[axis][0] = reach[axis][0].max(behind + point[axis]);
            reach[axis][1] = reach[axis][1].max(behind - point[axis]);
        }
        nearest = nearest.max(point.z);
    }
    if nearest == f64::NEG_INFINITY {
        return [0.0, 0.0, 1.0 + 1.0 / slopes[0].min(slopes[1])];
    }
    let [x, y] = reach.map(|[plus, minus]| 0.5 * (plus - minus));
    let mut distance = nearest / (1.0 - NEAR) + 0.1;
    for axis in 0..2 {
        distance = distance.max(0.5 * (reach[axis][0] + reach[axis][1]) / slopes[axis]);
    }
    [x, y, distance.max(0.2)]
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    const ROUNDING: f64 = 1e-9;

    fn cloud() -> Vec<Point3> {
        let number = |seed: u32| ((seed.wrapping_mul(2_654_435_761) >> 8) % 1000) as f32 * 1e-3;
        (0..60)
            .map(|i| {
                Point3::new(
                    3.0 * number(3 * i),
                    number(3 * i + 1),
                    2.0 * number(3 * i + 2),
                )
            })
            .collect()
    }

    fn lenses() -> impl Iterator<Item = Lens> {
        let projections = [
            Projection::Orthographic,
            Projection::Perspective { field_of_view: 0.6 },
        ];
        projections.into_iter().map(|projection| {
            let camera = Camera {
                projection,
                ..Camera::three_quarter()
            };
            Lens::framing(&camera, cloud().into_iter(), [300, 200])
        })
    }

    #[test]
    fn the_frame_is_tight() {
        for lens in lenses() {
            let screens = cloud()
                .into_iter()
                .map(|point| lens.screen(&lens.view(&point)));
            let (mut low, mut high) = ([f64::MAX; 2], [f64::MIN; 2]);
            for screen in screens {
                for axis in 0..2 {
                    low[axis] = low[axis].min(screen[axis]);
                    high[axis] = high[axis].max(screen[axis]);
                }
            }
            let (free_x, free_y) = (300.0 * MARGIN, 200.0 * MARGIN);
            assert!(low[0] >= free_x - ROUNDING && high[0] <= 300.0 - free_x + ROUNDING);
            assert!(low[1] >= free_y - ROUNDING && high[1] <= 200.0 - free_y + ROUNDING);
            let tight_x = (low[0] - free_x).abs() < ROUNDING;
            let tight_y = (low[1] - free_y).abs() < ROUNDING;
            assert!(tight_x || tight_y, "{low:?} {high:?}");
        }
    }

    #[test]
    fn a_pixel_leads_back_to_its_point() {
        for lens in lenses() {
            let point = lens.view(&cloud()[7]);
            let [x, y, nearness] = lens.screen(&point);
            let back = lens.point([x, y], lens.z(nearness));
            assert_relative_eq!(back, point, epsilon = ROUNDING);
        }
    }

    #[test]
    fn weights_give_the_point_that_is_seen() {
        for lens in lenses() {
            let corners = [0, 1, 2].map(|index| lens.view(&cloud()[index]));
            let inside = 0.2 * corners[0] + 0.3 * corners[1] + 0.5 * corners[2];
            let [x, y, _] = lens.screen(&inside);
            let weights = lens.weights([x, y], &corners);
            let expected = Vector3::new(0.2, 0.3, 0.5);
            assert_relative_eq!(weights / weights.sum(), expected, epsilon = ROUNDING);
        }
    }
}
