//! The steps that networks are made of, each over a kernel, on slices.
//!
//! Training calls them as operations of Burn with derivatives ([`tensor_engine`]), inference calls
//! them on reused buffers ([`slice_engine`]); [`Engine`] is what both have in common, so that each
//! stream is written once.

mod cost_engine;
mod engine;
mod extension;
mod feast;
mod linear;
mod pooling;
#[cfg(test)]
mod reference;
mod slice_engine;
mod tensor_engine;
#[cfg(test)]
mod tests;

pub(crate) use cost_engine::{CostEngine, Extent};
pub(crate) use engine::Engine;
pub(crate) use slice_engine::{Buffer, SliceEngine};
pub(crate) use tensor_engine::TensorEngine;
#[cfg(test)]
pub(crate) use tensor_engine::numbers;

use std::sync::Arc;

use garnet_kernel::{Activation, Adjacency, Features, NeighborTable, Workspace};

/// One step, with all that is not a matrix.
#[derive(Debug, Clone)]
pub(crate) enum Op {
    /// `act(Σ_p x_p W_p + b)`; inputs: the parts, the weights one below the other, the bias.
    ///
    /// A part of a single row is the same for all rows of the others.
    Linear { activation: Activation },
    /// A mesh convolution; inputs: the parts, then u, c, w, b, then the residual if there is one.
    Feast {
        adjacency: Arc<Adjacency>,
        has_residual: bool,
        activation: Activation,
    },
    /// The maximum over all rows; one input.
    GlobalMax,
    /// The maximum over the rows that each row of a table names; one input.
    NeighborMax(Arc<NeighborTable>),
    /// Their mean; one input.
    NeighborMean(Arc<NeighborTable>),
}

impl Op {
    /// Rows and columns of the result.
    pub(crate) fn shape(&self, inputs: &[[usize; 2]]) -> [usize; 2] {
        match self {
            Self::Linear { .. } => {
                let (parts, rest) = inputs.split_at(inputs.len() - 2);
                [linear::num_rows(parts), rest[0][1]]
            }
            Self::Feast {
                adjacency,
                has_residual,
                ..
            } => {
                let bias = inputs[inputs.len() - 1 - usize::from(*has_residual)];
                [adjacency.num_vertices(), bias[1]]
            }
            Self::GlobalMax => [1, inputs[0][1]],
            Self::NeighborMax(table) | Self::NeighborMean(table) => {
                [table.num_rows(), inputs[0][1]]
            }
        }
    }

    /// Writes the result; `trace` gets what only the way back needs, and may be left empty.
    pub(crate) fn forward(
        &self,
        inputs: &[Features<'_>],
        output: &mut [f32],
        trace: Option<&mut Vec<u32>>,
        workspace: &Workspace,
    ) {
        match self {
            Self::Linear { activation } => linear::forward(inputs, *activation, output, workspace),
            Self::Feast { .. } => feast::forward(self, inputs, output, workspace),
            Self::GlobalMax => pooling::global_max(inputs[0], output, trace, workspace),
            Self::NeighborMax(table) => {
                pooling::neighbor_max(table, inputs[0], output, trace, workspace);
            }
            Self::NeighborMean(table) => {
                garnet_kernel::neighbor_mean_forward(table, inputs[0], output, workspace);
            }
        }
    }

    /// Overwrites the derivatives by those inputs that are wanted, given that by the output.
    pub(crate) fn backward(
        &self,
        inputs: &[Features<'_>],
        (output, gradient, trace): (&[f32], &[f32], &[u32]),
        gradients: &mut [Option<Vec<f32>>],
        workspace: &Workspace,
    ) {
        let outputs = (output, gradient);
        match self {
            Self::Linear { activation } => {
                linear::backward(inputs, *activation, outputs, gradients, workspace);
            }
            Self::Feast { .. } => feast::backward(self, inputs, outputs, gradients, workspace),
            Self::GlobalMax => {
                if let Some(wanted) = &mut gradients[0] {
                    garnet_kernel::global_max_backward(trace, gradient, wanted);
                }
            }
            Self::NeighborMax(table) => {
                if let Some(wanted) = &mut gradients[0] {
                    let gradient = Features::new(gradient, inputs[0].channels);
                    garnet_kernel::neighbor_max_backward(table, trace, gradient, wanted, workspace);
                }
            }
            Self::NeighborMean(table) => {
                if let Some(wanted) = &mut gradients[0] {
                    let gradient = Features::new(gradient, inputs[0].channels);
                    garnet_kernel::neighbor_mean_backward(table, gradient, wanted, workspace);
                }
            }
        }
    }
}
