//! Where a posed body runs through itself.

use garnet_knn::{ClosestPoint, KnnError, Room, Surface, VertexTree};
use garnet_mesh::{Point3, Vector3};

/// Skin this near to embedded skin leaves no room for cloth, in metres.
const TRAP_DISTANCE: f32 = 0.01;

/// Cloth deeper in the body than this is not caught in a slit: it is to leave, in metres.
const SLIT_DEPTH: f32 = 0.005;

/// Skin farther from the garment than this cannot trap it, in metres.
const REACH: f32 = 0.05;

/// The faces of a body that lie inside another part of it, and those of slits.
#[derive(Debug)]
pub(crate) struct EmbeddedSkin {
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

    /// Whether one is nearer to a point than what leaves no room.
    fn are_near(&self, point: Point3) -> bool {
        self.tree.as_ref().is_some_and(|tree| {
            let near = tree.within(point, TRAP_DISTANCE);
            near.first()
                .is_some_and(|n| n.distance_squared < TRAP_DISTANCE * TRAP_DISTANCE)
        })
    }
}

impl EmbeddedSkin {
    /// Probes the faces near the garment `positions` by the winding number (DESIGN: above 0.5 is
    /// inside): a face has no room where the body is on its front, too. In a slit or a sharp crease, where the probe leaves the
    /// body by the opposite wall, there is one body alone behind the face: cloth that is pressed into it is caught, but what is deep
    /// in the body next to it is not.
    pub(crate) fn new(skin: &Surface, positions: &[Point3]) -> Result<Self, KnnError> {
        let (low, high) = bounds(positions);
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
            rooms,
            embedded: Middles::new(embedded)?,
            slits: Middles::new(slits)?,
        })
    }

    /// Whether a face leaves no room for cloth so far from it, in metres: it lies inside another part of the body, or in a slit.
    pub(crate) fn is_embedded(&self, face: u32, distance: f32) -> bool {
        self.rooms[face as usize].catches(distance, SLIT_DEPTH)
    }

    /// The middle of the face nearest to a point that leaves no room for cloth, if it is no farther than `reach`.
    pub(crate) fn nearest(&self, point: Point3, reach: f32) -> Option<Point3> {
        let found = [&self.embedded, &self.slits].map(|faces| faces.nearest(point, reach));
        let found = found.into_iter().flatten();
        let nearest = found.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(nearest.1)
    }

    /// Whether cloth with this closest skin is trapped.
    pub(crate) fn is_trap(&self, closest: &ClosestPoint) -> bool {
        let distance = closest.distance_squared.sqrt();
        self.is_embedded(closest.face, distance)
            || self.embedded.are_near(closest.point)
            || (distance < SLIT_DEPTH && self.slits.are_near(closest.point))
    }

    /// Whether cloth at a point on the skin is trapped.
    pub(crate) fn is_trap_at(&self, face: u32, point: Point3) -> bool {
        self.is_embedded(face, 0.0) || self.embedded.are_near(point) || self.slits.are_near(point)
    }
}

/// The middle of a face, and its unit normal; none if it has no area.
fn middle(skin: &Surface, face: usize) -> (Point3, Option<Vector3>) {
    let corners = skin.faces()[face].map(|vertex| skin.positions()[vertex as usize].coords);
    let [a, b, c] = corners;
    let normal = (b - a).cross(&(c - a)).try_normalize(f32::MIN_POSITIVE);
    (Point3::from((a + b + c) / 3.0), normal)
}

/// Whether a face has no room before it, inside another part of the body or in a slit, as [`EmbeddedSkin`] tells for all.
pub(crate) fn has_no_room(skin: &Surface, face: u32) -> bool {
    let (center, normal) = middle(skin, face as usize);
    normal.is_some_and(|normal| skin.room_before(center, normal) != Room::Free)
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
