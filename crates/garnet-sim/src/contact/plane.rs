//! Contacts as planes that move with the skin.

use crate::Vector3;
use crate::xpbd::particles::Particles;
use crate::xpbd::quad::Quad;

/// A vertex that has to stay in front of a plane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    pub(crate) vertex: u32,
    brake: Brake,
    /// Unit normal away from the skin; the fourth number is the least normal component that the
    /// vertex's offset may have, m.
    normal: Quad,
    /// Displacement of the skin a substep, m; the fourth number is what the least component grows
    /// by.
    drift: Quad,
}

/// What makes a plane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlaneOptions {
    pub(crate) vertex: u32,
    /// Unit normal away from the skin.
    pub(crate) normal: Vector3,
    /// How far the vertex is from the skin, negative behind it, m.
    pub(crate) distance: f32,
    /// How far it has to be, m.
    pub(crate) clearance: f32,
    /// Displacement of the skin a substep, m.
    pub(crate) drift: Vector3,
    /// The plane comes out of the skin by no more than this a substep, m.
    pub(crate) max_rise: f32,
    pub(crate) brake: Brake,
}

/// What slows a vertex down that slides along the skin.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Brake {
    /// Coulomb's, with this coefficient.
    Friction(f32),
    /// The vertex loses this share of its travel a substep: two planes that press a vertex from
    /// both sides say nothing about the force.
    Drag(f32),
}

impl Plane {
    /// The same for a vertex by another number.
    pub(crate) fn renamed(self, vertex: u32) -> Self {
        Self { vertex, ..self }
    }

    /// A plane for a vertex with an offset of zero.
    ///
    /// Where the vertex is too near or behind the skin, the plane starts at it and rises to the
    /// clearance, so that no vertex is thrown.
    pub(crate) fn new(options: &PlaneOptions) -> Self {
        let missing = options.clearance - options.distance;
        let (least, rise) = if missing > 0.0 {
            (0.0, options.max_rise)
        } else {
            (missing, 0.0)
        };
        Self {
            vertex: options.vertex,
            brake: options.brake,
            normal: Quad::new(options.normal, least),
            drift: Quad::new(options.drift, options.normal.dot(&options.drift) + rise),
        }
    }
}

/// Pushes vertices in front of their planes and brakes their sliding.
///
/// `substep` counts from the refresh that made the planes. Friction: a vertex that was pushed by p
/// keeps no tangential displacement against the skin up to μ p, and loses μ p beyond.
#[inline(never)]
pub(crate) fn project(planes: &[Plane], particles: &mut Particles, substep: f32) {
    for plane in planes {
        let vertex = plane.vertex as usize;
        let offset = particles.offsets[vertex];
        let least = plane.normal.0[3] + substep * plane.drift.0[3];
        let push = least - plane.normal.dot3(offset);
        if push <= 0.0 && matches!(plane.brake, Brake::Friction(_)) {
            continue;
        }
        let push = push.max(0.0);
        let normal = plane.normal.vector();
        let pushed = offset + normal * push;
        let against_skin = pushed - particles.last[vertex] - plane.drift.vector();
        let sliding = against_skin - normal * normal.dot3(against_skin);
        let squared = sliding.dot3(sliding);
        let share = match plane.brake {
            Brake::Drag(share) => share,
            Brake::Friction(coefficient) => {
                let grip = coefficient * push;
                if squared <= grip * grip {
                    1.0
                } else {
                    grip / squared.sqrt()
                }
            }
        };
        particles.offsets[vertex] = pushed - sliding * share;
    }
}
