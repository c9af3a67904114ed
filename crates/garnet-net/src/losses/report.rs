//! What an evaluation of the loss gives.

use garnet_mesh::Vector3;

use super::Term;

/// One term of one evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LossValue {
    /// Which.
    pub term: Term,
    /// Its value before weighting.
    pub value: f64,
    /// Its weight.
    pub weight: f64,
}

/// The terms of a scene, and the derivative of their weighted sum.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LossReport {
    /// The terms that were evaluated, in the order of [`Term::ALL`].
    pub values: Vec<LossValue>,
    /// By each predicted place `[vertex]`, in the world, per unit of 0.1 m.
    pub gradient: Vec<Vector3>,
}

impl LossReport {
    /// The weighted sum of all terms.
    pub fn total(&self) -> f64 {
        let weighted = self.values.iter().filter(|value| value.weight > 0.0);
        weighted.map(|value| value.weight * value.value).sum()
    }

    /// The value of a term, if it was evaluated.
    pub fn value(&self, term: Term) -> Option<f64> {
        let found = self.values.iter().find(|value| value.term == term);
        found.map(|value| value.value)
    }

    /// The first term without a finite value.
    pub fn non_finite_term(&self) -> Option<Term> {
        let found = self.values.iter().find(|value| !value.value.is_finite());
        found.map(|value| value.term)
    }

    /// The first vertex without a finite derivative.
    pub fn non_finite_vertex(&self) -> Option<usize> {
        let is_finite = |row: &Vector3| row.iter().all(|value| value.is_finite());
        self.gradient.iter().position(|row| !is_finite(row))
    }
}
