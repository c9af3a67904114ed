//! A fast look at one triangle against the four of a block, which lets all pairs pass that may
//! intersect.

use crate::bvh::Block;
use crate::lanes::{Lanes, Lanes3, NUM_LANES, cross3, dot3, max_abs3, splat3, sub3};
use crate::triangle_pair::{Triangle, UNDERFLOW};

/// Rounding of a 3x3 determinant in `f32`, relative to the product of its largest entries: six
/// products of three differences, with eight roundings each, stay below 6 * 8 * 6e-8.
const ROUNDING: f32 = 4e-6;
/// Above this a determinant may overflow.
const OVERFLOW: f32 = 1e37;

/// What of the triangles of a block is compared with others.
pub(crate) struct Shapes {
    min: Lanes3,
    max: Lanes3,
    normals: Lanes3,
    scales: Lanes,
}

impl Shapes {
    pub(crate) fn new(block: &Block) -> Self {
        let (min, max) = block.lane_bounds();
        let (normals, scales) = scaled_normal(&block.corners);
        Self {
            min,
            max,
            normals,
            scales,
        }
    }
}

/// A triangle to be compared with blocks.
pub(crate) struct Probe {
    corners: [Lanes3; 3],
    min: Lanes3,
    max: Lanes3,
    normal: Lanes3,
    scale: Lanes,
}

impl Probe {
    pub(crate) fn new(triangle: &Triangle) -> Self {
        let corners = triangle.map(splat3);
        let [a, b, c] = corners;
        let (normal, scale) = scaled_normal(&corners);
        Self {
            corners,
            min: std::array::from_fn(|axis| a[axis].min(b[axis]).min(c[axis])),
            max: std::array::from_fn(|axis| a[axis].max(b[axis]).max(c[axis])),
            normal,
            scale,
        }
    }

    /// Which triangles of the block may intersect this one: their boxes touch its box, and they lie
    /// neither wholly on one side of its plane nor have it wholly on one side of theirs.
    #[inline]
    pub(crate) fn may_intersect(&self, block: &Block, shapes: &Shapes) -> [bool; NUM_LANES] {
        self.passed(block, shapes, || [false; NUM_LANES])
    }

    /// [`Probe::may_intersect`] for triangles of one mesh: those that share a corner with this one
    /// by place pass wherever they lie, which saves looking at most pairs.
    #[inline]
    pub(crate) fn may_intersect_beyond(&self, block: &Block, shapes: &Shapes) -> [bool; NUM_LANES] {
        self.passed(block, shapes, || self.shares_corner(block))
    }

    #[inline]
    fn passed(
        &self,
        block: &Block,
        shapes: &Shapes,
        shares: impl Fn() -> [bool; NUM_LANES],
    ) -> [bool; NUM_LANES] {
        let mut passed = self.touches(shapes);
        if passed == [false; NUM_LANES] {
            return passed;
        }
        let shares = shares();
        if (0..NUM_LANES).any(|lane| passed[lane] && !shares[lane]) {
            let apart = self.apart(block, shapes).0;
            for lane in 0..NUM_LANES {
                passed[lane] &= shares[lane] || apart[lane] <= 0.0 || apart[lane].is_nan();
            }
        }
        passed
    }

    #[inline]
    fn touches(&self, shapes: &Shapes) -> [bool; NUM_LANES] {
        let apart = separation((&self.min, &self.max), (&shapes.min, &shapes.max)).0;
        apart.map(|distance| distance <= 0.0)
    }

    /// Positive where one triangle is on one side of the plane of the other for certain.
    #[inline]
    fn apart(&self, block: &Block, shapes: &Shapes) -> Lanes {
        let of_block = one_sided(&self.corners[0], &self.normal, self.scale, &block.corners);
        let of_probe = one_sided(
            &block.corners[0],
            &shapes.normals,
            shapes.scales,
            &self.corners,
        );
        of_block.max(of_probe)
    }

    #[inline]
    fn shares_corner(&self, block: &Block) -> [bool; NUM_LANES] {
        // How far apart corners are along the axis where they are that most; 0 at one place.
        let mut nearest = Lanes::splat(f32::INFINITY);
        for own in &self.corners {
            for other in &block.corners {
                nearest = nearest.min(max_abs3(sub3(*own, *other)));
            }
        }
        nearest.0.map(|distance| distance == 0.0)
    }
}

/// By how much two boxes are apart on the axis where that is most; positive if they do not touch.
#[inline]
pub(crate) fn separation(a: (&Lanes3, &Lanes3), b: (&Lanes3, &Lanes3)) -> Lanes {
    let on_axis = |axis: usize| (a.0[axis] - b.1[axis]).max(b.0[axis] - a.1[axis]);
    on_axis(0).max(on_axis(1)).max(on_axis(2))
}

/// The normals of four triangles, and the products of the largest components of their edges.
#[inline]
fn scaled_normal(corners: &[Lanes3; 3]) -> (Lanes3, Lanes) {
    let (ab, ac) = (sub3(corners[1], corners[0]), sub3(corners[2], corners[0]));
    (cross3(ab, ac), max_abs3(ab) * max_abs3(ac))
}

/// Positive where all corners are on one side of a plane for certain.
#[inline]
fn one_sided(origin: &Lanes3, normal: &Lanes3, scale: Lanes, corners: &[Lanes3; 3]) -> Lanes {
    let offsets = corners.map(|corner| sub3(corner, *origin));
    let heights = offsets.map(|offset| dot3(*normal, offset));
    let reach = max_abs3(offsets[0])
        .max(max_abs3(offsets[1]))
        .max(max_abs3(offsets[2]));
    let product = scale * reach;
    let rounding = Lanes::splat(ROUNDING) * product + Lanes::splat(UNDERFLOW);
    let infinity = Lanes::splat(f32::INFINITY);
    let rounding = (product.max(scale)).select_greater(Lanes::splat(OVERFLOW), infinity, rounding);
    let lowest = heights[0].min(heights[1]).min(heights[2]);
    let highest = heights[0].max(heights[1]).max(heights[2]);
    (lowest - rounding).max(Lanes::splat(0.0) - highest - rounding)
}
