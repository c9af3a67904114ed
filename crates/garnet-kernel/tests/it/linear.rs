use garnet_kernel::{
    Activation, Features, LinearGradients, LinearInput, LinearLayer, Workspace, linear_backward,
    linear_forward,
};

use crate::reference::{dot, linear};
use crate::values::{ROUNDING, Values, assert_close, wide};

/// Analytic gradients in `f32` against central differences in `f64`.
const GRADIENT: f64 = 1e-4;

/// A part of the input: its values and channels, and whether it is the same for all rows.
pub(crate) struct Part {
    pub(crate) values: Vec<f32>,
    pub(crate) channels: usize,
    pub(crate) is_broadcast: bool,
}

pub(crate) struct Case {
    pub(crate) rows: usize,
    pub(crate) parts: Vec<Part>,
    pub(crate) out: usize,
    pub(crate) w: Vec<f32>,
    pub(crate) b: Vec<f32>,
    pub(crate) activation: Activation,
    pub(crate) dy: Vec<f32>,
}

pub(crate) struct Outcome {
    pub(crate) y: Vec<f32>,
    pub(crate) dx: Vec<Vec<f32>>,
    pub(crate) dw: Vec<f32>,
    pub(crate) db: Vec<f32>,
}

impl Outcome {
    pub(crate) fn tensors(&self) -> Vec<(&'static str, &[f32])> {
        let mut tensors = vec![("y", &*self.y), ("dw", &self.dw), ("db", &self.db)];
        tensors.extend(self.dx.iter().map(|dx| ("dx", &**dx)));
        tensors
    }
}

impl Case {
    /// Positive channels come a row, negative ones are broadcast.
    pub(crate) fn new(rows: usize, channels: &[isize], out: usize, activation: Activation) -> Self {
        let mut values = Values::new((rows * 13 + out) as u64);
        let parts: Vec<Part> = channels
            .iter()
            .map(|&channels| {
                let (is_broadcast, channels) = (channels < 0, channels.unsigned_abs());
                let len = if is_broadcast {
                    channels
                } else {
                    channels * rows
                };
                Part {
                    values: values.numbers(len),
                    channels,
                    is_broadcast,
                }
            })
            .collect();
        let in_channels: usize = parts.iter().map(|part| part.channels).sum();
        Self {
            w: values.numbers(in_channels * out),
            b: values.numbers(out),
            dy: values.numbers(rows * out),
            rows,
            parts,
            out,
            activation,
        }
    }

    pub(crate) fn run(&self, workspace: &Workspace) -> Outcome {
        let layer = LinearLayer {
            out_channels: self.out,
            w: &self.w,
            b: Some(&self.b),
            activation: self.activation,
        };
        let parts: Vec<_> = (self.parts.iter())
            .map(|part| {
                if part.is_broadcast {
                    LinearInput::Broadcast(&part.values)
                } else {
                    LinearInput::PerRow(Features::new(&part.values, part.channels))
                }
            })
            .collect();
        let mut outcome = Outcome {
            y: vec![f32::NAN; self.dy.len()],
            dx: self
                .parts
                .iter()
                .map(|part| vec![f32::NAN; part.values.len()])
                .collect(),
            dw: vec![f32::NAN; self.w.len()],
            db: vec![f32::NAN; self.b.len()],
        };
        linear_forward(&layer, &parts, &mut outcome.y, workspace);
        let mut dx: Vec<_> = outcome.dx.iter_mut().map(|dx| Some(&mut **dx)).collect();
        let mut gradients = LinearGradients {
            parts: &mut dx,
            w: &mut outcome.dw,
            b: Some(&mut outcome.db),
        };
        linear_backward(
            &layer,
            &parts,
            (&outcome.y, &self.dy),
            &mut gradients,
            workspace,
        );
        outcome
    }

    fn expected(&self, parts: &[Vec<f64>], w: &[f64], b: &[f64]) -> Vec<f64> {
        let mut x = Vec::new();
        for row in 0..self.rows {
            for (part, values) in self.parts.iter().zip(parts) {
                let first = if part.is_broadcast {
                    0
                } else {
                    row * part.channels
                };
                x.extend_from_slice(&values[first..][..part.channels]);
            }
        }
        linear(&x, w, b, self.rows, self.activation)
    }

    fn check(&self) {
        let outcome = self.run(&Workspace::new());
        // All tensors in one list: parts, weights, bias.
        let mut tensors: Vec<Vec<f64>> = self.parts.iter().map(|part| wide(&part.values)).collect();
        tensors.extend([wide(&self.w), wide(&self.b)]);
        let num_parts = self.parts.len();
        let forward = |tensors: &[Vec<f64>]| {
            self.expected(
                &tensors[..num_parts],
                &tensors[num_parts],
                &tensors[num_parts + 1],
            )
        };
        assert_close("y", &outcome.y, &forward(&tensors), ROUNDING);

        let dy = wide(&self.dy);
        let mut found: Vec<&[f32]> = outcome.dx.iter().map(|dx| &**dx).collect();
        found.extend([&*outcome.dw, &outcome.db]);
        for (tensor, found) in found.into_iter().enumerate() {
            let picked = Values::new(3).sample(found.len(), 20);
            let step = 1e-6;
            let expected: Vec<f64> = picked
                .iter()
                .map(|&i| {
                    let before = tensors[tensor][i];
                    tensors[tensor][i] = before + step;
                    let above = dot(&forward(&tensors), &dy);
                    tensors[tensor][i] = before - step;
                    let below = dot(&forward(&tensors), &dy);
                    tensors[tensor][i] = before;
                    (above - below) / (2.0 * step)
                })
                .collect();
            let found: Vec<f32> = picked.iter().map(|&i| found[i]).collect();
            assert_close(&format!("gradient {tensor}"), &found, &expected, GRADIENT);
        }
    }
}

#[test]
fn layers_and_gradients_are_those_of_the_concatenation() {
    let leaky = Activation::LeakyRelu;
    Case::new(5, &[3], 4, leaky).check();
    Case::new(1, &[1], 1, leaky).check();
    Case::new(1, &[512], 9, Activation::None).check();
    Case::new(7, &[3, -5, 2], 6, leaky).check();
    Case::new(7, &[-5, 131, -1, 3], 17, leaky).check();
    Case::new(3, &[-4], 2, leaky).check();
    Case::new(600, &[2, -3, 4], 3, Activation::None).check();
    Case::new(600, &[130], 2, leaky).check();
}

#[test]
fn no_rows_are_no_work() {
    let outcome = Case::new(0, &[3, -2], 4, Activation::LeakyRelu).run(&Workspace::new());
    assert!(outcome.y.is_empty());
    assert!(
        outcome
            .dw
            .iter()
            .chain(&outcome.db)
            .chain(&outcome.dx[1])
            .all(|value| *value == 0.0)
    );
}

#[test]
fn a_layer_without_bias_has_bias_zero() {
    let mut case = Case::new(4, &[3], 2, Activation::LeakyRelu);
    case.b.fill(0.0);
    let with_zero = case.run(&Workspace::new()).y;
    let layer = LinearLayer {
        out_channels: 2,
        w: &case.w,
        b: None,
        activation: case.activation,
    };
    let mut y = [0.0; 8];
    let parts = [LinearInput::PerRow(Features::new(&case.parts[0].values, 3))];
    linear_forward(&layer, &parts, &mut y, &Workspace::new());
    assert_eq!(y[..], with_zero);
}
