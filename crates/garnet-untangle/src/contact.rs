//! Which skin a node of the cloth must stay in front of.

use garnet_knn::{ClosestPoint, Surface, Traps};
use garnet_mesh::{Point3, Vector3};

use crate::Binding;
use crate::lengths::DEEPEST;
use crate::skin_normals::SkinNormals;

/// Own skin that a node may be inside of is looked for no farther than this, in metres.
const OWN_REACH: f32 = DEEPEST;

/// Own skin in the pose is behind the cloth if the cosine between their normals is above this:
/// lower than in the rest pose, for folds turn cloth away from its skin. Lower ones let cloth be
/// pushed out through the far side of a limb, higher ones lose the skin under folds.
const BEHIND_COSINE: f32 = -0.6;

/// Cloth deeper inside its own part of the body returns to the skin that it lies on at rest: the
/// nearest skin may be on any side of the limb, in metres. About a quarter of the thickness of a
/// wrist: larger ones leave cloth on the wrong side of thin limbs, smaller ones draw folds back.
const DEEP: f32 = 0.012;

/// Two walls face each other if the cosine of their normals is below this.
pub(crate) const OPPOSED_COSINE: f32 = -0.5;

/// Beyond this distance from the skin the direction to it is the normal, in metres; nearer,
/// rounding decides over that direction.
const MIN_DIRECTION: f32 = 2e-4;

/// A half space that a node must stay in: `normal · x >= offset + clearance`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    pub(crate) normal: Vector3,
    pub(crate) offset: f32,
}

impl Plane {
    /// Distance of a point in front of the plane.
    pub(crate) fn height(&self, point: Point3) -> f32 {
        self.normal.dot(&point.coords) - self.offset
    }
}

/// What holds at a node until it has moved too far from where it was found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Contact {
    /// Where the node was when its contacts were found.
    pub(crate) position: Point3,
    /// The closest skin of all.
    pub(crate) closest: ClosestPoint,
    /// Signed distance to it where that has a meaning: negative inside the body.
    pub(crate) distance: f32,
    /// Its own skin, if near.
    pub(crate) own: Option<Plane>,
    /// Skin of another part of the body, if near.
    pub(crate) foreign: Option<Plane>,
    /// Inside how many parts of the body the node is that it does not belong to.
    pub(crate) foreign_parts: i32,
    /// Inside how many parts the node is after leaving those.
    pub(crate) own_parts: i32,
    /// From the node to the side of the foreign parts that it belongs to.
    pub(crate) home: Vector3,
    /// Whether the node stays where it is.
    pub(crate) is_held: bool,
}

impl Contact {
    /// Whether the node lies between two walls.
    pub(crate) fn is_between(&self) -> bool {
        self.own.is_some() && self.foreign.is_some()
    }
}

/// What the contacts of all nodes are found with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactFinder<'a> {
    pub(crate) binding: &'a Binding,
    pub(crate) skin: &'a Surface,
    pub(crate) traps: &'a Traps,
    pub(crate) normals: &'a SkinNormals,
    /// See [`UntangleOptions`](crate::UntangleOptions).
    pub(crate) keeps_sides: bool,
    pub(crate) clearance: f32,
}

impl ContactFinder<'_> {
    /// Finds the contacts of a node at `position`, whose cloth faces outwards by `normal`.
    ///
    /// Skin farther than `reach` is left out. `hint` is a face that may be near.
    pub(crate) fn find(
        &self,
        node: usize,
        position: Point3,
        normal: Vector3,
        reach: f32,
        hint: u32,
    ) -> Contact {
        let closest = self.skin.closest_from(position, hint);
        let distance = closest.distance_squared.sqrt();
        let mut contact = Contact {
            position,
            closest,
            distance,
            own: None,
            foreign: None,
            foreign_parts: 0,
            own_parts: 0,
            home: Vector3::zeros(),
            is_held: false,
        };
        if self.keeps_sides {
            self.keep_side(&mut contact, reach);
            return contact;
        }
        let is_own = |face: u32| self.is_own(node, face, normal);
        let closest_is_own = is_own(closest.face);
        let is_embedded = self.traps.leaves_no_room(closest.face, distance);
        let side = self.side_of_closest(position, &closest);
        if !is_embedded {
            contact.distance *= side;
            if closest_is_own {
                let is_near = distance < reach || side < 0.0;
                contact.own = is_near.then(|| self.own_plane(node, position, &closest, side));
                return contact;
            }
            if distance > reach && side > 0.0 {
                return contact;
            }
        }
        let winding = self.winding(position);
        let own_reach = if winding > 0 {
            self.binding.scale * OWN_REACH
        } else {
            reach
        };
        let own = self.own_skin(node, position, own_reach, is_own);
        let own_side = own.map_or(1.0, |own| self.side(position, &own));
        contact.own = own
            .filter(|own| own_side < 0.0 || own.distance_squared < reach * reach)
            .map(|own| self.own_plane(node, position, &own, own_side));
        contact.own_parts = i32::from(own_side < 0.0);
        contact.foreign_parts = (winding - contact.own_parts).max(0);
        if winding > 0 {
            contact.distance = -distance;
        }
        if contact.foreign_parts > 0 {
            contact.home = if self.binding.is_under(node, closest.face) {
                normal
            } else {
                -normal
            };
        } else if !closest_is_own && distance < reach && side > 0.0 {
            contact.foreign = Some(self.plane(position, &closest, side));
        }
        contact
    }

    /// Keeps cloth in front of the nearest skin, its own or foreign, or where it is if it is
    /// trapped there.
    fn keep_side(&self, contact: &mut Contact, reach: f32) {
        let Contact {
            position, closest, ..
        } = *contact;
        if self.traps.holds(&closest) {
            contact.is_held = true;
            if self.winding(position) > 0 {
                contact.distance = -contact.distance;
            }
            return;
        }
        let side = self.side_of_closest(position, &closest);
        contact.distance *= side;
        if contact.distance < reach {
            let wall = self.plane(position, &closest, side);
            contact.own = Some(wall);
            if contact.distance < self.clearance {
                contact.foreign = self.opposite_wall(position, closest.face, &wall);
            }
        }
    }

    /// Skin that faces a wall, if there is less room between the two than cloth is to keep from
    /// both.
    fn opposite_wall(&self, position: Point3, hint: u32, wall: &Plane) -> Option<Plane> {
        let faces_it = |face: u32| self.normals.face(face).dot(&wall.normal) < OPPOSED_COSINE;
        let room = 2.0 * self.clearance - wall.height(position);
        let opposite = (self.skin).closest_where_from(position, room, hint, faces_it)?;
        let side = self.side(position, &opposite);
        (side > 0.0).then(|| self.plane(position, &opposite, side))
    }

    /// The node's own skin nearest to `position`.
    fn own_skin(
        &self,
        node: usize,
        position: Point3,
        reach: f32,
        is_own: impl Fn(u32) -> bool,
    ) -> Option<ClosestPoint> {
        let hint = self.binding.skin[node].face;
        self.skin.closest_where_from(position, reach, hint, is_own)
    }

    /// Whether a face is the node's own skin.
    fn is_own(&self, node: usize, face: u32, normal: Vector3) -> bool {
        self.binding.is_own(node, face) && self.normals.face(face).dot(&normal) > BEHIND_COSINE
    }

    /// 1 in front of the skin, -1 behind it.
    fn side(&self, position: Point3, closest: &ClosestPoint) -> f32 {
        let normal = self.normals.pseudonormal(self.skin, closest);
        if (position - closest.point).dot(&normal) < 0.0 {
            -1.0
        } else {
            1.0
        }
    }

    /// The same of the closest skin of all. Faces that close a hole may run through the skin, and
    /// normals do not tell what is inside of them: nothing is that no part of the body goes round.
    fn side_of_closest(&self, position: Point3, closest: &ClosestPoint) -> f32 {
        let side = self.side(position, closest);
        if side < 0.0 && self.skin.has_caps() && self.winding(position) == 0 {
            return 1.0;
        }
        side
    }

    /// Inside how many parts of the body a point is.
    pub(crate) fn winding(&self, position: Point3) -> i32 {
        self.skin.parts_around(position)
    }

    /// The half space in front of the node's own skin, of which `nearest` is the nearest.
    fn own_plane(&self, node: usize, position: Point3, nearest: &ClosestPoint, side: f32) -> Plane {
        let deep = self.binding.scale * DEEP;
        let is_deep = side < 0.0 && nearest.distance_squared > deep * deep;
        let returned = is_deep.then(|| self.rest_skin_plane(node));
        match returned {
            Some(plane) if plane.height(position) < 0.0 => plane,
            _ => self.plane(position, nearest, side),
        }
    }

    /// The half space in front of the skin that a node lies on at rest, where that skin is now.
    fn rest_skin_plane(&self, node: usize) -> Plane {
        let skin = &self.binding.skin[node];
        let corners = self.skin.faces()[skin.face as usize].into_iter();
        let point: Vector3 = corners
            .zip(skin.barycentric)
            .map(|(vertex, share)| share * self.skin.positions()[vertex as usize].coords)
            .sum();
        let normal = self.normals.smooth(self.skin, skin);
        Plane {
            normal,
            offset: normal.dot(&point),
        }
    }

    /// The half space in front of the skin at `closest`.
    fn plane(&self, position: Point3, closest: &ClosestPoint, side: f32) -> Plane {
        let offset = position - closest.point;
        let normal = if side > 0.0 && offset.norm() > MIN_DIRECTION {
            offset.normalize()
        } else {
            self.normals.smooth(self.skin, closest)
        };
        Plane {
            normal,
            offset: normal.dot(&closest.point.coords),
        }
    }
}
