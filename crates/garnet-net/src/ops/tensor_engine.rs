//! Training: steps as operations of Burn, with derivatives where the device records them.

use std::sync::Arc;

use burn::module::Param;
use burn::tensor::{Device, Tensor, TensorData};
use garnet_kernel::Workspace;

use super::extension::{Call, call};
use super::{Engine, Op};

/// Runs steps on tensors of a device.
#[derive(Debug, Clone)]
pub(crate) struct TensorEngine {
    device: Device,
    workspace: Arc<Workspace>,
}

impl TensorEngine {
    /// For tensors of `device`, with memory for the kernels.
    pub(crate) fn new(device: &Device, workspace: &Arc<Workspace>) -> Self {
        Self {
            device: device.clone(),
            workspace: Arc::clone(workspace),
        }
    }

    /// A matrix of the given numbers.
    pub(crate) fn matrix(&self, values: &[f32], columns: usize) -> Tensor<2> {
        let shape = [values.len() / columns.max(1), columns];
        Tensor::from_data(TensorData::new(values.to_vec(), shape), &self.device)
    }
}

/// The numbers of a tensor, row after row.
pub(crate) fn numbers<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    let data = tensor.into_data().convert::<f32>();
    data.try_into_vec().expect("the data was converted to f32")
}

impl Engine for TensorEngine {
    type Matrix = Tensor<2>;

    fn weights<const D: usize>(&self, param: &Param<Tensor<D>>) -> Tensor<2> {
        let tensor = param.val();
        let shape = tensor.dims();
        let columns = shape[D - 1];
        let rows = shape.iter().product::<usize>() / columns;
        tensor.reshape([rows, columns])
    }

    fn call(&self, op: Op, inputs: &[&Tensor<2>]) -> Tensor<2> {
        let inputs = inputs.iter().map(|&input| input.clone()).collect();
        let workspace = Arc::clone(&self.workspace);
        call(inputs, Call { op, workspace })
    }

    fn with_scaled_rows(&self, matrix: &Tensor<2>, num_rows: usize, factor: f32) -> Tensor<2> {
        let [rows, _] = matrix.dims();
        let mut factors = vec![1.0; rows];
        factors[rows - num_rows..].fill(factor);
        matrix.clone() * self.matrix(&factors, 1)
    }

    fn near_identity(&self, row: &Tensor<2>) -> Tensor<2> {
        row.clone().reshape([3, 3]) + Tensor::eye(3, &self.device)
    }

    fn zeros(&self, columns: usize) -> Tensor<2> {
        Tensor::zeros([1, columns], &self.device)
    }
}
