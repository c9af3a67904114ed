//! Resistance to bending: the quadratic hinges of the cloth.

use nalgebra::{Matrix3, Vector3};

use super::blocks::Blocks;
use crate::Cloth;

/// The hinges of a [`Cloth`], in double precision.
#[derive(Debug, Clone)]
pub(super) struct Hinges(Vec<HingeTerm>);

#[derive(Debug, Clone, Copy)]
struct HingeTerm {
    vertices: [u32; 4],
    weights: [f64; 4],
    stiffness: f64,
}

impl HingeTerm {
    /// Twice the curvature normal of the hinge times the length of its edge.
    fn bend(&self, x: &[Vector3<f64>]) -> Vector3<f64> {
        let origin = x[self.vertices[0] as usize];
        // Differences keep translations free of force, whatever the rounding of the weights.
        let offset = |m: usize| (x[self.vertices[m] as usize] - origin) * self.weights[m];
        offset(1) + offset(2) + offset(3)
    }
}

impl Hinges {
    pub(super) fn new(cloth: &Cloth) -> Self {
        let terms = cloth.hinges().iter().map(|hinge| {
            let [_, b, c, d] = hinge.weights.map(f64::from);
            HingeTerm {
                vertices: hinge.vertices,
                weights: [-(b + c + d), b, c, d],
                stiffness: f64::from(hinge.stiffness),
            }
        });
        Self(terms.collect())
    }

    /// Pairs of vertices that the hinges couple.
    pub(super) fn pairs(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        const PAIRS: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
        let hinges = self.0.iter();
        hinges.flat_map(|term| PAIRS.map(|pair| pair.map(|corner| term.vertices[corner])))
    }

    /// Energy, J.
    pub(super) fn energy(&self, x: &[Vector3<f64>]) -> f64 {
        let energy = |term: &HingeTerm| 0.5 * term.stiffness * term.bend(x).norm_squared();
        self.0.iter().map(energy).sum()
    }

    /// Adds the gradient of the energy, N.
    pub(super) fn add_gradient(&self, x: &[Vector3<f64>], gradient: &mut [Vector3<f64>]) {
        for term in &self.0 {
            let moment = term.bend(x) * term.stiffness;
            for (&vertex, &weight) in term.vertices.iter().zip(&term.weights) {
                gradient[vertex as usize] += moment * weight;
            }
        }
    }

    /// Adds the second derivatives, which are the same at all positions.
    pub(super) fn add_hessian(&self, blocks: &mut Blocks) {
        for term in &self.0 {
            for row in 0..4 {
                for column in 0..=row {
                    let entry = term.stiffness * term.weights[row] * term.weights[column];
                    let block = Matrix3::identity() * entry;
                    blocks.add(term.vertices[row], term.vertices[column], &block);
                }
            }
        }
    }
}
