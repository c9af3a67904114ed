//! Cloth on cloth: vertices that repel each other.

use rayon::prelude::*;

use crate::layers::Layers;
use crate::xpbd::particles::Particles;
use crate::xpbd::quad::Quad;

/// Finds vertices that come near each other, and keeps them apart.
#[derive(Debug)]
pub(crate) struct Pairs {
    layers: Layers,
    /// The largest distance at which two vertices become a pair, m.
    search: f32,
    grid: Grid,
    near: Vec<Pair>,
}

/// Two vertices that are near each other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pair {
    pub(crate) vertices: [u32; 2],
    /// The distance that they have to keep at first, m, and what it grows by a substep.
    reach: f32,
    rise: f32,
}

/// Pairs are those that are nearer than this many times their reach: the others do not meet before
/// the next refresh.
const MARGIN: f32 = 1.5;

/// Vertices whose neighbors are looked for by one thread at a time.
const CHUNK: usize = 512;

impl Pairs {
    pub(crate) fn new(layers: Layers) -> Self {
        Self {
            search: MARGIN * layers.widest(),
            layers,
            grid: Grid::default(),
            near: Vec::new(),
        }
    }

    /// Finds the pairs anew, but for those of two vertices `is_out` `[vertex]`.
    ///
    /// Pairs that are too near begin at their distance and come apart by no more than `max_rise`
    /// metres a substep, in `num_substeps` if they can: none is thrown.
    pub(crate) fn refresh(
        &mut self,
        particles: &Particles,
        is_out: &[bool],
        max_rise: f32,
        num_substeps: u32,
    ) {
        let points = &particles.bases[..particles.num_vertices()];
        self.grid.fill(points, self.search);
        let (grid, layers) = (&self.grid, &self.layers);
        let pair = |a: usize, b: usize, squared: f32| {
            let reach = layers.reach(a, b);
            if squared > MARGIN * MARGIN * reach * reach || (is_out[a] && is_out[b]) {
                return None;
            }
            let (a, b) = (a.min(b), a.max(b));
            let full = layers.distance(a, b)?;
            let missing = (full - squared.sqrt()).max(0.0);
            Some(Pair {
                vertices: [a as u32, b as u32],
                reach: full - missing,
                rise: max_rise.min(missing / num_substeps as f32),
            })
        };
        let chunks = (0..points.len().div_ceil(CHUNK)).into_par_iter();
        let found = chunks.map(|chunk| {
            let some = chunk * CHUNK..points.len().min((chunk + 1) * CHUNK);
            let mut pairs = Vec::new();
            grid.for_near_pairs(some, points, self.search, |a, b, squared| {
                pairs.extend(pair(a, b, squared));
            });
            pairs
        });
        let found: Vec<Vec<Pair>> = found.collect();
        self.near.clear();
        self.near.extend(found.into_iter().flatten());
    }

    /// The pairs that were found.
    pub(crate) fn near(&self) -> &[Pair] {
        &self.near
    }
}

/// One vertex of a pair.
#[derive(Debug, Clone, Copy)]
pub(crate) struct End {
    pub(crate) base: Quad,
    pub(crate) offset: Quad,
    /// Its offset before the substep, m.
    pub(crate) last: Quad,
    /// One over its mass, 1/kg.
    pub(crate) inverse_mass: f32,
}

impl Pair {
    /// The same for vertices by other numbers.
    pub(crate) fn renamed(self, vertices: [u32; 2]) -> Self {
        Self { vertices, ..self }
    }

    /// The offsets of its two vertices, pushed apart and their sliding braked by Coulomb's coefficient, if they are too near.
    ///
    /// `substep` counts from the refresh that found the pair.
    #[expect(
        clippy::inline_always,
        reason = "the loop over pairs is half as fast with a call"
    )]
    #[inline(always)]
    pub(crate) fn pushed(
        &self,
        [a, b]: [End; 2],
        friction: f32,
        substep: f32,
    ) -> Option<[Quad; 2]> {
        let across = (a.base - b.base) + (a.offset - b.offset);
        let squared = across.dot3(across);
        let reach = self.reach + substep * self.rise;
        let total = a.inverse_mass + b.inverse_mass;
        if squared >= reach * reach || squared <= f32::MIN_POSITIVE || total == 0.0 {
            return None;
        }
        let (share_a, share_b) = (a.inverse_mass / total, b.inverse_mass / total);
        let distance = squared.sqrt();
        let normal = across * (1.0 / distance);
        let push = reach - distance;
        let against = (a.offset - a.last) - (b.offset - b.last);
        let sliding = against - normal * normal.dot3(against);
        let length = sliding.dot3(sliding).sqrt();
        let grip = friction * push;
        let braked = sliding * if length <= grip { 1.0 } else { grip / length };
        let change = normal * push - braked;
        Some([a.offset + change * share_a, b.offset - change * share_b])
    }
}

/// Points sorted into cubes of a hashed grid.
#[derive(Debug, Default)]
struct Grid {
    cells: Vec<[i32; 3]>,
    hashes: Vec<u32>,
    starts: Vec<u32>,
    /// Points by the hash of their cubes, and where they are.
    sorted: Vec<u32>,
    places: Vec<Quad>,
}

/// Half of the 26 neighbors of a cube: each pair of cubes is met once.
const FORWARD: [[i32; 3]; 13] = [
    [1, 0, 0],
    [-1, 1, 0],
    [0, 1, 0],
    [1, 1, 0],
    [-1, -1, 1],
    [0, -1, 1],
    [1, -1, 1],
    [-1, 0, 1],
    [0, 0, 1],
    [1, 0, 1],
    [-1, 1, 1],
    [0, 1, 1],
    [1, 1, 1],
];

impl Grid {
    fn fill(&mut self, points: &[Quad], size: f32) {
        let per_meter = 1.0 / size;
        let num_slots = (2 * points.len()).next_power_of_two();
        let cell = |point: &Quad| {
            let [x, y, z, _] = point.0;
            [x, y, z].map(|value| (value * per_meter).floor() as i32)
        };
        self.cells.clear();
        self.cells.extend(points.iter().map(cell));
        self.starts.clear();
        self.starts.resize(num_slots + 1, 0);
        self.hashes.clear();
        for &cell in &self.cells {
            let slot = hash(cell, num_slots);
            self.hashes.push(slot);
            self.starts[slot as usize + 1] += 1;
        }
        for slot in 0..num_slots {
            self.starts[slot + 1] += self.starts[slot];
        }
        // Filled from the back, so that each start ends where it began.
        let mut next = self.starts.clone();
        self.sorted.clear();
        self.sorted.resize(points.len(), 0);
        for (point, &slot) in self.hashes.iter().enumerate() {
            let place = &mut next[slot as usize];
            self.sorted[*place as usize] = point as u32;
            *place += 1;
        }
        self.places.clear();
        let sorted = self.sorted.iter();
        self.places
            .extend(sorted.map(|&point| points[point as usize]));
    }

    /// Calls `found` with each pair no farther apart than `distance`, and its squared distance: once with one of the
    /// two among `some`.
    fn for_near_pairs(
        &self,
        some: std::ops::Range<usize>,
        points: &[Quad],
        distance: f32,
        mut found: impl FnMut(usize, usize, f32),
    ) {
        let limit = distance * distance;
        let num_slots = self.starts.len() - 1;
        for a in some {
            let (place, cell) = (points[a], self.cells[a]);
            let mut check = |slot: u32, is_wanted: &dyn Fn(usize) -> bool| {
                let range =
                    self.starts[slot as usize] as usize..self.starts[slot as usize + 1] as usize;
                let candidates = self.sorted[range.clone()].iter().zip(&self.places[range]);
                for (&b, other) in candidates {
                    let across = place - *other;
                    let squared = across.dot3(across);
                    if squared < limit && is_wanted(b as usize) {
                        found(a, b as usize, squared);
                    }
                }
            };
            check(self.hashes[a], &|b| b > a && self.cells[b] == cell);
            for step in FORWARD {
                let other = [0, 1, 2].map(|axis| cell[axis].wrapping_add(step[axis]));
                check(hash(other, num_slots), &|b| self.cells[b] == other);
            }
        }
    }
}

/// Teschner et al. 2003, "Optimized spatial hashing for collision detection of deformable objects".
fn hash([x, y, z]: [i32; 3], num_slots: usize) -> u32 {
    let mixed =
        x.wrapping_mul(73_856_093) ^ y.wrapping_mul(19_349_663) ^ z.wrapping_mul(83_492_791);
    mixed as u32 & (num_slots as u32 - 1)
}
