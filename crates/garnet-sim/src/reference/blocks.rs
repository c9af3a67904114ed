//! The second derivatives of an energy, block by block.

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
    /// Adds ∂²E/∂x_row ∂x_column; what couples two vertices is added once, either way round.
    pub(super) fn add(&mut self, row: u32, column: u32, block: &Matrix3<f64>) {
        let index = match row == column {
            true => self.pattern.diagonal(row as usize),
            false => self.pattern.block(row, column),
        };
        match row < column {
            true => self.values[index] += block.transpose(),
            false => self.values[index] += block,
        }
    }

    /// Takes vertices that are held out of the system.
    pub(super) fn hold(&mut self, is_held: &[bool]) {
        for column in 0..self.pattern.num_vertices() {
            for (row, block) in self.pattern.column(column) {
                if is_held[row] || is_held[column] {
                    self.values[block] = match row == column {
                        true => Matrix3::identity(),
                        false => Matrix3::zeros(),
                    };
                }
            }
        }
    }
}
