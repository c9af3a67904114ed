//! The one operation that Burn learns: any [`Op`], forward and backward.
//!
//! Burn's extensions take a fixed number of tensors, and steps have up to [`MAX_INPUTS`]; the
//! places that a step does not use are filled with copies of its first input, which are ignored.

use std::sync::Arc;

use burn::backend::autodiff::checkpoint::{base::Checkpointer, strategy::CheckpointStrategy};
use burn::backend::autodiff::grads::Gradients;
use burn::backend::autodiff::ops::{Backward, Ops, OpsKind};
use burn::backend::flex::FlexTensor;
use burn::backend::tensor::FloatTensor;
use burn::backend::{Autodiff, Backend, Dispatch, Flex, TensorMetadata, backend_extension};
use burn::tensor::{Shape, Tensor, TensorData};
use garnet_kernel::{Features, Workspace};

use super::Op;

/// The most inputs of a step.
pub(super) const MAX_INPUTS: usize = 16;

/// A step and the memory it works in.
#[derive(Debug, Clone)]
pub(super) struct Call {
    pub(super) op: Op,
    pub(super) workspace: Arc<Workspace>,
}

/// Runs a step on tensors.
///
/// # Panics
///
/// If there are more than [`MAX_INPUTS`] inputs, or the device is not Flex.
pub(super) fn call(mut inputs: Vec<Tensor<2>>, call: Call) -> Tensor<2> {
    let num_inputs = inputs.len();
    assert!(
        num_inputs <= MAX_INPUTS,
        "a step has at most {MAX_INPUTS} inputs"
    );
    let filler = inputs[0].clone();
    inputs.resize(MAX_INPUTS, filler);
    let mut inputs = inputs.into_iter().map(Tensor::into_dispatch);
    let mut next = || inputs.next().expect("there are as many as places");
    Tensor::from_dispatch(<Dispatch as KernelOps>::kernel(
        next(),
        next(),
        next(),
        next(),
        next(),
        next(),
        next(),
        next(),
        next(),
        next(),
        next(),
        next(),
        next(),
        next(),
        next(),
        next(),
        num_inputs,
        call,
    ))
}

#[backend_extension(Flex, Autodiff)]
trait KernelOps: Backend {
    #[allow(
        clippy::too_many_arguments,
        reason = "extensions take no lists of tensors"
    )]
    fn kernel(
        x0: FloatTensor<Self>,
        x1: FloatTensor<Self>,
        x2: FloatTensor<Self>,
        x3: FloatTensor<Self>,
        x4: FloatTensor<Self>,
        x5: FloatTensor<Self>,
        x6: FloatTensor<Self>,
        x7: FloatTensor<Self>,
        x8: FloatTensor<Self>,
        x9: FloatTensor<Self>,
        x10: FloatTensor<Self>,
        x11: FloatTensor<Self>,
        x12: FloatTensor<Self>,
        x13: FloatTensor<Self>,
        x14: FloatTensor<Self>,
        x15: FloatTensor<Self>,
        num_inputs: usize,
        call: Call,
    ) -> FloatTensor<Self>;
}

impl KernelOps for Flex {
    fn kernel(
        x0: FloatTensor<Self>,
        x1: FloatTensor<Self>,
        x2: FloatTensor<Self>,
        x3: FloatTensor<Self>,
        x4: FloatTensor<Self>,
        x5: FloatTensor<Self>,
        x6: FloatTensor<Self>,
        x7: FloatTensor<Self>,
        x8: FloatTensor<Self>,
        x9: FloatTensor<Self>,
        x10: FloatTensor<Self>,
        x11: FloatTensor<Self>,
        x12: FloatTensor<Self>,
        x13: FloatTensor<Self>,
        x14: FloatTensor<Self>,
        x15: FloatTensor<Self>,
        num_inputs: usize,
        call: Call,
    ) -> FlexTensor {
        let mut inputs = vec![
            x0, x1, x2, x3, x4, x5, x6, x7, x8, x9, x10, x11, x12, x13, x14, x15,
        ];
        inputs.truncate(num_inputs);
        run(&contiguous(inputs), &call, None)
    }
}

/// What the way back needs.
#[derive(Debug, Clone)]
struct State {
    inputs: Vec<FlexTensor>,
    output: FlexTensor,
    trace: Arc<Vec<u32>>,
    call: Call,
}

impl<C: CheckpointStrategy> KernelOps for Autodiff<Flex, C> {
    fn kernel(
        x0: FloatTensor<Self>,
        x1: FloatTensor<Self>,
        x2: FloatTensor<Self>,
        x3: FloatTensor<Self>,
        x4: FloatTensor<Self>,
        x5: FloatTensor<Self>,
        x6: FloatTensor<Self>,
        x7: FloatTensor<Self>,
        x8: FloatTensor<Self>,
        x9: FloatTensor<Self>,
        x10: FloatTensor<Self>,
        x11: FloatTensor<Self>,
        x12: FloatTensor<Self>,
        x13: FloatTensor<Self>,
        x14: FloatTensor<Self>,
        x15: FloatTensor<Self>,
        num_inputs: usize,
        call: Call,
    ) -> FloatTensor<Self> {
        let mut inputs = vec![
            x0, x1, x2, x3, x4, x5, x6, x7, x8, x9, x10, x11, x12, x13, x14, x15,
        ];
        inputs.truncate(num_inputs);
        match num_inputs {
            1 => record::<C, 1>(inputs, call),
            2 => record::<C, 2>(inputs, call),
            3 => record::<C, 3>(inputs, call),
            4 => record::<C, 4>(inputs, call),
            5 => record::<C, 5>(inputs, call),
            6 => record::<C, 6>(inputs, call),
            7 => record::<C, 7>(inputs, call),
            8 => record::<C, 8>(inputs, call),
            9 => record::<C, 9>(inputs, call),
            10 => record::<C, 10>(inputs, call),
            11 => record::<C, 11>(inputs, call),
            12 => record::<C, 12>(inputs, call),
            13 => record::<C, 13>(inputs, call),
            14 => record::<C, 14>(inputs, call),
            15 => record::<C, 15>(inputs, call),
            16 => record::<C, 16>(inputs, call),
            _ => unreachable!("the number of inputs was checked"),
        }
    }
}

/// Runs a step and records it as a child of its `N` inputs.
fn record<C: CheckpointStrategy, const N: usize>(
    inputs: Vec<FloatTensor<Autodiff<Flex, C>>>,
    call: Call,
) -> FloatTensor<Autodiff<Flex, C>> {
    // Guards keep the inputs' nodes until the step is registered.
    let guards = std::array::from_fn(|number| inputs[number].node());
    let inputs = inputs
        .into_iter()
        .map(<FloatTensor<Autodiff<Flex, C>>>::into_primitive);
    let inputs = contiguous(inputs.collect());
    let mut trace = Vec::new();
    let output = run(&inputs, &call, Some(&mut trace));
    let step = KernelBackward::<N>.prepare::<C>(guards);
    match step.compute_bound().stateful() {
        OpsKind::Tracked(step) => {
            let state = State {
                inputs,
                output: output.clone(),
                trace: Arc::new(trace),
                call,
            };
            step.finish(state, output)
        }
        OpsKind::UnTracked(step) => step.finish(output),
    }
}

#[derive(Debug)]
struct KernelBackward<const N: usize>;

impl<const N: usize> Backward<Flex, N> for KernelBackward<N> {
    type State = State;

    fn backward(self, ops: Ops<State, N>, gradients: &mut Gradients, _: &mut Checkpointer) {
        let state = ops.state;
        let by_output = contiguous(vec![gradients.consume::<Flex>(&ops.node)]);
        let features: Vec<Features<'_>> = state.inputs.iter().map(features).collect();
        let mut wanted: Vec<Option<Vec<f32>>> = (ops.parents.iter().zip(&features))
            .map(|(parent, input)| parent.as_ref().map(|_| vec![0.0; input.values.len()]))
            .collect();
        let outputs = (
            state.output.storage::<f32>(),
            by_output[0].storage::<f32>(),
            state.trace.as_slice(),
        );
        let workspace = &state.call.workspace;
        (state.call.op).backward(&features, outputs, &mut wanted, workspace);
        for ((parent, wanted), input) in ops.parents.into_iter().zip(wanted).zip(&state.inputs) {
            if let (Some(parent), Some(wanted)) = (parent, wanted) {
                let gradient = tensor(wanted, input.shape());
                gradients.register::<Flex>(parent.id, gradient);
            }
        }
    }
}

fn run(inputs: &[FlexTensor], call: &Call, trace: Option<&mut Vec<u32>>) -> FlexTensor {
    let features: Vec<Features<'_>> = inputs.iter().map(features).collect();
    let shapes: Vec<[usize; 2]> = (features.iter())
        .map(|input| [input.values.len() / input.channels.max(1), input.channels])
        .collect();
    let shape = call.op.shape(&shapes);
    let mut output = vec![0.0; shape[0] * shape[1]];
    call.op
        .forward(&features, &mut output, trace, &call.workspace);
    tensor(output, Shape::from(shape))
}

fn tensor(values: Vec<f32>, shape: Shape) -> FlexTensor {
    FlexTensor::from_data(TensorData::new(values, shape))
}

fn features(tensor: &FlexTensor) -> Features<'_> {
    Features::new(tensor.storage::<f32>(), tensor.shape()[1])
}

/// The same tensors with all numbers in order, as kernels read them.
fn contiguous(tensors: Vec<FlexTensor>) -> Vec<FlexTensor> {
    let in_order = |tensor: FlexTensor| {
        let is_whole = tensor.storage::<f32>().len() == tensor.shape().num_elements();
        if tensor.is_contiguous() && tensor.layout().start_offset() == 0 && is_whole {
            tensor
        } else {
            tensor.to_contiguous()
        }
    };
    tensors.into_iter().map(in_order).collect()
}
