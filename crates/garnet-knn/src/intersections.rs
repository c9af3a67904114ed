//! Which triangles of two surfaces, or of one, intersect.

use crate::aabb::Aabb;
use crate::bvh::{Block, Bvh};
use crate::bvh_build::NONE;
use crate::lanes::{NUM_LANES, splat3};
use crate::pair_filter::{Probe, Shapes, separation};
use crate::surface::Surface;
use crate::triangle_pair::{neighbors_intersect, triangles_intersect};
use rayon::prelude::*;

/// Blocks that one task compares with the other surface.
const BLOCKS_PER_TASK: usize = 64;
/// Faces that one task of [`Surface::faces_crossing`] compares with the other surface.
const FACES_PER_TASK: usize = 256;

impl Surface {
    /// The pairs `[face of self, face of other]` of triangles that intersect, sorted.
    ///
    /// Exact: no pair is missed or made up by rounding. Triangles are closed, so touching in a
    /// point counts; triangles without area count as the segment or point that they are.
    pub fn intersections(&self, other: &Self) -> Vec<[u32; 2]> {
        let tasks = self.bvh().blocks.par_chunks(BLOCKS_PER_TASK);
        sorted(tasks.flat_map_iter(|blocks| {
            let mut pairs = Vec::new();
            for block in blocks {
                let lanes = (0..NUM_LANES).filter(|&lane| block.faces[lane] != NONE);
                let probes: Vec<(u32, Candidate)> = lanes
                    .map(|lane| (block.faces[lane], Candidate::new(block.triangle(lane))))
                    .collect();
                visit_blocks(other.bvh(), &block.bounds(), |_, other_block| {
                    let shapes = Shapes::new(other_block);
                    for (face, candidate) in &probes {
                        candidate.intersected(other_block, &shapes, |other_face| {
                            pairs.push([*face, other_face]);
                        });
                    }
                });
            }
            pairs
        }))
    }

    /// [`Surface::intersections`] of some faces only. Faces that do not exist are passed over, and
    /// repeated ones count once.
    pub fn faces_crossing(&self, other: &Self, candidate_faces: &[u32]) -> Vec<[u32; 2]> {
        let tasks = candidate_faces.par_chunks(FACES_PER_TASK);
        sorted(tasks.flat_map_iter(|faces| {
            let mut pairs = Vec::new();
            for &face in faces {
                let Some(triangle) = self.triangle(face) else {
                    continue;
                };
                let candidate = Candidate::new(triangle);
                visit_blocks(other.bvh(), &Aabb::of_points(triangle), |_, other_block| {
                    let shapes = Shapes::new(other_block);
                    candidate.intersected(other_block, &shapes, |other_face| {
                        pairs.push([face, other_face]);
                    });
                });
            }
            pairs
        }))
    }

    /// The pairs of faces of this surface that intersect, the smaller number first, sorted.
    ///
    /// Exact, with touching counted. Of faces that share a corner (by number or by place) only what
    /// they have in common beyond it counts: with one shared corner the opposite edge of one must
    /// meet the other, with two the faces must be coplanar and folded onto each other. Faces
    /// without area are left out: their edges are those of their neighbors.
    pub fn self_intersections(&self) -> Vec<[u32; 2]> {
        let bvh = self.bvh();
        let shapes: Vec<Shapes> = bvh.blocks.par_iter().map(Shapes::new).collect();
        let tasks = bvh.blocks.par_chunks(BLOCKS_PER_TASK).enumerate();
        sorted(tasks.flat_map_iter(|(task, blocks)| {
            let mut pairs = Vec::new();
            for (offset, block) in blocks.iter().enumerate() {
                let index = task * BLOCKS_PER_TASK + offset;
                let probes: [Candidate; NUM_LANES] =
                    std::array::from_fn(|lane| Candidate::new(block.triangle(lane)));
                visit_blocks(bvh, &block.bounds(), |other_index, other| {
                    if other_index < index {
                        return;
                    }
                    let shapes = &shapes[other_index];
                    for (lane, (&face, probe)) in block.faces.iter().zip(&probes).enumerate() {
                        let first = if other_index == index { lane + 1 } else { 0 };
                        if face != NONE {
                            probe.neighbors(other, shapes, first, |other_face| {
                                pairs.push([face.min(other_face), face.max(other_face)]);
                            });
                        }
                    }
                });
            }
            pairs
        }))
    }
}

fn sorted(pairs: impl ParallelIterator<Item = [u32; 2]>) -> Vec<[u32; 2]> {
    let mut pairs: Vec<[u32; 2]> = pairs.collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// A triangle with what is needed to compare it quickly.
struct Candidate {
    triangle: [[f32; 3]; 3],
    probe: Probe,
}

impl Candidate {
    fn new(triangle: [[f32; 3]; 3]) -> Self {
        Self {
            probe: Probe::new(&triangle),
            triangle,
        }
    }

    /// Tells the faces of a block that the triangle intersects.
    #[inline]
    fn intersected(&self, block: &Block, shapes: &Shapes, mut found: impl FnMut(u32)) {
        let passed = self.probe.may_intersect(block, shapes);
        for (lane, (passed, &face)) in passed.into_iter().zip(&block.faces).enumerate() {
            if passed && face != NONE && triangles_intersect(&self.triangle, &block.triangle(lane))
            {
                found(face);
            }
        }
    }

    /// Tells the faces of a block of the same surface, from lane `first` on, that the triangle
    /// intersects beyond what they share.
    #[inline]
    fn neighbors(&self, block: &Block, shapes: &Shapes, first: usize, mut found: impl FnMut(u32)) {
        let passed = self.probe.may_intersect_beyond(block, shapes);
        let lanes = passed.into_iter().zip(&block.faces).enumerate();
        for (lane, (passed, &face)) in lanes.skip(first) {
            if passed && face != NONE && neighbors_intersect(&self.triangle, &block.triangle(lane))
            {
                found(face);
            }
        }
    }
}

/// Visits every block whose box touches `bounds`, with its number.
fn visit_blocks(bvh: &Bvh, bounds: &Aabb, visit: impl FnMut(usize, &Block)) {
    let (own_min, own_max) = (splat3(bounds.min), splat3(bounds.max));
    bvh.visit(
        |min, max| separation((&own_min, &own_max), (min, max)),
        visit,
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{both, cube, grid, soup, sphere, surface, torus};
    use proptest::prelude::*;

    fn brute_force(a: &Surface, b: &Surface) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        for i in 0..a.faces().len() as u32 {
            for j in 0..b.faces().len() as u32 {
                if triangles_intersect(&a.triangle(i).unwrap(), &b.triangle(j).unwrap()) {
                    pairs.push([i, j]);
                }
            }
        }
        pairs
    }

    fn brute_force_self(surface: &Surface) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        for i in 0..surface.faces().len() as u32 {
            for j in i + 1..surface.faces().len() as u32 {
                let [a, b] = [i, j].map(|face| surface.triangle(face).unwrap());
                if neighbors_intersect(&a, &b) {
                    pairs.push([i, j]);
                }
            }
        }
        pairs
    }

    /// Coarse coordinates make touching, coplanar and flat triangles; fine ones the general case.
    fn corners() -> impl Strategy<Value = Vec<[f32; 3]>> {
        let coarse = (-3_i8..4).prop_map(f32::from);
        let coordinate = prop_oneof![coarse, -3.0_f32..3.0];
        prop::collection::vec(prop::array::uniform3(coordinate), 3..90)
    }

    proptest! {
        #[test]
        fn the_tree_finds_the_pairs_of_brute_force(a in corners(), b in corners()) {
            let (a, b) = (surface(soup(&a)), surface(soup(&b)));
            let pairs = brute_force(&a, &b);
            prop_assert_eq!(a.intersections(&b), pairs.clone());
            let all: Vec<u32> = (0..a.faces().len() as u32).collect();
            prop_assert_eq!(a.faces_crossing(&b, &all), pairs);
            prop_assert_eq!(a.self_intersections(), brute_force_self(&a));
        }

        #[test]
        fn tiny_and_huge_triangles_lose_no_pairs(a in corners(), power in -46_i32..6) {
            let scale = 10.0_f32.powi(power);
            let scaled: Vec<[f32; 3]> = a.iter().map(|corner| corner.map(|x| x * scale)).collect();
            let a = surface(soup(&scaled));
            prop_assert_eq!(a.intersections(&a), brute_force(&a, &a));
        }
    }

    #[test]
    fn simple_shapes_do_not_intersect_themselves() {
        for shape in [
            torus(30, 17),
            sphere([0.0; 3], 1.0, 13, 17),
            cube(0.0, 1.0, 5),
            grid(9),
        ] {
            assert_eq!(surface(shape).self_intersections(), [[0; 2]; 0]);
        }
    }

    #[test]
    fn spheres_that_overlap_intersect_along_a_band() {
        let (a, b) = (
            sphere([0.0; 3], 1.0, 13, 17),
            sphere([1.0, 0.1, 0.2], 1.0, 11, 19),
        );
        let num_faces = a.1.len() as u32;
        let between = surface(a.clone()).intersections(&surface(b.clone()));
        let within = surface(both(a, b)).self_intersections();
        let shifted: Vec<[u32; 2]> = between.iter().map(|&[i, j]| [i, j + num_faces]).collect();
        assert_eq!(within, shifted);
        assert!(between.len() > 20);
    }

    #[test]
    fn faces_that_do_not_exist_cross_nothing() {
        let surface = surface(grid(2));
        assert_eq!(
            surface.faces_crossing(&surface, &[99, u32::MAX]),
            [[0; 2]; 0]
        );
        let once = surface.faces_crossing(&surface, &[3]);
        assert_eq!(surface.faces_crossing(&surface, &[3, 3]), once);
    }

    #[test]
    fn answers_do_not_depend_on_the_number_of_threads() {
        let (a, b) = (
            surface(torus(60, 40)),
            surface(sphere([0.9, 0.0, 0.0], 0.7, 40, 60)),
        );
        let answers = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| {
                let points = a.positions();
                (
                    a.intersections(&b),
                    b.closest_all(points),
                    b.contains_all(points),
                )
            })
        };
        assert_eq!(answers(1), answers(3));
    }
}
