use garnet_kernel::{
    Activation, Adjacency, FeastGradients, FeastInput, FeastLayer, Features, Workspace,
    feast_backward, feast_forward,
};
use proptest::prelude::*;

use crate::reference::{Feast, dot};
use crate::values::{ROUNDING, Values, assert_close, wide};

/// Analytic gradients in `f32` against central differences in `f64`.
const GRADIENT: f64 = 1e-4;

/// A convolution with all its tensors; the features are split into two parts where there are two
/// channels.
pub(crate) struct Case {
    pub(crate) adjacency: Adjacency,
    pub(crate) num_heads: usize,
    pub(crate) out: usize,
    pub(crate) parts: Vec<(Vec<f32>, usize)>,
    pub(crate) u: Vec<f32>,
    pub(crate) c: Vec<f32>,
    pub(crate) w: Vec<f32>,
    pub(crate) b: Vec<f32>,
    pub(crate) residual: Vec<f32>,
    pub(crate) activation: Activation,
    pub(crate) dy: Vec<f32>,
}

/// Outputs and all gradients, in one order.
pub(crate) struct Outcome {
    pub(crate) y: Vec<f32>,
    pub(crate) dx: Vec<Vec<f32>>,
    pub(crate) du: Vec<f32>,
    pub(crate) dc: Vec<f32>,
    pub(crate) dw: Vec<f32>,
    pub(crate) db: Vec<f32>,
    pub(crate) d_residual: Vec<f32>,
}

impl Outcome {
    pub(crate) fn tensors(&self) -> Vec<(&'static str, &[f32])> {
        let mut tensors = vec![
            ("y", &*self.y),
            ("du", &self.du),
            ("dc", &self.dc),
            ("dw", &self.dw),
            ("db", &self.db),
            ("d_residual", &self.d_residual),
        ];
        tensors.extend(self.dx.iter().map(|dx| ("dx", &**dx)));
        tensors
    }
}

impl Case {
    pub(crate) fn new(
        num_vertices: usize,
        part_channels: &[usize],
        num_heads: usize,
        out: usize,
    ) -> Self {
        let mut values = Values::new((num_vertices * 31 + num_heads * 7 + out) as u64);
        let channels: usize = part_channels.iter().sum();
        Self {
            adjacency: values.graph(num_vertices),
            num_heads,
            out,
            parts: part_channels
                .iter()
                .map(|&k| (values.numbers(num_vertices * k), k))
                .collect(),
            u: values.numbers(channels * num_heads),
            c: values.numbers(num_heads),
            w: values.numbers(num_heads * channels * out),
            b: values.numbers(out),
            residual: values.numbers(num_vertices * out),
            activation: Activation::LeakyRelu,
            dy: values.numbers(num_vertices * out),
        }
    }

    pub(crate) fn run(&self, workspace: &Workspace) -> Outcome {
        let layer = FeastLayer {
            num_heads: self.num_heads,
            out_channels: self.out,
            u: &self.u,
            c: &self.c,
            w: &self.w,
            b: &self.b,
            activation: self.activation,
        };
        let features: Vec<_> = self
            .parts
            .iter()
            .map(|(part, k)| Features::new(part, *k))
            .collect();
        let input = FeastInput {
            adjacency: &self.adjacency,
            features: &features,
            residual: Some(&self.residual),
        };
        let mut y = vec![f32::NAN; self.dy.len()];
        feast_forward(&layer, &input, &mut y, workspace);

        let unset = |like: &[f32]| vec![f32::NAN; like.len()];
        let mut outcome = Outcome {
            dx: self.parts.iter().map(|(part, _)| unset(part)).collect(),
            du: unset(&self.u),
            dc: unset(&self.c),
            dw: unset(&self.w),
            db: unset(&self.b),
            d_residual: unset(&self.residual),
            y,
        };
        let mut dx: Vec<_> = outcome.dx.iter_mut().map(|dx| Some(&mut **dx)).collect();
        let mut gradients = FeastGradients {
            features: &mut dx,
            residual: Some(&mut outcome.d_residual),
            u: &mut outcome.du,
            c: &mut outcome.dc,
            w: &mut outcome.dw,
            b: &mut outcome.db,
        };
        feast_backward(
            &layer,
            &input,
            (&outcome.y, &self.dy),
            &mut gradients,
            workspace,
        );
        outcome
    }

    /// The same with one concatenated input.
    fn reference(&self) -> Feast {
        let x = (0..self.adjacency.num_vertices())
            .flat_map(|i| {
                self.parts
                    .iter()
                    .flat_map(move |(part, k)| wide(&part[i * k..][..*k]))
            })
            .collect();
        Feast {
            x,
            u: wide(&self.u),
            c: wide(&self.c),
            w: wide(&self.w),
            b: wide(&self.b),
            residual: wide(&self.residual),
        }
    }

    fn check_forward(&self) {
        let expected = self.reference().forward(&self.adjacency, self.activation);
        assert_close("y", &self.run(&Workspace::new()).y, &expected, ROUNDING);
    }

    /// Compares some components of each gradient.
    fn check_gradients(&self) {
        let outcome = self.run(&Workspace::new());
        let dy = wide(&self.dy);
        let channels: Vec<usize> = self.parts.iter().map(|(_, k)| *k).collect();
        let dx: Vec<f32> = (0..self.adjacency.num_vertices())
            .flat_map(|i| {
                outcome
                    .dx
                    .iter()
                    .zip(&channels)
                    .flat_map(move |(dx, k)| dx[i * k..][..*k].to_vec())
            })
            .collect();
        let found = [
            &dx,
            &outcome.du,
            &outcome.dc,
            &outcome.dw,
            &outcome.db,
            &outcome.d_residual,
        ];
        let mut reference = self.reference();
        let mut values = Values::new(5);
        for (tensor, found) in found.into_iter().enumerate() {
            let picked = values.sample(found.len(), 25);
            let step = 1e-6;
            let mut name = "";
            let expected: Vec<f64> = picked
                .iter()
                .map(|&i| {
                    let mut loss_at = |shift: f64| {
                        let tensor = &mut reference.tensors()[tensor];
                        name = tensor.0;
                        let before = std::mem::replace(&mut tensor.1[i], 0.0);
                        tensor.1[i] = before + shift;
                        let loss = dot(&reference.forward(&self.adjacency, self.activation), &dy);
                        reference.tensors()[index(name)].1[i] = before;
                        loss
                    };
                    (loss_at(step) - loss_at(-step)) / (2.0 * step)
                })
                .collect();
            let found: Vec<f32> = picked.iter().map(|&i| found[i]).collect();
            assert_close(name, &found, &expected, GRADIENT);
        }
    }
}

fn index(name: &str) -> usize {
    ["x", "u", "c", "w", "b", "residual"]
        .iter()
        .position(|n| *n == name)
        .expect("a known name")
}

#[test]
fn forward_is_the_definition_for_odd_sizes() {
    for num_heads in [1, 2, 8, 9, 16, 20] {
        Case::new(37, &[3], num_heads, 5).check_forward();
    }
    for parts in [&[1][..], &[3], &[16], &[19], &[128, 3], &[1, 7, 2]] {
        Case::new(41, parts, 8, 17).check_forward();
    }
    Case::new(1, &[1], 1, 1).check_forward();
    Case::new(129, &[131], 9, 1).check_forward();
}

#[test]
fn gradients_are_those_of_central_differences() {
    for num_heads in [1, 8, 9, 16] {
        Case::new(11, &[3], num_heads, 4).check_gradients();
    }
    Case::new(1, &[1], 1, 1).check_gradients();
    Case::new(9, &[17, 3], 8, 5).check_gradients();
    let mut without_activation = Case::new(13, &[5, 2], 2, 3);
    without_activation.activation = Activation::None;
    without_activation.check_gradients();
}

#[test]
fn gradients_hold_across_tiles_and_blocks() {
    Case::new(300, &[2, 1], 3, 2).check_gradients();
    Case::new(2 * 128 * 17 + 1, &[1], 1, 1).check_forward();
}

#[test]
fn an_empty_graph_gives_nothing() {
    let outcome = Case::new(0, &[3], 2, 4).run(&Workspace::new());
    assert!(outcome.y.is_empty());
    assert!(
        outcome
            .dw
            .iter()
            .chain(&outcome.du)
            .chain(&outcome.dc)
            .all(|value| *value == 0.0)
    );
}

#[test]
fn huge_logits_stay_finite_and_choose_one_head() {
    let mut case = Case::new(20, &[4], 3, 2);
    case.c = vec![-1e4, 1e4, 0.0];
    case.u.iter_mut().for_each(|u| *u *= 100.0);
    let outcome = case.run(&Workspace::new());
    assert!(
        outcome
            .tensors()
            .iter()
            .all(|(_, values)| values.iter().all(|value| value.is_finite()))
    );
    case.check_forward();
}

#[test]
fn features_moved_by_a_constant_move_only_through_the_weights() {
    // One constant head: y = mean of x_j W, so a shift of x by t shifts y by t W.
    let mut case = Case::new(30, &[3], 1, 2);
    case.activation = Activation::None;
    let before = case.run(&Workspace::new()).y;
    case.parts[0].0.iter_mut().for_each(|x| *x += 0.5);
    let after = case.run(&Workspace::new()).y;
    for (i, (before, after)) in before.iter().zip(&after).enumerate() {
        let shift: f32 = (0..3).map(|k| 0.5 * case.w[k * 2 + i % 2]).sum();
        assert!((after - before - shift).abs() < 1e-5);
    }
}

#[test]
fn gradients_that_are_not_wanted_are_left_out() {
    let case = Case::new(50, &[3, 2], 4, 3);
    let all = case.run(&Workspace::new());
    let layer = FeastLayer {
        num_heads: 4,
        out_channels: 3,
        u: &case.u,
        c: &case.c,
        w: &case.w,
        b: &case.b,
        activation: case.activation,
    };
    let features: Vec<_> = case
        .parts
        .iter()
        .map(|(part, k)| Features::new(part, *k))
        .collect();
    let input = FeastInput {
        adjacency: &case.adjacency,
        features: &features,
        residual: Some(&case.residual),
    };
    let (mut dx, mut du, mut dc) = (vec![0.0; 100], vec![0.0; 20], vec![0.0; 4]);
    let (mut dw, mut db) = (vec![0.0; 60], vec![0.0; 3]);
    let mut gradients = FeastGradients {
        features: &mut [None, Some(&mut dx)],
        residual: None,
        u: &mut du,
        c: &mut dc,
        w: &mut dw,
        b: &mut db,
    };
    feast_backward(
        &layer,
        &input,
        (&all.y, &case.dy),
        &mut gradients,
        &Workspace::new(),
    );
    assert_eq!(dx, all.dx[1]);
    assert_eq!((du, dc, dw, db), (all.du, all.dc, all.dw, all.db));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_shape_is_the_definition(
        num_vertices in 1_usize..160,
        first in 1_usize..20,
        second in 1_usize..5,
        num_heads in 1_usize..12,
        out in 1_usize..9,
    ) {
        Case::new(num_vertices, &[first, second], num_heads, out).check_forward();
    }
}
