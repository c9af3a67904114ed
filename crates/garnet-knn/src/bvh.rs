//! The hierarchy of boxes over the triangles, four boxes a node and four triangles a block.

use crate::aabb::Aabb;
use crate::bvh_build::{BLOCK_BIT, NONE, STACK_SIZE, tree_layout};
use crate::lanes::{Lanes, Lanes3, NUM_LANES};
use garnet_mesh::Point3;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Blocks that one task refits.
const BLOCKS_PER_TASK: usize = 1024;

/// Boxes `[lane]` of up to four children.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    pub(crate) min: Lanes3,
    pub(crate) max: Lanes3,
    pub(crate) children: [u32; NUM_LANES],
}

/// Up to four triangles; unused lanes repeat the first one and have the face [`NONE`].
#[derive(Debug, Clone)]
pub(crate) struct Block {
    /// Coordinates `[corner][axis]`.
    pub(crate) corners: [Lanes3; 3],
    pub(crate) faces: [u32; NUM_LANES],
}

/// What a child slot of a node refers to.
pub(crate) enum Child<'a> {
    Node(&'a Node),
    Block(&'a Block),
}

/// Nodes in depth-first order, node 0 the root, so that children come after their parent.
#[derive(Debug, Clone)]
pub(crate) struct Bvh {
    pub(crate) nodes: Vec<Node>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) bounds: Aabb,
}

impl Bvh {
    pub(crate) fn new(positions: &[Point3], faces: &[[u32; 3]]) -> Self {
        let layout = tree_layout(positions, faces);
        let empty = Lanes::splat(0.0);
        let node = |children| Node {
            min: [empty; 3],
            max: [empty; 3],
            children,
        };
        let block = |faces| Block {
            corners: [[empty; 3]; 3],
            faces,
        };
        let mut bvh = Self {
            nodes: layout.nodes.into_iter().map(node).collect(),
            blocks: layout.blocks.into_iter().map(block).collect(),
            bounds: Aabb::EMPTY,
        };
        bvh.refit(positions, faces);
        bvh
    }

    /// Fits all boxes to new positions of the same faces.
    pub(crate) fn refit(&mut self, positions: &[Point3], faces: &[[u32; 3]]) {
        self.blocks
            .par_chunks_mut(BLOCKS_PER_TASK)
            .for_each(|blocks| {
                for block in blocks {
                    block.refit(positions, faces);
                }
            });
        for index in (0..self.nodes.len()).rev() {
            let mut min = [[f32::INFINITY; NUM_LANES]; 3];
            let mut max = [[f32::NEG_INFINITY; NUM_LANES]; 3];
            for (slot, &child) in self.nodes[index].children.iter().enumerate() {
                if child == NONE {
                    continue;
                }
                let bounds = match self.child(child) {
                    Child::Node(node) => node.bounds(),
                    Child::Block(block) => block.bounds(),
                };
                for axis in 0..3 {
                    min[axis][slot] = bounds.min[axis];
                    max[axis][slot] = bounds.max[axis];
                }
            }
            self.nodes[index].min = min.map(Lanes);
            self.nodes[index].max = max.map(Lanes);
        }
        self.bounds = self.nodes[0].bounds();
    }

    /// The number of a child that is a block.
    pub(crate) fn block_index(child: u32) -> usize {
        (child & !BLOCK_BIT) as usize
    }

    /// Visits the blocks, with their numbers, below boxes (by smallest and largest corner) that are
    /// missed by nothing more than 0.
    #[inline]
    pub(crate) fn visit(
        &self,
        misses_by: impl Fn(&Lanes3, &Lanes3) -> Lanes,
        mut visit: impl FnMut(usize, &Block),
    ) {
        let mut stack = [0_u32; STACK_SIZE];
        let mut size = 1;
        while size > 0 {
            size -= 1;
            let child = stack[size];
            match self.child(child) {
                Child::Node(node) => {
                    let misses = misses_by(&node.min, &node.max).0;
                    for (&miss, &child) in misses.iter().zip(&node.children) {
                        if miss <= 0.0 && child != NONE {
                            stack[size] = child;
                            size += 1;
                        }
                    }
                }
                Child::Block(block) => visit(Self::block_index(child), block),
            }
        }
    }

    /// What a child slot that is not [`NONE`] refers to.
    #[inline]
    pub(crate) fn child(&self, child: u32) -> Child<'_> {
        if child & BLOCK_BIT == 0 {
            Child::Node(&self.nodes[child as usize])
        } else {
            Child::Block(&self.blocks[Self::block_index(child)])
        }
    }
}

impl Node {
    fn bounds(&self) -> Aabb {
        Aabb {
            min: self.min.map(Lanes::min_lane),
            max: self.max.map(Lanes::max_lane),
        }
    }
}

impl Block {
    fn refit(&mut self, positions: &[Point3], faces: &[[u32; 3]]) {
        for lane in 0..NUM_LANES {
            let face = match self.faces[lane] {
                NONE => self.faces[0],
                face => face,
            };
            for (corner, &vertex) in faces[face as usize].iter().enumerate() {
                let position = positions[vertex as usize];
                for axis in 0..3 {
                    self.corners[corner][axis].0[lane] = position[axis];
                }
            }
        }
    }

    /// The box of each triangle.
    #[inline]
    pub(crate) fn lane_bounds(&self) -> (Lanes3, Lanes3) {
        let [a, b, c] = &self.corners;
        let min = std::array::from_fn(|axis| a[axis].min(b[axis]).min(c[axis]));
        let max = std::array::from_fn(|axis| a[axis].max(b[axis]).max(c[axis]));
        (min, max)
    }

    pub(crate) fn bounds(&self) -> Aabb {
        let (min, max) = self.lane_bounds();
        Aabb {
            min: min.map(Lanes::min_lane),
            max: max.map(Lanes::max_lane),
        }
    }

    /// The corners of one triangle in double precision.
    #[inline]
    pub(crate) fn triangle_f64(&self, lane: usize) -> [Vector3<f64>; 3] {
        self.corners
            .map(|[x, y, z]| Vector3::new(x.0[lane], y.0[lane], z.0[lane]).cast())
    }

    /// The corners of one triangle `[corner][axis]`.
    #[inline]
    pub(crate) fn triangle(&self, lane: usize) -> [[f32; 3]; 3] {
        self.corners.map(|corner| corner.map(|axis| axis.0[lane]))
    }
}
