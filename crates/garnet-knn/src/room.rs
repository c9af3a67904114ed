//! Whether there is room for something before a place on the skin of a body that may run through
//! itself.

use rayon::prelude::*;

use crate::Surface;
use crate::winding::POINTS_PER_TASK;
use garnet_mesh::{Point3, Vector3};

/// How far in front of and behind a place the body is probed, in metres.
pub const PROBE_DISTANCE: f32 = 5e-4;

/// What is before a place on a skin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Room {
    /// Air.
    Free,
    /// The opposite wall of a slit or of a sharp crease, and behind the place one part of the body
    /// alone.
    InSlit,
    /// Another part of the body, which the place is inside of.
    Embedded,
}

impl Room {
    /// Whether something so far from the skin, in metres, is caught there: slits catch what is on
    /// their walls, no deeper than `slit_depth`, in metres.
    pub fn catches(self, distance: f32, slit_depth: f32) -> bool {
        match self {
            Self::Free => false,
            Self::InSlit => distance < slit_depth,
            Self::Embedded => true,
        }
    }
}

impl Surface {
    /// What is before a place on the skin with this unit normal, [`PROBE_DISTANCE`] away, by
    /// winding numbers.
    pub fn room_before(&self, place: Point3, normal: Vector3) -> Room {
        let probe = PROBE_DISTANCE * normal;
        if !self.contains(place + probe) {
            return Room::Free;
        }
        if self.parts_around(place - probe) > 1 {
            Room::Embedded
        } else {
            Room::InSlit
        }
    }

    /// [`Surface::room_before`] for many places with their normals `[place]` at once, on all
    /// threads.
    pub fn room_before_all(&self, places: &[(Point3, Vector3)]) -> Vec<Room> {
        let places = places.par_iter().with_min_len(POINTS_PER_TASK);
        places
            .map(|&(place, normal)| self.room_before(place, normal))
            .collect()
    }

    /// Inside how many parts of the body a point is; of open skins by the generalised winding
    /// number.
    pub fn parts_around(&self, point: Point3) -> i32 {
        if self.is_closed() {
            self.winding_number(point)
        } else {
            self.generalized_winding_number(point).round() as i32
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use garnet_mesh::TriMesh;
    use garnet_mesh::primitives::icosphere;

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
    fn the_walls_of_a_slit_catch_what_is_on_them_and_nothing_deep() {
        let skin = Surface::new(&legs());
        assert!(skin.is_closed());
        let x = Vector3::x();
        let [wall, outer] = [HALF_SLIT, 0.2].map(|x| Point3::new(x, 0.2, 0.0));
        let rooms = skin.room_before_all(&[(wall, -x), (outer, x)]);
        assert_eq!(rooms, [Room::InSlit, Room::Free]);
        assert!(rooms[0].catches(0.002, 0.005) && !rooms[0].catches(0.02, 0.005));
        assert!(!rooms[1].catches(0.0, 0.005));
    }

    #[test]
    fn skin_inside_another_part_is_embedded() {
        let (mut positions, mut faces) = icosphere(3, 0.2).into_parts();
        let count = positions.len() as u32;
        positions.extend_from_within(..);
        for position in &mut positions[count as usize..] {
            position.x += 0.3;
        }
        let other: Vec<[u32; 3]> = faces.iter().map(|face| face.map(|v| v + count)).collect();
        faces.extend(other);
        let skin = Surface::new(&TriMesh::new(positions, faces).unwrap());
        let place = |point: Point3| {
            let closest = skin.closest(point);
            skin.room_before(closest.point, skin.face_normal(closest.face))
        };
        let inner = Point3::new(0.199, 0.01, 0.01);
        assert_eq!(place(inner), Room::Embedded);
        assert!(place(inner).catches(0.1, 0.005));
        assert_eq!(place(Point3::new(-0.2, 0.01, 0.01)), Room::Free);
    }
}
