//! Which skin a draped garment lies on.

use crate::contact::contacts::{Contacts, Hold};
use crate::contact::skin::Skin;
use crate::xpbd::particles::Particles;
use crate::{Cloth, Point3};

/// What the production solver holds the vertices of a garment with, followed to where another
/// solver takes them.
#[derive(Debug)]
pub(crate) struct Grounds<'a> {
    cloth: &'a Cloth,
    skin: &'a Skin,
    contacts: Contacts,
    holds: Vec<[Option<Hold>; 2]>,
}

/// Vertices so far from the skin are told of it, in metres: another solver may take them there at
/// once.
const BAND: f32 = 0.05;

/// Skin is around a place if the cosine of the angle between the normals is above this.
const AROUND: f32 = 0.2;

impl<'a> Grounds<'a> {
    /// `contacts` are those at the end of a run on `skin`.
    pub(crate) fn new(cloth: &'a Cloth, skin: &'a Skin, mut contacts: Contacts) -> Self {
        contacts.wear.reach.band = BAND;
        Self {
            holds: vec![[None; 2]; cloth.num_vertices()],
            cloth,
            skin,
            contacts,
        }
    }

    /// Follows the vertices to `positions` `[vertex]`: each stays on the skin that it is on.
    pub(crate) fn follow(&mut self, positions: &[Point3]) {
        let particles = Particles::new(self.cloth, positions);
        self.contacts
            .look(self.skin, self.cloth.faces(), &particles);
        for (vertex, &position) in positions.iter().enumerate() {
            self.holds[vertex] = self.contacts.follow(vertex, position, self.skin);
        }
    }

    /// The skin.
    pub(crate) fn skin(&self) -> &'a Skin {
        self.skin
    }

    /// Whether a face is of the skin that holds a vertex, or of that around it.
    pub(crate) fn is_under(&self, vertex: usize, face: u32) -> bool {
        let normal = self.skin.face_normal(face);
        let mut holds = self.holds[vertex].iter().flatten();
        self.skin.is_allowed(face, self.contacts.wear.masks[vertex])
            && holds.any(|hold| hold.near.normal.dot(&normal) > AROUND)
    }

    /// Whether a vertex is caught between two parts of the body.
    pub(crate) fn is_caught(&self, vertex: usize) -> bool {
        self.contacts.is_squeezed[vertex]
    }

    /// What the friction of the fabric is multiplied by at a vertex.
    pub(crate) fn grip(&self, vertex: usize) -> f32 {
        let grip = self.contacts.wear.grips[vertex];
        if grip > 0.0 { grip } else { 1.0 }
    }
}
