//! Where a picture is taken from.

use std::f32::consts::{FRAC_PI_2, PI};

/// A direction to look from; the distance follows from what must be in the frame.
///
/// Y is up and a body faces +Z. Named sides are those of the body: its left is at +X, and
/// [`Camera::left`] shows its left side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Turn of the camera about the Y axis, radians: 0 from the front, π/2 from the body's left.
    pub azimuth: f32,
    /// Height of the camera over the horizon, radians: π/2 from above.
    pub elevation: f32,
    /// Parallel or converging lines of sight.
    pub projection: Projection,
    /// Enlargement over the one at which everything just fits.
    pub zoom: f32,
}

/// How lines of sight run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Projection {
    /// Parallel lines of sight: lengths can be compared all over the picture.
    #[default]
    Orthographic,
    /// Lines of sight from one point.
    Perspective {
        /// The angle between the upper and the lower edge of the view, radians, below π.
        field_of_view: f32,
    },
}

impl Camera {
    /// An orthographic camera at an azimuth and an elevation, in radians.
    pub const fn new(azimuth: f32, elevation: f32) -> Self {
        Self {
            azimuth,
            elevation,
            projection: Projection::Orthographic,
            zoom: 1.0,
        }
    }

    /// From +Z.
    pub const fn front() -> Self {
        Self::new(0.0, 0.0)
    }

    /// From -Z.
    pub const fn back() -> Self {
        Self::new(PI, 0.0)
    }

    /// From +X, the left of a body that faces +Z.
    pub const fn left() -> Self {
        Self::new(FRAC_PI_2, 0.0)
    }

    /// From -X, the right of a body that faces +Z.
    pub const fn right() -> Self {
        Self::new(-FRAC_PI_2, 0.0)
    }

    /// From +Y, with the front at the lower edge of the picture.
    pub const fn top() -> Self {
        Self::new(0.0, FRAC_PI_2)
    }

    /// From the front, half to the body's left and a little above.
    pub const fn three_quarter() -> Self {
        Self::new(0.65, 0.22)
    }
}
