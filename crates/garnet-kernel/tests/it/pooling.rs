use garnet_kernel::{
    Activation, Features, NeighborTable, Workspace, add_backward, add_forward, global_max_backward,
    global_max_forward, neighbor_max_backward, neighbor_max_forward, neighbor_mean_backward,
    neighbor_mean_forward,
};
use proptest::prelude::*;

use crate::values::{ROUNDING, Values, assert_close, assert_close_at};

fn table(values: &mut Values, rows: usize, sources: usize, k: usize) -> NeighborTable {
    NeighborTable::new(sources, k, values.indices(rows * k, sources)).expect("indices are in range")
}

/// Largest values, their sources, and the gradient, by the definition.
fn expected_max(
    table: &NeighborTable,
    x: &[f32],
    channels: usize,
    dy: &[f32],
) -> (Vec<f32>, Vec<f64>) {
    let (mut y, mut dx) = (Vec::new(), vec![0.0; x.len()]);
    for row in 0..table.num_rows() {
        for channel in 0..channels {
            let mut best = table.neighbors(row)[0];
            for &source in table.neighbors(row) {
                if x[source as usize * channels + channel] > x[best as usize * channels + channel] {
                    best = source;
                }
            }
            y.push(x[best as usize * channels + channel]);
            dx[best as usize * channels + channel] += f64::from(dy[row * channels + channel]);
        }
    }
    (y, dx)
}

fn check_neighbor_pooling(rows: usize, sources: usize, k: usize, channels: usize) {
    let mut values = Values::new(11);
    let table = table(&mut values, rows, sources, k);
    let (x, dy) = (
        values.numbers(sources * channels),
        values.numbers(rows * channels),
    );
    let workspace = Workspace::new();

    let (mut y, mut largest) = (vec![f32::NAN; dy.len()], vec![u32::MAX; dy.len()]);
    let mut dx = vec![f32::NAN; x.len()];
    neighbor_max_forward(
        &table,
        Features::new(&x, channels),
        &mut y,
        &mut largest,
        &workspace,
    );
    neighbor_max_backward(
        &table,
        &largest,
        Features::new(&dy, channels),
        &mut dx,
        &workspace,
    );
    let (expected, expected_dx) = expected_max(&table, &x, channels, &dy);
    assert_eq!(y, expected);
    // Gradients are sums that may cancel: what is added rounds, not what is left.
    let magnitudes: Vec<f32> = dy.iter().map(|dy| dy.abs()).collect();
    let (_, added) = expected_max(&table, &x, channels, &magnitudes);
    let rounding = ROUNDING * added.iter().copied().fold(1e-3, f64::max);
    assert_close_at("dx of the maximum", &dx, &expected_dx, rounding);
    y.fill(f32::NAN);
    neighbor_max_forward(
        &table,
        Features::new(&x, channels),
        &mut y,
        &mut [],
        &workspace,
    );
    assert_eq!(y, expected);

    neighbor_mean_forward(&table, Features::new(&x, channels), &mut y, &workspace);
    neighbor_mean_backward(&table, Features::new(&dy, channels), &mut dx, &workspace);
    let (mut expected, mut expected_dx) = (vec![0.0; y.len()], vec![0.0; x.len()]);
    let mut added = vec![0.0; x.len()];
    for row in 0..rows {
        for &source in table.neighbors(row) {
            for channel in 0..channels {
                let (i, j) = (
                    row * channels + channel,
                    source as usize * channels + channel,
                );
                expected[i] += f64::from(x[j]) / k as f64;
                expected_dx[j] += f64::from(dy[i]) / k as f64;
                added[j] += f64::from(dy[i].abs()) / k as f64;
            }
        }
    }
    assert_close("mean", &y, &expected, ROUNDING);
    let rounding = ROUNDING * added.iter().copied().fold(1e-3, f64::max);
    assert_close_at("dx of the mean", &dx, &expected_dx, rounding);
}

#[test]
fn neighbor_pooling_is_the_definition_for_odd_sizes() {
    for (rows, sources, k, channels) in [
        (1, 1, 1, 1),
        (5, 9, 1, 3),
        (7, 2, 15, 131),
        (300, 40, 16, 17),
        (130, 200, 15, 16),
        (0, 4, 3, 2),
    ] {
        check_neighbor_pooling(rows, sources, k, channels);
    }
}

#[test]
fn the_first_of_equal_neighbors_wins() {
    let table = NeighborTable::new(3, 3, vec![2, 0, 1]).expect("valid");
    let (mut y, mut largest) = ([0.0], [0]);
    neighbor_max_forward(
        &table,
        Features::new(&[1.0; 3], 1),
        &mut y,
        &mut largest,
        &Workspace::new(),
    );
    assert_eq!(largest, [2]);
}

#[test]
fn the_global_maximum_and_its_gradient_are_those_of_the_definition() {
    for (rows, channels) in [(1, 1), (1, 5), (257, 3), (300, 17), (1000, 131)] {
        let mut values = Values::new(17);
        let x = values.numbers(rows * channels);
        let dy = values.numbers(channels);
        let (mut y, mut largest) = (vec![0.0; channels], vec![0; channels]);
        global_max_forward(
            Features::new(&x, channels),
            &mut y,
            &mut largest,
            &Workspace::new(),
        );
        let mut dx = vec![f32::NAN; x.len()];
        global_max_backward(&largest, &dy, &mut dx);
        for channel in 0..channels {
            let column: Vec<f32> = x[channel..].iter().step_by(channels).copied().collect();
            let largest_value = column.iter().copied().fold(f32::MIN, f32::max);
            assert_eq!(y[channel], largest_value);
            assert_eq!(column[largest[channel] as usize], largest_value);
            for row in 0..rows {
                let expected = if row == largest[channel] as usize {
                    dy[channel]
                } else {
                    0.0
                };
                assert_eq!(dx[row * channels + channel], expected);
            }
        }
    }
}

#[test]
fn the_first_of_equal_rows_wins_across_tiles() {
    let (mut y, mut largest) = ([0.0], [9]);
    global_max_forward(
        Features::new(&[2.0; 1000], 1),
        &mut y,
        &mut largest,
        &Workspace::new(),
    );
    assert_eq!((y, largest), ([2.0], [0]));
}

#[test]
fn a_sum_of_branches_is_activated_and_differentiated() {
    let mut values = Values::new(23);
    let (a, b, dy) = (
        values.numbers(40_001),
        values.numbers(40_001),
        values.numbers(40_001),
    );
    for activation in [Activation::None, Activation::LeakyRelu] {
        let (mut y, mut d_sum) = (vec![0.0; a.len()], vec![0.0; a.len()]);
        add_forward(&a, &b, activation, &mut y);
        add_backward(&y, &dy, activation, &mut d_sum);
        let slopes = a.iter().zip(&b).map(|(a, b)| match activation {
            Activation::LeakyRelu if a + b <= 0.0 => 0.1,
            _ => 1.0,
        });
        let (expected_y, expected): (Vec<f64>, Vec<f64>) = (slopes.zip(a.iter().zip(&b)).zip(&dy))
            .map(|((slope, (a, b)), dy)| (slope * f64::from(a + b), slope * f64::from(*dy)))
            .unzip();
        assert_close("y", &y, &expected_y, ROUNDING);
        assert_close("d_sum", &d_sum, &expected, ROUNDING);
    }
}

proptest! {
    #[test]
    fn any_table_is_pooled_by_the_definition(
        rows in 1_usize..150, sources in 1_usize..60, k in 1_usize..20, channels in 1_usize..40,
    ) {
        check_neighbor_pooling(rows, sources, k, channels);
    }
}
