//! The second derivatives of an energy, block by block.

use std::cmp::Ordering;

use nalgebra::Matrix3;

use super::system::Pattern;

/// What to do with directions in which an energy bends downward.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Curvature {
    /// Keep them: the true second derivatives, with which Newton's method converges quadratically.
    True,
    /// Leave them out: positive definite everywhere, so that every step goes downhill.
    Projected,
}

impl Curvature {
    pub(super) fn of(self, value: f64) -> f64 {
        match self {
            Self::True => value,
            Self::Projected => value.max(0.0),
        }
    }
}

/// The blocks of a Newton system, being summed.
#[derive(Debug)]
pub(super) struct Blocks<'a> {
    pub(super) pattern: &'a Pattern,
    /// `[block]`, N/m.
    pub(super) values: &'a mut [Matrix3<f64>],
}

impl Blocks<'_> {
    /// Adds the second derivative by the places of `row` and `column`; what couples two vertices is
    /// added once, either way round.
    pub(super) fn add(&mut self, row: u32, column: u32, block: &Matrix3<f64>) {
        match row.cmp(&column) {
            Ordering::Less => self.values[self.pattern.block(row, column)] += block.transpose(),
            Ordering::Equal => self.values[self.pattern.diagonal(row as usize)] += block,
            Ordering::Greater => self.values[self.pattern.block(row, column)] += block,
        }
    }

    /// Takes vertices that are held out of the system.
    pub(super) fn hold(&mut self, is_held: &[bool]) {
        for column in 0..self.pattern.num_vertices() {
            for (row, block) in self.pattern.column(column) {
                if is_held[row] || is_held[column] {
                    self.values[block] = if row == column {
                        Matrix3::identity()
                    } else {
                        Matrix3::zeros()
                    };
                }
            }
        }
    }
}
