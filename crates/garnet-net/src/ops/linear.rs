//! The fused linear layer: parts, bias and activation in one pass.

use garnet_kernel::{
    Activation, Features, LinearGradients, LinearInput, LinearLayer, Workspace, linear_backward,
    linear_forward,
};

/// Rows of the result: those of the parts that have more than one.
pub(super) fn num_rows(parts: &[[usize; 2]]) -> usize {
    parts.iter().map(|shape| shape[0]).max().unwrap_or(0)
}

/// Parts as kernels take them: a single row beside many is broadcast.
fn parts<'a>(inputs: &'a [Features<'a>]) -> Vec<LinearInput<'a>> {
    let rows = |part: &Features<'_>| part.values.len() / part.channels.max(1);
    let most = inputs.iter().map(rows).max().unwrap_or(0);
    let part = |part: &Features<'a>| match rows(part) {
        1 if most > 1 => LinearInput::Broadcast(part.values),
        _ => LinearInput::PerRow(*part),
    };
    inputs.iter().map(part).collect()
}

fn layer<'a>(rest: &'a [Features<'a>], activation: Activation) -> LinearLayer<'a> {
    LinearLayer {
        out_channels: rest[0].channels,
        w: rest[0].values,
        b: Some(rest[1].values),
        activation,
    }
}

pub(super) fn forward(
    inputs: &[Features<'_>],
    activation: Activation,
    output: &mut [f32],
    workspace: &Workspace,
) {
    let (inputs, rest) = inputs.split_at(inputs.len() - 2);
    linear_forward(&layer(rest, activation), &parts(inputs), output, workspace);
}

pub(super) fn backward(
    inputs: &[Features<'_>],
    activation: Activation,
    outputs: (&[f32], &[f32]),
    gradients: &mut [Option<Vec<f32>>],
    workspace: &Workspace,
) {
    let (inputs, rest) = inputs.split_at(inputs.len() - 2);
    let (of_parts, of_rest) = gradients.split_at_mut(inputs.len());
    let [of_w, of_b] = of_rest else {
        unreachable!("a linear layer has weights and a bias");
    };
    let mut of_parts: Vec<Option<&mut [f32]>> =
        of_parts.iter_mut().map(Option::as_deref_mut).collect();
    // Weights that come out of the network (the transformers) are not always wanted.
    let mut unwanted = Vec::new();
    if of_w.is_none() {
        unwanted.resize(rest[0].values.len(), 0.0);
    }
    let mut wanted = LinearGradients {
        parts: &mut of_parts,
        w: of_w.as_deref_mut().unwrap_or(&mut unwanted),
        b: of_b.as_deref_mut(),
    };
    let layer = layer(rest, activation);
    linear_backward(&layer, &parts(inputs), outputs, &mut wanted, workspace);
}
