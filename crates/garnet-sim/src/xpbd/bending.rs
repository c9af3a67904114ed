//! Hinges that resist folds.

use crate::Cloth;
use crate::xpbd::coloring::colors;
use crate::xpbd::particles::Places;
use crate::xpbd::quad::Quad;

/// Hinges ordered by color.
///
/// The constraint Σ wₘ xₘ = 0 is linear, so one projection with a fresh multiplier is a constant
/// matrix:
///
/// ```text
/// Δxₘ = −mₘ wₘ s / (Σ mₙ wₙ² + α),   s = Σ wₙ xₙ,   α = 1 / (b h²)
/// ```
///
/// with mₘ one over the masses and b the stiffness of the hinge.
#[derive(Debug, Clone, Default)]
pub(crate) struct Bending {
    rows: Vec<Row>,
    /// The hinge of each row.
    hinges: Vec<u32>,
}

#[derive(Debug, Clone, Copy)]
struct Row {
    vertices: [u32; 4],
    weights: Quad,
    /// What each vertex moves by for s = 1.
    responses: Quad,
    /// s of the bases; the fourth number is 0.
    base: Quad,
}

impl Bending {
    /// Some of the hinges of the cloth, all of whose vertices have places.
    pub(crate) fn new(cloth: &Cloth, some: &[u32], places: Places<'_>) -> Self {
        let hinges = cloth.hinges();
        let vertices = some
            .iter()
            .map(|&hinge| places.of(hinges[hinge as usize].vertices));
        let order = colors(places.number, vertices).concat();
        let order: Vec<u32> = order
            .into_iter()
            .map(|index| some[index as usize])
            .collect();
        let rows = order.iter().map(|&hinge| {
            let hinge = &hinges[hinge as usize];
            Row {
                vertices: places.of(hinge.vertices),
                weights: Quad(hinge.weights),
                responses: Quad::ZERO,
                base: Quad::ZERO,
            }
        });
        Self {
            rows: rows.collect(),
            hinges: order,
        }
    }

    /// Sets the length of the substep, in seconds, and in how many of them hinges are projected
    /// once. The impulse of one projection is that of all these substeps.
    pub(crate) fn set_step(
        &mut self,
        cloth: &Cloth,
        inverse_masses: &[f32],
        step: f32,
        every: u32,
    ) {
        for (row, &hinge) in self.rows.iter_mut().zip(&self.hinges) {
            let hinge = &cloth.hinges()[hinge as usize];
            let inverse = hinge.vertices.map(|vertex| inverse_masses[vertex as usize]);
            let per_weight: f32 = (0..4)
                .map(|m| inverse[m] * hinge.weights[m] * hinge.weights[m])
                .sum();
            // Cloth without bending rigidity has an infinite compliance: no response.
            let stiffness = hinge.stiffness * step * step * every as f32;
            let denominator = per_weight * stiffness + 1.0;
            row.responses = Quad(
                [0, 1, 2, 3].map(|m| -inverse[m] * hinge.weights[m] * stiffness / denominator),
            );
        }
    }

    /// Takes over new bases.
    pub(crate) fn rebase(&mut self, bases: &[Quad]) {
        for row in &mut self.rows {
            // The weights sum to zero: relative to one vertex the products stay small.
            let [a, b, c, d] = row.vertices.map(|vertex| bases[vertex as usize]);
            let [_, second, third, fourth] = row.weights.0;
            row.base = (b - a) * second + (c - a) * third + (d - a) * fourth;
        }
    }

    /// Projects every hinge once.
    #[inline(never)]
    pub(crate) fn project(&self, offsets: &mut [Quad]) {
        for row in &self.rows {
            let [a, b, c, d] = row.vertices.map(|vertex| vertex as usize);
            let [wa, wb, wc, wd] = row.weights.0;
            let [ra, rb, rc, rd] = row.responses.0;
            let (xa, xb, xc, xd) = (offsets[a], offsets[b], offsets[c], offsets[d]);
            let fold = row.base + xa * wa + xb * wb + (xc * wc + xd * wd);
            offsets[a] = xa + fold * ra;
            offsets[b] = xb + fold * rb;
            offsets[c] = xc + fold * rc;
            offsets[d] = xd + fold * rd;
        }
    }
}
