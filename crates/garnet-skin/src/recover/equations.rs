//! The normal equations of a recovery: 6 × 6 blocks, only where two joints share vertices.

use nalgebra::{Matrix6, Vector6};

use crate::{Skeleton, SkinWeights};

/// Which pairs of joints meet in the equations.
///
/// A pair has its smaller joint first; the pair of a joint with itself comes with the number of the
/// joint, so the first `num_joints` pairs are the diagonal.
#[derive(Debug)]
pub(super) struct Pattern {
    num_joints: usize,
    off_diagonal: Vec<(u16, u16)>,
}

/// `A δ = b` with symmetric `A`.
#[derive(Debug, Clone)]
pub(super) struct Equations {
    /// Blocks of the pairs `[pair]`; a pair `(i, j)` stores the block of row `i`, column `j`.
    pub blocks: Vec<Matrix6<f64>>,
    /// `b`, `[joint]`.
    pub right: Vec<Vector6<f64>>,
}

impl Pattern {
    /// The pairs of joints that share a vertex or are parent and child.
    pub(super) fn new(weights: &SkinWeights, skeleton: &Skeleton) -> Self {
        let mut off_diagonal = Vec::new();
        for vertex in 0..weights.num_vertices() {
            let (joints, _) = weights.row(vertex);
            for (position, &a) in joints.iter().enumerate() {
                for &b in &joints[position + 1..] {
                    off_diagonal.push((a.min(b), a.max(b)));
                }
            }
            // Keeps the list short on meshes of millions of vertices.
            if off_diagonal.len() > 1 << 16 {
                off_diagonal.sort_unstable();
                off_diagonal.dedup();
            }
        }
        for (joint, of) in skeleton.joints().iter().enumerate() {
            if let Some(parent) = of.parent {
                off_diagonal.push((joint.min(parent) as u16, joint.max(parent) as u16));
            }
        }
        off_diagonal.sort_unstable();
        off_diagonal.dedup();
        Self {
            num_joints: skeleton.num_joints(),
            off_diagonal,
        }
    }

    /// The number of the pair of two joints, and whether they come the other way round in it.
    pub(super) fn pair(&self, a: usize, b: usize) -> (usize, bool) {
        if a == b {
            return (a, false);
        }
        let pair = (a.min(b) as u16, a.max(b) as u16);
        let found = self.off_diagonal.binary_search(&pair);
        let found =
            found.expect("the pattern has every pair of joints that share a vertex or a bone");
        (self.num_joints + found, a > b)
    }

    /// Equations of zeros.
    pub(super) fn zeros(&self) -> Equations {
        Equations {
            blocks: vec![Matrix6::zeros(); self.num_joints + self.off_diagonal.len()],
            right: vec![Vector6::zeros(); self.num_joints],
        }
    }

    /// `A x`.
    fn times(&self, blocks: &[Matrix6<f64>], x: &[Vector6<f64>]) -> Vec<Vector6<f64>> {
        let (diagonal, others) = blocks.split_at(self.num_joints);
        let mut product: Vec<Vector6<f64>> =
            diagonal.iter().zip(x).map(|(block, x)| block * x).collect();
        for (&(a, b), block) in self.off_diagonal.iter().zip(others) {
            let (a, b) = (usize::from(a), usize::from(b));
            product[a] += block * x[b];
            product[b] += block.tr_mul(&x[a]);
        }
        product
    }

    /// Solves `A δ = b` by conjugate gradients, preconditioned with the diagonal blocks (Saad 2003,
    /// Algorithm 9.1), down to `tolerance` of the first residual.
    ///
    /// None if a diagonal block is singular, which damping excludes for finite equations.
    pub(super) fn solve(&self, equations: &Equations, tolerance: f64) -> Option<Vec<Vector6<f64>>> {
        let diagonal = &equations.blocks[..self.num_joints];
        let factors: Vec<_> = diagonal
            .iter()
            .map(|block| block.cholesky())
            .collect::<Option<_>>()?;
        let precondition = |r: &[Vector6<f64>]| -> Vec<Vector6<f64>> {
            factors
                .iter()
                .zip(r)
                .map(|(factor, r)| factor.solve(r))
                .collect()
        };
        let mut x = vec![Vector6::zeros(); self.num_joints];
        let mut residual = equations.right.clone();
        let mut z = precondition(&residual);
        let mut direction = z.clone();
        let mut energy = dot(&residual, &z);
        let enough = energy * tolerance * tolerance;
        for _ in 0..6 * self.num_joints {
            if energy <= enough {
                break;
            }
            let image = self.times(&equations.blocks, &direction);
            let curvature = dot(&direction, &image);
            if curvature <= 0.0 {
                break;
            }
            let step = energy / curvature;
            for joint in 0..self.num_joints {
                x[joint] += direction[joint] * step;
                residual[joint] -= image[joint] * step;
            }
            z = precondition(&residual);
            let next = dot(&residual, &z);
            let turn = next / energy;
            energy = next;
            for (direction, z) in direction.iter_mut().zip(&z) {
                *direction = z + *direction * turn;
            }
        }
        Some(x)
    }
}

impl Equations {
    /// Adds other equations of the same pattern.
    pub(super) fn add(&mut self, other: &Self) {
        for (block, other) in self.blocks.iter_mut().zip(&other.blocks) {
            *block += other;
        }
        for (right, other) in self.right.iter_mut().zip(&other.right) {
            *right += other;
        }
    }
}

fn dot(a: &[Vector6<f64>], b: &[Vector6<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::{Joint, Point3};

    #[test]
    fn conjugate_gradients_solve_a_chain_of_joints() {
        let joint = |index: usize| Joint {
            name: String::new(),
            parent: index.checked_sub(1),
            rest_position: Point3::origin(),
        };
        let skeleton = Skeleton::new((0..4).map(joint).collect()).unwrap();
        let weights = SkinWeights::from_influences(4, [[(0, 0.5), (3, 0.5)]]).unwrap();
        let pattern = Pattern::new(&weights, &skeleton);
        assert_eq!(pattern.pair(3, 0), (5, true));
        let mut equations = pattern.zeros();
        let mut dense = DMatrix::<f64>::zeros(24, 24);
        let mut right = DVector::<f64>::zeros(24);
        for a in 0..4 {
            equations.right[a] = Vector6::from_fn(|row, _| (row + 2 * a) as f64 - 3.0);
            right
                .fixed_rows_mut::<6>(6 * a)
                .copy_from(&equations.right[a]);
            for b in a..4 {
                if (a, b) == (0, 2) || (a, b) == (1, 3) {
                    continue;
                }
                let (pair, _) = pattern.pair(a, b);
                let diagonal = if a == b { 10.0 } else { 0.0 };
                let mut block = Matrix6::from_fn(|row, column| {
                    ((row * 5 + column * 3 + a + b) % 7) as f64 * 0.1
                });
                if a == b {
                    block = (block + block.transpose()) * 0.5 + Matrix6::identity() * diagonal;
                }
                equations.blocks[pair] = block;
                dense.fixed_view_mut::<6, 6>(6 * a, 6 * b).copy_from(&block);
                dense
                    .fixed_view_mut::<6, 6>(6 * b, 6 * a)
                    .copy_from(&block.transpose());
            }
        }
        let found = pattern.solve(&equations, 1e-12).unwrap();
        let expected = dense.lu().solve(&right).unwrap();
        for (joint, found) in found.iter().enumerate() {
            approx::assert_relative_eq!(
                *found,
                expected.fixed_rows::<6>(6 * joint).into_owned(),
                epsilon = 1e-9
            );
        }
    }
}
