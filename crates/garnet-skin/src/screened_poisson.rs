//! Smooth fields on the cloth: the screened Poisson equation.
//!
//! `(Λ + L) x = b` with the Laplacian `L` of a [`ClothGraph`] and a diagonal `Λ` that ties each
//! node to a value of its own. Weights are smoothed, shapes carried and strain relaxed by it; a
//! sparse Cholesky factor, made once, serves every drape.

use faer::linalg::solvers::SolveCore;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Conj, Mat, Side};
use garnet_mesh::Vector3;

use crate::{ClothGraph, SkinError};

/// Nodes that nothing ties down would make the system singular; they get this screening.
const MIN_SCREENING: f64 = 1e-9;

/// A factor of `Λ + L`.
#[derive(Debug, Clone)]
pub struct ScreenedPoisson {
    screening: Vec<f64>,
    symbolic: SymbolicLlt<usize>,
    factor: Llt<usize, f64>,
}

impl ScreenedPoisson {
    /// Factors the system of `graph` with the diagonal `screening` `[node]`, which is not negative.
    ///
    /// A screening of `area / r²` lets a difference die out over the length `r`.
    ///
    /// # Errors
    ///
    /// [`SkinError::Singular`] if the factor does not exist, which finite weights exclude.
    pub fn new(graph: &ClothGraph, screening: Vec<f64>) -> Result<Self, SkinError> {
        let screening = tied(screening);
        let matrix = system(graph, &screening)?;
        let symbolic = SymbolicLlt::try_new(matrix.symbolic(), Side::Lower)
            .map_err(|error| SkinError::Singular(format!("{error:?}")))?;
        Self::factored(screening, symbolic, &matrix)
    }

    /// The same graph with another `screening`; the ordering of the nodes is used again.
    ///
    /// # Errors
    ///
    /// As [`ScreenedPoisson::new`].
    pub fn rescreened(&self, graph: &ClothGraph, screening: Vec<f64>) -> Result<Self, SkinError> {
        let screening = tied(screening);
        let matrix = system(graph, &screening)?;
        Self::factored(screening, self.symbolic.clone(), &matrix)
    }

    fn factored(
        screening: Vec<f64>,
        symbolic: SymbolicLlt<usize>,
        matrix: &SparseColMat<usize, f64>,
    ) -> Result<Self, SkinError> {
        let factor = Llt::try_new_with_symbolic(symbolic.clone(), matrix.as_ref(), Side::Lower)
            .map_err(|error| SkinError::Singular(format!("{error:?}")))?;
        Ok(Self {
            screening,
            symbolic,
            factor,
        })
    }

    /// The diagonal `Λ` `[node]`.
    pub fn screening(&self) -> &[f64] {
        &self.screening
    }

    /// Solves for vectors: `right_side` and result `[node]`.
    pub fn solve(&self, right_side: &[Vector3]) -> Vec<Vector3> {
        let mut columns = Mat::from_fn(right_side.len(), 3, |node, axis| {
            f64::from(right_side[node][axis])
        });
        self.factor
            .solve_in_place_with_conj(Conj::No, columns.as_mut());
        (0..right_side.len())
            .map(|node| Vector3::from_fn(|axis, _| columns[(node, axis)] as f32))
            .collect()
    }

    /// The field closest to `values` `[column][node]` that is smooth over the screening's length:
    /// solves `(Λ + L) x = Λ values`.
    pub fn smoothed(&self, values: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut columns = Mat::from_fn(self.screening.len(), values.len(), |node, column| {
            self.screening[node] * values[column][node]
        });
        self.factor
            .solve_in_place_with_conj(Conj::No, columns.as_mut());
        let column = |column: usize| columns.col(column).iter().copied().collect();
        (0..values.len()).map(column).collect()
    }

    /// [`ScreenedPoisson::smoothed`] for vectors `[node]`.
    pub fn smoothed_vectors(&self, values: &[Vector3]) -> Vec<Vector3> {
        let screened = |(value, &screening): (&Vector3, &f64)| value * screening as f32;
        let right_side: Vec<Vector3> = values.iter().zip(&self.screening).map(screened).collect();
        self.solve(&right_side)
    }
}

/// A diagonal that ties down all nodes: those that are in no face, too.
fn tied(screening: Vec<f64>) -> Vec<f64> {
    let tied = screening.into_iter().map(|value| value.max(MIN_SCREENING));
    tied.collect()
}

/// The lower triangle of `Λ + L`.
fn system(graph: &ClothGraph, screening: &[f64]) -> Result<SparseColMat<usize, f64>, SkinError> {
    let mut diagonal: Vec<f64> = screening.to_vec();
    let mut entries = Vec::with_capacity(graph.edges().len() + graph.num_nodes());
    for (&[a, b], &weight) in graph.edges().iter().zip(graph.weights()) {
        let weight = f64::from(weight);
        diagonal[a as usize] += weight;
        diagonal[b as usize] += weight;
        entries.push(Triplet::new(a.max(b) as usize, a.min(b) as usize, -weight));
    }
    for (node, &value) in diagonal.iter().enumerate() {
        entries.push(Triplet::new(node, node, value));
    }
    let size = graph.num_nodes();
    SparseColMat::try_new_from_triplets(size, size, &entries)
        .map_err(|error| SkinError::Singular(format!("{error:?}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use garnet_mesh::{Point3, Topology};

    /// A path of `count` nodes 1 m apart, as stitches of weight 1.
    fn path(count: u32) -> ClothGraph {
        let positions: Vec<Point3> = (0..count)
            .map(|node| Point3::new(node as f32, 0.0, 0.0))
            .collect();
        let stitches: Vec<[u32; 2]> = (1..count).map(|node| [node - 1, node]).collect();
        let topology = Topology::new(positions.len(), &[]);
        ClothGraph::new(&positions, &[], &topology, &stitches)
    }

    #[test]
    fn a_constant_stays_constant() {
        let graph = path(9);
        let system = ScreenedPoisson::new(&graph, vec![0.3; 9]).unwrap();
        let smoothed = system.smoothed(&[vec![2.0; 9]]);
        for value in &smoothed[0] {
            approx::assert_relative_eq!(*value, 2.0, max_relative = 1e-9);
        }
    }

    #[test]
    fn between_two_held_ends_the_field_is_straight() {
        let graph = path(5);
        let held = vec![1e9, 0.0, 0.0, 0.0, 1e9];
        let system = ScreenedPoisson::new(&graph, held).unwrap();
        let smoothed = system.smoothed(&[vec![0.0, 9.0, 9.0, 9.0, 4.0]]);
        for (node, value) in smoothed[0].iter().enumerate() {
            approx::assert_relative_eq!(*value, node as f64, epsilon = 1e-6);
        }
    }

    #[test]
    fn another_screening_gives_what_a_new_factor_gives() {
        let graph = path(6);
        let values = vec![vec![1.0, 0.0, 3.0, 0.0, 2.0, 5.0]];
        let system = ScreenedPoisson::new(&graph, vec![0.5; 6]).unwrap();
        let rescreened = system.rescreened(&graph, vec![2.0; 6]).unwrap();
        let fresh = ScreenedPoisson::new(&graph, vec![2.0; 6]).unwrap();
        assert_eq!(rescreened.smoothed(&values), fresh.smoothed(&values));
    }
}
