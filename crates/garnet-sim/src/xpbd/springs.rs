//! Edges that resist changes of their length, in blocks.

use crate::Cloth;
use crate::xpbd::Projection;
use crate::xpbd::coloring::colors;
use crate::xpbd::particles::{Particles, Places};
use crate::xpbd::quad::Quad;

/// Springs in blocks that share no vertex.
///
/// One projection of XPBD (Macklin, Müller and Chentanez 2016, equations 17 and 18) with a fresh
/// multiplier a substep:
///
/// ```text
/// Δx₁ = −w₁ / (w₁ + w₂ + α) (|d| − l) d/|d|,   α = 1 / (k h²),   d = x₁ − x₂
/// ```
///
/// with the compliance α of its k for a spring that is shorter than l.
#[derive(Debug, Clone, Default)]
pub(crate) struct Springs {
    blocks: Vec<Block>,
    /// The spring of each slot of the blocks; none in padding.
    slots: Vec<Option<u32>>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub(super) first: [u32; WIDTH],
    pub(super) second: [u32; WIDTH],
    /// Base of the first vertex less that of the second, m; the fourth number is 0.
    pub(super) spans: [Quad; WIDTH],
    /// Rest lengths, m.
    pub(super) lengths: [f32; WIDTH],
    /// Share of the correction that each vertex takes.
    pub(super) first_shares: [f32; WIDTH],
    pub(super) second_shares: [f32; WIDTH],
    /// What both are multiplied by where the spring is shorter than at rest.
    pub(super) compressions: [f32; WIDTH],
}

/// Springs of a block: loops over so many numbers become vector instructions.
pub(super) const WIDTH: usize = 16;

/// Keeps a spring of no length from dividing by zero, m².
pub(super) const TINY_SQUARED: f32 = 1e-20;

impl Springs {
    /// Some of the springs of the cloth, all of whose ends have places.
    pub(crate) fn new(cloth: &Cloth, some: &[u32], places: Places<'_>) -> Self {
        let ends = |spring: u32| places.of(cloth.springs()[spring as usize].vertices);
        let edges = some.iter().map(|&spring| ends(spring));
        let padding = Particles::padding(places.number);
        let mut slots = Vec::with_capacity(some.len() + 64);
        for color in colors(places.number, edges) {
            slots.extend(color.into_iter().map(|index| Some(some[index as usize])));
            slots.resize(slots.len().next_multiple_of(WIDTH), None);
        }
        let blocks = slots.chunks_exact(WIDTH).map(|slots| {
            let vertex = |slot: usize, which: usize| slots[slot].map_or(padding, ends)[which];
            Block {
                first: std::array::from_fn(|slot| vertex(slot, 0)),
                second: std::array::from_fn(|slot| vertex(slot, 1)),
                spans: [Quad::ZERO; WIDTH],
                lengths: [1.0; WIDTH],
                first_shares: [0.0; WIDTH],
                second_shares: [0.0; WIDTH],
                compressions: [1.0; WIDTH],
            }
        });
        Self {
            blocks: blocks.collect(),
            slots,
        }
    }

    /// Sets how springs are projected.
    pub(crate) fn set_projection(
        &mut self,
        cloth: &Cloth,
        inverse_masses: &[f32],
        Projection {
            step,
            over_relaxation,
            ..
        }: Projection,
    ) {
        for (index, slot) in self.slots.iter().enumerate() {
            let Some(spring) = *slot else { continue };
            let spring = &cloth.springs()[spring as usize];
            let compliance = |stiffness: f32| 1.0 / (stiffness * step * step);
            let [first, second] = spring
                .vertices
                .map(|vertex| inverse_masses[vertex as usize]);
            let stretched = first + second + compliance(spring.stiffness);
            let block = &mut self.blocks[index / WIDTH];
            block.first_shares[index % WIDTH] = over_relaxation * first / stretched;
            block.second_shares[index % WIDTH] = over_relaxation * second / stretched;
            // Without any stiffness the compliance is infinite, and the factor zero.
            let shortened = first + second + compliance(spring.compression);
            block.compressions[index % WIDTH] = stretched / shortened;
        }
    }

    /// Sets the rest lengths `[spring]`, in metres.
    pub(crate) fn set_lengths(&mut self, lengths: impl Fn(usize) -> f32) {
        for (index, slot) in self.slots.iter().enumerate() {
            if let Some(spring) = *slot {
                self.blocks[index / WIDTH].lengths[index % WIDTH] = lengths(spring as usize);
            }
        }
    }

    /// Takes over new bases.
    pub(crate) fn rebase(&mut self, bases: &[Quad]) {
        for block in &mut self.blocks {
            let ends = block.first.into_iter().zip(block.second);
            for (span, (first, second)) in block.spans.iter_mut().zip(ends) {
                *span = bases[first as usize] - bases[second as usize];
            }
        }
    }

    /// Projects every spring once.
    #[inline(never)]
    pub(crate) fn project(&self, offsets: &mut [Quad]) {
        #[cfg(target_arch = "x86_64")]
        if super::eights::project(&self.blocks, offsets) {
            return;
        }
        self.project_plainly(offsets);
    }

    fn project_plainly(&self, offsets: &mut [Quad]) {
        for block in &self.blocks {
            let mut along = block.spans;
            for (slot, along) in along.iter_mut().enumerate() {
                let [first, second] = [block.first[slot], block.second[slot]];
                *along += offsets[first as usize] - offsets[second as usize];
            }
            let mut stretch = [0.0; WIDTH];
            for (slot, stretch) in stretch.iter_mut().enumerate() {
                let [x, y, z, _] = along[slot].0;
                let length = (x * x + y * y + z * z + TINY_SQUARED).sqrt();
                let relative = 1.0 - block.lengths[slot] / length;
                *stretch = relative.max(0.0) + relative.min(0.0) * block.compressions[slot];
            }
            for slot in 0..WIDTH {
                let [first, second] = [block.first[slot], block.second[slot]];
                let correction = along[slot] * stretch[slot];
                offsets[first as usize] -= correction * block.first_shares[slot];
                offsets[second as usize] += correction * block.second_shares[slot];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Fabric;
    use crate::xpbd::sheet::{Sheet, waves};

    /// All springs of a sheet, ready to be projected.
    fn springs(sheet: &Sheet, projection: Projection) -> Springs {
        let cloth = &sheet.cloth;
        let all: Vec<u32> = (0..cloth.springs().len() as u32).collect();
        let mut springs = Springs::new(cloth, &all, sheet.places());
        springs.set_projection(cloth, &cloth.inverse_masses(), projection);
        springs.set_lengths(|spring| cloth.springs()[spring].rest_length);
        springs.rebase(&sheet.particles.bases);
        springs
    }

    /// Offsets after one projection of a sheet that is `scale` times as large as at rest.
    fn projected(fabric: &Fabric, scale: f32) -> Vec<Quad> {
        let sheet = Sheet::new([4, 3], fabric, |p| p * scale);
        let mut offsets = sheet.particles.offsets.clone();
        springs(&sheet, Projection::of(5e-4, 1)).project(&mut offsets);
        offsets
    }

    #[test]
    fn vector_instructions_give_the_same_bits_as_the_plain_loop() {
        // Not as many springs as blocks have room for, in several colors.
        let sheet = Sheet::new([9, 7], &Fabric::interlock(), waves);
        let springs = springs(&sheet, Projection::of(5e-4, 1));
        let [mut fast, mut plain] = [0; 2].map(|_| sheet.particles.offsets.clone());
        for _ in 0..20 {
            springs.project(&mut fast);
            springs.project_plainly(&mut plain);
        }
        assert_eq!(fast, plain);
        assert!(plain.iter().any(|offset| offset.dot3(*offset) > 1e-8));
    }

    #[test]
    fn over_relaxed_springs_are_corrected_by_as_much_more() {
        let sheet = Sheet::new([4, 3], &Fabric::interlock(), waves);
        let plain = Projection::of(5e-4, 1);
        let more = Projection {
            over_relaxation: 1.5,
            ..plain
        };
        let [plain, more] = [plain, more].map(|projection| springs(&sheet, projection));
        for (plain, more) in plain.blocks.iter().zip(&more.blocks) {
            let shares = |block: &Block| [block.first_shares, block.second_shares].concat();
            for (plain, more) in shares(plain).into_iter().zip(shares(more)) {
                assert!((more - 1.5 * plain).abs() < 1e-6);
            }
            let bits = |block: &Block| block.compressions.map(f32::to_bits);
            assert_eq!(bits(plain), bits(more));
        }
    }

    #[test]
    fn a_shortened_spring_gives_way_as_one_of_its_share_of_the_stiffness_does() {
        let half = Fabric {
            compression: 0.5,
            ..Fabric::cotton()
        };
        let weak = Fabric {
            membrane: 0.5 * half.membrane,
            compression: 1.0,
            ..half
        };
        let whole = Fabric {
            compression: 1.0,
            ..half
        };
        let largest = |a: &[Quad], b: &[Quad]| {
            let apart = a.iter().zip(b).map(|(a, b)| (*a - *b).dot3(*a - *b).sqrt());
            apart.fold(0.0, f32::max)
        };
        let shortened = projected(&half, 0.9);
        assert!(largest(&shortened, &projected(&weak, 0.9)) < 1e-8);
        assert!(largest(&shortened, &projected(&whole, 0.9)) > 1e-5);
        assert_eq!(projected(&half, 1.1), projected(&whole, 1.1));
        let none = Fabric {
            compression: 0.0,
            ..half
        };
        assert!(projected(&none, 0.9).iter().all(|o| *o == Quad::ZERO));
    }
}
