//! Inference: steps on reused buffers, without tensors and without derivatives.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use burn::module::{Module, ModuleVisitor, Param, ParamId};
use burn::tensor::Tensor;
use garnet_kernel::{Features, Workspace};

use super::{Engine, Op};

/// Buffers that are free at the moment.
type Pool = Arc<Mutex<Vec<Vec<f32>>>>;

/// A matrix whose memory goes back to the engine when no one needs it any more.
#[derive(Debug)]
pub(crate) struct Buffer {
    values: Vec<f32>,
    columns: usize,
    pool: Pool,
}

impl Buffer {
    /// The numbers, row after row.
    pub(crate) fn values(&self) -> &[f32] {
        &self.values
    }

    fn features(&self) -> Features<'_> {
        Features::new(&self.values, self.columns)
    }

    fn shape(&self) -> [usize; 2] {
        [self.values.len() / self.columns.max(1), self.columns]
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        let values = std::mem::take(&mut self.values);
        let mut pool = self.pool.lock().unwrap_or_else(PoisonError::into_inner);
        pool.push(values);
    }
}

/// Runs steps on slices; holds a copy of the weights, and all memory between scenes.
#[derive(Debug)]
pub(crate) struct SliceEngine {
    weights: HashMap<ParamId, Arc<Buffer>>,
    pool: Pool,
    workspace: Workspace,
}

impl SliceEngine {
    /// Copies the weights of a module.
    pub(crate) fn new(module: &impl Module) -> Self {
        let mut engine = Self {
            weights: HashMap::new(),
            pool: Pool::default(),
            workspace: Workspace::new(),
        };
        module.visit(&mut engine);
        engine
    }

    /// A matrix of the given numbers.
    pub(crate) fn matrix(&self, values: &[f32], columns: usize) -> Arc<Buffer> {
        let mut buffer = self.buffer(values.len());
        buffer.copy_from_slice(values);
        self.wrap(buffer, columns)
    }

    /// Memory kept between scenes, in bytes.
    pub(crate) fn num_bytes(&self) -> usize {
        let pool = self.pool.lock().unwrap_or_else(PoisonError::into_inner);
        let numbers: usize = pool.iter().map(Vec::capacity).sum();
        let weights: usize = (self.weights.values())
            .map(|weights| weights.values.len())
            .sum();
        size_of::<f32>() * (numbers + weights) + self.workspace.num_bytes()
    }

    /// A buffer of `len` numbers with any content: the smallest that is large enough.
    fn buffer(&self, len: usize) -> Vec<f32> {
        let mut pool = self.pool.lock().unwrap_or_else(PoisonError::into_inner);
        let fitting = (0..pool.len())
            .filter(|&number| pool[number].capacity() >= len)
            .min_by_key(|&number| pool[number].capacity());
        let mut buffer = match fitting {
            Some(number) => pool.swap_remove(number),
            None => Vec::with_capacity(len),
        };
        buffer.resize(len, 0.0);
        buffer
    }

    fn wrap(&self, values: Vec<f32>, columns: usize) -> Arc<Buffer> {
        Arc::new(Buffer {
            values,
            columns,
            pool: Arc::clone(&self.pool),
        })
    }
}

impl ModuleVisitor for SliceEngine {
    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        let tensor = param.val();
        let columns = tensor.dims()[D - 1];
        let buffer = self.wrap(super::tensor_engine::numbers(tensor), columns);
        self.weights.insert(param.id, buffer);
    }
}

impl Engine for SliceEngine {
    type Matrix = Arc<Buffer>;

    fn weights<const D: usize>(&self, param: &Param<Tensor<D>>) -> Arc<Buffer> {
        Arc::clone(&self.weights[&param.id])
    }

    fn call(&self, op: Op, inputs: &[&Arc<Buffer>]) -> Arc<Buffer> {
        let shapes: Vec<_> = inputs.iter().map(|input| input.shape()).collect();
        let [rows, columns] = op.shape(&shapes);
        let features: Vec<_> = inputs.iter().map(|input| input.features()).collect();
        let mut output = self.buffer(rows * columns);
        op.forward(&features, &mut output, None, &self.workspace);
        self.wrap(output, columns)
    }

    fn with_scaled_rows(&self, matrix: &Arc<Buffer>, num_rows: usize, factor: f32) -> Arc<Buffer> {
        let mut values = self.buffer(matrix.values.len());
        values.copy_from_slice(&matrix.values);
        let first = values.len() - num_rows * matrix.columns;
        for value in &mut values[first..] {
            *value *= factor;
        }
        self.wrap(values, matrix.columns)
    }

    fn near_identity(&self, row: &Arc<Buffer>) -> Arc<Buffer> {
        let mut values = self.buffer(9);
        values.copy_from_slice(&row.values);
        for diagonal in [0, 4, 8] {
            values[diagonal] += 1.0;
        }
        self.wrap(values, 3)
    }

    fn zeros(&self, columns: usize) -> Arc<Buffer> {
        self.matrix(&vec![0.0; columns], columns)
    }
}
