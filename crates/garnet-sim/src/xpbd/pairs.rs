//! Cloth on cloth: vertices that repel each other.

use std::ops::Range;

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

/// Slots of the grid whose pairs are looked for by one thread at a time.
const CHUNK: usize = 1024;

impl Pairs {
    pub(crate) fn new(layers: Layers) -> Self {
        Self {
            search: MARGIN * layers.widest(),
            layers,
            grid: Grid::default(),
            near: Vec::new(),
        }
    }

    /// Sorts the vertices for [`Pairs::refresh`].
    pub(crate) fn sort(&mut self, particles: &Particles) {
        let points = &particles.bases[..particles.num_vertices()];
        self.grid.fill(points, self.layers.radii(), self.search);
    }

    /// Finds the pairs of [sorted](Pairs::sort) vertices, but for those of two vertices `is_out`
    /// `[vertex]`.
    ///
    /// Pairs that are too near begin at their distance and come apart by no more than `max_rise`
    /// metres a substep, in `num_substeps` if they can: none is thrown.
    pub(crate) fn refresh(&mut self, is_out: &[bool], max_rise: f32, num_substeps: u32) {
        let (grid, layers) = (&self.grid, &self.layers);
        let pair = |a: usize, b: usize, squared: f32| {
            if is_out[a] && is_out[b] {
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
        let chunks = (0..grid.num_slots().div_ceil(CHUNK)).into_par_iter();
        let found = chunks.map(|chunk| {
            let slots = chunk * CHUNK..grid.num_slots().min((chunk + 1) * CHUNK);
            let mut pairs = Vec::new();
            grid.for_near_pairs(slots, |a, b, squared| {
                pairs.extend(pair(a, b, squared).map(|pair| (a as u32, pair)));
            });
            pairs
        });
        let found: Vec<Vec<(u32, Pair)>> = found.collect();
        let mut found = found.concat();
        // In the order of the vertices that met the others, not of the cubes, whose numbers are
        // those of a hash.
        found.sort_by_key(|&(vertex, _)| vertex);
        self.near.clear();
        self.near.extend(found.into_iter().map(|(_, pair)| pair));
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

    /// The offsets of its two vertices, pushed apart and their sliding braked by Coulomb's
    /// coefficient, if they are too near.
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
    /// Points by the hash of their cubes, these, and coordinates and radii, each on its own.
    sorted: Vec<u32>,
    sorted_cells: Vec<[i32; 3]>,
    numbers: [Vec<f32>; 4],
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
    /// Sorts points into cubes of this size: the largest distance of a pair.
    fn fill(&mut self, points: &[Quad], radii: &[f32], size: f32) {
        let per_metre = 1.0 / size;
        let num_slots = (2 * points.len()).next_power_of_two();
        let cell = |point: &Quad| {
            let [x, y, z, _] = point.0;
            [x, y, z].map(|value| floor(value * per_metre))
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
        let sorted = || self.sorted.iter().map(|&point| point as usize);
        self.sorted_cells.clear();
        self.sorted_cells
            .extend(sorted().map(|point| self.cells[point]));
        for (axis, numbers) in self.numbers.iter_mut().enumerate() {
            numbers.clear();
            match axis {
                0..3 => numbers.extend(sorted().map(|point| points[point].0[axis])),
                _ => numbers.extend(sorted().map(|point| radii[point])),
            }
        }
    }

    fn num_slots(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Where the points of a slot are in the sorted lists.
    fn slot(&self, slot: u32) -> Range<usize> {
        self.starts[slot as usize] as usize..self.starts[slot as usize + 1] as usize
    }

    /// Calls `found` with each pair no farther apart than [`MARGIN`] times the sum of its radii,
    /// and its squared distance: once, with the one first whose cube is in one of the slots and
    /// meets that of the other; these by the number of the step there, then by their own.
    fn for_near_pairs(&self, slots: Range<usize>, mut found: impl FnMut(usize, usize, f32)) {
        let mut around = Around::default();
        for slot in slots {
            let members = self.slot(slot as u32);
            for first in members.clone() {
                let cell = self.sorted_cells[first];
                if self.sorted_cells[members.start..first].contains(&cell) {
                    continue;
                }
                around.clear();
                self.add(cell, slot as u32, &mut around);
                let num_own = around.points.len();
                for step in FORWARD {
                    let other = [0, 1, 2].map(|axis| cell[axis].wrapping_add(step[axis]));
                    self.add(other, hash(other, self.num_slots()), &mut around);
                }
                for own in 0..num_own {
                    around.meet(own, &mut found);
                }
            }
        }
    }

    /// Adds the points of a cube.
    fn add(&self, cell: [i32; 3], slot: u32, around: &mut Around) {
        let mut rest = self.slot(slot);
        // The points of a cube follow each other, but for another one that has the same hash.
        while let Some(skipped) =
            (self.sorted_cells[rest.clone()].iter()).position(|&other| other == cell)
        {
            let first = rest.start + skipped;
            let others = self.sorted_cells[first..rest.end].iter();
            let run = first..first + others.take_while(|&&other| other == cell).count();
            around.points.extend_from_slice(&self.sorted[run.clone()]);
            for (all, numbers) in around.numbers.iter_mut().zip(&self.numbers) {
                all.extend_from_slice(&numbers[run.clone()]);
            }
            rest.start = run.end;
        }
    }
}

/// The points of a cube and those of its neighbors.
#[derive(Debug, Default)]
struct Around {
    points: Vec<u32>,
    /// Coordinates and radii, each on its own.
    numbers: [Vec<f32>; 4],
    /// Squared distances from one of them, and by how much these are more than a pair may have.
    squared: Vec<f32>,
    excess: Vec<f32>,
}

impl Around {
    fn clear(&mut self) {
        self.points.clear();
        self.numbers.iter_mut().for_each(Vec::clear);
    }

    /// Calls `found` with one of the points and each later one that is near it.
    fn meet(&mut self, from: usize, found: &mut impl FnMut(usize, usize, f32)) {
        let [x, y, z, radius] = self.numbers.each_ref().map(|numbers| numbers[from]);
        let [xs, ys, zs, radii] = self.numbers.each_ref().map(|numbers| &numbers[from + 1..]);
        self.squared.clear();
        let places = xs.iter().zip(ys).zip(zs);
        self.squared.extend(places.map(|((&ox, &oy), &oz)| {
            let [dx, dy, dz] = [x - ox, y - oy, z - oz];
            dx * dx + dy * dy + dz * dz
        }));
        self.excess.clear();
        let pairs = self.squared.iter().zip(radii);
        self.excess.extend(pairs.map(|(&squared, &other)| {
            let reach = radius + other;
            squared - MARGIN * MARGIN * reach * reach
        }));
        let points = &self.points[from + 1..];
        for ((&excess, &squared), &point) in self.excess.iter().zip(&self.squared).zip(points) {
            if excess <= 0.0 {
                found(self.points[from] as usize, point as usize, squared);
            }
        }
    }
}

/// Rounds down; the target's baseline has no instruction for it.
fn floor(value: f32) -> i32 {
    let towards_zero = value as i32;
    towards_zero - i32::from((towards_zero as f32) > value)
}

/// Teschner et al. 2003, "Optimized spatial hashing for collision detection of deformable objects".
fn hash([x, y, z]: [i32; 3], num_slots: usize) -> u32 {
    let mixed =
        x.wrapping_mul(73_856_093) ^ y.wrapping_mul(19_349_663) ^ z.wrapping_mul(83_492_791);
    mixed as u32 & (num_slots as u32 - 1)
}
