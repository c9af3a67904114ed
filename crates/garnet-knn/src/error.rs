//! What can be wrong with points handed to a tree or a surface.

/// What can be wrong with points handed to a tree or a surface.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KnnError {
    /// A coordinate is NaN or infinite, or beyond what surfaces take.
    #[error("point {index} has the coordinate `{value}`, which is not finite or out of range")]
    CoordinateOutOfRange {
        /// Number of the point, from 0.
        index: usize,
        /// The coordinate as found.
        value: f32,
    },
    /// New positions do not fit the surface.
    #[error("there are {found} positions for {expected} vertices")]
    PositionCount {
        /// How many positions were given.
        found: usize,
        /// How many vertices the surface has.
        expected: usize,
    },
    /// More points than a `u32` can number.
    #[error("{count} points are more than the 4294967295 that can be numbered")]
    TooManyPoints {
        /// How many points were given.
        count: usize,
    },
}

/// Refuses the first coordinate that is NaN or infinite.
pub(crate) fn check_finite(points: &[garnet_mesh::Point3]) -> Result<(), KnnError> {
    for (index, point) in points.iter().enumerate() {
        if let Some(&value) = point.iter().find(|value| !value.is_finite()) {
            return Err(KnnError::CoordinateOutOfRange { index, value });
        }
    }
    Ok(())
}
