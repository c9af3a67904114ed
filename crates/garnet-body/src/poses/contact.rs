//! How deep the parts of a posed body run into each other.
//!
//! The depth of two parts is the largest distance from a vertex of one that lies inside the other
//! to the other's skin, either way round. Skin always folds where a limb bends, and skinned flesh,
//! unlike real one, does not give way there. Parts that hang on each other are therefore judged
//! away from their joint only: vertices within [`CREASE`] times the radius of the limb at the joint
//! (armpit, elbow pit, groin, knee pit) are left out. At elbow and knee the flesh beyond them meets
//! too when the limb closes; that depth is a *fold* and has a limit of its own. Head and trunk are
//! not compared.
//!
//! What happens within the creases is measured too, and reported apart: a hip bent by 90 degrees
//! folds the groin by 2 to 5 cm, the more so the heavier the body. No other pose avoids that, so it
//! has no limit.

use std::ops::RangeInclusive;

use garnet_knn::Surface;
use garnet_mesh::{Vector3, vertex_normals};
use garnet_skin::{Body, Method, Point3, Pose, SkinError};
use rayon::prelude::*;

use super::parts::{ClosedPart, Part, parts_of_vertices};
use crate::motion::{Figure, RetargetError, Role};

/// Radius of a crease in radii of the limb at its joint.
const CREASE: f32 = 1.35;

/// Of meshes with twice as many vertices, or more, only every second or so is tested.
const ENOUGH_VERTICES: usize = 15_000;

/// Room for cloth between an arm and what is beside it, in metres: two layers that keep the
/// clearance to both sides. Tried: 0 to 40 mm (docs/experiments/063).
const ROOM: f32 = 0.012;

/// Edges of the skin, in parts of their length, by which coarse skin and cloth bulge between their
/// corners.
const BULGE: f64 = 0.5;

/// Lengths of legs of grown bodies, in metres. Depths of others are in proportion.
const GROWN: RangeInclusive<f32> = 0.55..=1.2;

/// What two parts that run into each other mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactKind {
    /// One part runs into another.
    Contact,
    /// The flesh of a limb that closes at elbow or knee meets beyond the crease.
    Fold,
    /// Skin folds within the crease of the joint that the parts share: every bend does that.
    Crease,
}

/// Two parts that run into each other, at the deepest place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The part whose vertex lies inside the other, and the other.
    pub parts: [Part; 2],
    /// How deep, in metres.
    pub depth: f32,
    /// What it means.
    pub kind: ContactKind,
    /// The vertex of the body.
    pub vertex: u32,
    /// Where it is.
    pub position: Point3,
    /// The nearest point on the other's skin.
    pub exit: Point3,
    /// A body vertex at that point.
    pub exit_vertex: u32,
    /// Corners of the face of the body at that point, and the share that each has in it.
    pub exit_corners: [(u32, f32); 3],
}

/// All contacts of a posed body.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct ContactReport {
    /// The deepest place of each part inside each other part, where there is one.
    pub contacts: Vec<Contact>,
}

impl ContactReport {
    /// The largest depth of parts that run into each other, in metres.
    pub fn depth(&self) -> f32 {
        self.deepest(ContactKind::Contact)
    }

    /// The largest depth of a fold at elbow or knee, in metres.
    pub fn fold_depth(&self) -> f32 {
        self.deepest(ContactKind::Fold)
    }

    /// The largest depth within the crease of a joint, in metres.
    pub fn crease_depth(&self) -> f32 {
        self.deepest(ContactKind::Crease)
    }

    fn deepest(&self, kind: ContactKind) -> f32 {
        let contacts = self.contacts.iter().filter(|contact| contact.kind == kind);
        contacts.map(|contact| contact.depth).fold(0.0, f32::max)
    }
}

/// A body cut into parts, ready to be asked about poses.
#[derive(Debug, Clone)]
pub struct SelfContact {
    body: Body,
    figure: Figure,
    parts: Vec<ClosedPart>,
    surfaces: Vec<Surface>,
    pairs: Vec<Pair>,
}

/// A part whose vertices are tested against another.
#[derive(Debug, Clone)]
struct Pair {
    tested: usize,
    within: usize,
    kind: ContactKind,
    /// Vertices of the tested part, by their number in it.
    vertices: Vec<u32>,
    /// What share of the room for cloth between the two each of them is to leave; empty if there
    /// is none between them.
    rooms: Vec<f32>,
}

impl SelfContact {
    /// Cuts a body into parts.
    ///
    /// # Errors
    ///
    /// [`RetargetError`] if its skeleton is no human figure.
    pub fn new(body: &Body) -> Result<Self, RetargetError> {
        let figure = Figure::new(body.skeleton(), "the body")?;
        let of_vertices = parts_of_vertices(body)?;
        let cut = Part::ALL.into_iter();
        let parts: Vec<ClosedPart> = cut
            .filter_map(|part| ClosedPart::new(body, &of_vertices, part))
            .collect();
        let surfaces = parts.iter().map(|part| Surface::new(&part.mesh)).collect();
        let mut pairs = Vec::new();
        for tested in 0..parts.len() {
            for within in 0..parts.len() {
                pairs.extend(pairs_of(body, &figure, &parts, tested, within));
            }
        }
        Ok(Self {
            body: body.clone(),
            figure,
            parts,
            surfaces,
            pairs,
        })
    }

    /// The body whose parts may touch.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// How many times as large as a grown one the body is: 1 for all grown ones, less for dolls and
    /// more for giants. Depths in [`SeparationOptions`](super::SeparationOptions) are those of
    /// grown bodies.
    pub fn scale(&self) -> f32 {
        let leg = self.figure.leg_length() as f32;
        leg / leg.clamp(*GROWN.start(), *GROWN.end())
    }

    /// The room that a motion is to leave for cloth between arms and what is beside them, in metres
    /// of a grown body; more on coarse bodies.
    pub fn room_for_cloth(&self) -> f32 {
        let rest = self.body.rest();
        let corners = rest
            .faces()
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let edges = corners.map(|ends| {
            let [a, b] = ends.map(|end| rest.positions()[end as usize]);
            f64::from((b - a).norm())
        });
        let mean = edges.sum::<f64>() / (3 * rest.num_faces()).max(1) as f64;
        ROOM + (BULGE * mean) as f32 / self.scale()
    }

    pub(super) fn figure(&self) -> &Figure {
        &self.figure
    }

    /// The deepest of each of many contacts `[pair]`.
    pub(super) fn report_of_all(all: &[Vec<Contact>]) -> ContactReport {
        let deepest = |contacts: &Vec<Contact>| {
            let first = contacts.first().copied()?;
            let deeper = |a: Contact, b: &Contact| if b.depth > a.depth { *b } else { a };
            Some(contacts.iter().fold(first, deeper))
        };
        ContactReport {
            contacts: all.iter().filter_map(deepest).collect(),
        }
    }

    /// The contacts in a pose.
    ///
    /// # Errors
    ///
    /// Those of [`garnet_skin::Skeleton::transforms`].
    pub fn report(&self, pose: &Pose) -> Result<ContactReport, SkinError> {
        self.report_with_room(pose, 0.0)
    }

    /// The contacts in a pose, of arms with trunk and thighs from `room` metres outside of the
    /// skin.
    pub(super) fn report_with_room(
        &self,
        pose: &Pose,
        room: f32,
    ) -> Result<ContactReport, SkinError> {
        let positions = self.body.posed_positions(pose, Method::DualQuaternion)?;
        self.deepest_at(&positions, room)
    }

    /// The contacts at positions `[vertex]` of the body.
    ///
    /// # Errors
    ///
    /// [`SkinError::TargetCount`] or [`SkinError::Knn`].
    pub fn report_of(&self, positions: &[Point3]) -> Result<ContactReport, SkinError> {
        self.deepest_at(positions, 0.0)
    }

    fn deepest_at(&self, positions: &[Point3], room: f32) -> Result<ContactReport, SkinError> {
        let surfaces = self.surfaces_at(positions)?;
        let out = if room > 0.0 {
            let mut normals = vertex_normals(positions, self.body.rest().faces());
            for normal in &mut normals {
                *normal *= room;
            }
            normals
        } else {
            Vec::new()
        };
        let contacts = self.pairs.par_iter().map(|pair| {
            let mut deepest: Option<Contact> = None;
            self.visit(pair, &surfaces, &out, |contact| {
                if deepest.is_none_or(|deepest| deepest.depth < contact.depth) {
                    deepest = Some(contact);
                }
            });
            deepest
        });
        let contacts: Vec<Option<Contact>> = contacts.collect();
        Ok(ContactReport {
            contacts: contacts.into_iter().flatten().collect(),
        })
    }

    /// All vertices of a part inside another one, in a pose, of each two parts `[pair]`.
    pub(super) fn all_contacts(&self, pose: &Pose) -> Result<Vec<Vec<Contact>>, SkinError> {
        let positions = self.body.posed_positions(pose, Method::DualQuaternion)?;
        let surfaces = self.surfaces_at(&positions)?;
        let contacts = self.pairs.par_iter().map(|pair| {
            let mut all = Vec::new();
            self.visit(pair, &surfaces, &[], |contact| all.push(contact));
            all
        });
        Ok(contacts.collect())
    }

    /// The skin of each part `[part]` where the vertices of the body are at `positions`.
    fn surfaces_at(&self, positions: &[Point3]) -> Result<Vec<Surface>, SkinError> {
        let expected = self.body.rest().num_vertices();
        if positions.len() != expected {
            let found = positions.len();
            return Err(SkinError::TargetCount { found, expected });
        }
        let moved = self.surfaces.par_iter().zip(&self.parts);
        let moved = moved.map(|(surface, part)| surface.moved(part.gather(positions)));
        let surfaces: Result<Vec<Surface>, _> = moved.collect();
        Ok(surfaces?)
    }

    /// Visits the vertices of a part inside another one; where there is room for cloth between the
    /// two, those that are once they went `out` `[body vertex]`, if that is not empty.
    fn visit(
        &self,
        pair: &Pair,
        surfaces: &[Surface],
        out: &[Vector3],
        mut found: impl FnMut(Contact),
    ) {
        let (tested, within) = (&self.parts[pair.tested], &self.parts[pair.within]);
        let surface = &surfaces[pair.within];
        let (low, high) = surface.bounds();
        let (other_low, other_high) = surfaces[pair.tested].bounds();
        let rooms = if out.is_empty() {
            &[]
        } else {
            pair.rooms.as_slice()
        };
        let reach = out
            .first()
            .filter(|_| !rooms.is_empty())
            .map_or(0.0, Vector3::norm);
        let is_apart = |axis: usize| {
            low[axis] > other_high[axis] + reach || high[axis] < other_low[axis] - reach
        };
        if (0..3).any(is_apart) {
            return;
        }
        let positions = surfaces[pair.tested].positions();
        let mut hint = u32::MAX;
        for (number, &vertex) in pair.vertices.iter().enumerate() {
            let mut position = positions[vertex as usize];
            if let Some(&share) = rooms.get(number) {
                position += out[tested.vertices[vertex as usize] as usize] * share;
            }
            let is_near = (0..3).all(|axis| (low[axis]..=high[axis]).contains(&position[axis]));
            if !is_near || surface.winding_number(position) <= 0 {
                continue;
            }
            let is_skin = |face: u32| face < within.num_skin_faces;
            let Some(closest) = surface.closest_where_from(position, f32::INFINITY, hint, is_skin)
            else {
                continue;
            };
            hint = closest.face;
            let depth = closest.distance_squared.sqrt();
            let corners = surface.faces()[closest.face as usize];
            let of_body =
                |corner: u32| (within.vertices.get(corner as usize).copied()).unwrap_or_default();
            let shares = closest.barycentric;
            found(Contact {
                parts: [tested.part, within.part],
                depth,
                kind: pair.kind,
                vertex: tested.vertices[vertex as usize],
                position,
                exit: closest.point,
                exit_vertex: of_body(corners[0]),
                exit_corners: [0, 1, 2].map(|corner| (of_body(corners[corner]), shares[corner])),
            });
        }
    }
}

/// What of a part is tested against another: nothing for head and trunk, the vertices near the
/// joint and the others apart for neighbors.
fn pairs_of(
    body: &Body,
    figure: &Figure,
    parts: &[ClosedPart],
    tested: usize,
    within: usize,
) -> Vec<Pair> {
    let (a, b) = (parts[tested].part, parts[within].part);
    let is_neck = matches!(
        (a, b),
        (Part::Head, Part::Trunk) | (Part::Trunk, Part::Head)
    );
    if tested == within || is_neck {
        return Vec::new();
    }
    // Of two neighbors the one farther from the trunk has the joint.
    let below = if a.parent() == Some(b) {
        Some(tested)
    } else if b.parent() == Some(a) {
        Some(within)
    } else {
        None
    };
    let crease = below.and_then(|below| {
        let joint = figure.joint(parts[below].part.joint()?)?;
        let center = body.skeleton().joints()[joint].rest_position;
        Some((center, CREASE * parts[below].border_radius(center)))
    });
    let hinge = below.and_then(|below| parts[below].part.joint());
    let part = &parts[tested];
    let in_crease = |vertex: &u32| {
        let position = part.mesh.positions()[*vertex as usize];
        crease.is_some_and(|(center, radius)| (position - center).norm() < radius)
    };
    // Of fine meshes some vertices tell how deep all are.
    let stride = (body.rest().num_vertices() / ENOUGH_VERTICES).max(1);
    let own = (0..part.vertices.len() as u32).step_by(stride);
    let own = own.filter(|&vertex| part.is_own[vertex as usize]);
    let (near, far): (Vec<u32>, Vec<u32>) = own.partition(in_crease);
    let kind = match hinge {
        Some(Role::Elbow(_) | Role::Knee(_)) => ContactKind::Fold,
        _ => ContactKind::Contact,
    };
    let pairs = [(kind, far), (ContactKind::Crease, near)];
    let pairs = pairs
        .into_iter()
        .filter(|(_, vertices)| !vertices.is_empty());
    let pairs = pairs.map(|(kind, vertices)| Pair {
        rooms: if kind == ContactKind::Contact && has_room(a, b) {
            let place = |&vertex: &u32| part.mesh.positions()[vertex as usize];
            vertices
                .iter()
                .map(|vertex| room_at(place(vertex), crease))
                .collect()
        } else {
            Vec::new()
        },
        tested,
        within,
        kind,
        vertices,
    });
    pairs.collect()
}

/// Whether cloth lies between two parts: arms beside the trunk and the thighs.
fn has_room(a: Part, b: Part) -> bool {
    let is_arm = |part| matches!(part, Part::UpperArm(_) | Part::Forearm(_));
    let is_beside = |part| matches!(part, Part::Trunk | Part::Thigh(_));
    (is_arm(a) && is_beside(b)) || (is_beside(a) && is_arm(b))
}

/// What share of the room for cloth there is at a place at rest: none at the rim of the crease of
/// the joint that the parts share, all of it twice as far from there.
fn room_at(place: Point3, crease: Option<(Point3, f32)>) -> f32 {
    crease.map_or(1.0, |(center, radius)| {
        ((place - center).norm() / radius - 1.0).clamp(0.0, 1.0)
    })
}
