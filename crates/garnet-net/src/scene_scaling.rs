//! Mean and spread of what networks are told.

use crate::{InputScaling, Scene};

/// Numbers that change by less are always the same.
const LEAST_CHANGE: f64 = 1e-6;

/// No spread is taken to be less: a number that hardly changes in the training would else count for
/// hundreds in a scene that is not of it.
const LEAST_SPREAD: f64 = 1e-3;

/// Sums over the scenes of a training.
#[derive(Debug, Clone, Default)]
pub struct ScalingSums {
    parameters: Vec<Sums>,
    vertices: Vec<Sums>,
}

/// Of a number.
#[derive(Debug, Clone, Copy)]
struct Sums {
    count: f64,
    sum: f64,
    squares: f64,
    least: f64,
    most: f64,
}

impl Sums {
    const NOTHING: Self = Self {
        count: 0.0,
        sum: 0.0,
        squares: 0.0,
        least: f64::INFINITY,
        most: f64::NEG_INFINITY,
    };

    fn add(&mut self, number: f32) {
        let number = f64::from(number);
        self.count += 1.0;
        self.sum += number;
        self.squares += number * number;
        self.least = self.least.min(number);
        self.most = self.most.max(number);
    }

    /// Mean and spread.
    fn scale(&self) -> [f32; 2] {
        let count = self.count.max(1.0);
        let mean = self.sum / count;
        if self.most - self.least < LEAST_CHANGE {
            return [mean as f32, 0.0];
        }
        let variance = (self.squares / count - mean * mean).max(0.0);
        [mean as f32, variance.sqrt().max(LEAST_SPREAD) as f32]
    }
}

impl ScalingSums {
    /// Adds what a network is told of a scene that was prepared without scales.
    pub fn add(&mut self, scene: &Scene) {
        let num_vertices = scene.num_vertices().max(1);
        add(
            &mut self.parameters,
            &scene.parameters,
            scene.parameters.len(),
        );
        let width = scene.features.len() / num_vertices;
        add(&mut self.vertices, &scene.features, width);
    }

    /// The scales that were found.
    pub fn scaling(&self) -> InputScaling {
        let of = |sums: &[Sums]| sums.iter().map(Sums::scale).collect();
        InputScaling {
            parameters: of(&self.parameters),
            vertices: of(&self.vertices),
        }
    }
}

fn add(sums: &mut Vec<Sums>, numbers: &[f32], width: usize) {
    sums.resize(width, Sums::NOTHING);
    for row in numbers.chunks_exact(width.max(1)) {
        for (sums, &number) in sums.iter_mut().zip(row) {
            sums.add(number);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_to_mean_zero_and_spread_one() {
        let rows = [
            [1.0, 5.0, 0.0],
            [3.0, 5.0, 1e-5],
            [5.0, 5.0, 0.0],
            [7.0, 5.0, 1e-5],
        ];
        let mut sums = Vec::new();
        add(&mut sums, rows.as_flattened(), 3);
        let scales: Vec<[f32; 2]> = sums.iter().map(Sums::scale).collect();
        let mut numbers = rows.as_flattened().to_vec();
        InputScaling::apply(&scales, &mut numbers);
        let of = |column: usize| numbers.iter().skip(column).step_by(3).copied();
        assert!(of(0).sum::<f32>().abs() < 1e-5);
        assert!((of(0).map(|number| number * number).sum::<f32>() - 4.0).abs() < 1e-5);
        // What never changes tells nothing, and what hardly does stays small.
        assert!(of(1).all(|number| number.abs() < 1e-30));
        assert!(of(2).all(|number| number.abs() < 0.01 && number.abs() > 0.0));
    }
}
