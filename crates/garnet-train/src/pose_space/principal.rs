//! Principal shapes of many offsets.

use faer::{Mat, MatRef, Side};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::offsets::Offsets;

/// Directions that are followed beside those that are asked for.
const MORE: usize = 16;

/// Times that the directions are led through the offsets and back.
const PASSES: usize = 2;

/// Principal shapes, and the share that each scene has of them.
pub(super) struct Principal {
    /// `[shape][vertex][3]`, each of norm 1.
    pub(super) shapes: Vec<f32>,
    /// `[scene, shape]`, in metres.
    pub(super) shares: Mat<f64>,
}

/// The principal shapes of offsets, largest first, by a randomized range finder.
///
/// Source: *Halko, Martinsson and Tropp 2011, algorithms 4.4 and 5.1*.
pub(super) fn principal(offsets: &Offsets, count: usize) -> Principal {
    let matrix = offsets.centered.as_ref();
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
            centered,
        };
        let found = principal(&offsets, 3);
        for scene in 0..20 {
            for row in 0..90 {
                let parts = (0..3).map(|shape| {
                    f64::from(found.shapes[90 * shape + row]) * found.shares[(scene, shape)]
                });
                let expected = f64::from(offsets.centered[(row, scene)]);
                assert!((parts.sum::<f64>() - expected).abs() < 1e-4);
            }
        }
        for shape in found.shapes.chunks(90) {
            let norm: f32 = shape.iter().map(|number| number * number).sum();
            assert!((norm - 1.0).abs() < 1e-4);
        }
    }
}
