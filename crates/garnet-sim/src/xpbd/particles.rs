//! Where the vertices are and were.

use crate::xpbd::quad::Quad;
use crate::{Cloth, Point3, Vector3};

/// Vertices as bases that stay for many substeps, and small offsets from them that move.
///
/// A substep of 1/7200 s adds g h² = 0.19 µm to a fall, while `f32` coordinates of 1 m have steps
/// of 0.12 µm: summed up in positions, gravity would be wrong by a tenth. Offsets stay below a few
/// millimetres and have steps below 1 nm. Velocities are differences of offsets.
///
/// Two more vertices without mass follow those of the cloth: blocks of springs that are not full
/// end there.
#[derive(Debug, Clone, Default)]
pub(crate) struct Particles {
    /// Where offsets count from, in metres; the fourth number is 0.
    pub(crate) bases: Vec<Quad>,
    /// Place less base, in metres; the fourth number is 0.
    pub(crate) offsets: Vec<Quad>,
    /// Offsets before the substep.
    pub(crate) last: Vec<Quad>,
    /// Vertices that are held.
    pins: Vec<u32>,
    num_vertices: usize,
}

/// Where vertices are in a list of some of them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Places<'a> {
    /// By vertex of the cloth; without meaning for those that are not in the list.
    pub(crate) by_vertex: &'a [u32],
    /// How many are in the list.
    pub(crate) number: usize,
}

impl Places<'_> {
    pub(crate) fn of<const N: usize>(self, vertices: [u32; N]) -> [u32; N] {
        vertices.map(|vertex| self.by_vertex[vertex as usize])
    }
}

/// Two places apart, so that a spring between them has a direction.
const PADDING: [Quad; 2] = [Quad::ZERO, Quad([1.0, 0.0, 0.0, 0.0])];

/// What moves vertices freely in a substep.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Push {
    /// Gravity times the square of the substep, m.
    pub(crate) gravity: f32,
    /// What is left of a velocity after drag.
    pub(crate) keep: f32,
    /// No vertex moves on its own by more than this, m.
    pub(crate) max_travel: f32,
}

impl Particles {
    pub(crate) fn new(cloth: &Cloth, start: &[Point3]) -> Self {
        let points = start.iter().map(|point| Quad::new(point.coords, 0.0));
        let bases: Vec<Quad> = points.chain(PADDING).collect();
        let num_vertices = start.len();
        let vertices = 0..num_vertices as u32;
        Self {
            offsets: vec![Quad::ZERO; bases.len()],
            last: vec![Quad::ZERO; bases.len()],
            bases,
            pins: vertices
                .filter(|&vertex| cloth.is_pinned()[vertex as usize])
                .collect(),
            num_vertices,
        }
    }

    /// Some of the vertices `[place]`, in that order.
    pub(crate) fn some(&self, vertices: &[u32]) -> Self {
        let bases = vertices.iter().map(|&vertex| self.bases[vertex as usize]);
        let bases: Vec<Quad> = bases.chain(PADDING).collect();
        let mut is_pinned = vec![false; self.num_vertices];
        (self.pins.iter()).for_each(|&vertex| is_pinned[vertex as usize] = true);
        let places = (0..).zip(vertices);
        Self {
            offsets: vec![Quad::ZERO; bases.len()],
            last: vec![Quad::ZERO; bases.len()],
            bases,
            pins: places
                .filter(|&(_, &vertex)| is_pinned[vertex as usize])
                .map(|(place, _)| place)
                .collect(),
            num_vertices: vertices.len(),
        }
    }

    /// Takes over the state of some of the vertices of others.
    pub(crate) fn load(&mut self, from: &Self, vertices: &[u32]) {
        for (place, &vertex) in vertices.iter().enumerate() {
            let vertex = vertex as usize;
            self.bases[place] = from.bases[vertex];
            self.offsets[place] = from.offsets[vertex];
            self.last[place] = from.last[vertex];
        }
        // Padding falls with the others, and nobody else puts it back.
        for offsets in [&mut self.offsets, &mut self.last] {
            offsets[vertices.len()..].fill(Quad::ZERO);
        }
    }

    /// Gives the state of all vertices to others.
    pub(crate) fn store(&self, to: &mut Self, vertices: &[u32]) {
        for (place, &vertex) in vertices.iter().enumerate() {
            let vertex = vertex as usize;
            to.offsets[vertex] = self.offsets[place];
            to.last[vertex] = self.last[place];
        }
    }

    pub(crate) fn num_vertices(&self) -> usize {
        self.num_vertices
    }

    /// The numbers of the two vertices at which padding springs end.
    pub(crate) fn padding(num_vertices: usize) -> [u32; 2] {
        [num_vertices as u32, num_vertices as u32 + 1]
    }

    /// Where a vertex is, in metres.
    pub(crate) fn position(&self, vertex: usize) -> Point3 {
        Point3::from((self.bases[vertex] + self.offsets[vertex]).xyz())
    }

    /// Where all are `[vertex]`, in metres.
    pub(crate) fn positions(&self) -> Vec<Point3> {
        (0..self.num_vertices)
            .map(|vertex| self.position(vertex))
            .collect()
    }

    /// Begins a substep: every vertex flies on.
    ///
    /// `wind` `[vertex]` is the displacement of the air a substep, m, and the share of its velocity
    /// against it that the vertex loses; empty if the air stands still.
    #[inline(never)]
    pub(crate) fn fly(&mut self, push: Push, wind: &[Quad]) {
        let num_done = self.fly_by_vectors(push, wind);
        self.fly_plainly(num_done, push, wind);
        self.hold_pins();
    }

    /// Moves the first vertices freely by vector instructions, if there are any; returns how many.
    #[cfg(target_arch = "x86_64")]
    fn fly_by_vectors(&mut self, push: Push, wind: &[Quad]) -> usize {
        // Padding has no wind.
        let num_alike = match wind.len() {
            0 => self.offsets.len(),
            number => number.min(self.offsets.len()),
        };
        let number = num_alike - num_alike % 2;
        let (offsets, last) = (&mut self.offsets[..number], &mut self.last[..number]);
        let wind = &wind[..number.min(wind.len())];
        if super::eights::fly(push, offsets, last, wind) {
            number
        } else {
            0
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn fly_by_vectors(&mut self, _push: Push, _wind: &[Quad]) -> usize {
        0
    }

    /// Moves the vertices from a number on freely.
    fn fly_plainly(&mut self, first: usize, push: Push, wind: &[Quad]) {
        let fall = Quad([0.0, -push.gravity, 0.0, 0.0]);
        let limit = push.max_travel * push.max_travel;
        let mut wind = wind.iter().skip(first);
        let vertices = self.offsets[first..]
            .iter_mut()
            .zip(&mut self.last[first..]);
        for (offset, last) in vertices {
            let mut travel = (*offset - *last) * push.keep;
            if let Some(&wind) = wind.next() {
                travel += (wind.vector() - travel) * wind.0[3];
            }
            let squared = travel.dot3(travel);
            if squared > limit {
                travel = travel * (limit / squared).sqrt();
            }
            *last = *offset;
            *offset += travel + fall;
        }
    }

    /// Gives vertices the velocities of the air `[vertex]`, as displacements a substep, m.
    pub(crate) fn set_off(&mut self, wind: &[Quad]) {
        let vertices = self.offsets.iter().zip(&mut self.last);
        for ((offset, last), wind) in vertices.zip(wind) {
            *last = *offset - wind.vector();
        }
    }

    /// Puts vertices `[vertex]` somewhere else, where they are still.
    pub(crate) fn put(&mut self, positions: &[Point3]) {
        for (base, point) in self.bases.iter_mut().zip(positions) {
            *base = Quad::new(point.coords, 0.0);
        }
        self.offsets.fill(Quad::ZERO);
        self.last.fill(Quad::ZERO);
    }

    /// Gives vertices these velocities `[vertex]`, m/s, with substeps of `step` seconds.
    pub(crate) fn set_velocities(&mut self, velocities: &[Vector3], step: f32) {
        let vertices = self.offsets.iter().zip(&mut self.last);
        for ((offset, last), velocity) in vertices.zip(velocities) {
            *last = *offset - Quad::new(velocity * step, 0.0);
        }
    }

    /// The velocities of the last substep `[vertex]`, m/s.
    pub(crate) fn velocities(&self, step: f32) -> Vec<Vector3> {
        let vertices = self.offsets.iter().zip(&self.last);
        let moved = vertices.map(|(offset, last)| (*offset - *last).xyz() / step);
        moved.take(self.num_vertices).collect()
    }

    /// Changes the length of the substep: displacements of the old become those of the new.
    pub(crate) fn rescale(&mut self, new_over_old: f32) {
        for (offset, last) in self.offsets.iter().zip(&mut self.last) {
            *last = *offset - (*offset - *last) * new_over_old;
        }
    }

    /// Moves the bases to where the vertices are. What rounding leaves stays in the offsets.
    pub(crate) fn rebase(&mut self) {
        let vertices = self
            .bases
            .iter_mut()
            .zip(&mut self.offsets)
            .zip(&mut self.last);
        for ((base, offset), last) in vertices {
            let moved = *base + *offset;
            let shift = moved - *base;
            *base = moved;
            *offset -= shift;
            *last -= shift;
        }
    }

    fn hold_pins(&mut self) {
        for &vertex in &self.pins {
            self.offsets[vertex as usize] = self.last[vertex as usize];
        }
    }

    /// The first vertex whose place is not finite or farther than `reach` from `center`.
    pub(crate) fn first_lost(&self, center: Vector3, reach: f32) -> Option<usize> {
        (0..self.num_vertices).find(|&vertex| {
            let from_center = self.position(vertex).coords - center;
            let squared = from_center.norm_squared();
            squared.is_nan() || squared > reach * reach
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Fabric;
    use crate::xpbd::sheet::Sheet;

    #[test]
    fn vector_instructions_let_vertices_fly_as_the_plain_loop_does() {
        // An odd number of vertices, some of them faster than they may be.
        let sheet = Sheet::new([6, 4], &Fabric::silk(), |p| *p);
        assert_eq!(sheet.cloth.num_vertices() % 2, 1);
        let push = Push {
            gravity: 1e-4,
            keep: 0.98,
            max_travel: 0.02,
        };
        let number = |place: usize| ((place * 37 % 11) as f32 - 5.0) * 0.004;
        let breath = |place: usize| Quad([number(place), 0.001, number(place + 3), 0.3]);
        let breeze: Vec<Quad> = (0..sheet.cloth.num_vertices()).map(breath).collect();
        for wind in [&[][..], &breeze] {
            let mut fast = sheet.particles.clone();
            for (place, last) in fast.last.iter_mut().enumerate() {
                *last = Quad([number(place), number(place + 1), number(place + 2), 0.0]);
            }
            let mut plain = fast.clone();
            for _ in 0..10 {
                fast.fly(push, wind);
                plain.fly_plainly(0, push, wind);
            }
            assert_eq!(fast.offsets, plain.offsets);
            assert_eq!(fast.last, plain.last);
        }
    }
}
