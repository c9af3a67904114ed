//! Where a posed body runs through itself.

use garnet_knn::{KnnError, Surface, VertexTree};
use garnet_mesh::Point3;

/// How far in front of a face the body is probed, in metres.
const PROBE_DISTANCE: f32 = 5e-4;

/// Skin this near to embedded skin leaves no room for cloth, in metres.
const TRAP_DISTANCE: f32 = 0.01;

/// Skin farther from the garment than this cannot trap it, in metres.
const REACH: f32 = 0.05;

/// The faces of a body that lie inside another part of it.
#[derive(Debug)]
pub(crate) struct EmbeddedSkin {
    is_embedded: Vec<bool>,
    centers: Option<VertexTree>,
    places: Vec<Point3>,
}

impl EmbeddedSkin {
    /// Probes the faces near the garment `positions` by the winding number (DESIGN: above 0.5 is
    /// inside).
    pub(crate) fn new(skin: &Surface, positions: &[Point3]) -> Result<Self, KnnError> {
        let (low, high) = bounds(positions);
        let mut probed = Vec::new();
        let mut probes = Vec::new();
        let mut probed_centers = Vec::new();
        for (face, corners) in skin.faces().iter().enumerate() {
            let [a, b, c] = corners.map(|vertex| skin.positions()[vertex as usize].coords);
            let center = Point3::from((a + b + c) / 3.0);
            let is_near = (0..3).all(|axis| (low[axis]..=high[axis]).contains(&center[axis]));
            let normal = (b - a).cross(&(c - a));
            if let (true, Some(normal)) = (is_near, normal.try_normalize(f32::MIN_POSITIVE)) {
                probed.push(face);
                probes.push(center + PROBE_DISTANCE * normal);
                probed_centers.push(center);
            }
        }
        let mut is_embedded = vec![false; skin.faces().len()];
        let mut centers = Vec::new();
        let inside = skin.contains_all(&probes);
        for ((face, center), inside) in probed.into_iter().zip(probed_centers).zip(inside) {
            is_embedded[face] = inside;
            if inside {
                centers.push(center);
            }
        }
        let tree = if centers.is_empty() {
            None
        } else {
            Some(VertexTree::new(&centers)?)
        };
        Ok(Self {
            is_embedded,
            centers: tree,
            places: centers,
        })
    }

    /// Whether a face lies inside another part of the body.
    pub(crate) fn is_embedded(&self, face: u32) -> bool {
        self.is_embedded[face as usize]
    }

    /// The middle of the embedded face nearest to a point, if it is no farther than `reach`.
    pub(crate) fn nearest(&self, point: Point3, reach: f32) -> Option<Point3> {
        let near = self.centers.as_ref()?.nearest(point)?;
        let is_near = near.distance_squared < reach * reach;
        is_near.then(|| self.places[near.index as usize])
    }

    /// Whether cloth whose closest skin is `point` on `face` is trapped.
    pub(crate) fn is_trap(&self, face: u32, point: Point3) -> bool {
        self.is_embedded(face)
            || self.centers.as_ref().is_some_and(|tree| {
                let near = tree.within(point, TRAP_DISTANCE);
                near.first()
                    .is_some_and(|n| n.distance_squared < TRAP_DISTANCE * TRAP_DISTANCE)
            })
    }
}

/// The box of the garment, with the reach around it.
fn bounds(positions: &[Point3]) -> (Point3, Point3) {
    let mut low = Point3::from([f32::INFINITY; 3]);
    let mut high = Point3::from([f32::NEG_INFINITY; 3]);
    for position in positions {
        low = low.inf(position);
        high = high.sup(position);
    }
    (
        low.map(|value| value - REACH),
        high.map(|value| value + REACH),
    )
}
