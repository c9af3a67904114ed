//! What is between patches of the cloth.

use std::ops::DerefMut;

use crate::Cloth;
use crate::xpbd::pairs::Pair;
use crate::xpbd::particles::Particles;
use crate::xpbd::patch::{Pace, Parts, Patch};

/// Where a vertex is: its patch, and its place there.
pub(super) type Source = [u32; 2];

/// Springs, hinges and pairs whose vertices are in several patches.
#[derive(Debug, Default)]
pub(super) struct Seam {
    /// The springs and hinges, on copies of their vertices.
    patch: Patch,
    /// From where each place of it is copied.
    copied: Vec<Source>,
    /// The pairs, by vertices of the cloth.
    pub(super) pairs: Vec<Pair>,
}

impl Seam {
    /// `sources` are those of the vertices of the cloth.
    pub(super) fn new(
        cloth: &Cloth,
        particles: &Particles,
        parts: &Parts,
        sources: &[Source],
    ) -> Self {
        let springs = (parts.springs.iter()).map(|&spring| &cloth.springs()[spring as usize]);
        let hinges = (parts.hinges.iter()).map(|&hinge| &cloth.hinges()[hinge as usize]);
        let of_springs = springs.flat_map(|spring| spring.vertices);
        let of_hinges = hinges.flat_map(|hinge| hinge.vertices);
        let mut vertices: Vec<u32> = of_springs.chain(of_hinges).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let mut by_vertex = vec![0; cloth.num_vertices()];
        for (place, &vertex) in (0..).zip(&vertices) {
            by_vertex[vertex as usize] = place;
        }
        let copied = vertices.iter().map(|&vertex| sources[vertex as usize]);
        Self {
            copied: copied.collect(),
            patch: Patch::new(cloth, particles, vertices, parts, &by_vertex),
            pairs: Vec::new(),
        }
    }

    /// Its springs and hinges.
    pub(super) fn patch(&mut self) -> &mut Patch {
        &mut self.patch
    }

    /// How many vertices are copied.
    #[cfg(test)]
    pub(super) fn num_copied(&self) -> usize {
        self.copied.len()
    }

    /// Projects what is between patches once.
    pub(super) fn project(
        &mut self,
        patches: &mut [impl DerefMut<Target = Patch>],
        sources: &[Source],
        pace: &Pace,
        (bends, substep): (bool, f32),
    ) {
        let offsets = &mut self.patch.particles.offsets;
        for (offset, &[patch, place]) in offsets.iter_mut().zip(&self.copied) {
            *offset = patches[patch as usize].particles.offsets[place as usize];
        }
        self.patch.pull(bends);
        let offsets = &self.patch.particles.offsets;
        for (&offset, &[patch, place]) in offsets.iter().zip(&self.copied) {
            patches[patch as usize].particles.offsets[place as usize] = offset;
        }
        for pair in &self.pairs {
            let ends = pair.vertices.map(|vertex| sources[vertex as usize]);
            let known = ends.map(|[patch, place]| patches[patch as usize].state(place as usize));
            if let Some(pushed) = pair.pushed(known, pace.friction, substep) {
                for ([patch, place], offset) in ends.into_iter().zip(pushed) {
                    patches[patch as usize].particles.offsets[place as usize] = offset;
                }
            }
        }
    }
}
