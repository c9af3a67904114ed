//! Which way is up in a motion.

use std::fmt;

use garnet_mesh::UpAxis;
use garnet_skin::Vector3;
use nalgebra::UnitQuaternion;

/// The direction that points up in a motion: an axis of its file with a sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Upward {
    /// The x axis.
    X,
    /// Against the x axis.
    MinusX,
    /// The y axis, as in files of graphics.
    Y,
    /// Against the y axis, as in the axes of a camera.
    MinusY,
    /// The z axis, as in AMASS.
    Z,
    /// Against the z axis.
    MinusZ,
}

impl Upward {
    /// All of them; the usual ones first.
    pub const ALL: [Self; 6] = [
        Self::Y,
        Self::Z,
        Self::MinusY,
        Self::MinusZ,
        Self::X,
        Self::MinusX,
    ];

    /// The unit vector that points up.
    pub fn direction(self) -> Vector3 {
        match self {
            Self::X => Vector3::x(),
            Self::MinusX => -Vector3::x(),
            Self::Y => Vector3::y(),
            Self::MinusY => -Vector3::y(),
            Self::Z => Vector3::z(),
            Self::MinusZ => -Vector3::z(),
        }
    }

    /// The turn that brings it to Y, by as little as it takes.
    pub fn to_y_up(self) -> UnitQuaternion<f32> {
        let (axis, quarters) = match self {
            Self::Y => return UnitQuaternion::identity(),
            Self::Z => (Vector3::x_axis(), -1.0),
            Self::MinusZ => (Vector3::x_axis(), 1.0),
            Self::MinusY => (Vector3::x_axis(), 2.0),
            Self::X => (Vector3::z_axis(), 1.0),
            Self::MinusX => (Vector3::z_axis(), -1.0),
        };
        UnitQuaternion::from_axis_angle(&axis, quarters * std::f32::consts::FRAC_PI_2)
    }

    /// The one that a vector points along most; the usual ones first among equals.
    pub fn nearest(vector: &Vector3) -> Self {
        let mut nearest = Self::Y;
        for other in Self::ALL {
            if other.direction().dot(vector) > nearest.direction().dot(vector) {
                nearest = other;
            }
        }
        nearest
    }
}

impl From<UpAxis> for Upward {
    fn from(axis: UpAxis) -> Self {
        match axis {
            UpAxis::Y => Self::Y,
            UpAxis::Z => Self::Z,
        }
    }
}

impl fmt::Display for Upward {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "x",
            Self::MinusX => "-x",
            Self::Y => "y",
            Self::MinusY => "-y",
            Self::Z => "z",
            Self::MinusZ => "-z",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_direction_is_turned_to_y_and_is_nearest_to_itself() {
        for up in Upward::ALL {
            let turned = up.to_y_up() * up.direction();
            assert!((turned - Vector3::y()).norm() < 1e-6, "{up}: {turned}");
            assert_eq!(Upward::nearest(&up.direction()), up);
        }
    }
}
