//! The cloth as patches whose substeps run side by side.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use crate::Cloth;
use crate::contact::Plane;
use crate::xpbd::Projection;
use crate::xpbd::pairs::Pair;
use crate::xpbd::particles::Particles;
use crate::xpbd::patch::{Pace, Parts, Patch};
use crate::xpbd::quad::Quad;
use crate::xpbd::rounds::{Rounds, locked};
use crate::xpbd::seam::{Seam, Source};

/// Patches, and what is between them.
///
/// A substep takes all patches side by side, then what is between them. How they are cut depends on
/// the mesh alone, so that the number of threads does not show.
#[derive(Debug, Default)]
pub(crate) struct Patchwork {
    /// How many patches were asked for.
    number: u32,
    patches: Vec<Mutex<Patch>>,
    seam: Seam,
    /// Where each vertex of the cloth is.
    sources: Vec<Source>,
}

/// The patchwork that a run of a cloth has left for the next one: cutting takes as long as many
/// substeps.
#[derive(Debug, Default)]
pub(crate) struct Spare(Mutex<Patchwork>);

impl Clone for Spare {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Spare {
    /// What was left, if it is in so many patches.
    pub(crate) fn take(&self, number: u32) -> Option<Patchwork> {
        let mut left = locked(&self.0);
        (left.number == number).then(|| std::mem::take(&mut *left))
    }

    pub(crate) fn leave(&self, patchwork: Patchwork) {
        *locked(&self.0) = patchwork;
    }
}

impl Patchwork {
    /// Cuts the cloth into so many patches, or fewer if it has fewer vertices.
    pub(crate) fn new(cloth: &Cloth, particles: &Particles, number: u32) -> Self {
        let order = if number > 1 {
            from_end_to_end(cloth)
        } else {
            (0..cloth.num_vertices() as u32).collect()
        };
        let size = order.len().div_ceil(number as usize).max(1);
        let mut cut: Vec<Vec<u32>> = order.chunks(size).map(<[u32]>::to_vec).collect();
        let mut sources = vec![[0; 2]; order.len()];
        for (patch, vertices) in (0..).zip(&mut cut) {
            vertices.sort_unstable();
            for (place, &vertex) in (0..).zip(vertices.iter()) {
                sources[vertex as usize] = [patch, place];
            }
        }
        let mut parts: Vec<Parts> = cut.iter().map(|_| Parts::default()).collect();
        let mut between = Parts::default();
        for (index, spring) in (0..).zip(cloth.springs()) {
            let parts = shared(&sources, &spring.vertices).map(|patch| &mut parts[patch]);
            parts.unwrap_or(&mut between).springs.push(index);
        }
        for (index, hinge) in (0..).zip(cloth.hinges()) {
            let parts = shared(&sources, &hinge.vertices).map(|patch| &mut parts[patch]);
            parts.unwrap_or(&mut between).hinges.push(index);
        }
        let by_vertex: Vec<u32> = sources.iter().map(|&[_, place]| place).collect();
        let patches = cut.into_iter().zip(&parts);
        Self {
            number,
            patches: patches
                .map(|(vertices, parts)| Patch::new(cloth, particles, vertices, parts, &by_vertex))
                .map(Mutex::new)
                .collect(),
            seam: Seam::new(cloth, particles, &between, &sources),
            sources,
        }
    }

    /// Sets how springs and hinges are projected.
    pub(crate) fn set_projection(
        &mut self,
        cloth: &Cloth,
        inverse_masses: &[f32],
        projection: Projection,
    ) {
        let set = |patch: &mut Patch| patch.set_projection(cloth, inverse_masses, projection);
        (self.patches.par_iter_mut()).for_each(|patch| set(exclusive(patch)));
        set(self.seam.patch());
    }

    /// Sets the rest lengths `[spring]`, in metres.
    pub(crate) fn set_lengths(&mut self, lengths: impl Fn(usize) -> f32) {
        for patch in &mut self.patches {
            exclusive(patch).set_lengths(&lengths);
        }
        self.seam.patch().set_lengths(&lengths);
    }

    /// Takes over where the vertices are, the air around them, and what they touch.
    pub(crate) fn load(
        &mut self,
        particles: &Particles,
        wind: &[Quad],
        pairs: &[Pair],
        planes: &[Plane],
    ) {
        let mut patches: Vec<&mut Patch> = self.patches.iter_mut().map(exclusive).collect();
        (patches.par_iter_mut()).for_each(|patch| patch.load(particles, wind));
        self.seam.patch().load(particles, &[]);
        self.seam.pairs.clear();
        for pair in pairs {
            match shared(&self.sources, &pair.vertices) {
                Some(patch) => {
                    let vertices = pair.vertices.map(|vertex| self.sources[vertex as usize][1]);
                    patches[patch].pairs.push(pair.renamed(vertices));
                }
                None => self.seam.pairs.push(*pair),
            }
        }
        for plane in planes {
            let [patch, vertex] = self.sources[plane.vertex as usize];
            patches[patch as usize].planes.push(plane.renamed(vertex));
        }
    }

    /// Takes so many substeps after it was loaded; `first` counts the substeps of the stage before
    /// them.
    ///
    /// Another thread, if there is one, does what is to be done `meanwhile`, and then helps.
    pub(crate) fn step(
        &mut self,
        number: u32,
        first: u32,
        pace: &Pace,
        meanwhile: impl FnOnce() + Send,
    ) {
        let Self {
            patches,
            seam,
            sources,
            ..
        } = self;
        let bends = |substep: u32| (first + substep).is_multiple_of(pace.bending_interval);
        let work = |substep: u32, patch: &mut Patch| {
            if substep > 0 {
                patch.end(pace, substep as f32);
            }
            if substep < number {
                patch.begin(pace, bends(substep));
            }
        };
        let rounds = Rounds::new(patches);
        let lead = || {
            let _end = rounds.end();
            for substep in 0..number {
                rounds.lead(substep, &work);
                let mut patches: Vec<_> = patches.iter().map(locked).collect();
                let state = (bends(substep), substep as f32 + 1.0);
                seam.project(&mut patches, sources, pace, state);
            }
            rounds.lead(number, &work);
        };
        rayon::join(lead, || {
            meanwhile();
            if patches.len() > 1 {
                rounds.help(&work);
            }
        });
    }

    /// Tells where the vertices have come to.
    pub(crate) fn store(&mut self, particles: &mut Particles) {
        for patch in &mut self.patches {
            exclusive(patch).store(particles);
        }
    }
}

/// A patch that nobody else can work on.
fn exclusive(patch: &mut Mutex<Patch>) -> &mut Patch {
    patch.get_mut().unwrap_or_else(PoisonError::into_inner)
}

/// The patch in which all of some vertices are.
fn shared(sources: &[Source], vertices: &[u32]) -> Option<usize> {
    let patch = |&vertex: &u32| sources[vertex as usize][0] as usize;
    let first = vertices.first().map(patch)?;
    let mut others = vertices.iter().map(patch);
    others.all(|other| other == first).then_some(first)
}

/// The vertices in the order in which they are met from one end of the garment to the other, piece
/// by piece: little is between what comes before and after any of them.
fn from_end_to_end(cloth: &Cloth) -> Vec<u32> {
    let mut order = Vec::with_capacity(cloth.num_vertices());
    let [mut is_seen, mut is_in_order] = [0; 2].map(|_| vec![false; cloth.num_vertices()]);
    for vertex in 0..cloth.num_vertices() as u32 {
        if !is_seen[vertex as usize] {
            let mut piece = Vec::new();
            spread(cloth, vertex, &mut is_seen, &mut piece);
            let end = piece.last().copied().unwrap_or(vertex);
            spread(cloth, end, &mut is_in_order, &mut order);
        }
    }
    order
}

/// Adds what is joined to a vertex to a list, by the number of edges between.
fn spread(cloth: &Cloth, from: u32, is_met: &mut [bool], met: &mut Vec<u32>) {
    let mut next = met.len();
    met.push(from);
    is_met[from as usize] = true;
    while let Some(&vertex) = met.get(next) {
        next += 1;
        for &neighbor in cloth.topology().neighbors(vertex as usize) {
            if !std::mem::replace(&mut is_met[neighbor as usize], true) {
                met.push(neighbor);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Fabric, RestShape};
    use garnet_mesh::primitives::grid;

    #[test]
    fn patches_share_the_vertices_and_little_is_between_them() {
        let mesh = grid(40, 10, [1.0, 0.25]);
        let rest = RestShape::Worn(mesh.positions().to_vec());
        let cloth = Cloth::new(mesh.faces(), mesh.num_vertices(), &rest, &Fabric::cotton());
        let cloth = cloth.unwrap();
        let particles = Particles::new(&cloth, mesh.positions());
        for number in [1, 2, 4] {
            let patchwork = Patchwork::new(&cloth, &particles, number);
            let vertices = patchwork
                .patches
                .iter()
                .map(|patch| locked(patch).vertices.clone());
            let vertices: Vec<Vec<u32>> = vertices.collect();
            assert_eq!(vertices.len(), number as usize);
            let sizes = vertices.iter().map(Vec::len);
            assert!(sizes.clone().max().unwrap() - sizes.min().unwrap() < 4);
            let mut all = vertices.concat();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..cloth.num_vertices() as u32));
            // Cut across: two hinges deep at each cut.
            let between = patchwork.seam.num_copied();
            assert!(between <= 60 * (number as usize - 1), "{between}");
        }
    }

    #[test]
    fn pieces_and_more_patches_than_vertices_are_no_trouble() {
        let mesh = grid(1, 1, [0.1, 0.1]);
        let rest = RestShape::Worn(mesh.positions().to_vec());
        let cloth = Cloth::new(&mesh.faces()[..1], 4, &rest, &Fabric::cotton()).unwrap();
        let particles = Particles::new(&cloth, mesh.positions());
        let patchwork = Patchwork::new(&cloth, &particles, 9);
        assert_eq!(patchwork.patches.len(), 4);
    }
}
