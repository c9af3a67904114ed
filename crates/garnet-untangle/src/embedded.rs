//! Where a posed body runs through itself.

use garnet_knn::{KnnError, Surface, VertexTree};
use garnet_mesh::{Point3, Vector3};

/// How far in front of and behind a face the body is probed, in metres.
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
    /// inside): a face is embedded where the body is on its front, too. In a sharp crease, where the probe leaves the
    /// body by the opposite wall, there is one body alone behind the face: that is no place where cloth may stay inside.
    pub(crate) fn new(skin: &Surface, positions: &[Point3]) -> Result<Self, KnnError> {
        let (low, high) = bounds(positions);
        let mut probed = Vec::new();
        let mut probes = Vec::new();
        let mut probed_centers = Vec::new();
        for face in 0..skin.faces().len() {
            let [a, b, c] = corners(skin, face);
            let center = Point3::from((a + b + c) / 3.0);
            let is_near = (0..3).all(|axis| (low[axis]..=high[axis]).contains(&center[axis]));
            if let Some(probe) = probe(skin, face).filter(|_| is_near) {
                probed.push(face);
                probes.push(probe);
                probed_centers.push(center);
            }
        }
        let mut is_embedded = vec![false; skin.faces().len()];
        let mut centers = Vec::new();
        let inside = skin.contains_all(&probes);
        let found = probed
            .into_iter()
            .zip(probed_centers)
            .zip(probes)
            .zip(inside);
        for (((face, center), probe), inside) in found {
            if inside && has_two_parts_behind(skin, center, probe) {
                is_embedded[face] = true;
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

/// Inside how many parts of the body a point is.
pub(crate) fn winding(skin: &Surface, point: Point3) -> i32 {
    if skin.is_closed() {
        skin.winding_number(point)
    } else {
        skin.generalized_winding_number(point).round() as i32
    }
}

fn corners(skin: &Surface, face: usize) -> [Vector3; 3] {
    skin.faces()[face].map(|vertex| skin.positions()[vertex as usize].coords)
}

/// The place just before the middle of a face; none if the face has no area.
fn probe(skin: &Surface, face: usize) -> Option<Point3> {
    let [a, b, c] = corners(skin, face);
    let normal = (b - a).cross(&(c - a)).try_normalize(f32::MIN_POSITIVE)?;
    Some(Point3::from((a + b + c) / 3.0) + PROBE_DISTANCE * normal)
}

/// Whether two parts of the body are behind a face, where its probe is mirrored.
fn has_two_parts_behind(skin: &Surface, center: Point3, probe: Point3) -> bool {
    winding(skin, center + (center - probe)) > 1
}

/// Whether a face lies inside another part of the body, as [`EmbeddedSkin`] tells for all.
pub(crate) fn is_embedded(skin: &Surface, face: u32) -> bool {
    let [a, b, c] = corners(skin, face as usize);
    let center = Point3::from((a + b + c) / 3.0);
    let probe = probe(skin, face as usize);
    probe.is_some_and(|probe| skin.contains(probe) && has_two_parts_behind(skin, center, probe))
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

#[cfg(test)]
mod tests {
    use super::*;
    use garnet_mesh::TriMesh;

    /// The middle of a slit is as wide as twice this, in metres.
    const HALF_SLIT: f32 = 1e-4;

    /// Two legs on a base with a slit between them, extruded.
    fn legs() -> TriMesh {
        let e = HALF_SLIT;
        let outline = [
            [-0.2, 0.0],
            [0.2, 0.0],
            [0.2, 0.1],
            [0.2, 0.4],
            [e, 0.4],
            [e, 0.1],
            [-e, 0.1],
            [-e, 0.4],
            [-0.2, 0.4],
            [-0.2, 0.1],
        ];
        let caps = [
            [0, 1, 2],
            [0, 2, 5],
            [0, 5, 6],
            [0, 6, 9],
            [9, 6, 7],
            [9, 7, 8],
            [5, 2, 3],
            [5, 3, 4],
        ];
        let count = outline.len() as u32;
        let at = |z: f32| outline.map(|[x, y]| Point3::new(x, y, z));
        let mut faces: Vec<[u32; 3]> = caps.to_vec();
        faces.extend(caps.map(|[a, b, c]| [a + count, c + count, b + count]));
        for corner in 0..count {
            let next = (corner + 1) % count;
            faces.push([corner, corner + count, next]);
            faces.push([next, corner + count, next + count]);
        }
        TriMesh::new([at(0.1), at(-0.1)].concat(), faces).unwrap()
    }

    #[test]
    fn walls_of_a_slit_are_not_embedded() {
        let skin = Surface::new(&legs());
        assert!(skin.is_closed());
        assert!(skin.contains(Point3::new(0.1, 0.2, 0.0)));
        assert!(!skin.contains(Point3::new(0.0, 0.2, 0.0)));
        let embedded = EmbeddedSkin::new(&skin, &[Point3::new(0.05, 0.2, 0.0)]).unwrap();
        let all = 0..skin.faces().len() as u32;
        assert!(!all.into_iter().any(|face| embedded.is_embedded(face)));
    }
}
