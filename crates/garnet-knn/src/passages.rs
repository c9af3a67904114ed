//! Where a segment goes through a surface.
//!
//! Seen along the segment, each side of a triangle passes the line on one side or the other, by a
//! sign that is computed the same way for both triangles at the side: watertight, as Woop, Benthin
//! and Wald 2013. Signs are those of double precision.

use crate::bvh::Block;
use crate::bvh_build::NONE;
use crate::lanes::{Lanes, Lanes3, splat3};
use crate::surface::Surface;
use garnet_mesh::Point3;
use nalgebra::Vector3;

/// Boxes are widened by this share of the largest coordinate, against rounding.
const BOX_SLACK: f32 = 1e-6;

/// Direction components smaller than this have no usable reciprocal.
const MIN_COMPONENT: f32 = 1e-20;

/// A place where a segment goes through a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passage {
    /// How far along the direction, in lengths of it.
    pub length: f32,
    /// The face that it goes through.
    pub face: u32,
    /// Weights of the corners of that face; not negative, sum 1.
    pub barycentric: [f32; 3],
    /// 1 where the segment leaves through the front of the face, -1 where it enters from there:
    /// the winding number behind the passage is smaller by this than before it.
    pub turn: i32,
}

impl Surface {
    /// Where the segment from `from` to `from + length * direction` goes through the surface,
    /// sorted by length, then by face.
    ///
    /// Faces that lie along the segment are passed over. Empty for a segment that is not finite or
    /// has no extent.
    pub fn passages(&self, from: Point3, direction: Vector3<f32>, length: f32) -> Vec<Passage> {
        let mut passages = Vec::new();
        let extent = direction.norm() * length;
        if !extent.is_finite() || extent <= 0.0 || !from.iter().all(|value| value.is_finite()) {
            return passages;
        }
        let segment = Segment::new(from, direction, length);
        self.bvh().visit(
            |min, max| segment.misses_by(min, max),
            |_, block| segment.pass_block(block, &mut passages),
        );
        passages.sort_unstable_by(|a, b| a.length.total_cmp(&b.length).then(a.face.cmp(&b.face)));
        passages
    }
}

/// A segment, prepared for tests against boxes and triangles.
struct Segment {
    origin: Lanes3,
    reciprocal: Lanes3,
    length: f32,
    slack: f32,
    from: Vector3<f64>,
    direction: Vector3<f64>,
}

impl Segment {
    fn new(from: Point3, direction: Vector3<f32>, length: f32) -> Self {
        let reciprocal = direction.map(|component| {
            let size = component.abs().max(MIN_COMPONENT);
            1.0 / size.copysign(component)
        });
        let farthest = (from.coords.abs() + direction.abs() * length).max();
        Self {
            origin: splat3(from.coords.into()),
            reciprocal: splat3(reciprocal.into()),
            length,
            slack: BOX_SLACK * farthest,
            from: from.coords.cast(),
            direction: direction.cast(),
        }
    }

    /// Positive for boxes that the segment misses.
    #[inline]
    fn misses_by(&self, min: &Lanes3, max: &Lanes3) -> Lanes {
        let slack = Lanes::splat(self.slack);
        let mut enter = Lanes::splat(0.0);
        let mut leave = Lanes::splat(self.length);
        for axis in 0..3 {
            let (origin, reciprocal) = (self.origin[axis], self.reciprocal[axis]);
            let one = (min[axis] - slack - origin) * reciprocal;
            let other = (max[axis] + slack - origin) * reciprocal;
            enter = enter.max(one.min(other));
            leave = leave.min(one.max(other));
        }
        enter - leave
    }

    fn pass_block(&self, block: &Block, passages: &mut Vec<Passage>) {
        let (min, max) = block.lane_bounds();
        let misses = self.misses_by(&min, &max).0;
        for (lane, (&miss, &face)) in misses.iter().zip(&block.faces).enumerate() {
            if miss <= 0.0 && face != NONE {
                passages.extend(self.passage(face, &block.triangle_f64(lane)));
            }
        }
    }

    fn passage(&self, face: u32, corners: &[Vector3<f64>; 3]) -> Option<Passage> {
        let [a, b, c] = corners.map(|corner| corner - self.from);
        let turns = [self.turn(b, c), self.turn(c, a), self.turn(a, b)];
        if turns.iter().any(|turn| turn.is_left != turns[0].is_left) {
            return None;
        }
        let total: f64 = turns.iter().map(|turn| turn.volume).sum();
        if total == 0.0 {
            return None;
        }
        let shares = turns.map(|turn| turn.volume / total);
        let hit = shares[0] * a + shares[1] * b + shares[2] * c;
        let length = (hit.dot(&self.direction) / self.direction.norm_squared()) as f32;
        (0.0..=self.length).contains(&length).then(|| Passage {
            length,
            face,
            barycentric: shares.map(|share| share as f32),
            turn: if turns[0].is_left { 1 } else { -1 },
        })
    }

    /// On which side a side of a triangle passes the line; `from` and `to` are relative to its
    /// start.
    #[inline]
    fn turn(&self, from: Vector3<f64>, to: Vector3<f64>) -> Turn {
        let volume = from.cross(&to).dot(&self.direction);
        let is_left = if volume == 0.0 {
            // The line meets the side: one of the two triangles there has it.
            from.as_slice() < to.as_slice()
        } else {
            volume > 0.0
        };
        Turn { volume, is_left }
    }
}

/// How a side of a triangle passes a line.
#[derive(Debug, Clone, Copy)]
struct Turn {
    /// Six times the volume that the side spans with a unit of the line.
    volume: f64,
    is_left: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{both, cube, sphere, surface, torus};
    use proptest::prelude::*;

    #[test]
    fn a_line_through_a_sphere_enters_and_leaves() {
        let sphere = surface(sphere([0.0; 3], 1.0, 40, 60));
        let passages = sphere.passages(Point3::new(-2.0, 0.01, 0.02), Vector3::x(), 4.0);
        let turns: Vec<i32> = passages.iter().map(|passage| passage.turn).collect();
        assert_eq!(turns, [-1, 1]);
        approx::assert_relative_eq!(passages[0].length, 1.0, epsilon = 5e-3);
        approx::assert_relative_eq!(passages[1].length, 3.0, epsilon = 5e-3);
    }

    #[test]
    fn a_passage_is_on_its_face() {
        let torus = surface(torus(24, 12));
        let (from, direction) = (Point3::new(-2.0, 0.1, 0.05), Vector3::new(2.0, 0.11, -0.03));
        let passages = torus.passages(from, direction, 2.0);
        assert_eq!(passages.len(), 4);
        for passage in passages {
            let corners =
                torus.faces()[passage.face as usize].map(|v| torus.positions()[v as usize]);
            let parts = corners.iter().zip(passage.barycentric);
            let point: Vector3<f32> = parts.map(|(corner, share)| share * corner.coords).sum();
            let on_line = from.coords + passage.length * direction;
            assert!((point - on_line).norm() < 1e-6);
        }
    }

    #[test]
    fn a_line_along_the_sides_of_a_box_goes_through_it_once() {
        // The box has its own vertices and edges on these lines.
        let cube = surface(cube(-1.0, 1.0, 4));
        for y in [-0.5, 0.0, 0.5] {
            for z in [-0.5, 0.0, 0.5] {
                let passages = cube.passages(Point3::new(-3.0, y, z), Vector3::x(), 6.0);
                let turns: Vec<i32> = passages.iter().map(|passage| passage.turn).collect();
                assert_eq!(turns, [-1, 1], "{y} {z}");
            }
        }
    }

    #[test]
    fn segments_without_extent_pass_nothing() {
        let cube = surface(cube(-1.0, 1.0, 2));
        let origin = Point3::origin();
        assert!(cube.passages(origin, Vector3::zeros(), 5.0).is_empty());
        assert!(cube.passages(origin, Vector3::x(), -5.0).is_empty());
        assert!(cube.passages(origin, Vector3::x(), f32::NAN).is_empty());
        assert!(
            cube.passages(Point3::new(f32::INFINITY, 0.0, 0.0), Vector3::x(), 1.0)
                .is_empty()
        );
    }

    proptest! {
        #[test]
        fn passages_change_the_winding_number_by_their_turns(
            from in prop::array::uniform3(-1.5_f32..1.5),
            to in prop::array::uniform3(-1.5_f32..1.5),
        ) {
            let spheres = surface(both(
                sphere([0.0; 3], 1.0, 12, 16),
                sphere([0.5, 0.1, 0.0], 0.8, 11, 13),
            ));
            let (from, to) = (Point3::from(from), Point3::from(to));
            let turns = spheres.passages(from, to - from, 1.0).iter().map(|p| p.turn).sum::<i32>();
            prop_assert_eq!(spheres.winding_number(from) - turns, spheres.winding_number(to));
        }
    }
}
