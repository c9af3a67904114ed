//! Hinges that resist folds.

use crate::Cloth;
use crate::xpbd::Projection;
use crate::xpbd::coloring::colors;
use crate::xpbd::particles::{Particles, Places};
use crate::xpbd::quad::Quad;

/// Hinges ordered by color, an even number of each: two that follow each other share no vertex.
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
    /// The hinge of each row; none in padding.
    hinges: Vec<Option<u32>>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    pub(super) vertices: [u32; 4],
    pub(super) weights: Quad,
    /// What each vertex moves by for s = 1.
    pub(super) responses: Quad,
    /// s of the bases; the fourth number is 0.
    pub(super) base: Quad,
}

impl Bending {
    /// Some of the hinges of the cloth, all of whose vertices have places.
    pub(crate) fn new(cloth: &Cloth, some: &[u32], places: Places<'_>) -> Self {
        let hinges = cloth.hinges();
        let vertices = some
            .iter()
            .map(|&hinge| places.of(hinges[hinge as usize].vertices));
        let mut order = Vec::with_capacity(some.len() + 16);
        for color in colors(places.number, vertices) {
            order.extend(color.into_iter().map(|index| Some(some[index as usize])));
            order.resize(order.len().next_multiple_of(2), None);
        }
        let [first, second] = Particles::padding(places.number);
        let rows = order.iter().map(|hinge| {
            let hinge = hinge.map(|hinge| &hinges[hinge as usize]);
            Row {
                vertices: hinge.map_or([first, second, first, second], |hinge| {
                    places.of(hinge.vertices)
                }),
                weights: hinge.map_or(Quad::ZERO, |hinge| Quad(hinge.weights)),
                responses: Quad::ZERO,
                base: Quad::ZERO,
            }
        });
        Self {
            rows: rows.collect(),
            hinges: order,
        }
    }

    /// Sets how hinges are projected. The impulse of one projection is that of all the substeps up
    /// to the next.
    pub(crate) fn set_projection(
        &mut self,
        cloth: &Cloth,
        inverse_masses: &[f32],
        Projection {
            step,
            bending_interval,
            ..
        }: Projection,
    ) {
        for (row, hinge) in self.rows.iter_mut().zip(&self.hinges) {
            let Some(hinge) = *hinge else { continue };
            let hinge = &cloth.hinges()[hinge as usize];
            let inverse = hinge.vertices.map(|vertex| inverse_masses[vertex as usize]);
            let per_weight: f32 = (0..4)
                .map(|m| inverse[m] * hinge.weights[m] * hinge.weights[m])
                .sum();
            // Cloth without bending rigidity has an infinite compliance: no response.
            let stiffness = hinge.stiffness * step * step * bending_interval as f32;
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
        #[cfg(target_arch = "x86_64")]
        if super::eights::bend(&self.rows, offsets) {
            return;
        }
        self.project_plainly(offsets);
    }

    fn project_plainly(&self, offsets: &mut [Quad]) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Fabric;
    use crate::xpbd::sheet::{Sheet, waves};

    #[test]
    fn vector_instructions_give_the_same_bits_as_the_plain_loop() {
        // Colors with odd numbers of hinges, too.
        let sheet = Sheet::new([9, 7], &Fabric::denim(), waves);
        let (cloth, particles) = (&sheet.cloth, &sheet.particles);
        let all: Vec<u32> = (0..cloth.hinges().len() as u32).collect();
        let mut bending = Bending::new(cloth, &all, sheet.places());
        assert!(bending.hinges.iter().any(Option::is_none));
        bending.set_projection(cloth, &cloth.inverse_masses(), Projection::of(5e-4, 4));
        bending.rebase(&particles.bases);
        let [mut fast, mut plain] = [0; 2].map(|_| particles.offsets.clone());
        for _ in 0..20 {
            bending.project(&mut fast);
            bending.project_plainly(&mut plain);
        }
        assert_eq!(fast, plain);
        assert!(plain.iter().any(|offset| offset.dot3(*offset) > 1e-8));
    }
}
