//! Tapered bones and their smooth union: the shape of the mannequin and of the form under its
//! clothes.

use garnet::{Point3, Vector3};

/// A segment with a radius at each end; flattened or deepened along z.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bone {
    pub(crate) ends: [Point3; 2],
    /// Radii at the ends, in metres.
    pub(crate) radii: [f32; 2],
    /// Extent along z as a share of the radius.
    pub(crate) depth: f32,
}

impl Bone {
    /// A round bone.
    pub(crate) fn new(ends: [[f32; 3]; 2], radii: [f32; 2]) -> Self {
        Self {
            ends: ends.map(Point3::from),
            radii,
            depth: 1.0,
        }
    }

    pub(crate) fn with_depth(self, depth: f32) -> Self {
        Self { depth, ..self }
    }

    /// About the distance to the surface, negative inside, in metres.
    pub(crate) fn distance(&self, point: Point3) -> f32 {
        let flat = |v: Vector3| Vector3::new(v.x, v.y, v.z / self.depth);
        let along = flat(self.ends[1] - self.ends[0]);
        let offset = flat(point - self.ends[0]);
        let share = (offset.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        let radius = self.radii[0] + share * (self.radii[1] - self.radii[0]);
        (offset - share * along).norm() - radius
    }
}

/// The smaller of two distances, rounded where they differ by less than `width`.
pub(crate) fn smooth_min(a: f32, b: f32, width: f32) -> f32 {
    let overlap = (width - (a - b).abs()).max(0.0) / width;
    a.min(b) - 0.25 * width * overlap * overlap
}

/// The smooth union of several bones.
pub(crate) fn union(bones: &[Bone], width: f32, point: Point3) -> f32 {
    let distances = bones.iter().map(|bone| bone.distance(point));
    distances.fold(f32::INFINITY, |a, b| {
        if a < f32::INFINITY {
            smooth_min(a, b, width)
        } else {
            b
        }
    })
}

/// Moves a point towards the level of a field, by steps of Newton's method along the gradient.
pub(crate) fn onto_level(field: impl Fn(Point3) -> f32, level: f32, point: Point3) -> Point3 {
    const STEPS: usize = 3;
    const LONGEST: f32 = 0.05;
    let mut point = point;
    for _ in 0..STEPS {
        let slope = gradient(&field, point);
        let step = (level - field(point)) / slope.norm_squared().max(0.05);
        let step = step * slope;
        let scale = (LONGEST / step.norm().max(f32::MIN_POSITIVE)).min(1.0);
        point += scale * step;
    }
    point
}

fn gradient(field: impl Fn(Point3) -> f32, point: Point3) -> Vector3 {
    const STEP: f32 = 1e-3;
    let slope = |axis: Vector3| field(point + axis) - field(point - axis);
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| slope(STEP * axis));
    Vector3::new(x, y, z) / (2.0 * STEP)
}
