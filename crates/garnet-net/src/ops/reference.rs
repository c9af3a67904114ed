//! The same steps in plain operations of Burn, to test against.

use burn::tensor::activation::{leaky_relu, softmax};
use burn::tensor::{IndexingUpdateOp, Int, Tensor, TensorData};
use garnet_kernel::{Activation, Adjacency, LEAKY_SLOPE, NeighborTable};

use super::Op;

/// Runs a step in plain operations.
pub(super) fn reference(op: &Op, inputs: &[Tensor<2>]) -> Tensor<2> {
    match op {
        Op::Linear { activation } => linear(inputs, *activation),
        Op::Feast {
            adjacency,
            has_residual,
            activation,
        } => feast(adjacency, *has_residual, *activation, inputs),
        Op::GlobalMax => inputs[0].clone().max_dim(0),
        Op::NeighborMax(table) => gathered(table, &inputs[0]).max_dim(1).squeeze_dim(1),
        Op::NeighborMean(table) => gathered(table, &inputs[0]).mean_dim(1).squeeze_dim(1),
    }
}

fn activated(sums: Tensor<2>, activation: Activation) -> Tensor<2> {
    match activation {
        Activation::None => sums,
        Activation::LeakyRelu => leaky_relu(sums, f64::from(LEAKY_SLOPE)),
    }
}

fn linear(inputs: &[Tensor<2>], activation: Activation) -> Tensor<2> {
    let [parts @ .., w, b] = inputs else {
        unreachable!("a linear layer has weights and a bias");
    };
    let rows = parts.iter().map(|part| part.dims()[0]).max().unwrap();
    let parts = parts.iter().map(|part| {
        let [_, columns] = part.dims();
        part.clone().expand([rows, columns])
    });
    let x = Tensor::cat(parts.collect(), 1);
    activated(x.matmul(w.clone()) + b.clone(), activation)
}

fn feast(
    adjacency: &Adjacency,
    has_residual: bool,
    activation: Activation,
    inputs: &[Tensor<2>],
) -> Tensor<2> {
    let num_parts = inputs.len() - 4 - usize::from(has_residual);
    let (parts, rest) = inputs.split_at(num_parts);
    let [u, c, w, b] = [0, 1, 2, 3].map(|number| rest[number].clone());
    let x = Tensor::cat(parts.to_vec(), 1);
    let device = x.device();
    let ([vertices, channels], [_, heads], [_, outputs]) = (x.dims(), u.dims(), b.dims());
    let (mut from, mut to, mut shares) = (Vec::new(), Vec::new(), Vec::new());
    for vertex in 0..vertices as u32 {
        let ring = adjacency.neighbors(vertex as usize);
        for &other in ring {
            from.push(i64::from(other));
            to.push(i64::from(vertex));
            shares.push(1.0 / ring.len() as f32);
        }
    }
    let edges = from.len();
    let numbers = |list: Vec<i64>| -> Tensor<1, Int> {
        Tensor::from_data(TensorData::new(list, [edges]), &device)
    };
    let (from, to) = (numbers(from), numbers(to));
    let shares = Tensor::<2>::from_data(TensorData::new(shares, [edges, 1]), &device);
    let xu = x.clone().matmul(u);
    let q = softmax(
        xu.clone().select(0, from.clone()) - xu.select(0, to.clone()) + c,
        1,
    ) * shares;
    let heads_of_w = w.reshape([heads, channels, outputs]).swap_dims(0, 1);
    let projected = x.matmul(heads_of_w.reshape([channels, heads * outputs]));
    let projected = projected.select(0, from).reshape([edges, heads, outputs]);
    let messages = (projected * q.unsqueeze_dim::<3>(2)).sum_dim(1);
    let messages = messages.reshape([edges, outputs]);
    let zeros = Tensor::<2>::zeros([vertices, outputs], &device);
    let mut sums = zeros.select_assign(0, to, messages, IndexingUpdateOp::Add) + b;
    if has_residual {
        sums = sums + rest[4].clone();
    }
    activated(sums, activation)
}

fn gathered(table: &NeighborTable, features: &Tensor<2>) -> Tensor<3> {
    let [_, channels] = features.dims();
    let (rows, columns) = (table.num_rows(), table.neighbors_per_row());
    let numbers = (0..rows).flat_map(|row| table.neighbors(row).iter());
    let numbers: Vec<i64> = numbers.map(|&number| i64::from(number)).collect();
    let data = TensorData::new(numbers, [rows * columns]);
    let numbers = Tensor::<1, Int>::from_data(data, &features.device());
    (features.clone().select(0, numbers)).reshape([rows, columns, channels])
}
