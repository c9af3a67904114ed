//! Principal shapes of many offsets.

use faer::{Mat, MatRef, Side};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::offsets::Offsets;

/// Directions that are followed beside those that are asked for.
const MORE: usize = 16;

/// Times that the directions are led through the offsets and back.
const PASSES: usize = 2;

/// Shapes of which the scenes have less than this share of what they have of the first are left
/// out.
const LEAST: f64 = 1e-6;

/// Principal shapes, and the share that each scene has of them.
pub(super) struct Principal {
    /// `[shape][vertex][3]`, each of norm 1.
    pub(super) shapes: Vec<f32>,
    /// `[scene, shape]`, in metres.
    pub(super) shares: Mat<f64>,
    /// 1 for shapes that are the same in the mirror, −1 for those that change their sign `[shape]`.
    pub(super) parity: Vec<f32>,
}

/// The largest principal shapes of both halves of offsets, largest first.
pub(super) fn principal(offsets: &Offsets, count: usize) -> Principal {
    let of_even = principal_of(&offsets.even, count);
    let Some(odd) = &offsets.odd else {
        return of_even;
    };
    let of_odd = principal_of(odd, count);
    let halves = [&of_even, &of_odd];
    let mut order: Vec<(f64, usize, usize)> = (halves.iter().enumerate())
        .flat_map(|(half, principal)| {
            let shapes = 0..principal.shares.ncols();
            shapes.map(move |shape| (principal.shares.col(shape).norm_l2(), half, shape))
        })
        .collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let most = order.first().map_or(0.0, |first| first.0);
    order.retain(|(norm, _, _)| *norm > LEAST * most);
    order.truncate(count);
    let rows = offsets.mean.len();
    let shape_of = |&(_, half, shape): &(f64, usize, usize)| {
        &halves[half].shapes[rows * shape..rows * (shape + 1)]
    };
    Principal {
        shapes: order.iter().flat_map(shape_of).copied().collect(),
        shares: Mat::from_fn(of_even.shares.nrows(), order.len(), |scene, column| {
            let (_, half, shape) = order[column];
            halves[half].shares[(scene, shape)]
        }),
        parity: order
            .iter()
            .map(|&(_, half, _)| [1.0, -1.0][half])
            .collect(),
    }
}

/// The principal shapes of offsets, largest first, by a randomized range finder.
///
/// Source: *Halko, Martinsson and Tropp 2011, algorithms 4.4 and 5.1*.
pub(super) fn principal_of(offsets: &Mat<f32>, count: usize) -> Principal {
    let matrix = offsets.as_ref();
    let (num_rows, num_scenes) = (matrix.nrows(), matrix.ncols());
    let count = count.min(num_scenes).min(num_rows);
    let directions = (count + MORE).min(num_scenes).min(num_rows);
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let sketch = Mat::<f32>::from_fn(num_scenes, directions, |_, _| {
        random.random_range(-1.0..1.0)
    });
    let mut basis = orthonormal((matrix * &sketch).as_ref());
    for _ in 0..PASSES {
        let back = orthonormal((matrix.transpose() * &basis).as_ref());
        basis = orthonormal((matrix * &back).as_ref());
    }
    let shares = matrix.transpose() * &basis;
    // Directions of the basis are turned into those of the variance.
    let double = Mat::<f64>::from_fn(num_scenes, directions, |scene, direction| {
        f64::from(shares[(scene, direction)])
    });
    let covariance = double.transpose() * &double;
    let Ok(eigen) = covariance.self_adjoint_eigen(Side::Lower) else {
        return Principal {
            shapes: Vec::new(),
            shares: Mat::zeros(num_scenes, 0),
            parity: Vec::new(),
        };
    };
    // Eigenvalues ascend.
    let turn = Mat::<f64>::from_fn(directions, count, |row, column| {
        eigen.U()[(row, directions - 1 - column)]
    });
    let single = Mat::<f32>::from_fn(directions, count, |row, column| turn[(row, column)] as f32);
    let shapes = &basis * &single;
    let column = |shape: usize| (0..num_rows).map(move |row| (row, shape));
    Principal {
        shapes: (0..count)
            .flat_map(|shape| column(shape).map(|place| shapes[place]))
            .collect(),
        shares: &double * &turn,
        parity: vec![1.0; count],
    }
}

fn orthonormal(matrix: MatRef<'_, f32>) -> Mat<f32> {
    matrix.qr().compute_thin_Q()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_of_few_shapes_come_back() {
        let shape = |number: usize, row: usize| ((number + 1) as f32 * 0.37 * row as f32).sin();
        let centered = Mat::<f32>::from_fn(90, 20, |row, scene| {
            let share = |number: usize| ((scene * (number + 2)) as f32 * 0.7).cos();
            (0..3)
                .map(|number| share(number) * shape(number, row))
                .sum()
        });
        let offsets = Offsets {
            mean: vec![0.0; 90],
            even: centered.clone(),
            odd: None,
        };
        let found = principal(&offsets, 3);
        for scene in 0..20 {
            for row in 0..90 {
                let parts = (0..3).map(|shape| {
                    f64::from(found.shapes[90 * shape + row]) * found.shares[(scene, shape)]
                });
                let expected = f64::from(centered[(row, scene)]);
                assert!((parts.sum::<f64>() - expected).abs() < 1e-4);
            }
        }
        for shape in found.shapes.chunks(90) {
            let norm: f32 = shape.iter().map(|number| number * number).sum();
            assert!((norm - 1.0).abs() < 1e-4);
        }
        assert_eq!(found.parity, [1.0; 3]);

        // The larger half comes first; what is not there is left out.
        let halves = Offsets {
            even: faer::Scale(0.1_f32) * &offsets.even,
            odd: Some(offsets.even),
            mean: offsets.mean,
        };
        assert!(principal(&halves, 4).parity[0] < 0.0);
        assert_eq!(principal(&halves, 4).shares.ncols(), 4);
        assert_eq!(principal(&halves, 9).shares.ncols(), 6);
    }
}
