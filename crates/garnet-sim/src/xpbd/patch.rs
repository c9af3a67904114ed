//! A part of the cloth whose substeps run on one thread.

use crate::Cloth;
use crate::contact::{self, Plane};
use crate::xpbd::Projection;
use crate::xpbd::bending::Bending;
use crate::xpbd::pairs::{End, Pair};
use crate::xpbd::particles::{Particles, Places, Push};
use crate::xpbd::quad::Quad;
use crate::xpbd::springs::Springs;

/// Some vertices and what is between them alone.
#[derive(Debug, Default)]
pub(crate) struct Patch {
    /// The vertex of the cloth at each place.
    pub(super) vertices: Vec<u32>,
    pub(super) particles: Particles,
    inverse_masses: Vec<f32>,
    springs: Springs,
    bending: Bending,
    pub(super) pairs: Vec<Pair>,
    pub(super) planes: Vec<Plane>,
    wind: Vec<Quad>,
}

/// What the substeps of a stage have in common.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pace {
    /// What moves vertices freely.
    pub(crate) push: Push,
    /// Coulomb's coefficient of cloth on cloth.
    pub(crate) friction: f32,
    /// Hinges are projected once in so many substeps.
    pub(crate) bending_interval: u32,
}

/// Springs and hinges of the cloth.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub(super) springs: Vec<u32>,
    pub(super) hinges: Vec<u32>,
}

impl Patch {
    /// Of the places of its vertices those of its springs and hinges have to be known.
    pub(super) fn new(
        cloth: &Cloth,
        particles: &Particles,
        vertices: Vec<u32>,
        parts: &Parts,
        by_vertex: &[u32],
    ) -> Self {
        let inverse_masses = cloth.inverse_masses();
        let places = Places {
            by_vertex,
            number: vertices.len(),
        };
        let mass = |&vertex: &u32| inverse_masses[vertex as usize];
        Self {
            particles: particles.some(&vertices),
            inverse_masses: vertices.iter().map(mass).collect(),
            springs: Springs::new(cloth, &parts.springs, places),
            bending: Bending::new(cloth, &parts.hinges, places),
            pairs: Vec::new(),
            planes: Vec::new(),
            wind: Vec::new(),
            vertices,
        }
    }

    /// Sets how springs and hinges are projected.
    pub(super) fn set_projection(
        &mut self,
        cloth: &Cloth,
        inverse_masses: &[f32],
        projection: Projection,
    ) {
        (self.springs).set_projection(cloth, inverse_masses, projection);
        (self.bending).set_projection(cloth, inverse_masses, projection);
    }

    /// Sets the rest lengths `[spring of the cloth]`, in metres.
    pub(super) fn set_lengths(&mut self, lengths: &dyn Fn(usize) -> f32) {
        self.springs.set_lengths(lengths);
    }

    /// Takes over where its vertices are, and the air around them.
    pub(super) fn load(&mut self, from: &Particles, wind: &[Quad]) {
        self.particles.load(from, &self.vertices);
        self.pairs.clear();
        self.planes.clear();
        self.wind.clear();
        if !wind.is_empty() {
            let of_vertex = |&vertex: &u32| wind[vertex as usize];
            self.wind.extend(self.vertices.iter().map(of_vertex));
        }
        self.springs.rebase(&self.particles.bases);
        self.bending.rebase(&self.particles.bases);
    }

    /// Tells where its vertices have come to.
    pub(super) fn store(&self, to: &mut Particles) {
        self.particles.store(to, &self.vertices);
    }

    /// Begins a substep: vertices fly on, springs and hinges pull.
    pub(super) fn begin(&mut self, pace: &Pace, bends: bool) {
        self.particles.fly(pace.push, &self.wind);
        self.pull(bends);
    }

    /// Springs and hinges pull.
    pub(super) fn pull(&mut self, bends: bool) {
        self.springs.project(&mut self.particles.offsets);
        if bends {
            self.bending.project(&mut self.particles.offsets);
        }
    }

    /// Ends a substep: vertices are pushed apart and in front of the skin.
    ///
    /// `substep` counts from the refresh that found pairs and planes.
    pub(super) fn end(&mut self, pace: &Pace, substep: f32) {
        self.push_apart(pace.friction, substep);
        contact::project(&self.planes, &mut self.particles, substep);
    }

    #[inline(never)]
    fn push_apart(&mut self, friction: f32, substep: f32) {
        for pair in &self.pairs {
            let places = pair.vertices.map(|place| place as usize);
            let ends = places.map(|place| self.state(place));
            if let Some(pushed) = pair.pushed(ends, friction, substep) {
                places
                    .into_iter()
                    .zip(pushed)
                    .for_each(|(place, offset)| self.particles.offsets[place] = offset);
            }
        }
    }

    /// What a pair has to know of a vertex.
    #[inline]
    pub(super) fn state(&self, place: usize) -> End {
        End {
            base: self.particles.bases[place],
            offset: self.particles.offsets[place],
            last: self.particles.last[place],
            inverse_mass: self.inverse_masses[place],
        }
    }
}
