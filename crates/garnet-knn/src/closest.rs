//! Closest points on a surface.

use crate::bvh::{Block, Bvh, Child, Node};
use crate::bvh_build::{NONE, STACK_SIZE};
use crate::closest_on_triangle::{Feature, Projection, distance_squared_bound, project};
use crate::lanes::{Lanes, Lanes3, NUM_LANES, splat3};
use crate::surface::Surface;
use garnet_mesh::Point3;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Points that one task of a batch looks up.
pub(crate) const POINTS_PER_TASK: usize = 256;

/// Widens a bound on a squared distance by more than the rounding of a box distance.
const BOX_ROUNDING: f32 = 1.0 + 2e-6;

/// The point of a surface nearest to a query point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosestPoint {
    /// The face that it lies on; the smallest of several at the same distance.
    pub face: u32,
    /// Weights of the corners of that face; not negative, sum 1.
    pub barycentric: [f32; 3],
    /// Where it is, in metres.
    pub point: Point3,
    /// Squared distance from the query, m².
    pub distance_squared: f32,
    /// The part of the face that it lies on.
    pub feature: Feature,
}

impl Surface {
    /// The point of the surface nearest to `point`.
    ///
    /// Faces are compared in double precision; of several at the same distance (to `f32`) the one
    /// with the smallest number is taken. For a `point` that is not finite the answer is the first
    /// corner of face 0 at an infinite distance.
    pub fn closest(&self, point: Point3) -> ClosestPoint {
        self.nearest(point, NONE).0
    }

    /// Like [`Surface::closest`], with the same answer, but faster where `hint_face` is near it:
    /// its distance is the first bound. A face that does not exist gives no hint.
    pub fn closest_from(&self, point: Point3, hint_face: u32) -> ClosestPoint {
        self.nearest(point, hint_face).0
    }

    /// The closest point, and the offset from it to `point` in double precision.
    pub(crate) fn nearest(&self, point: Point3, hint_face: u32) -> (ClosestPoint, Projection) {
        let mut best = Best::within(f32::INFINITY);
        if !point.iter().all(|value| value.is_finite()) {
            return self.unreachable(point);
        }
        if let Some(corners) = self.triangle_f64(hint_face) {
            let projection = project(point.coords.cast(), &corners);
            best.offer(hint_face, &projection);
        }
        search(self.bvh(), point, &mut best, |_| true);
        self.finished(point, &best)
            .unwrap_or_else(|| self.unreachable(point))
    }

    /// The nearest point no farther than `max_distance`, if there is one.
    ///
    /// `None` too for a `max_distance` that is negative or NaN and a `point` that is not finite.
    pub fn closest_within(&self, point: Point3, max_distance: f32) -> Option<ClosestPoint> {
        self.closest_where(point, max_distance, |_| true)
    }

    /// The nearest point, no farther than `max_distance`, on a face that `accept` takes.
    ///
    /// `accept` is asked only about faces that come near. `None` too for a `max_distance` that is
    /// negative or NaN and a `point` that is not finite.
    pub fn closest_where(
        &self,
        point: Point3,
        max_distance: f32,
        accept: impl Fn(u32) -> bool,
    ) -> Option<ClosestPoint> {
        self.closest_where_from(point, max_distance, NONE, accept)
    }

    /// Like [`Surface::closest_where`], with the same answer, but faster where `hint_face` is near
    /// and taken: its distance is the first bound. A face that does not exist gives no hint.
    pub fn closest_where_from(
        &self,
        point: Point3,
        max_distance: f32,
        hint_face: u32,
        accept: impl Fn(u32) -> bool,
    ) -> Option<ClosestPoint> {
        if !(max_distance >= 0.0 && point.iter().all(|value| value.is_finite())) {
            return None;
        }
        let mut best = Best::within(max_distance * max_distance);
        if let Some(corners) = self.triangle_f64(hint_face)
            && accept(hint_face)
        {
            best.offer(hint_face, &project(point.coords.cast(), &corners));
        }
        search(self.bvh(), point, &mut best, accept);
        Some(self.finished(point, &best)?.0)
    }

    /// [`Surface::closest`] for many points `[point]` at once, on all threads.
    pub fn closest_all(&self, points: &[Point3]) -> Vec<ClosestPoint> {
        self.nearest_all(points, |closest, _| closest)
    }

    /// `result` of each point, its closest point and its projection. Each point starts from the
    /// face of the one before.
    pub(crate) fn nearest_all<T: Send>(
        &self,
        points: &[Point3],
        result: impl Fn(ClosestPoint, Projection) -> T + Sync,
    ) -> Vec<T> {
        let tasks = points.par_chunks(POINTS_PER_TASK);
        let per_task = tasks.map(|points| {
            let mut hint_face = NONE;
            let one = |&point: &Point3| {
                let (closest, projection) = self.nearest(point, hint_face);
                hint_face = closest.face;
                result(closest, projection)
            };
            points.iter().map(one).collect::<Vec<T>>()
        });
        per_task.flatten_iter().collect()
    }

    fn finished(&self, point: Point3, best: &Best) -> Option<(ClosestPoint, Projection)> {
        let [a, b, c] = self.triangle_f64(best.face)?;
        let projection = project(point.coords.cast(), &[a, b, c]);
        let [u, v, w] = projection.barycentric;
        let place = u * a + v * b + w * c;
        let closest = ClosestPoint {
            face: best.face,
            barycentric: projection.barycentric.map(|weight| weight.max(0.0) as f32),
            point: Point3::from(place.cast::<f32>()),
            distance_squared: best.distance_squared,
            feature: projection.feature,
        };
        Some((closest, projection))
    }

    /// The answer for points that have none.
    fn unreachable(&self, point: Point3) -> (ClosestPoint, Projection) {
        let first = self.faces()[0][0];
        let closest = ClosestPoint {
            face: 0,
            barycentric: [1.0, 0.0, 0.0],
            point: self.positions()[first as usize],
            distance_squared: f32::INFINITY,
            feature: Feature::Vertex(0),
        };
        let projection = Projection {
            barycentric: [1.0, 0.0, 0.0],
            offset: (point - closest.point).map(f64::from),
            distance_squared: f64::INFINITY,
            feature: Feature::Vertex(0),
        };
        (closest, projection)
    }
}

/// The nearest face so far; faces compare by distance, then by number.
struct Best {
    distance_squared: f32,
    face: u32,
    /// Boxes and bounds above this need no look.
    limit: f32,
}

impl Best {
    fn within(distance_squared: f32) -> Self {
        Self {
            distance_squared,
            face: NONE,
            limit: distance_squared * BOX_ROUNDING,
        }
    }

    #[inline]
    fn offer(&mut self, face: u32, projection: &Projection) {
        let distance_squared = projection.distance_squared as f32;
        let is_nearer = distance_squared < self.distance_squared
            || (distance_squared <= self.distance_squared && face < self.face);
        if is_nearer {
            self.distance_squared = distance_squared;
            self.face = face;
            self.limit = distance_squared * BOX_ROUNDING;
        }
    }
}

/// Walks the tree, nearest boxes first, and offers every accepted face that may beat `best`.
#[inline]
fn search(bvh: &Bvh, point: Point3, best: &mut Best, accept: impl Fn(u32) -> bool) {
    let p = point.coords.cast();
    let p_lanes = splat3(point.coords.into());
    let mut stack = [0_u64; STACK_SIZE];
    let mut size = 1;
    while size > 0 {
        size -= 1;
        let (distance_squared, child) = unpacked(stack[size]);
        if distance_squared > best.limit {
            continue;
        }
        match bvh.child(child) {
            Child::Node(node) => {
                let distances = node.distances_squared(p_lanes).0;
                let limit = best.limit;
                let entries: [u64; NUM_LANES] = std::array::from_fn(|lane| {
                    let (distance_squared, child) = (distances[lane], node.children[lane]);
                    let is_near = child != NONE && distance_squared <= limit;
                    if is_near {
                        packed(distance_squared, child)
                    } else {
                        u64::MAX
                    }
                });
                // Written without branches, which would be mispredicted: what is not near comes
                // first and is written over.
                for entry in sorted_descending(entries) {
                    stack[size] = entry;
                    size += usize::from(entry != u64::MAX);
                }
            }
            Child::Block(block) => search_block(block, p, p_lanes, best, &accept),
        }
    }
}

#[inline]
fn search_block(
    block: &Block,
    p: Vector3<f64>,
    p_lanes: Lanes3,
    best: &mut Best,
    accept: &impl Fn(u32) -> bool,
) {
    let bounds = distance_squared_bound(p_lanes, &block.corners).0;
    let mut near_lanes = 0_u32;
    for (lane, (&bound, &face)) in bounds.iter().zip(&block.faces).enumerate() {
        let is_near = face != NONE && (bound <= best.limit || bound.is_nan());
        near_lanes |= u32::from(is_near) << lane;
    }
    while near_lanes != 0 {
        let lane = near_lanes.trailing_zeros() as usize;
        near_lanes &= near_lanes - 1;
        let face = block.faces[lane];
        if bounds[lane] > best.limit || !accept(face) {
            continue;
        }
        best.offer(face, &project(p, &block.triangle_f64(lane)));
    }
}

/// A distance and a child as one number that is ordered like the distance, which is not negative.
#[inline]
fn packed(distance_squared: f32, child: u32) -> u64 {
    (u64::from(distance_squared.to_bits()) << 32) | u64::from(child)
}

#[inline]
fn unpacked(entry: u64) -> (f32, u32) {
    (f32::from_bits((entry >> 32) as u32), entry as u32)
}

#[inline]
fn sorted_descending([a, b, c, d]: [u64; 4]) -> [u64; 4] {
    let ordered = |x: u64, y: u64| (x.max(y), x.min(y));
    let ((a, b), (c, d)) = (ordered(a, b), ordered(c, d));
    let ((a, c), (b, d)) = (ordered(a, c), ordered(b, d));
    let (b, c) = ordered(b, c);
    [a, b, c, d]
}

impl Node {
    /// Squared distances to the boxes.
    #[inline]
    fn distances_squared(&self, p: Lanes3) -> Lanes {
        let zero = Lanes::splat(0.0);
        let outside = |axis: usize| {
            let (below, above) = (self.min[axis] - p[axis], p[axis] - self.max[axis]);
            below.max(above).max(zero)
        };
        let (x, y, z) = (outside(0), outside(1), outside(2));
        x * x + y * y + z * z
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{grid, soup, sphere, surface, torus};
    use proptest::prelude::*;

    fn brute_force(surface: &Surface, point: Point3) -> (f32, u32) {
        let faces = 0..surface.faces().len() as u32;
        let distances = faces.map(|face| {
            let corners = surface.triangle_f64(face).unwrap();
            (
                project(point.coords.cast(), &corners).distance_squared as f32,
                face,
            )
        });
        distances
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
            .unwrap()
    }

    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![(-4_i8..5).prop_map(f32::from), -4.0_f32..4.0]
    }

    proptest! {
        #[test]
        fn the_tree_finds_what_brute_force_finds(
            corners in prop::collection::vec(prop::array::uniform3(coordinate()), 3..240),
            points in prop::collection::vec(prop::array::uniform3(coordinate()), 1..8),
            hint in any::<u32>(),
        ) {
            let surface = surface(soup(&corners));
            for point in points.into_iter().map(Point3::from) {
                let closest = surface.closest(point);
                let expected = brute_force(&surface, point);
                prop_assert_eq!((closest.distance_squared, closest.face), expected);
                let hinted = surface.closest_from(point, hint % surface.faces().len() as u32);
                prop_assert_eq!(hinted, closest);
                let distance = closest.distance_squared.sqrt() * (1.0 + 1e-5);
                prop_assert_eq!(surface.closest_within(point, distance), Some(closest));
                prop_assert_eq!(surface.closest_within(point, 0.9 * distance - 1e-5), None);
            }
        }

        #[test]
        fn any_bits_are_answered(bits in prop::array::uniform3(any::<u32>()), hint in any::<u32>()) {
            let point = Point3::from(bits.map(f32::from_bits));
            let surface = surface(sphere([0.0; 3], 1.0, 4, 5));
            let closest = surface.closest_from(point, hint);
            prop_assert!((closest.face as usize) < surface.faces().len());
            prop_assert!(closest.point.iter().all(|value| value.is_finite()));
            prop_assert!(!closest.distance_squared.is_nan());
            let signed = surface.signed_distance(point);
            prop_assert!(!signed.distance.is_nan() && !signed.normal.x.is_nan());
            prop_assert_eq!(surface.contains(point), surface.winding_number(point) > 0);
        }
    }

    #[test]
    fn of_faces_at_the_same_vertex_the_first_wins() {
        let surface = surface(grid(6));
        let point = Point3::new(3.0, 3.0, 1.0);
        assert_eq!(surface.closest(point).face, brute_force(&surface, point).1);
        assert!(matches!(surface.closest(point).feature, Feature::Vertex(_)));
    }

    #[test]
    fn only_accepted_faces_are_found() {
        let surface = surface(torus(24, 12));
        let point = Point3::new(0.1, 0.2, 0.3);
        let nearest = surface.closest(point).face;
        let other = surface
            .closest_where(point, f32::INFINITY, |face| face != nearest)
            .unwrap();
        assert_ne!(other.face, nearest);
        for hint in [0, other.face, nearest, u32::MAX] {
            let is_other = |face| face != nearest;
            let hinted = surface.closest_where_from(point, f32::INFINITY, hint, is_other);
            assert_eq!(hinted, Some(other));
        }
        assert_eq!(surface.closest_where(point, f32::INFINITY, |_| false), None);
        assert_eq!(surface.closest_where(point, f32::NAN, |_| true), None);
        assert_eq!(surface.closest_where(point, -1.0, |_| true), None);
    }

    #[test]
    fn a_batch_gives_what_single_queries_give() {
        let surface = surface(torus(24, 12));
        let points: Vec<Point3> = sphere([0.3, 0.0, 0.0], 1.1, 20, 30).0;
        let single: Vec<ClosestPoint> = points.iter().map(|&p| surface.closest(p)).collect();
        assert_eq!(surface.closest_all(&points), single);
    }

    #[test]
    fn a_point_at_infinity_is_infinitely_far() {
        let surface = surface(grid(2));
        let closest = surface.closest(Point3::new(f32::INFINITY, 0.0, 0.0));
        assert_eq!((closest.face, closest.distance_squared), (0, f32::INFINITY));
        assert_eq!(
            surface.closest_within(Point3::new(f32::NAN, 0.0, 0.0), 1e9),
            None
        );
    }
}
