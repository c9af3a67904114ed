//! The parts of a body: trunk, head, upper arms, forearms with hands, thighs, shanks with feet.
//!
//! A vertex belongs to the part of its heaviest joint, a face to the part of most of its corners.
//! The skin of a part is open where it meets its neighbors; a fan of faces around the middle of
//! each opening closes it. Neighbors share the fan, so that the parts fill the body at rest without
//! overlap.

use std::collections::BTreeMap;

use garnet_mesh::TriMesh;
use garnet_skin::{Body, Point3, Vector3};

use crate::motion::{Figure, RetargetError, Role, Side};

/// A part of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Part {
    /// Pelvis, spine, shoulders and neck.
    Trunk,
    /// The head.
    Head,
    /// From shoulder to elbow.
    UpperArm(Side),
    /// From elbow to fingertips.
    Forearm(Side),
    /// From hip to knee.
    Thigh(Side),
    /// From knee to toes.
    Shank(Side),
}

impl Part {
    /// All parts of a body.
    pub const ALL: [Self; 10] = [
        Self::Trunk,
        Self::Head,
        Self::UpperArm(Side::Left),
        Self::UpperArm(Side::Right),
        Self::Forearm(Side::Left),
        Self::Forearm(Side::Right),
        Self::Thigh(Side::Left),
        Self::Thigh(Side::Right),
        Self::Shank(Side::Left),
        Self::Shank(Side::Right),
    ];

    /// The joint that the part hangs on; none for the trunk.
    pub const fn joint(self) -> Option<Role> {
        match self {
            Self::Trunk => None,
            Self::Head => Some(Role::Head),
            Self::UpperArm(side) => Some(Role::Shoulder(side)),
            Self::Forearm(side) => Some(Role::Elbow(side)),
            Self::Thigh(side) => Some(Role::Hip(side)),
            Self::Shank(side) => Some(Role::Knee(side)),
        }
    }

    /// The part that it hangs on.
    pub const fn parent(self) -> Option<Self> {
        match self {
            Self::Trunk => None,
            Self::Head | Self::UpperArm(_) | Self::Thigh(_) => Some(Self::Trunk),
            Self::Forearm(side) => Some(Self::UpperArm(side)),
            Self::Shank(side) => Some(Self::Thigh(side)),
        }
    }
}

/// The part of each vertex `[vertex]` of a body: that of its heaviest joint.
///
/// # Errors
///
/// [`RetargetError`] if its skeleton is no human figure.
pub fn parts_of_vertices(body: &Body) -> Result<Vec<Part>, RetargetError> {
    let figure = Figure::new(body.skeleton(), "the body")?;
    let of_joints = parts_of_joints(body, &figure);
    let vertices = 0..body.rest().num_vertices();
    Ok(vertices
        .map(|vertex| of_joints[body.weights().heaviest(vertex)])
        .collect())
}

/// The part of each joint `[joint]`: that of the nearest joint above it that a part hangs on.
fn parts_of_joints(body: &Body, figure: &Figure) -> Vec<Part> {
    let skeleton = body.skeleton();
    let mut parts = vec![Part::Trunk; skeleton.num_joints()];
    for &index in skeleton.parents_first() {
        let own = Part::ALL
            .into_iter()
            .find(|part| part.joint().and_then(|role| figure.joint(role)) == Some(index));
        let inherited = skeleton.joints()[index].parent.map(|parent| parts[parent]);
        parts[index] = own.or(inherited).unwrap_or(Part::Trunk);
    }
    parts
}

/// A closed part of a body.
#[derive(Debug, Clone)]
pub(super) struct ClosedPart {
    pub(super) part: Part,
    /// Body vertex of each vertex of the part that lies on the skin.
    pub(super) vertices: Vec<u32>,
    /// Whether a vertex of `vertices` is counted to this part: those of a border face may belong to
    /// the neighbor.
    pub(super) is_own: Vec<bool>,
    /// Vertices of the part around each opening.
    openings: Vec<Vec<u32>>,
    /// The rest mesh: `vertices`, then the middle of each opening.
    pub(super) mesh: TriMesh,
    /// Faces that lie on the skin; the fans follow.
    pub(super) num_skin_faces: u32,
}

impl ClosedPart {
    /// Cuts a part out of a body; none if it has no face.
    pub(super) fn new(body: &Body, parts: &[Part], part: Part) -> Option<Self> {
        let rest = body.rest();
        // Seams of textures are closed in the skin.
        let skin_faces = body.skin().faces();
        let is_of_part = |face: &[u32; 3]| {
            // Of faces that lie on others the skin keeps a point.
            if face[0] == face[1] && face[1] == face[2] {
                return false;
            }
            let count = face
                .iter()
                .filter(|&&vertex| parts[vertex as usize] == part)
                .count();
            count >= 2 || count == 1 && all_differ(face, parts) && parts[face[0] as usize] == part
        };
        let mut local: BTreeMap<u32, u32> = BTreeMap::new();
        let mut vertices = Vec::new();
        let mut faces: Vec<[u32; 3]> = Vec::new();
        for face in skin_faces.iter().filter(|face| is_of_part(face)) {
            faces.push(face.map(|vertex| {
                *local.entry(vertex).or_insert_with(|| {
                    vertices.push(vertex);
                    vertices.len() as u32 - 1
                })
            }));
        }
        if faces.is_empty() {
            return None;
        }
        let num_skin_faces = faces.len() as u32;
        let openings = close(&mut faces, vertices.len() as u32);
        let mut positions: Vec<Point3> = vertices
            .iter()
            .map(|&vertex| rest.positions()[vertex as usize])
            .collect();
        append_middles(&mut positions, &openings);
        let is_own = vertices
            .iter()
            .map(|&vertex| parts[vertex as usize] == part)
            .collect();
        Some(Self {
            part,
            vertices,
            is_own,
            openings,
            mesh: TriMesh::new(positions, faces).ok()?,
            num_skin_faces,
        })
    }

    /// Positions of the part's own vertices out of those of the body.
    pub(super) fn gather(&self, body_positions: &[Point3]) -> Vec<Point3> {
        let own = self.vertices.iter();
        let mut positions: Vec<Point3> =
            own.map(|&vertex| body_positions[vertex as usize]).collect();
        append_middles(&mut positions, &self.openings);
        positions
    }

    /// The largest distance from `joint` to the border of the part, at rest.
    pub(super) fn border_radius(&self, joint: Point3) -> f32 {
        let border = self.openings.iter().map(|opening| {
            let distances = opening
                .iter()
                .map(|&vertex| (self.mesh.positions()[vertex as usize] - joint).norm());
            distances.fold(0.0, f32::max)
        });
        // A part has an opening at each end: the near one is meant.
        border.fold(f32::INFINITY, f32::min)
    }
}

fn all_differ(face: &[u32; 3], parts: &[Part]) -> bool {
    let [a, b, c] = face.map(|vertex| parts[vertex as usize]);
    a != b && b != c && a != c
}

fn append_middles(positions: &mut Vec<Point3>, openings: &[Vec<u32>]) {
    for opening in openings {
        let sum: Vector3 = opening
            .iter()
            .map(|&vertex| positions[vertex as usize].coords)
            .sum();
        positions.push(Point3::from(sum / opening.len().max(1) as f32));
    }
}

/// Adds a fan of faces for each piece of the border around a new vertex, from number `next` on;
/// returns the vertices of each piece.
fn close(faces: &mut Vec<[u32; 3]>, next: u32) -> Vec<Vec<u32>> {
    let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for &[a, b, c] in faces.iter() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (key, sign) = if from < to {
                ((from, to), 1)
            } else {
                ((to, from), -1)
            };
            *edges.entry(key).or_default() += sign;
        }
    }
    let mut border: Vec<(u32, u32)> = Vec::new();
    for (&(low, high), &times) in &edges {
        let edge = if times > 0 { (low, high) } else { (high, low) };
        border.extend(std::iter::repeat_n(edge, times.unsigned_abs() as usize));
    }
    let mut piece_of: BTreeMap<u32, u32> = BTreeMap::new();
    for &(a, b) in &border {
        let root = |piece_of: &BTreeMap<u32, u32>, mut vertex: u32| {
            while let Some(&up) = piece_of.get(&vertex).filter(|&&up| up != vertex) {
                vertex = up;
            }
            vertex
        };
        let (ra, rb) = (root(&piece_of, a), root(&piece_of, b));
        let low = ra.min(rb);
        for vertex in [a, b, ra, rb] {
            piece_of.insert(vertex, low);
        }
    }
    let mut openings: Vec<Vec<u32>> = Vec::new();
    let mut number_of: BTreeMap<u32, usize> = BTreeMap::new();
    let vertices: Vec<u32> = piece_of.keys().copied().collect();
    let root = |mut vertex: u32| {
        while let Some(&up) = piece_of.get(&vertex).filter(|&&up| up != vertex) {
            vertex = up;
        }
        vertex
    };
    for vertex in vertices {
        let number = *number_of.entry(root(vertex)).or_insert_with(|| {
            openings.push(Vec::new());
            openings.len() - 1
        });
        openings[number].push(vertex);
    }
    for (a, b) in border {
        let middle = next + number_of.get(&root(a)).copied().unwrap_or(0) as u32;
        faces.push([b, a, middle]);
    }
    openings
}
