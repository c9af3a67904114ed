//! Edges that resist changes of their length, four at a time.

use crate::Cloth;
use crate::xpbd::coloring::colors;
use crate::xpbd::particles::Particles;
use crate::xpbd::quad::Quad;

/// Springs in blocks of four that share no vertex.
///
/// One projection of XPBD (Macklin, Müller and Chentanez 2016, equations 17 and 18) with a fresh
/// multiplier a substep:
///
/// ```text
/// Δx₁ = −w₁ / (w₁ + w₂ + α) (|d| − l) d/|d|,   α = 1 / (k h²),   d = x₁ − x₂
/// ```
#[derive(Debug, Clone)]
pub(crate) struct Springs {
    blocks: Vec<Block>,
    /// The spring of each slot of the blocks; none in padding.
    slots: Vec<Option<u32>>,
}

#[derive(Debug, Clone, Copy)]
struct Block {
    first: [u32; 4],
    second: [u32; 4],
    /// Base of the first vertex less that of the second `[axis]`, m.
    spans: [Quad; 3],
    /// Rest lengths, m.
    lengths: Quad,
    /// Share of the correction that each vertex takes.
    first_shares: Quad,
    second_shares: Quad,
}

/// Keeps a spring of no length from dividing by zero, m².
const TINY_SQUARED: f32 = 1e-20;

impl Springs {
    pub(crate) fn new(cloth: &Cloth) -> Self {
        let springs = cloth.springs();
        let edges = springs.iter().map(|spring| spring.vertices);
        let [end, other_end] = Particles::padding(cloth.num_vertices());
        let mut slots = Vec::with_capacity(springs.len() + 64);
        for color in colors(cloth.num_vertices(), edges) {
            slots.extend(color.into_iter().map(Some));
            slots.resize(slots.len().next_multiple_of(4), None);
        }
        let blocks = slots.chunks_exact(4).map(|slots| {
            let vertex = |slot: usize, which: usize| match slots[slot] {
                Some(spring) => springs[spring as usize].vertices[which],
                None => [end, other_end][which],
            };
            Block {
                first: [0, 1, 2, 3].map(|slot| vertex(slot, 0)),
                second: [0, 1, 2, 3].map(|slot| vertex(slot, 1)),
                spans: [Quad::ZERO; 3],
                lengths: Quad::splat(1.0),
                first_shares: Quad::ZERO,
                second_shares: Quad::ZERO,
            }
        });
        Self {
            blocks: blocks.collect(),
            slots,
        }
    }

    /// Sets the length of the substep, in seconds.
    pub(crate) fn set_step(&mut self, cloth: &Cloth, inverse_masses: &[f32], step: f32) {
        for (index, slot) in self.slots.iter().enumerate() {
            let Some(spring) = *slot else { continue };
            let spring = &cloth.springs()[spring as usize];
            let compliance = 1.0 / (spring.stiffness * step * step);
            let [first, second] = spring
                .vertices
                .map(|vertex| inverse_masses[vertex as usize]);
            let block = &mut self.blocks[index / 4];
            block.first_shares.0[index % 4] = first / (first + second + compliance);
            block.second_shares.0[index % 4] = second / (first + second + compliance);
        }
    }

    /// Sets the rest lengths `[spring]`, in metres.
    pub(crate) fn set_lengths(&mut self, lengths: impl Fn(usize) -> f32) {
        for (index, slot) in self.slots.iter().enumerate() {
            if let Some(spring) = *slot {
                self.blocks[index / 4].lengths.0[index % 4] = lengths(spring as usize);
            }
        }
    }

    /// Takes over new bases.
    pub(crate) fn rebase(&mut self, bases: &[Quad]) {
        for block in &mut self.blocks {
            let difference = |slot: usize| {
                bases[block.first[slot] as usize] - bases[block.second[slot] as usize]
            };
            block.spans = Quad::transposed([0, 1, 2, 3].map(difference));
        }
    }

    /// Projects every spring once.
    pub(crate) fn project(&self, offsets: &mut [Quad]) {
        for block in &self.blocks {
            let first = block.first.map(|vertex| offsets[vertex as usize]);
            let second = block.second.map(|vertex| offsets[vertex as usize]);
            let [x, y, z] = Quad::transposed([
                first[0] - second[0],
                first[1] - second[1],
                first[2] - second[2],
                first[3] - second[3],
            ]);
            let [x, y, z] = [x + block.spans[0], y + block.spans[1], z + block.spans[2]];
            let length = (x * x + y * y + z * z + Quad::splat(TINY_SQUARED)).sqrt();
            let stretch = Quad::splat(1.0) - block.lengths * length.recip();
            let to_first = stretch * block.first_shares;
            let to_second = stretch * block.second_shares;
            for slot in 0..4 {
                let along = Quad([x.0[slot], y.0[slot], z.0[slot], 0.0]);
                offsets[block.first[slot] as usize] = first[slot] - along * to_first.0[slot];
                offsets[block.second[slot] as usize] = second[slot] + along * to_second.0[slot];
            }
        }
    }
}
