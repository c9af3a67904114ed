//! Counting: steps on extents alone.

use std::cell::Cell;

use burn::module::Param;
use burn::tensor::Tensor;

use super::{Engine, Op};

/// Edges of a triangle mesh for each vertex, that to itself included.
const EDGES_PER_VERTEX: usize = 7;

/// Rows and columns of a matrix.
pub(crate) type Extent = [usize; 2];

/// Adds up multiplications and additions.
#[derive(Debug, Default)]
pub(crate) struct CostEngine {
    flops: Cell<u64>,
}

impl CostEngine {
    /// Multiplications and additions so far.
    pub(crate) fn flops(&self) -> u64 {
        self.flops.get()
    }
}

impl Engine for CostEngine {
    type Matrix = Extent;

    fn weights<const D: usize>(&self, param: &Param<Tensor<D>>) -> Extent {
        let shape = param.lazy_shape();
        let columns = shape[D - 1];
        [shape.iter().product::<usize>() / columns, columns]
    }

    fn call(&self, op: Op, inputs: &[&Extent]) -> Extent {
        let inputs: Vec<Extent> = inputs.iter().map(|&&input| input).collect();
        let shape = op.shape(&inputs);
        let flops = match &op {
            Op::Linear { .. } => {
                let parts = &inputs[..inputs.len() - 2];
                parts.iter().map(|part| part[0] * part[1]).sum::<usize>() * 2 * shape[1]
            }
            Op::Feast { has_residual, .. } => {
                let num_parts = inputs.len() - 4 - usize::from(*has_residual);
                let channels: usize = inputs[..num_parts].iter().map(|part| part[1]).sum();
                let heads = inputs[num_parts][1];
                let per_vertex = channels * heads * (shape[1] + 1 + EDGES_PER_VERTEX);
                2 * shape[0] * per_vertex
            }
            Op::GlobalMax => inputs[0][0] * inputs[0][1],
            Op::NeighborMax(table) | Op::NeighborMean(table) => {
                table.neighbors_per_row() * shape[0] * shape[1]
            }
        };
        self.flops.set(self.flops.get() + flops as u64);
        shape
    }

    fn with_scaled_rows(&self, matrix: &Extent, _: usize, _: f32) -> Extent {
        *matrix
    }

    fn near_identity(&self, _: &Extent) -> Extent {
        [3, 3]
    }

    fn zeros(&self, columns: usize) -> Extent {
        [1, columns]
    }
}
