//! Newton's method with a line search.

use nalgebra::{Matrix3, Vector3};

use super::blocks::Curvature;
use super::factor::Factor;
use super::potential::{Inertia, Potential};
use super::system::Pattern;
use crate::SimError;

/// Share of the decrease that the slope promises which a step has to reach (Armijo).
const ARMIJO: f64 = 1e-4;

/// Energies nearer than this share of the larger are equal: the rounding of sums in `f64`.
const ENERGY_ROUNDING: f64 = 1e-13;

/// Halvings of a step before it is given up.
const MAX_HALVINGS: usize = 24;

/// Steps with projected second derivatives after the true ones were not positive definite: twice as
/// many each time, up to this.
const MAX_PATIENCE: usize = 16;

/// Pairs nearer than this many radii are in the pattern, so that it need not change in every step.
const PATTERN_RADII: f64 = 1.5;

/// The linear algebra of Newton steps, kept from step to step.
pub(super) struct Newton {
    /// What the cloth couples, without self-contact.
    cloth_pairs: Vec<[u32; 2]>,
    contact_pairs: Vec<[u32; 2]>,
    system: Option<(Pattern, Factor)>,
    blocks: Vec<Matrix3<f64>>,
    /// Steps for which the projected second derivatives are used, and how many the next time.
    projected: [usize; 2],
}

/// What one minimisation did.
#[derive(Debug, Clone, Copy)]
pub(super) struct Minimum {
    /// Newton steps, one factorisation each.
    pub(super) iterations: usize,
    /// Whether the gradient is below the tolerance.
    pub(super) is_reached: bool,
}

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Largest force left over on a vertex, N.
    pub(super) force: f64,
    pub(super) iterations: usize,
    /// Longest way of a vertex in one step, in metres.
    pub(super) step: f64,
}

impl Newton {
    pub(super) fn new(cloth_pairs: Vec<[u32; 2]>) -> Self {
        Self {
            cloth_pairs,
            contact_pairs: Vec::new(),
            system: None,
            blocks: Vec::new(),
            projected: [0, 1],
        }
    }

    /// Moves `x` to a minimum of `potential` with `inertia`, downhill in every step.
    pub(super) fn minimize(
        &mut self,
        potential: &mut Potential,
        inertia: &Inertia,
        x: &mut Vec<Vector3<f64>>,
        limits: Limits,
    ) -> Result<Minimum, SimError> {
        let mut energy = potential.energy(x, inertia);
        for iterations in 0..=limits.iterations {
            let gradient = potential.gradient(x, inertia);
            let is_reached = largest(&gradient) <= limits.force;
            if is_reached || iterations == limits.iterations {
                return Ok(Minimum {
                    iterations,
                    is_reached,
                });
            }
            if let Some(pairs) = &mut potential.self_contact {
                pairs.look(x);
            }
            let mut direction = self.direction(potential, inertia, x, &gradient)?;
            let max_step = potential
                .self_contact
                .as_ref()
                .map_or(limits.step, |pairs| limits.step.min(pairs.max_move()));
            let scale = (max_step / largest(&direction)).min(1.0);
            for direction in &mut direction {
                *direction *= scale;
            }
            let slope: f64 = gradient.iter().zip(&direction).map(|(g, d)| g.dot(d)).sum();
            match line_search(potential, inertia, x, (&direction, slope, energy)) {
                Some((next, next_energy)) => {
                    *x = next;
                    energy = next_energy;
                }
                // No step goes down: the rounding of the energy has been reached.
                None => {
                    return Ok(Minimum {
                        iterations,
                        is_reached: false,
                    });
                }
            }
        }
        unreachable!("the last round returns")
    }

    /// The Newton direction at `x`.
    fn direction(
        &mut self,
        potential: &Potential,
        inertia: &Inertia,
        x: &[Vector3<f64>],
        gradient: &[Vector3<f64>],
    ) -> Result<Vec<Vector3<f64>>, SimError> {
        self.prepare(potential, x)?;
        let Some((pattern, factor)) = &mut self.system else {
            return Err(SimError::Unsolvable { size: 3 * x.len() });
        };
        let mut direction: Vec<Vector3<f64>> = gradient.iter().map(|gradient| -gradient).collect();
        let mut attempt = |curvature: Curvature, shift: f64| {
            potential.hessian(x, inertia, curvature, (pattern, &mut self.blocks));
            for vertex in 0..x.len() {
                self.blocks[pattern.diagonal(vertex)] += Matrix3::identity() * shift;
            }
            factor.factor(pattern, &self.blocks)
        };
        let [left, patience] = self.projected;
        let is_true = left == 0 && attempt(Curvature::True, 0.0);
        if is_true {
            self.projected = [0, 1];
        } else {
            if left == 0 {
                self.projected = [patience, (2 * patience).min(MAX_PATIENCE)];
            }
            self.projected[0] -= 1;
            // Free of inertia and slack, cloth has directions without any stiffness.
            let mut shift = 0.0;
            while !attempt(Curvature::Projected, shift) {
                shift = if shift == 0.0 {
                    MIN_SHIFT
                } else {
                    10.0 * shift
                };
                if shift > MAX_SHIFT {
                    return Err(SimError::Unsolvable { size: 3 * x.len() });
                }
            }
        }
        factor.solve(&mut direction);
        Ok(direction)
    }

    /// Makes a pattern that holds all pairs in contact.
    fn prepare(&mut self, potential: &Potential, x: &[Vector3<f64>]) -> Result<(), SimError> {
        if let Some(contact) = &potential.self_contact {
            let is_known = |pair: [u32; 2]| self.contact_pairs.binary_search(&pair).is_ok();
            if !contact.near_pairs(x, 1.0).all(is_known) {
                self.contact_pairs = contact.near_pairs(x, PATTERN_RADII).collect();
                self.system = None;
            }
        }
        if self.system.is_none() {
            let pairs = self.cloth_pairs.iter().chain(&self.contact_pairs);
            let pattern = Pattern::new(x.len(), pairs.copied());
            self.blocks = vec![Matrix3::zeros(); pattern.num_blocks()];
            let factor = Factor::new(&pattern);
            let factor = factor.ok_or(SimError::Unsolvable { size: 3 * x.len() })?;
            self.system = Some((pattern, factor));
        }
        Ok(())
    }
}

/// Smallest and largest stiffness, N/m, that holds vertices which nothing else does.
const MIN_SHIFT: f64 = 1e-9;
const MAX_SHIFT: f64 = 1e6;

/// The longest of some vectors; infinite if one is not a number.
pub(super) fn largest(vectors: &[Vector3<f64>]) -> f64 {
    let mut largest = 0.0_f64;
    for vector in vectors {
        let length = vector.norm();
        if length.is_nan() {
            return f64::INFINITY;
        }
        largest = largest.max(length);
    }
    largest
}

/// The first point along the direction that lies low enough, and its energy.
fn line_search(
    potential: &Potential,
    inertia: &Inertia,
    x: &[Vector3<f64>],
    (direction, slope, energy): (&[Vector3<f64>], f64, f64),
) -> Option<(Vec<Vector3<f64>>, f64)> {
    let mut share = 1.0;
    for _ in 0..MAX_HALVINGS {
        let steps = x.iter().zip(direction);
        let next: Vec<Vector3<f64>> = steps.map(|(x, direction)| x + direction * share).collect();
        let next_energy = potential.energy(&next, inertia);
        let rounding = ENERGY_ROUNDING * energy.abs().max(next_energy.abs());
        if next_energy <= energy + ARMIJO * share * slope + rounding {
            return Some((next, next_energy));
        }
        share *= 0.5;
    }
    None
}
