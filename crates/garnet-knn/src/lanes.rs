//! Four numbers side by side, written so that the compiler keeps them in one register.

use std::ops::{Add, Div, Mul, Sub};

/// How many boxes a node and how many triangles a block holds.
pub(crate) const NUM_LANES: usize = 4;

/// Four `f32` that are computed with together.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(16))]
pub(crate) struct Lanes(pub(crate) [f32; NUM_LANES]);

impl Lanes {
    pub(crate) const fn splat(value: f32) -> Self {
        Self([value; NUM_LANES])
    }

    /// The larger of each lane; `other` where a lane is NaN.
    #[inline]
    pub(crate) fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    /// The smaller of each lane; `other` where a lane is NaN.
    #[inline]
    pub(crate) fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline]
    pub(crate) fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    /// `yes` where `self > other`, else `no`.
    #[inline]
    pub(crate) fn select_greater(self, other: Self, yes: Self, no: Self) -> Self {
        Self(std::array::from_fn(|i| {
            if self.0[i] > other.0[i] {
                yes.0[i]
            } else {
                no.0[i]
            }
        }))
    }

    #[inline]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    /// The smallest of the four.
    #[inline]
    pub(crate) fn min_lane(self) -> f32 {
        let [a, b, c, d] = self.0;
        a.min(b).min(c.min(d))
    }

    /// The largest of the four.
    #[inline]
    pub(crate) fn max_lane(self) -> f32 {
        let [a, b, c, d] = self.0;
        a.max(b).max(c.max(d))
    }
}

impl Add for Lanes {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Lanes {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Lanes {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Div for Lanes {
    type Output = Self;

    #[inline]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
}

/// Four vectors `[axis]`.
pub(crate) type Lanes3 = [Lanes; 3];

#[inline]
pub(crate) fn splat3(v: [f32; 3]) -> Lanes3 {
    v.map(Lanes::splat)
}

#[inline]
pub(crate) fn sub3(a: Lanes3, b: Lanes3) -> Lanes3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
pub(crate) fn dot3(a: Lanes3, b: Lanes3) -> Lanes {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(crate) fn cross3(a: Lanes3, b: Lanes3) -> Lanes3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The largest absolute component of each vector.
#[inline]
pub(crate) fn max_abs3(a: Lanes3) -> Lanes {
    a[0].abs().max(a[1].abs()).max(a[2].abs())
}
