//! Contacts as planes that move with the skin.

use crate::xpbd::particles::Particles;
use crate::xpbd::quad::Quad;
use crate::{Point3, Vector3};

/// A vertex that has to stay in front of a plane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    pub(crate) vertex: u32,
    /// Unit normal away from the skin; the fourth number is the least normal component that the
    /// vertex's offset may have, m.
    normal: Quad,
    /// Displacement of the skin a substep, m; the fourth number is its normal component.
    drift: Quad,
}

/// What all contacts of a stage share.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactLaw {
    /// Coulomb's coefficient.
    pub(crate) friction: f32,
    /// No vertex gains velocity from being pushed out farther than this a substep, m.
    pub(crate) max_push: f32,
}

impl Plane {
    /// A plane at `clearance` metres over a point of the skin, which moves by `drift` metres a
    /// substep.
    pub(crate) fn new(
        vertex: u32,
        base: Point3,
        point: Point3,
        normal: Vector3,
        clearance: f32,
        drift: Vector3,
    ) -> Self {
        let least = normal.dot(&(point - base)) + clearance;
        Self {
            vertex,
            normal: Quad::new(normal, least),
            drift: Quad::new(drift, normal.dot(&drift)),
        }
    }
}

/// Pushes vertices in front of their planes and brakes their sliding.
///
/// `substep` counts from the refresh that made the planes. Friction: a vertex that was pushed by p
/// keeps no tangential displacement against the skin up to μ p, and loses μ p beyond.
pub(crate) fn project(planes: &[Plane], particles: &mut Particles, law: ContactLaw, substep: f32) {
    for plane in planes {
        let vertex = plane.vertex as usize;
        let offset = particles.offsets[vertex];
        let least = plane.normal.0[3] + substep * plane.drift.0[3];
        let push = least - plane.normal.dot3(offset);
        if push <= 0.0 {
            continue;
        }
        let normal = Quad([plane.normal.0[0], plane.normal.0[1], plane.normal.0[2], 0.0]);
        let drift = Quad([plane.drift.0[0], plane.drift.0[1], plane.drift.0[2], 0.0]);
        let excess = (push - law.max_push).max(0.0);
        let last = particles.last[vertex] + normal * excess;
        let pushed = offset + normal * push;
        let against_skin = pushed - last - drift;
        let sliding = against_skin - normal * normal.dot3(against_skin);
        let length_squared = sliding.dot3(sliding);
        let grip = law.friction * (push - excess);
        let share = if length_squared <= grip * grip {
            1.0
        } else {
            grip / length_squared.sqrt()
        };
        particles.offsets[vertex] = pushed - sliding * share;
        particles.last[vertex] = last;
    }
}
