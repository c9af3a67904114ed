//! Follows the skin under each vertex of the garment.
//!
//! A vertex near the skin has its *own* skin: the place that it reached by walking over the skin
//! from the place before. Where limbs come near each other or run through each other, the nearest
//! skin changes from one limb to the next; own skin does not, so cloth is not torn to both sides or
//! pulled through. A second place, the *other* skin, is what comes near from another direction. In a
//! gap narrower than twice the thickness cloth lies in the middle; where there is no gap left, it
//! stays on its own skin.

use crate::contact::plane::Plane;
use crate::contact::skin::{Foot, Skin, unit};
use crate::xpbd::particles::Particles;
use crate::{Point3, Vector3};

/// The distances that contact goes by, in metres.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reach {
    /// The distance that cloth keeps from skin.
    pub(crate) thickness: f32,
    /// Vertices this much farther out get a plane, because they may arrive before the next refresh.
    pub(crate) band: f32,
    /// Farther than this, skin is not looked for.
    pub(crate) far: f32,
    /// Nearer than this, own skin is kept.
    pub(crate) near: f32,
    /// Own skin may jump this far at once.
    pub(crate) jump: f32,
    /// Vertices deeper than this are not pushed out: the way out is unknown.
    pub(crate) depth: f32,
    /// Other skin is looked for up to this distance.
    pub(crate) other: f32,
}

impl Reach {
    pub(crate) fn of(thickness: f32) -> Self {
        Self {
            thickness,
            band: 0.012,
            far: 0.05,
            near: 0.02,
            jump: 0.03,
            depth: 0.04,
            other: 0.02,
        }
    }
}

/// Each vertex asks the whole skin at every so many refreshes; in between it walks.
const TURNS: u32 = 4;

/// Two skins face each other if the cosine of the angle between their normals is below this.
const FACING: f32 = -0.3;

/// Other skin holds vertices that are no deeper in it than this, m.
const OTHER_DEPTH: f32 = 0.01;

/// Where limbs run through each other cloth keeps this distance to its own, m.
const SQUEEZED: f32 = 5e-4;

/// Below this distance the direction from skin to vertex is rounding, m.
const TOUCHING: f32 = 1e-4;

const NONE: u32 = u32::MAX;

/// What is remembered of a vertex.
#[derive(Debug, Clone, Copy)]
struct Track {
    own: u32,
    other: u32,
    /// Where the vertex was when the whole skin was last asked.
    asked_at: Point3,
    /// How far the skin had come then, m.
    skin_travel: f32,
    /// How far vertex and skin may come before the vertex can touch anything, m.
    slack: f32,
}

/// Follows the skin under all vertices.
#[derive(Debug)]
pub(crate) struct Contacts {
    tracks: Vec<Track>,
    masks: Vec<u32>,
    reach: Reach,
    turn: u32,
    pub(crate) planes: Vec<Plane>,
}

/// A place on the skin, seen from a vertex.
#[derive(Debug, Clone, Copy)]
struct Near {
    foot: Foot,
    normal: Vector3,
    /// Negative behind the skin, m.
    distance: f32,
}

impl Contacts {
    /// `masks` says which parts each vertex may touch; 0 for vertices that touch none.
    pub(crate) fn new(masks: Vec<u32>, reach: Reach) -> Self {
        let track = Track {
            own: NONE,
            other: NONE,
            asked_at: Point3::origin(),
            skin_travel: 0.0,
            slack: 0.0,
        };
        Self {
            tracks: vec![track; masks.len()],
            planes: Vec::with_capacity(2 * masks.len()),
            masks,
            reach,
            turn: 0,
        }
    }

    /// Makes the planes anew for the skin as it is; substeps last `step` seconds.
    pub(crate) fn refresh(&mut self, skin: &Skin, particles: &Particles, step: f32) {
        self.planes.clear();
        self.turn = (self.turn + 1) % TURNS;
        for vertex in 0..self.tracks.len() {
            let mask = self.masks[vertex];
            let point = particles.position(vertex);
            let track = &self.tracks[vertex];
            let moved = (point - track.asked_at).norm() + (skin.travel() - track.skin_travel);
            if mask == 0 || moved < track.slack {
                continue;
            }
            let is_turn = vertex as u32 % TURNS == self.turn;
            let mut track = *track;
            track.slack = 0.0;
            let own = self.own_skin(skin, point, mask, is_turn, &mut track);
            let other = own.and_then(|own| {
                self.other_skin(skin, point, mask, is_turn.then_some(own), &mut track)
            });
            self.tracks[vertex] = track;
            let base = point;
            let mut add = |near: Near, clearance: f32| {
                let drift = skin.velocity(&near.foot) * step;
                self.planes.push(Plane::new(
                    vertex as u32,
                    base,
                    near.foot.point,
                    near.normal,
                    clearance,
                    drift,
                ));
            };
            let Reach {
                thickness,
                band,
                depth,
                ..
            } = self.reach;
            let is_held = |near: &Near, depth: f32| {
                near.distance < thickness + band && near.distance > -depth
            };
            let own = own.filter(|near| is_held(near, depth));
            let other = other.filter(|near| is_held(near, OTHER_DEPTH));
            match (own, other) {
                (Some(own), Some(other)) if own.normal.dot(&other.normal) < FACING => {
                    let gap = (other.foot.point - own.foot.point).dot(&own.normal);
                    if gap > 0.0 {
                        let clearance = thickness.min(0.5 * gap);
                        add(other, clearance);
                        add(own, clearance);
                    } else {
                        add(own, thickness.min(SQUEEZED));
                    }
                }
                (own, other) => {
                    for near in [other, own].into_iter().flatten() {
                        add(near, thickness);
                    }
                }
            }
        }
    }

    /// The place that the vertex reached on the skin that it lies on.
    fn own_skin(
        &self,
        skin: &Skin,
        point: Point3,
        mask: u32,
        is_turn: bool,
        track: &mut Track,
    ) -> Option<Near> {
        let reach = &self.reach;
        let walked = (track.own != NONE).then(|| skin.walk(point, track.own, mask));
        let near = walked.filter(|foot| foot.distance_squared < reach.near * reach.near);
        if let Some(near) = near
            && !is_turn
        {
            track.own = near.face;
            return Some(seen(skin, near));
        }
        let bound = walked.map_or(reach.far, |foot| {
            foot.distance_squared.sqrt().min(reach.far)
        });
        let is_allowed = |face| skin.is_allowed(face, mask);
        let surface = skin.surface();
        let nearest = surface.closest_where_from(point, bound, track.own, is_allowed);
        let nearest = nearest.map(|closest| skin.foot_on(closest.face, point));
        track.asked_at = point;
        track.skin_travel = skin.travel();
        match (nearest, near) {
            (None, None) => {
                track.own = NONE;
                track.slack = bound - (reach.thickness + reach.band);
                None
            }
            (None, Some(near)) => {
                track.own = near.face;
                Some(seen(skin, near))
            }
            (Some(nearest), Some(near)) if !self.is_same_skin(skin, &nearest, &near) => {
                track.own = near.face;
                if nearest.offset.dot(&skin.pseudonormal(&nearest)) > 0.0 {
                    track.other = nearest.face;
                }
                Some(seen(skin, near))
            }
            (Some(nearest), _) => {
                track.own = nearest.face;
                let seen = seen(skin, nearest);
                track.slack = seen.distance - (reach.thickness + reach.band);
                Some(seen)
            }
        }
    }

    /// Whether cloth can have slid from one place to the other.
    fn is_same_skin(&self, skin: &Skin, a: &Foot, b: &Foot) -> bool {
        let jump = self.reach.jump;
        a.face == b.face
            || ((a.point - b.point).norm_squared() < jump * jump
                && skin.smooth_normal(a).dot(&skin.smooth_normal(b)) > 0.0)
    }

    /// The place that faces the own skin, or that comes near from another side.
    fn other_skin(
        &self,
        skin: &Skin,
        point: Point3,
        mask: u32,
        search_from: Option<Near>,
        track: &mut Track,
    ) -> Option<Near> {
        if let Some(own) = search_from
            && track.other == NONE
            && own.distance < self.reach.other + self.reach.thickness
        {
            let faces_own = |face: u32| {
                let normal = skin.face_normal(face);
                skin.is_allowed(face, mask)
                    && normal.dot(&own.normal) < FACING
                    && skin.foot_on(face, point).offset.dot(&normal) > -self.reach.thickness
            };
            let surface = skin.surface();
            let found = surface.closest_where_from(point, self.reach.other, NONE, faces_own);
            track.other = found.map_or(NONE, |closest| closest.face);
        }
        if track.other == NONE {
            return None;
        }
        let other = seen(skin, skin.walk(point, track.other, mask));
        if other.foot.face == track.own || other.distance.abs() > self.reach.other {
            track.other = NONE;
            return None;
        }
        track.other = other.foot.face;
        track.slack = 0.0;
        Some(other)
    }
}

/// A place on the skin as the vertex sees it.
fn seen(skin: &Skin, foot: Foot) -> Near {
    let pseudonormal = skin.pseudonormal(&foot);
    let distance = foot.distance_squared.sqrt();
    let is_behind = foot.offset.dot(&pseudonormal) < 0.0;
    let normal = match (distance > TOUCHING, is_behind) {
        (false, _) => unit(skin.smooth_normal(&foot)),
        (true, false) => foot.offset / distance,
        (true, true) => -foot.offset / distance,
    };
    Near {
        foot,
        normal,
        distance: if is_behind { -distance } else { distance },
    }
}
