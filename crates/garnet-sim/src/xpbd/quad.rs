//! Four numbers side by side, written so that the compiler keeps them in one register.

#![expect(
    clippy::inline_always,
    reason = "each is one instruction; a call would cost ten"
)]

use std::ops::{Add, AddAssign, Mul, Sub, SubAssign};

use crate::Vector3;

/// Four `f32`: a vector and a fourth number.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(align(16))]
pub(crate) struct Quad(pub(crate) [f32; 4]);

impl Quad {
    pub(crate) const ZERO: Self = Self([0.0; 4]);

    #[inline(always)]
    pub(crate) const fn splat(value: f32) -> Self {
        Self([value; 4])
    }

    /// A vector, and a fourth number.
    #[inline(always)]
    pub(crate) fn new(vector: Vector3, fourth: f32) -> Self {
        Self([vector.x, vector.y, vector.z, fourth])
    }

    /// The first three numbers.
    #[inline(always)]
    pub(crate) fn xyz(self) -> Vector3 {
        Vector3::new(self.0[0], self.0[1], self.0[2])
    }

    /// The same with a fourth number of 0.
    #[inline(always)]
    pub(crate) fn vector(self) -> Self {
        Self([self.0[0], self.0[1], self.0[2], 0.0])
    }

    /// Inner product of the first three numbers.
    #[inline(always)]
    pub(crate) fn dot3(self, other: Self) -> f32 {
        let [a, b, c, _] = (self * other).0;
        a + b + c
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self([
            f(self.0[0], other.0[0]),
            f(self.0[1], other.0[1]),
            f(self.0[2], other.0[2]),
            f(self.0[3], other.0[3]),
        ])
    }
}

impl Add for Quad {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Quad {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Quad {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Mul<f32> for Quad {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f32) -> Self {
        self * Self::splat(factor)
    }
}

impl AddAssign for Quad {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Quad {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
