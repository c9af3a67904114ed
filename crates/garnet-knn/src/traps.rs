//! Where a body that runs through itself leaves cloth no room.

use garnet_mesh::{Point3, Vector3};

use crate::{ClosestPoint, KnnError, Room, Surface, VertexTree};

/// Skin whose middle is this near to embedded skin leaves no room either, in metres on a person:
/// the rim of a contact, where cloth that hangs on caught cloth has no way out. A larger one calls
/// more of an armpit trapped.
pub const TRAP_DISTANCE: f32 = 0.01;

/// A slit or a crease of one part of the body catches cloth that is no deeper in it than this, in
/// metres on a person: what is deeper has another side to leave by. A larger one excuses deeper
/// cloth.
pub const SLIT_DEPTH: f32 = 0.005;

/// Skin farther from the cloth than this is not looked at, in metres on a person: it cannot be the
/// closest skin of cloth that is in reach of a [`Traps::nearest`] contact.
const REACH: f32 = 0.05;

/// The places of a skin where cloth is *trapped*: this is the one definition of the word.
///
/// A point is trapped if the face nearest to it is *embedded*, which means that it lies inside
/// another part of the body ([`Room::Embedded`] before its middle), or if the middle of an embedded
/// face is within [`TRAP_DISTANCE`] of the closest point. Before a face of a slit or of a crease of
/// one part ([`Room::InSlit`]) it is trapped, in the same two ways, only if it is no farther from
/// the skin than [`SLIT_DEPTH`].
///
/// Whether a point is trapped does not depend on whether it is *inside*, which means that the
/// skin winds around it ([`Surface::contains`]).
///
/// # Examples
///
/// ```
/// use garnet_knn::{Surface, Traps};
/// use garnet_mesh::{Point3, TriMesh, primitives::icosphere};
///
/// // Two balls that run through each other.
/// let (mut positions, mut faces) = icosphere(3, 0.2).into_parts();
/// let count = positions.len() as u32;
/// for index in 0..positions.len() {
///     let other = positions[index];
///     positions.push(Point3::new(other.x + 0.3, other.y, other.z));
/// }
/// let other: Vec<[u32; 3]> = faces.iter().map(|face| face.map(|v| v + count)).collect();
/// faces.extend(other);
/// let skin = Surface::new(&TriMesh::new(positions, faces)?);
///
/// let [between, before] = [0.199, -0.201].map(|x| Point3::new(x, 0.01, 0.01));
/// let traps = Traps::near(&skin, &[between, before], 1.0)?;
/// assert!(traps.holds(&skin.closest(between)));
/// assert!(!traps.holds(&skin.closest(before)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Traps {
    /// What lengths of a person are multiplied by.
    scale: f32,
    /// What is before each face `[face]`.
    rooms: Vec<Room>,
    embedded: Middles,
    slits: Middles,
}

/// The middles of some faces.
#[derive(Debug)]
struct Middles {
    tree: Option<VertexTree>,
    places: Vec<Point3>,
}

impl Middles {
    fn new(places: Vec<Point3>) -> Result<Self, KnnError> {
        let tree = if places.is_empty() {
            None
        } else {
            Some(VertexTree::new(&places)?)
        };
        Ok(Self { tree, places })
    }

    /// The nearest to a point, if it is no farther than `reach`.
    fn nearest(&self, point: Point3, reach: f32) -> Option<(f32, Point3)> {
        let near = self.tree.as_ref()?.nearest(point)?;
        let is_near = near.distance_squared < reach * reach;
        is_near.then(|| (near.distance_squared, self.places[near.index as usize]))
    }

    /// Whether one is nearer to a point than `distance`.
    fn are_near(&self, point: Point3, distance: f32) -> bool {
        self.tree.as_ref().is_some_and(|tree| {
            let near = tree.within(point, distance);
            near.first()
                .is_some_and(|n| n.distance_squared < distance * distance)
        })
    }
}

impl Traps {
    /// Probes the faces near points, in metres: those within 5 cm of their box. Of points that are
    /// farther from the skin nothing is known, and they count as free.
    ///
    /// Lengths are `scale` times those of a person, for dolls and giants, or fingers.
    ///
    /// # Errors
    ///
    /// [`KnnError`] if there are more faces than can be searched.
    pub fn near(skin: &Surface, points: &[Point3], scale: f32) -> Result<Self, KnnError> {
        let (low, high) = bounds(points, scale * REACH);
        let (mut probed, mut places) = (Vec::new(), Vec::new());
        for face in 0..skin.faces().len() {
            let (center, normal) = middle(skin, face);
            let is_near = (0..3).all(|axis| (low[axis]..=high[axis]).contains(&center[axis]));
            if let Some(normal) = normal.filter(|_| is_near) {
                probed.push(face);
                places.push((center, normal));
            }
        }
        let mut rooms = vec![Room::Free; skin.faces().len()];
        let (mut embedded, mut slits) = (Vec::new(), Vec::new());
        let found = skin.room_before_all(&places);
        for ((face, (center, _)), room) in probed.into_iter().zip(places).zip(found) {
            rooms[face] = room;
            match room {
                Room::Free => {}
                Room::InSlit => slits.push(center),
                Room::Embedded => embedded.push(center),
            }
        }
        Ok(Self {
            scale,
            rooms,
            embedded: Middles::new(embedded)?,
            slits: Middles::new(slits)?,
        })
    }

    /// Whether a point with this closest skin is trapped.
    ///
    /// # Panics
    ///
    /// If the skin is another one, with fewer faces.
    pub fn holds(&self, closest: &ClosestPoint) -> bool {
        let distance = closest.distance_squared.sqrt();
        self.leaves_no_room(closest.face, distance)
            || self
                .embedded
                .are_near(closest.point, self.scale * TRAP_DISTANCE)
            || (distance < self.scale * SLIT_DEPTH
                && self
                    .slits
                    .are_near(closest.point, self.scale * TRAP_DISTANCE))
    }

    /// Whether a point on a face of the skin is trapped.
    ///
    /// # Panics
    ///
    /// As [`Traps::holds`].
    pub fn holds_at(&self, face: u32, point: Point3) -> bool {
        self.leaves_no_room(face, 0.0)
            || self.embedded.are_near(point, self.scale * TRAP_DISTANCE)
            || self.slits.are_near(point, self.scale * TRAP_DISTANCE)
    }

    /// Whether a face itself, not one near it, leaves no room for cloth so far from it, in metres.
    ///
    /// # Panics
    ///
    /// As [`Traps::holds`].
    pub fn leaves_no_room(&self, face: u32, distance: f32) -> bool {
        self.rooms[face as usize].catches(distance, self.scale * SLIT_DEPTH)
    }

    /// The middle of the face nearest to a point that leaves no room for cloth, if it is no farther
    /// than `reach`, in metres.
    pub fn nearest(&self, point: Point3, reach: f32) -> Option<Point3> {
        let found = [&self.embedded, &self.slits].map(|faces| faces.nearest(point, reach));
        let found = found.into_iter().flatten();
        let nearest = found.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(nearest.1)
    }
}

impl Surface {
    /// What is before the middle of a face; free if it has no area.
    ///
    /// # Panics
    ///
    /// If the surface has fewer faces.
    pub fn room_before_face(&self, face: u32) -> Room {
        let (center, normal) = middle(self, face as usize);
        normal.map_or(Room::Free, |normal| self.room_before(center, normal))
    }
}

/// The middle of a face, and its unit normal; none if it has no area.
fn middle(skin: &Surface, face: usize) -> (Point3, Option<Vector3>) {
    let corners = skin.faces()[face].map(|vertex| skin.positions()[vertex as usize].coords);
    let [a, b, c] = corners;
    let normal = (b - a).cross(&(c - a)).try_normalize(f32::MIN_POSITIVE);
    (Point3::from((a + b + c) / 3.0), normal)
}

/// The box of the points, with a reach around it.
fn bounds(points: &[Point3], reach: f32) -> (Point3, Point3) {
    let mut low = Point3::from([f32::INFINITY; 3]);
    let mut high = Point3::from([f32::NEG_INFINITY; 3]);
    for point in points {
        low = low.inf(point);
        high = high.sup(point);
    }
    (
        low.map(|value| value - reach),
        high.map(|value| value + reach),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{both, sphere, surface};

    #[test]
    fn a_doll_traps_where_a_person_does() {
        let balls = |scale: f32| {
            let ball = |x: f32| sphere([scale * x, 0.0, 0.0], scale * 0.2, 33, 49);
            surface(both(ball(0.0), ball(0.3)))
        };
        let trapped = |scale: f32, lengths: f32| -> Vec<bool> {
            let skin = balls(scale);
            let places = (0..200).map(|number| {
                let angle = number as f32 / 100.0 * std::f32::consts::PI;
                Point3::from(Vector3::new(angle.cos(), angle.sin(), 0.02) * (0.205 * scale))
            });
            let places: Vec<Point3> = places.collect();
            let traps = Traps::near(&skin, &places, lengths).unwrap();
            let closest = skin.closest_all(&places);
            closest.iter().map(|found| traps.holds(found)).collect()
        };
        let count = |trapped: &[bool]| trapped.iter().filter(|is_trapped| **is_trapped).count();
        let person = trapped(1.0, 1.0);
        assert!((10..100).contains(&count(&person)), "{}", count(&person));
        // Rounding may move one at the rim.
        let doll = trapped(0.05, 0.05);
        let differ = doll.iter().zip(&person).filter(|(a, b)| a != b).count();
        assert!(differ <= 4, "{differ}");
        assert!(count(&trapped(0.05, 1.0)) > count(&person) + 50);
    }
}
