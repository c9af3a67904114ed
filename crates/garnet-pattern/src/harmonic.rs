//! How the inside of a panel follows its outline.

use crate::curve::Point2;

/// Weights of edges that Delaunay lets vanish, so that every vertex is held by all its neighbors.
const LEAST_WEIGHT: f64 = 1e-3;

/// The relative residual at which the solution is taken.
const TOLERANCE: f64 = 1e-11;

/// The harmonic map of a triangulated panel: given its outline, it places the inside.
///
/// Cotangent weights of the mean pattern (Pinkall and Polthier 1993): the mean outline gives the
/// mean inside back, and so does every affine image of it. The weights of a Delaunay
/// triangulation are not negative, so a convex outline never folds (Tutte 1963, Floater 2003);
/// others are checked by the caller.
#[derive(Debug, Clone)]
pub(crate) struct HarmonicMap {
    outline: usize,
    /// For each interior vertex its neighbors and weights.
    rows: Vec<Vec<(u32, f64)>>,
}

impl HarmonicMap {
    /// Takes the weights from points `[vertex]`, the outline first.
    pub(crate) fn new(points: &[Point2], outline: usize, faces: &[[u32; 3]]) -> Self {
        let mut rows: Vec<Vec<(u32, f64)>> = vec![Vec::new(); points.len()];
        for face in faces {
            for corner in 0..3 {
                let [a, b, c] = [face[corner], face[(corner + 1) % 3], face[(corner + 2) % 3]];
                let [p, q, apex] = [b, c, a].map(|vertex| points[vertex as usize]);
                let (u, v) = (
                    [p[0] - apex[0], p[1] - apex[1]],
                    [q[0] - apex[0], q[1] - apex[1]],
                );
                let cross = (u[0] * v[1] - u[1] * v[0]).max(1e-12);
                let cotangent = (u[0] * v[0] + u[1] * v[1]) / cross;
                for (from, to) in [(b, c), (c, b)] {
                    let row = &mut rows[from as usize];
                    match row.iter_mut().find(|(vertex, _)| *vertex == to) {
                        Some((_, weight)) => *weight += cotangent,
                        None => row.push((to, cotangent)),
                    }
                }
            }
        }
        let mut rows = rows.split_off(outline);
        for row in &mut rows {
            row.sort_unstable_by_key(|&(vertex, _)| vertex);
            for (_, weight) in row {
                *weight = weight.max(LEAST_WEIGHT);
            }
        }
        Self { outline, rows }
    }

    /// All points `[vertex]` for an outline, by conjugate gradients from `guess` `[vertex]`.
    pub(crate) fn placed(&self, outline: &[Point2], guess: &[Point2]) -> Vec<Point2> {
        let mut points = outline.to_vec();
        points.extend_from_slice(&guess[self.outline..]);
        for axis in 0..2 {
            self.solve(&mut points, axis);
        }
        points
    }

    fn solve(&self, points: &mut [Point2], axis: usize) {
        let size = self.rows.len();
        let diagonal: Vec<f64> = self
            .rows
            .iter()
            .map(|row| row.iter().map(|&(_, weight)| weight).sum())
            .collect();
        // The residual of the Laplacian with the outline held.
        let mut residual: Vec<f64> = (0..size)
            .map(|i| {
                let pulls = self.rows[i]
                    .iter()
                    .map(|&(j, weight)| weight * points[j as usize][axis]);
                pulls.sum::<f64>() - diagonal[i] * points[self.outline + i][axis]
            })
            .collect();
        let preconditioned = |residual: &[f64]| -> Vec<f64> {
            residual.iter().zip(&diagonal).map(|(r, d)| r / d).collect()
        };
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let mut step = preconditioned(&residual);
        let mut energy = dot(&residual, &step);
        let scale: f64 = diagonal.iter().sum::<f64>().max(1e-30);
        for _ in 0..10 * size.max(10) {
            // In metres: the mean distance that a vertex still wants to move.
            if energy <= scale * TOLERANCE * TOLERANCE {
                break;
            }
            let image: Vec<f64> = (0..size)
                .map(|i| {
                    let pulls = self.rows[i].iter().map(|&(j, weight)| {
                        match (j as usize).checked_sub(self.outline) {
                            Some(j) => weight * step[j],
                            None => 0.0,
                        }
                    });
                    diagonal[i] * step[i] - pulls.sum::<f64>()
                })
                .collect();
            let share = energy / dot(&step, &image);
            for i in 0..size {
                points[self.outline + i][axis] += share * step[i];
                residual[i] -= share * image[i];
            }
            let next = preconditioned(&residual);
            let next_energy = dot(&residual, &next);
            let keep = next_energy / energy;
            energy = next_energy;
            for i in 0..size {
                step[i] = next[i] + keep * step[i];
            }
        }
    }
}
