use std::sync::Arc;

use burn::tensor::{Device, Tensor, TensorData};
use garnet_kernel::{Activation, Adjacency, NeighborTable};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::reference::reference;
use super::tensor_engine::numbers;
use super::{Engine, Op, TensorEngine};

/// Bound on the difference of kernels and plain tensors, relative to the largest number.
const TOLERANCE: f32 = 1e-5;

fn random(shape: [usize; 2], seed: u64) -> TensorData {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut number = || random.next_u32() as f32 / u32::MAX as f32 - 0.5;
    TensorData::new(
        (0..shape[0] * shape[1])
            .map(|_| number())
            .collect::<Vec<_>>(),
        shape,
    )
}

/// The result and the derivatives of a weighted sum of it, by each input.
fn run(
    run: impl Fn(&[Tensor<2>]) -> Tensor<2>,
    inputs: &[TensorData],
    device: &Device,
) -> Vec<Vec<f32>> {
    let inputs: Vec<Tensor<2>> = (inputs.iter())
        .map(|data| Tensor::from_data(data.clone(), device).require_grad())
        .collect();
    let output = run(&inputs);
    let weights = Tensor::from_data(random(output.dims(), 99), device);
    let gradients = (output.clone() * weights).sum().backward();
    let mut results = vec![numbers(output)];
    for input in &inputs {
        let gradient = input
            .grad(&gradients)
            .expect("every input has a derivative");
        results.push(numbers(gradient));
    }
    results
}

fn check(op: &Op, shapes: &[[usize; 2]]) {
    let device = Device::flex().autodiff();
    let engine = TensorEngine::new(&device, &Arc::default());
    let inputs: Vec<TensorData> = shapes
        .iter()
        .copied()
        .zip(0..)
        .map(|(s, n)| random(s, n))
        .collect();
    let by_kernel =
        |inputs: &[Tensor<2>]| engine.call(op.clone(), &inputs.iter().collect::<Vec<_>>());
    let ours = run(by_kernel, &inputs, &device);
    let theirs = run(|inputs| reference(op, inputs), &inputs, &device);
    for (number, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
        assert_eq!(ours.len(), theirs.len());
        let largest = theirs
            .iter()
            .fold(0.0_f32, |most, value| most.max(value.abs()));
        assert!(largest > 0.0, "{op:?}: array {number} is not tested");
        for (a, b) in ours.iter().zip(theirs) {
            assert!(
                (a - b).abs() <= TOLERANCE * largest,
                "{op:?}: array {number}: {a} and {b}"
            );
        }
    }
}

fn ring_of(num_vertices: u32) -> Arc<Adjacency> {
    let lists: Vec<Vec<u32>> = (0..num_vertices)
        .map(|vertex| match vertex {
            // One vertex sees itself alone.
            3 => vec![],
            _ => [1, 5, num_vertices - 1]
                .map(|step| (vertex + step) % num_vertices)
                .to_vec(),
        })
        .collect();
    Arc::new(Adjacency::from_lists(&lists).unwrap())
}

#[test]
fn linear_layers_agree_with_plain_tensors() {
    for activation in [Activation::None, Activation::LeakyRelu] {
        let op = Op::Linear { activation };
        check(&op, &[[300, 7], [7, 5], [1, 5]]);
        check(&op, &[[300, 7], [1, 4], [300, 3], [14, 33], [1, 33]]);
        check(&op, &[[1, 4], [1, 3], [7, 9], [1, 9]]);
    }
}

#[test]
fn mesh_convolutions_agree_with_plain_tensors() {
    for heads in [1, 4, 8, 9] {
        for has_residual in [false, true] {
            let op = Op::Feast {
                adjacency: ring_of(150),
                has_residual,
                activation: Activation::LeakyRelu,
            };
            let channels = 16 + 3;
            let mut shapes = vec![[150, 16], [150, 3], [channels, heads], [1, heads]];
            shapes.extend([[heads * channels, 12], [1, 12]]);
            shapes.extend(has_residual.then_some([150, 12]));
            if heads == 1 {
                // A single head has the weight 1 whatever steers it.
                continue;
            }
            check(&op, &shapes);
        }
    }
}

#[test]
fn pooling_agrees_with_plain_tensors() {
    let table = |num_sources: u32, columns: usize| {
        let numbers = (0..90 * columns as u32).map(|number| number * 37 % num_sources);
        Arc::new(NeighborTable::new(num_sources as usize, columns, numbers.collect()).unwrap())
    };
    check(&Op::GlobalMax, &[[400, 21]]);
    check(&Op::NeighborMax(table(70, 15)), &[[70, 20]]);
    check(&Op::NeighborMean(table(70, 16)), &[[70, 20]]);
}
