//! The mesh convolution of FeaStNet.

use garnet_kernel::{
    FeastGradients, FeastInput, FeastLayer, Features, Workspace, feast_backward, feast_forward,
};

use super::Op;

/// Inputs sorted by what they are: parts, u, c, w, b, residual.
struct Sorted<'a> {
    num_parts: usize,
    layer: FeastLayer<'a>,
    input: FeastInput<'a>,
}

fn sorted<'a>(op: &'a Op, inputs: &'a [Features<'a>]) -> Sorted<'a> {
    let Op::Feast {
        adjacency,
        has_residual,
        activation,
    } = op
    else {
        unreachable!("only mesh convolutions come here");
    };
    let num_parts = inputs.len() - 4 - usize::from(*has_residual);
    let (features, rest) = inputs.split_at(num_parts);
    Sorted {
        num_parts,
        layer: FeastLayer {
            num_heads: rest[0].channels,
            out_channels: rest[2].channels,
            u: rest[0].values,
            c: rest[1].values,
            w: rest[2].values,
            b: rest[3].values,
            activation: *activation,
        },
        input: FeastInput {
            adjacency,
            features,
            residual: rest.get(4).map(|residual| residual.values),
        },
    }
}

pub(super) fn forward(op: &Op, inputs: &[Features<'_>], output: &mut [f32], workspace: &Workspace) {
    let Sorted { layer, input, .. } = sorted(op, inputs);
    feast_forward(&layer, &input, output, workspace);
}

pub(super) fn backward(
    op: &Op,
    inputs: &[Features<'_>],
    outputs: (&[f32], &[f32]),
    gradients: &mut [Option<Vec<f32>>],
    workspace: &Workspace,
) {
    let Sorted {
        num_parts,
        layer,
        input,
    } = sorted(op, inputs);
    let (of_parts, of_rest) = gradients.split_at_mut(num_parts);
    let mut of_parts: Vec<Option<&mut [f32]>> =
        of_parts.iter_mut().map(Option::as_deref_mut).collect();
    let mut unwanted: Vec<Vec<f32>> = (inputs[num_parts..num_parts + 4].iter())
        .map(|input| vec![0.0; input.values.len()])
        .collect();
    let mut of_rest = of_rest.iter_mut();
    let mut slots = unwanted.iter_mut().zip(of_rest.by_ref().take(4));
    let mut next = || match slots.next() {
        Some((_, Some(wanted))) => wanted.as_mut_slice(),
        Some((unwanted, None)) => unwanted.as_mut_slice(),
        None => unreachable!("a mesh convolution has four arrays of weights"),
    };
    let (u, c, w, b) = (next(), next(), next(), next());
    let mut wanted = FeastGradients {
        features: &mut of_parts,
        residual: of_rest.next().and_then(Option::as_deref_mut),
        u,
        c,
        w,
        b,
    };
    feast_backward(&layer, &input, outputs, &mut wanted, workspace);
}
