//! Which triangles go under which node: a four-wide tree by the binned surface-area heuristic.
//!
//! Wald 2007, "On fast construction of SAH-based bounding volume hierarchies", with costs counted
//! in blocks of four triangles, so that blocks come out full.

use crate::aabb::Aabb;
use crate::lanes::NUM_LANES;
use garnet_mesh::Point3;
use rayon::prelude::*;

/// Marks a child slot or a lane that holds nothing.
pub(crate) const NONE: u32 = u32::MAX;
/// Set in a child that is the number of a block, clear in one that is the number of a node.
pub(crate) const BLOCK_BIT: u32 = 1 << 31;

const NUM_BINS: usize = 16;
/// Below this depth sets are halved by count, which bounds the depth of the whole tree by
/// `MAX_SAH_DEPTH + 16`: a set of at most 2^32 triangles is quartered at each further level.
const MAX_SAH_DEPTH: usize = 16;
/// Sets larger than this are built by several threads.
const PARALLEL_COUNT: usize = 2048;

/// The most entries a depth-first walk of a tree keeps: three siblings a level, and the children
/// of the last node.
pub(crate) const STACK_SIZE: usize = 3 * (MAX_SAH_DEPTH + 16) + NUM_LANES;

/// Children `[node][slot]` and faces `[block][lane]` in depth-first order; node 0 is the root.
#[derive(Debug, Default)]
pub(crate) struct TreeLayout {
    pub(crate) nodes: Vec<[u32; NUM_LANES]>,
    pub(crate) blocks: Vec<[u32; NUM_LANES]>,
}

struct Primitive {
    bounds: Aabb,
    center: [f32; 3],
    face: u32,
}

/// Sorts the faces into a tree; there is at least one node.
///
/// Faces that are a point are left out where there are others: they have no side, and hide the
/// faces around the point.
pub(crate) fn tree_layout(positions: &[Point3], faces: &[[u32; 3]]) -> TreeLayout {
    let is_point = |[a, b, c]: &[u32; 3]| a == b && b == c;
    let keeps_points = faces.iter().all(is_point);
    let mut primitives: Vec<Primitive> = faces
        .par_iter()
        .with_min_len(2048)
        .enumerate()
        .filter(|(_, corners)| keeps_points || !is_point(corners))
        .map(|(face, corners)| {
            let bounds =
                Aabb::of_points(corners.iter().map(|&v| positions[v as usize].coords.into()));
            Primitive {
                center: std::array::from_fn(|axis| 0.5 * bounds.min[axis] + 0.5 * bounds.max[axis]),
                bounds,
                face: face as u32,
            }
        })
        .collect();
    let mut layout = TreeLayout::default();
    let root = layout.grow(&mut primitives, 0);
    if root != 0 {
        layout.nodes.push([root, NONE, NONE, NONE]);
    }
    layout
}

impl TreeLayout {
    /// Adds the subtree of `primitives` and returns its root as a child.
    fn grow(&mut self, primitives: &mut [Primitive], depth: usize) -> u32 {
        let count = primitives.len();
        if count <= NUM_LANES {
            let faces = std::array::from_fn(|lane| primitives.get(lane).map_or(NONE, |p| p.face));
            self.blocks.push(faces);
            return (self.blocks.len() - 1) as u32 | BLOCK_BIT;
        }
        let node = self.nodes.len();
        self.nodes.push([NONE; NUM_LANES]);
        let parts = quartered(primitives, depth);
        if count > PARALLEL_COUNT {
            let subtrees: Vec<(Self, u32)> = parts
                .into_par_iter()
                .map(|part| {
                    let mut subtree = Self::default();
                    let root = if part.is_empty() {
                        NONE
                    } else {
                        subtree.grow(part, depth + 1)
                    };
                    (subtree, root)
                })
                .collect();
            for (slot, (subtree, root)) in subtrees.into_iter().enumerate() {
                self.nodes[node][slot] = self.append(&subtree, root);
            }
        } else {
            for (slot, part) in parts.into_iter().enumerate() {
                if !part.is_empty() {
                    self.nodes[node][slot] = self.grow(part, depth + 1);
                }
            }
        }
        node as u32
    }

    /// Moves a subtree behind what is here and returns its root as a child.
    fn append(&mut self, subtree: &Self, root: u32) -> u32 {
        let (num_nodes, num_blocks) = (self.nodes.len() as u32, self.blocks.len() as u32);
        let moved = |child: u32| match child {
            NONE => NONE,
            block if block & BLOCK_BIT != 0 => block + num_blocks,
            node => node + num_nodes,
        };
        self.nodes
            .extend(subtree.nodes.iter().map(|children| children.map(moved)));
        self.blocks.extend_from_slice(&subtree.blocks);
        moved(root)
    }
}

/// Splits a set three times, each time the part with the largest box; empty parts come last.
fn quartered(primitives: &mut [Primitive], depth: usize) -> [&mut [Primitive]; NUM_LANES] {
    let mut parts: [&mut [Primitive]; NUM_LANES] = Default::default();
    let mut areas = [0.0_f32; NUM_LANES];
    parts[0] = primitives;
    for num_parts in 1..NUM_LANES {
        let mut largest: Option<usize> = None;
        for part in (0..num_parts).filter(|&part| parts[part].len() > NUM_LANES) {
            let is_larger = |best: usize| {
                if depth < MAX_SAH_DEPTH {
                    areas[part] > areas[best]
                } else {
                    parts[part].len() > parts[best].len()
                }
            };
            if largest.is_none_or(is_larger) {
                largest = Some(part);
            }
        }
        let Some(part) = largest else { break };
        let split = if depth < MAX_SAH_DEPTH {
            binned_split(parts[part])
        } else {
            None
        };
        let split = split.unwrap_or_else(|| halving_split(parts[part]));
        let (left, right) = std::mem::take(&mut parts[part]).split_at_mut(split.count);
        (parts[part], areas[part]) = (left, split.left_area);
        (parts[num_parts], areas[num_parts]) = (right, split.right_area);
    }
    parts
}

struct Split {
    count: usize,
    left_area: f32,
    right_area: f32,
}

/// Splits at the cheapest of the planes between bins along the longest axis of the centers;
/// `None` when all centers fall into one bin.
fn binned_split(primitives: &mut [Primitive]) -> Option<Split> {
    let centers = Aabb::of_points(primitives.iter().map(|p| p.center));
    let axis = longest_axis(&centers);
    let start = centers.min[axis];
    let scale = NUM_BINS as f32 / (centers.max[axis] - start);
    if !scale.is_finite() {
        return None;
    }
    // The cast saturates, so a center on the far end falls into the last bin after `min`.
    #[expect(clippy::cast_sign_loss, reason = "centers are not below the start")]
    let bin_of = |p: &Primitive| (((p.center[axis] - start) * scale) as usize).min(NUM_BINS - 1);
    let mut bins = [(0_usize, Aabb::EMPTY); NUM_BINS];
    for primitive in primitives.iter() {
        let (count, bounds) = &mut bins[bin_of(primitive)];
        *count += 1;
        bounds.merge(&primitive.bounds);
    }
    let mut right_of = [(0_usize, 0.0_f32); NUM_BINS];
    let (mut count, mut bounds) = (0, Aabb::EMPTY);
    for bin in (1..NUM_BINS).rev() {
        count += bins[bin].0;
        bounds.merge(&bins[bin].1);
        right_of[bin] = (count, bounds.half_area());
    }
    let blocks = |count: usize| count.div_ceil(NUM_LANES) as f32;
    let mut best: Option<(f32, usize, Split)> = None;
    let (mut count, mut bounds) = (0, Aabb::EMPTY);
    for bin in 1..NUM_BINS {
        count += bins[bin - 1].0;
        bounds.merge(&bins[bin - 1].1);
        let (right_count, right_area) = right_of[bin];
        if count == 0 || right_count == 0 {
            continue;
        }
        let left_area = bounds.half_area();
        let cost = left_area * blocks(count) + right_area * blocks(right_count);
        if best.as_ref().is_none_or(|(least, ..)| cost < *least) {
            best = Some((
                cost,
                bin,
                Split {
                    count,
                    left_area,
                    right_area,
                },
            ));
        }
    }
    let (_, plane, split) = best?;
    partition(primitives, |p| bin_of(p) < plane);
    Some(split)
}

/// Puts half of the set, in whole blocks, on either side of the longest axis of the centers.
fn halving_split(primitives: &mut [Primitive]) -> Split {
    let axis = longest_axis(&Aabb::of_points(primitives.iter().map(|p| p.center)));
    let num_blocks = primitives.len().div_ceil(NUM_LANES);
    let count = num_blocks.div_ceil(2) * NUM_LANES;
    primitives.select_nth_unstable_by(count - 1, |a, b| {
        (a.center[axis].total_cmp(&b.center[axis])).then(a.face.cmp(&b.face))
    });
    let area = |part: &[Primitive]| {
        let mut bounds = Aabb::EMPTY;
        for primitive in part {
            bounds.merge(&primitive.bounds);
        }
        bounds.half_area()
    };
    let (left, right) = primitives.split_at(count);
    Split {
        count,
        left_area: area(left),
        right_area: area(right),
    }
}

fn longest_axis(bounds: &Aabb) -> usize {
    let extent = |axis: usize| bounds.max[axis] - bounds.min[axis];
    let longer = |a: usize, b: usize| if extent(b) > extent(a) { b } else { a };
    longer(longer(0, 1), 2)
}

/// Moves the items that `is_left` accepts to the front.
fn partition<T>(items: &mut [T], is_left: impl Fn(&T) -> bool) {
    let mut num_left = 0;
    for index in 0..items.len() {
        if is_left(&items[index]) {
            items.swap(num_left, index);
            num_left += 1;
        }
    }
}
