//! Signed distances of simple solids, negative inside, and their smooth union.
//!
//! All are exact to first order near the surface, which is what blending and projecting need.

use super::curve::Curves;

pub(crate) type Vec3 = nalgebra::Vector3<f64>;

/// The length of a vector of two components; unlike `hypot`, which is slow, not safe from overflow.
#[inline]
pub(crate) fn length(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}

/// The union of two solids with a fillet of width `k` where their distances are alike.
///
/// Polynomial smooth minimum: Quilez 2013.
#[inline]
pub(crate) fn smooth_union(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0);
    a.min(b) - h * h / (4.0 * k)
}

/// The intersection of two solids with a rounded edge of width `k`.
#[inline]
pub(crate) fn smooth_intersection(a: f64, b: f64, k: f64) -> f64 {
    -smooth_union(-a, -b, k)
}

/// A hill (or, with a negative height, a hollow) that is added to the surface of a solid.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bump {
    pub(crate) center: Vec3,
    /// Standard deviations along the axes.
    pub(crate) radii: Vec3,
    pub(crate) height: f64,
}

impl Bump {
    pub(crate) fn new(height: f64, center: [f64; 3], radii: [f64; 3]) -> Self {
        Self {
            center: center.into(),
            radii: radii.into(),
            height,
        }
    }

    /// What is taken from the distance.
    #[inline]
    pub(crate) fn at(&self, point: &Vec3) -> f64 {
        let reach = (point - self.center).component_div(&self.radii);
        let squared = reach.norm_squared();
        if squared > 16.0 {
            return 0.0;
        }
        // Shifted so that it ends at zero.
        self.height * ((-0.5 * squared).exp() - (-8.0_f64).exp())
    }
}

/// An ellipsoid along the axes.
#[inline]
pub(crate) fn ellipsoid(point: &Vec3, center: &Vec3, radii: &Vec3) -> f64 {
    let scaled = (point - center).component_div(radii);
    let length = scaled.norm();
    if length < 1e-6 {
        return -radii.min();
    }
    let gradient = scaled.component_div(radii).norm() / length;
    (length - 1.0) / gradient
}

/// A ball that is swept along a segment while its radius changes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Capsule {
    start: Vec3,
    axis: Vec3,
    radii: [f64; 2],
}

impl Capsule {
    pub(crate) fn new(start: Vec3, end: Vec3, radii: [f64; 2]) -> Self {
        Self {
            start,
            axis: end - start,
            radii,
        }
    }

    #[inline]
    pub(crate) fn distance(&self, point: &Vec3) -> f64 {
        let offset = point - self.start;
        let along = (offset.dot(&self.axis) / self.axis.norm_squared()).clamp(0.0, 1.0);
        let [start, end] = self.radii;
        (offset - along * self.axis).norm() - (start + (end - start) * along)
    }
}

/// One section of a [`Loft`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Section {
    /// Half width to either side.
    pub(crate) side: f64,
    /// Depth to the front of the center.
    pub(crate) front: f64,
    /// Depth to the back of the center.
    pub(crate) back: f64,
    /// Where the center lies, sideways and to the front of the axis.
    pub(crate) center: [f64; 2],
    /// Exponent of the superellipse: 2 is an ellipse, more is squarer.
    pub(crate) exponent: f64,
}

impl Section {
    /// An ellipse about the axis.
    pub(crate) fn ellipse(side: f64, depth: f64) -> Self {
        Self {
            side,
            front: depth,
            back: depth,
            center: [0.0, 0.0],
            exponent: 2.0,
        }
    }

    pub(crate) fn centered(mut self, side: f64, front: f64) -> Self {
        self.center = [side, front];
        self
    }

    pub(crate) fn squared(mut self, exponent: f64) -> Self {
        self.exponent = exponent;
        self
    }

    fn values(&self) -> [f64; 6] {
        let [side, front] = self.center;
        [self.side, self.front, self.back, side, front, self.exponent]
    }
}

/// Superelliptic sections along a straight axis, with rounded ends.
#[derive(Debug, Clone)]
pub(crate) struct Loft {
    start: Vec3,
    axis: Vec3,
    side: Vec3,
    front: Vec3,
    length: f64,
    curves: Curves<6>,
    /// Length of the rounded ends over the smallest half axis: at the start and at the end.
    caps: [f64; 2],
}

impl Loft {
    /// A loft from `start` to `end` whose sections have their side towards `side`; `stations` are
    /// pairs of a place from 0 to 1 and the section there.
    pub(crate) fn new(
        [start, end]: [Vec3; 2],
        side: Vec3,
        stations: &[(f64, Section)],
        smoothing: f64,
    ) -> Self {
        let length = (end - start).norm();
        let axis = (end - start) / length;
        let side = (side - axis * side.dot(&axis)).normalize();
        // To the front of the body, or upwards for an axis that points there itself.
        let across = side.cross(&axis);
        let front = if across.z + 0.5 * across.y < 0.0 {
            -across
        } else {
            across
        };
        let places: Vec<f64> = stations.iter().map(|&(place, _)| place).collect();
        let values: Vec<[f64; 6]> = stations
            .iter()
            .map(|(_, section)| section.values())
            .collect();
        Self {
            start,
            axis,
            side,
            front,
            length,
            curves: Curves::new(&places, &values, smoothing),
            caps: [1.0; 2],
        }
    }

    pub(crate) fn with_caps(mut self, caps: [f64; 2]) -> Self {
        self.caps = caps;
        self
    }

    #[inline]
    pub(crate) fn distance(&self, point: &Vec3) -> f64 {
        let offset = point - self.start;
        let along = offset.dot(&self.axis);
        let [side, front, back, center_side, center_front, exponent] =
            self.curves.at(along / self.length);
        let x = offset.dot(&self.side) - center_side;
        let z = offset.dot(&self.front) - center_front;
        let depth = if z >= 0.0 { front } else { back };
        let (u, v) = (x.abs() / side, z.abs() / depth);
        let (radius, gradient) = if (exponent - 2.0).abs() < 1e-9 {
            let radius = length(u, v).max(1e-3);
            (radius, length(u / side, v / depth) / radius)
        } else {
            let (u_power, v_power) = (u.powf(exponent - 1.0), v.powf(exponent - 1.0));
            let power = (u_power * u + v_power * v).max(1e-8);
            let radius = power.powf(1.0 / exponent);
            let slope = length(u_power / side, v_power / depth);
            (radius, slope * radius / power)
        };
        let gradient = gradient.max(0.5 / side.max(depth));
        let past = if along < 0.0 {
            -along
        } else {
            along - self.length
        };
        if past <= 0.0 {
            return (radius - 1.0) / gradient;
        }
        let cap = self.caps[usize::from(along > 0.0)] * side.min(0.5 * (front + back));
        let total = length(radius, past / cap);
        // Towards the pole the gradient is that of the cap.
        let share = (radius / total).powi(2);
        (total - 1.0) / (share * gradient + (1.0 - share) / cap)
    }

    /// Coordinates of a point in the loft: place along the axis in metres, and sideways and to the
    /// front in units of the section there.
    pub(crate) fn coordinates(&self, point: &Vec3) -> [f64; 3] {
        let offset = point - self.start;
        let along = offset.dot(&self.axis);
        let [side, front, back, center_side, center_front, _] = self.curves.at(along / self.length);
        let x = offset.dot(&self.side) - center_side;
        let z = offset.dot(&self.front) - center_front;
        let depth = 0.5 * (front + back);
        [along / self.length, x / side, z / depth]
    }

    /// The point at given coordinates, see [`Loft::coordinates`].
    pub(crate) fn point(&self, [along, side_units, front_units]: [f64; 3]) -> Vec3 {
        let [side, front, back, center_side, center_front, _] = self.curves.at(along);
        let depth = 0.5 * (front + back);
        self.start
            + self.axis * (along * self.length)
            + self.side * (center_side + side_units * side)
            + self.front * (center_front + front_units * depth)
    }

    /// The point of the axis of the sections at a place from 0 to 1.
    pub(crate) fn center(&self, along: f64) -> Vec3 {
        self.point([along, 0.0, 0.0])
    }
}

/// The perimeter of a superellipse of half axes 1 and `depth`.
pub(crate) fn perimeter(depth: f64, exponent: f64) -> f64 {
    const SEGMENTS: usize = 96;
    let corner = |segment: usize| {
        let angle = segment as f64 / SEGMENTS as f64 * std::f64::consts::FRAC_PI_2;
        let power = 2.0 / exponent;
        [
            angle.cos().powf(power),
            depth * angle.sin().abs().powf(power),
        ]
    };
    let lengths = (0..SEGMENTS).map(|segment| {
        let ([a, b], [c, d]) = (corner(segment), corner(segment + 1));
        (c - a).hypot(d - b)
    });
    4.0 * lengths.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_has_the_perimeter_of_a_circle() {
        approx::assert_relative_eq!(
            perimeter(1.0, 2.0),
            std::f64::consts::TAU,
            max_relative = 1e-3
        );
        assert!(perimeter(1.0, 4.0) > perimeter(1.0, 2.0));
    }

    #[test]
    fn distances_are_right_to_first_order_at_the_surface() {
        let loft = Loft::new(
            [Vec3::zeros(), Vec3::y()],
            Vec3::x(),
            &[
                (0.0, Section::ellipse(0.2, 0.1)),
                (1.0, Section::ellipse(0.2, 0.1)),
            ],
            0.02,
        );
        for (point, distance) in [
            ([0.21, 0.5, 0.0], 0.01),
            ([0.0, 0.5, 0.11], 0.01),
            ([0.0, 0.5, -0.09], -0.01),
            ([0.0, 1.11, 0.0], 0.01),
        ] {
            approx::assert_relative_eq!(loft.distance(&point.into()), distance, epsilon = 1e-3);
        }
        let ball = ellipsoid(
            &[0.0, 0.0, 0.31].into(),
            &Vec3::zeros(),
            &[0.1, 0.2, 0.3].into(),
        );
        approx::assert_relative_eq!(ball, 0.01, epsilon = 1e-3);
    }

    #[test]
    fn loft_coordinates_lead_back_to_the_point() {
        let loft = Loft::new(
            [Vec3::zeros(), Vec3::new(0.3, -0.6, 0.1)],
            Vec3::x(),
            &[
                (0.0, Section::ellipse(0.2, 0.1)),
                (1.0, Section::ellipse(0.1, 0.1).centered(0.01, 0.02)),
            ],
            0.05,
        );
        let point = Vec3::new(0.2, -0.3, 0.1);
        let back = loft.point(loft.coordinates(&point));
        approx::assert_relative_eq!(back, point, epsilon = 1e-9);
    }
}
