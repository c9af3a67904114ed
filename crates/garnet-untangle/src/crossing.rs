//! Triangles of cloth that cross the skin though their corners are outside.
//!
//! Long edges cut through a round limb. Such triangles are sampled, and their corners asked to keep
//! as much more clearance as the deepest sample needs.

use garnet_knn::{Room, Surface};
use garnet_mesh::{Point3, Vector3};
use rayon::prelude::*;

use crate::UntangleError;
use crate::cloth::Cloth;
use crate::contact::{Contact, ContactFinder};

/// Samples on a crossing triangle are no farther apart than this, in metres, ...
const SAMPLE_DISTANCE: f32 = 0.008;

/// ... unless that takes more parts of a side than this.
const MAX_SIDE_PARTS: usize = 6;

/// Samples of a crossing triangle are lifted to this height over the skin, in metres.
const SAMPLE_CLEARANCE: f32 = 4e-4;

/// A corner is lifted by at least and at most this in one round, in metres.
const LIFT_RANGE: [f32; 2] = [3e-4, 5e-3];

/// The faces of the cloth that cross the skin.
#[derive(Debug)]
pub(crate) struct Crossing {
    /// The surface of the cloth.
    surface: Surface,
    /// The faces, sorted.
    pub(crate) faces: Vec<u32>,
}

impl Crossing {
    /// Those of the cloth where it is now.
    pub(crate) fn of(cloth: &Cloth<'_>) -> Result<Self, UntangleError> {
        let finder = cloth.scene.finder;
        let surface = finder.binding.surface.moved(cloth.positions.clone())?;
        let faces = crossing_faces(&surface, finder.skin);
        Ok(Self { surface, faces })
    }

    /// Those that cross the skin itself, and not what closes its holes alone.
    pub(crate) fn of_skin(&self, skin: &Surface) -> Vec<u32> {
        if !skin.has_caps() {
            return self.faces.clone();
        }
        let pairs = self.surface.faces_crossing(skin, &self.faces).into_iter();
        let of_skin = pairs.filter(|&[_, face]| !skin.is_cap(face));
        let mut faces: Vec<u32> = of_skin.map(|[face, _]| face).collect();
        faces.dedup();
        faces
    }

    /// Tests the faces of `moved` nodes, and those that crossed before, once these nodes were
    /// moved.
    pub(crate) fn refresh(
        &mut self,
        cloth: &Cloth<'_>,
        moved: &[u32],
    ) -> Result<(), UntangleError> {
        self.surface.refit(&cloth.positions)?;
        let topology = cloth.scene.garment.topology();
        let mut candidates = std::mem::take(&mut self.faces);
        for &node in moved {
            candidates.extend_from_slice(topology.vertex_faces(node as usize));
        }
        candidates.sort_unstable();
        candidates.dedup();
        let pairs = (self.surface).faces_crossing(cloth.scene.finder.skin, &candidates);
        self.faces = pairs.into_iter().map(|[face, _]| face).collect();
        self.faces.dedup();
        Ok(())
    }
}

/// The garment's faces that cross the skin, sorted.
pub(crate) fn crossing_faces(garment: &Surface, skin: &Surface) -> Vec<u32> {
    let mut faces: Vec<u32> = garment
        .intersections(skin)
        .into_iter()
        .map(|[face, _]| face)
        .collect();
    faces.dedup();
    faces
}

/// The faces of a garment that cross skin with room before it, which lies in no other part of the
/// body and no slit, sorted. What closes holes is no skin.
pub fn free_crossing_faces(garment: &Surface, skin: &Surface) -> Vec<u32> {
    let pairs = garment.intersections(skin).into_iter();
    let pairs = pairs.filter(|&[_, face]| !skin.is_cap(face));
    let free = pairs.filter(|&[_, face]| skin.room_before_face(face) == Room::Free);
    let mut faces: Vec<u32> = free.map(|[face, _]| face).collect();
    faces.sort_unstable();
    faces.dedup();
    faces
}

/// Raises `clearances` `[node]` at the corners of crossing faces, to `limit` at most.
pub(crate) fn raise_clearances(
    finder: &ContactFinder<'_>,
    crossing: &[[u32; 3]],
    positions: &[Point3],
    normal_of: impl Fn(u32) -> Vector3 + Sync,
    contacts: &[Contact],
    clearances: &mut [f32],
    limit: f32,
) {
    let lift = |corners: &[u32; 3]| {
        let depth = deepest_sample(finder, *corners, positions, &normal_of, contacts);
        let scale = finder.binding.scale;
        let [least, most] = LIFT_RANGE.map(|length| scale * length);
        (scale * SAMPLE_CLEARANCE - depth).clamp(least, most)
    };
    let lifts: Vec<f32> = crossing.par_iter().map(lift).collect();
    let mut raised: Vec<(u32, f32)> = Vec::with_capacity(3 * crossing.len());
    for (corners, lift) in crossing.iter().zip(lifts) {
        raised.extend(corners.map(|node| (node, lift)));
    }
    raised.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
    raised.dedup_by_key(|(node, _)| *node);
    for (node, lift) in raised {
        let clearance = &mut clearances[node as usize];
        *clearance = (*clearance + lift).min(limit.max(*clearance));
    }
}

/// The smallest signed distance of samples on a triangle, as its corner with the largest share
/// sees the skin.
fn deepest_sample(
    finder: &ContactFinder<'_>,
    corners: [u32; 3],
    positions: &[Point3],
    normal_of: &impl Fn(u32) -> Vector3,
    contacts: &[Contact],
) -> f32 {
    let scale = finder.binding.scale;
    let corner_normals = corners.map(normal_of);
    let mut deepest = f32::INFINITY;
    let [a, b, c] = corners.map(|node| positions[node as usize]);
    let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    let parts = ((longest / (scale * SAMPLE_DISTANCE)).ceil() as usize).clamp(3, MAX_SIDE_PARTS);
    for i in 0..=parts {
        for j in 0..=parts - i {
            let counts = [i, j, parts - i - j];
            if counts.contains(&parts) {
                continue;
            }
            let shares = counts.map(|count| count as f32 / parts as f32);
            let mut sample = Vector3::zeros();
            let mut normal = Vector3::zeros();
            let mut main = (0.0, corners[0]);
            let shared = shares.into_iter().zip(corners).zip(corner_normals);
            for ((share, node), corner_normal) in shared {
                sample += share * positions[node as usize].coords;
                normal += share * corner_normal;
                if share > main.0 {
                    main = (share, node);
                }
            }
            let node = main.1 as usize;
            let hint = contacts[node].closest.face;
            let sample = Point3::from(sample);
            let contact = finder.find(node, sample, normal, scale * SAMPLE_CLEARANCE, hint);
            for plane in [contact.own, contact.foreign].into_iter().flatten() {
                deepest = deepest.min(plane.height(sample));
            }
        }
    }
    deepest
}

#[cfg(test)]
mod tests {
    use garnet_mesh::{TriMesh, primitives::cuboid};

    use super::*;

    #[test]
    fn what_closes_a_hole_is_no_skin() {
        let cube = cuboid([1.0; 3]);
        let last = cube.faces()[cube.num_faces() - 1];
        let corners = last.map(|corner| cube.positions()[corner as usize]);
        let middle = Point3::from(corners.iter().map(|p| p.coords).sum::<Vector3>() / 3.0);
        let [a, b, c] = corners;
        let normal = (b - a).cross(&(c - a)).normalize();
        let along = (b - a).normalize();
        let corners = vec![
            middle + 0.1 * normal,
            middle - 0.1 * normal,
            middle + 0.1 * normal + 0.05 * along,
        ];
        let cloth = Surface::new(&TriMesh::new(corners, vec![[0, 1, 2]]).unwrap());
        assert_eq!(free_crossing_faces(&cloth, &Surface::new(&cube)), [0]);
        assert_eq!(
            free_crossing_faces(&cloth, &Surface::with_caps(&cube, 2)),
            [0; 0]
        );
    }
}
