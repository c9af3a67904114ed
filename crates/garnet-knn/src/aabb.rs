//! Axis-aligned boxes.

/// An axis-aligned box; `EMPTY` holds nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Aabb {
    pub(crate) min: [f32; 3],
    pub(crate) max: [f32; 3],
}

impl Aabb {
    pub(crate) const EMPTY: Self = Self {
        min: [f32::INFINITY; 3],
        max: [f32::NEG_INFINITY; 3],
    };

    pub(crate) fn of_points(points: impl IntoIterator<Item = [f32; 3]>) -> Self {
        let mut bounds = Self::EMPTY;
        for point in points {
            bounds.include(point);
        }
        bounds
    }

    #[inline]
    pub(crate) fn include(&mut self, point: [f32; 3]) {
        self.merge(&Self {
            min: point,
            max: point,
        });
    }

    #[inline]
    pub(crate) fn merge(&mut self, other: &Self) {
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(other.min[axis]);
            self.max[axis] = self.max[axis].max(other.max[axis]);
        }
    }

    /// Half the surface area; 0 for the empty box.
    #[inline]
    pub(crate) fn half_area(&self) -> f32 {
        let [x, y, z] = std::array::from_fn(|axis| (self.max[axis] - self.min[axis]).max(0.0));
        x * y + y * z + z * x
    }

    /// Whether a point lies in the box, its faces included.
    pub(crate) fn contains(&self, point: [f32; 3]) -> bool {
        (0..3).all(|axis| self.min[axis] <= point[axis] && point[axis] <= self.max[axis])
    }
}
