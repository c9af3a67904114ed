//! The winding number of a closed surface by counting where an axis-parallel ray leaves and enters.
//!
//! Seen along the ray, each triangle goes round the point once, minus once, or not at all. That is
//! counted on its sides one by one, each by a rule that gives two triangles the same answer for a
//! side they share: watertight, as Woop, Benthin and Wald 2013. Ties are broken as if the point
//! were moved by infinitesimals (Edelsbrunner and Mücke 1990, "Simulation of simplicity") and
//! orientations are exact (Shewchuk 1997), so rays through edges and vertices count right.

use crate::bvh::{Block, Bvh};
use crate::bvh_build::NONE;
use crate::lanes::{Lanes, Lanes3};
use robust::{Coord, Coord3D, orient2d, orient3d};

/// A ray parallel to an axis. `axes` is a cyclic order that ends with the axis of the ray.
struct Ray {
    origin: [f32; 3],
    axes: [usize; 3],
    is_forward: bool,
}

/// How often a closed surface goes round a point.
pub(crate) fn crossing_number(bvh: &Bvh, point: [f32; 3]) -> i32 {
    if !bvh.bounds.contains(point) {
        return 0;
    }
    let ray = Ray::shortest(bvh, point);
    let mut count = 0;
    bvh.visit(
        |min, max| ray.misses_by(min, max),
        |_, block| count += ray.crossings(block),
    );
    count
}

impl Ray {
    /// The ray that leaves the box of the surface soonest.
    fn shortest(bvh: &Bvh, origin: [f32; 3]) -> Self {
        let mut shortest = (f32::INFINITY, 0, true);
        for (axis, start) in origin.into_iter().enumerate() {
            let forward = bvh.bounds.max[axis] - start;
            let backward = start - bvh.bounds.min[axis];
            for (length, is_forward) in [(forward, true), (backward, false)] {
                if length < shortest.0 {
                    shortest = (length, axis, is_forward);
                }
            }
        }
        let (_, axis, is_forward) = shortest;
        Self {
            origin,
            axes: [(axis + 1) % 3, (axis + 2) % 3, axis],
            is_forward,
        }
    }

    /// Positive for boxes that the ray misses; the sign of a difference is exact.
    #[inline]
    fn misses_by(&self, min: &Lanes3, max: &Lanes3) -> Lanes {
        let [u, v, depth] = self.axes;
        let p = |axis: usize| Lanes::splat(self.origin[axis]);
        let beside_u = (min[u] - p(u)).max(p(u) - max[u]);
        let beside_v = (min[v] - p(v)).max(p(v) - max[v]);
        let behind = if self.is_forward {
            p(depth) - max[depth]
        } else {
            min[depth] - p(depth)
        };
        beside_u.max(beside_v).max(behind)
    }

    #[inline]
    fn crossings(&self, block: &Block) -> i32 {
        let (min, max) = block.lane_bounds();
        let distances = self.misses_by(&min, &max).0;
        let mut count = 0;
        for (lane, (&distance, &face)) in distances.iter().zip(&block.faces).enumerate() {
            if distance <= 0.0 && face != NONE {
                count += self.crossing(&block.triangle(lane));
            }
        }
        count
    }

    /// 1 where the ray leaves through the triangle, -1 where it enters, 0 where it misses.
    fn crossing(&self, corners: &[[f32; 3]; 3]) -> i32 {
        let [a, b, c] = corners;
        let turns = self.side_turn(a, b) + self.side_turn(b, c) + self.side_turn(c, a);
        if turns == 0 {
            return 0;
        }
        let depth = self.axes[2];
        let start = self.origin[depth];
        let is_ahead = if corners.iter().all(|corner| corner[depth] > start) {
            self.is_forward
        } else if corners.iter().all(|corner| corner[depth] < start) {
            !self.is_forward
        } else {
            let [a, b, c, p] = [*a, *b, *c, self.origin].map(|[x, y, z]| Coord3D { x, y, z });
            // Positive with the point below a counter-clockwise triangle.
            let below = orient3d(a, b, c, p) * f64::from(turns);
            if self.is_forward {
                below > 0.0
            } else {
                below < 0.0
            }
        };
        match (is_ahead, self.is_forward) {
            (false, _) => 0,
            (true, true) => turns,
            (true, false) => -turns,
        }
    }

    /// 1 for a side that passes to the right of the point upward, -1 downward, 0 otherwise, seen
    /// along the axis; the point counts as moved up and right by an infinitesimal.
    #[inline]
    fn side_turn(&self, from: &[f32; 3], to: &[f32; 3]) -> i32 {
        let [u, v, _] = self.axes;
        let height = self.origin[v];
        let (lower, upper, turn) = match (from[v] <= height, to[v] <= height) {
            (true, false) => (from, to, 1),
            (false, true) => (to, from, -1),
            _ => return 0,
        };
        let flat = |point: &[f32; 3]| Coord {
            x: point[u],
            y: point[v],
        };
        if orient2d(flat(lower), flat(upper), flat(&self.origin)) > 0.0 {
            turn
        } else {
            0
        }
    }
}
