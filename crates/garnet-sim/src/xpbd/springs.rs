//! Edges that resist changes of their length, in blocks.

use crate::Cloth;
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
#[derive(Debug, Clone)]
pub(crate) struct Springs {
    blocks: Vec<Block>,
    /// The spring of each slot of the blocks; none in padding.
    slots: Vec<Option<u32>>,
}

#[derive(Debug, Clone, Copy)]
struct Block {
    first: [u32; WIDTH],
    second: [u32; WIDTH],
    /// Base of the first vertex less that of the second, m.
    spans: [Quad; WIDTH],
    /// Rest lengths, m.
    lengths: [f32; WIDTH],
    /// Share of the correction that each vertex takes.
    first_shares: [f32; WIDTH],
    second_shares: [f32; WIDTH],
}

/// Springs of a block: loops over so many numbers become vector instructions.
const WIDTH: usize = 16;

/// Keeps a spring of no length from dividing by zero, m².
const TINY_SQUARED: f32 = 1e-20;

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
            let block = &mut self.blocks[index / WIDTH];
            block.first_shares[index % WIDTH] = first / (first + second + compliance);
            block.second_shares[index % WIDTH] = second / (first + second + compliance);
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
                *stretch = 1.0 - block.lengths[slot] / length;
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
