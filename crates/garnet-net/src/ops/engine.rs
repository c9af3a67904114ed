//! What runs the steps of a network.

use burn::module::Param;
use burn::tensor::Tensor;

use super::Op;

/// Runs steps on matrices of its own kind: tensors with derivatives, buffers, or mere extents.
pub(crate) trait Engine {
    /// A matrix; cloning it copies no numbers.
    type Matrix: Clone;

    /// Weights as a matrix; a vector is a single row.
    fn weights<const D: usize>(&self, param: &Param<Tensor<D>>) -> Self::Matrix;

    /// Runs one step.
    fn call(&self, op: Op, inputs: &[&Self::Matrix]) -> Self::Matrix;

    /// Multiplies the last `num_rows` rows by a factor.
    fn with_scaled_rows(&self, matrix: &Self::Matrix, num_rows: usize, factor: f32)
    -> Self::Matrix;

    /// Makes 9 numbers a matrix of 3 by 3 and adds the identity.
    fn near_identity(&self, row: &Self::Matrix) -> Self::Matrix;

    /// A row of zeros.
    fn zeros(&self, columns: usize) -> Self::Matrix;
}
