//! Sparse Cholesky factors of Newton systems.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::Perm;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};
use nalgebra::{Matrix3, Vector3};

use super::system::Pattern;

/// A Cholesky factorisation whose symbolic half serves every matrix of one [`Pattern`].
pub(super) struct Factor {
    structure: SymbolicSparseColMat<usize>,
    symbolic: SymbolicCholesky<usize>,
    /// The matrix, lower triangle by columns.
    values: Vec<f64>,
    /// The factor.
    entries: Vec<f64>,
    scratch: MemBuffer,
    right_side: Vec<f64>,
}

impl Factor {
    /// Orders the vertices of a pattern and finds where its factors are not zero; `None` if that
    /// would not fit into memory.
    pub(super) fn new(pattern: &Pattern) -> Option<Self> {
        let size = 3 * pattern.num_vertices();
        let (pointers, indices) = pattern.scalar_columns();
        let structure = SymbolicSparseColMat::new_checked(size, size, pointers, None, indices);
        let symbolic = symbolic_factor(pattern, structure.as_ref())?;
        let numeric = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        let solve = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        Some(Self {
            values: Vec::with_capacity(structure.row_idx().len()),
            entries: vec![0.0; symbolic.len_val()],
            scratch: MemBuffer::try_new(numeric.or(solve)).ok()?,
            right_side: vec![0.0; size],
            structure,
            symbolic,
        })
    }

    /// Factors the matrix of `blocks` `[block]`; `false` if it is not positive definite.
    pub(super) fn factor(&mut self, pattern: &Pattern, blocks: &[Matrix3<f64>]) -> bool {
        pattern.scalar_values(blocks, &mut self.values);
        let matrix = SparseColMatRef::new(self.structure.as_ref(), &self.values);
        let stack = MemStack::new(&mut self.scratch);
        self.symbolic
            .factorize_numeric_llt(
                &mut self.entries,
                matrix,
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                stack,
                Spec::default(),
            )
            .is_ok()
    }

    /// Solves for `vectors` `[vertex]` in place, with the matrix that was last factored.
    pub(super) fn solve(&mut self, vectors: &mut [Vector3<f64>]) {
        for (axes, vector) in self.right_side.chunks_exact_mut(3).zip(vectors.iter()) {
            axes.copy_from_slice(vector.as_slice());
        }
        let column =
            MatMut::from_column_major_slice_mut(&mut self.right_side, 3 * vectors.len(), 1);
        LltRef::new(&self.symbolic, &self.entries).solve_in_place_with_conj(
            Conj::No,
            column,
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
        for (vector, axes) in vectors.iter_mut().zip(self.right_side.chunks_exact(3)) {
            vector.copy_from_slice(axes);
        }
    }
}

/// The structure of the factors, with the vertices in an order of minimum degree.
///
/// The order is found on the blocks, nine times fewer than the entries.
fn symbolic_factor(
    pattern: &Pattern,
    structure: SymbolicSparseColMatRef<'_, usize>,
) -> Option<SymbolicCholesky<usize>> {
    let num_vertices = pattern.num_vertices();
    let (pointers, rows) = pattern.block_columns();
    let blocks =
        SymbolicSparseColMatRef::new_checked(num_vertices, num_vertices, &pointers, None, &rows);
    let mut order = vec![0; num_vertices];
    let mut place = vec![0; num_vertices];
    let needed = amd::order_maybe_unsorted_scratch::<usize>(num_vertices, rows.len());
    let mut scratch = MemBuffer::try_new(needed).ok()?;
    let stack = MemStack::new(&mut scratch);
    amd::order_maybe_unsorted(
        &mut order,
        &mut place,
        blocks,
        amd::Control::default(),
        stack,
    )
    .ok()?;
    let axes_of = |vertices: &[usize]| -> Box<[usize]> {
        let axes = vertices
            .iter()
            .flat_map(|vertex| (0..3).map(move |axis| 3 * vertex + axis));
        axes.collect()
    };
    let permutation = Perm::new_checked(axes_of(&order), axes_of(&place), 3 * num_vertices);
    factorize_symbolic_cholesky(
        structure,
        Side::Lower,
        SymmetricOrdering::Custom(permutation.as_ref()),
        CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        },
    )
    .ok()
}
