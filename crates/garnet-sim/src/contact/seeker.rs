//! Finds the skin under a vertex.
//!
//! A vertex near the skin has its *own* skin: the place that it reached by walking over the skin
//! from the place before. Where limbs come near each other or run through each other, the nearest
//! skin changes from one limb to the next; own skin does not, so cloth is not torn to both sides or
//! pulled through. Own skin is under the cloth: both look to the same side. A second place, the
//! *other* skin, is what comes near from another side.

use crate::contact::skin::{Foot, Skin, unit};
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
    /// Other skin holds vertices that are no deeper in it than this.
    pub(crate) other_depth: f32,
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
            other_depth: 0.02,
        }
    }
}

/// Two skins, or cloth and skin, look to opposite sides if the cosine of the angle between their
/// normals is below this.
pub(crate) const FACING: f32 = -0.3;

/// Below this distance the direction from skin to vertex is rounding, m.
const TOUCHING: f32 = 1e-4;

/// No face.
pub(crate) const NONE: u32 = u32::MAX;

/// What is remembered of a vertex.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Track {
    own: u32,
    other: u32,
    /// Where the vertex was when the whole skin was last asked.
    asked_at: Point3,
    /// How far the skin had come then, m.
    skin_travel: f32,
    /// How far vertex and skin may come before the vertex can touch anything, m.
    slack: f32,
}

impl Track {
    /// A vertex that lies on a face, or [`NONE`].
    pub(crate) fn on(face: u32) -> Self {
        Self {
            own: face,
            other: NONE,
            asked_at: Point3::origin(),
            skin_travel: 0.0,
            slack: 0.0,
        }
    }

    /// A face that is near vertices around this one, if one is known.
    pub(crate) fn hint(&self) -> u32 {
        self.own
    }

    /// Whether the vertex cannot have come near any skin since the skin was asked.
    pub(crate) fn is_free(&self, point: Point3, skin: &Skin) -> bool {
        let is_carried = skin.is_moving() && self.own != NONE;
        !is_carried
            && (point - self.asked_at).norm() + (skin.travel() - self.skin_travel) < self.slack
    }
}

/// A place on the skin, seen from a vertex.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Near {
    pub(crate) foot: Foot,
    /// Unit vector away from the skin.
    pub(crate) normal: Vector3,
    /// Negative behind the skin, m.
    pub(crate) distance: f32,
}

/// Looks for skin from one vertex.
#[derive(Debug)]
pub(crate) struct Seeker<'a> {
    pub(crate) skin: &'a Skin,
    pub(crate) reach: &'a Reach,
    pub(crate) point: Point3,
    /// The parts that the vertex may touch.
    pub(crate) mask: u32,
    /// Unit normal of the cloth to its outside; zero if it has none.
    pub(crate) outward: Vector3,
    /// A face that may be near, if own skin is not known.
    pub(crate) hint: u32,
}

impl Seeker<'_> {
    /// The nearest allowed skin that `accept` takes, no farther than a bound.
    pub(crate) fn nearest(
        &self,
        bound: f32,
        hint: u32,
        accept: impl Fn(u32) -> bool,
    ) -> Option<Foot> {
        let accept = |face: u32| self.skin.is_allowed(face, self.mask) && accept(face);
        let surface = self.skin.surface();
        let closest = surface.closest_where_from(self.point, bound, hint, accept)?;
        Some(self.skin.foot_on(closest.face, self.point))
    }

    /// Takes the face that may be near for that which the vertex was taken to lie on, if it is
    /// nearer: the way from there is shorter.
    pub(crate) fn guess(&self, track: &mut Track) {
        let to = |face: u32| {
            let corner = self.skin.surface().faces()[face as usize][0];
            (self.skin.surface().positions()[corner as usize] - self.point).norm_squared()
        };
        let is_known = self.hint != NONE && track.own != NONE;
        if is_known && self.skin.is_allowed(self.hint, self.mask) && to(self.hint) < to(track.own) {
            track.own = self.hint;
        }
    }

    /// The place that the vertex has come to on its own skin.
    ///
    /// Only if `is_turn` the whole skin is asked, unless own skin is far or not known.
    pub(crate) fn own(&self, track: &mut Track, is_turn: bool) -> Option<Near> {
        let (skin, reach) = (self.skin, self.reach);
        let walked = (track.own != NONE).then(|| skin.walk(self.point, track.own, self.mask));
        let mut near = walked.filter(|foot| foot.distance_squared < reach.near * reach.near);
        track.slack = 0.0;
        if let Some(near) = near
            && !is_turn
        {
            track.own = near.face;
            return Some(self.seen(near));
        }
        let mut bound = walked.map_or(reach.far, |foot| {
            foot.distance_squared.sqrt().min(reach.far)
        });
        if let Some(foot) = near
            && !self.is_under(unit(skin.smooth_normal(&foot)))
        {
            track.other = foot.face;
            near = None;
            bound = reach.far;
        }
        let hint = if track.own == NONE {
            self.hint
        } else {
            track.own
        };
        track.asked_at = self.point;
        track.skin_travel = skin.travel();
        let mut nearest = self.nearest(bound, hint, |_| true);
        let mut is_free = true;
        if let Some(foot) = nearest
            && !self.is_under(skin.face_normal(foot.face))
        {
            is_free = false;
            if self.is_before(&foot) {
                track.other = foot.face;
            }
            nearest = self.nearest(bound, hint, |face| self.is_under(skin.face_normal(face)));
        }
        let own = match (nearest, near) {
            (Some(nearest), Some(near)) if !self.is_same_skin(&nearest, &near) => {
                if self.is_before(&nearest) {
                    track.other = nearest.face;
                }
                is_free = false;
                Some(near)
            }
            (Some(nearest), _) => Some(nearest),
            (None, near) => near,
        };
        track.own = own.map_or(NONE, |foot| foot.face);
        let own = own.map(|foot| self.seen(foot));
        if is_free {
            let distance = own.map_or(bound, |near| near.distance);
            track.slack = distance - (reach.thickness + reach.band);
        }
        own
    }

    /// The place that faces the own skin, or that comes near from another side.
    ///
    /// It is looked for only if `is_turn`; in between it is followed.
    pub(crate) fn other(
        &self,
        track: &mut Track,
        own: Option<Near>,
        is_turn: bool,
    ) -> Option<Near> {
        let (skin, reach) = (self.skin, self.reach);
        if let Some(own) = own
            && is_turn
            && track.other == NONE
            && own.distance < reach.other + reach.thickness
        {
            let faces_own = |face: u32| {
                let normal = skin.face_normal(face);
                normal.dot(&own.normal) < FACING
                    && skin.foot_on(face, self.point).offset.dot(&normal) > -reach.thickness
            };
            let found = self.nearest(reach.other, NONE, faces_own);
            track.other = found.map_or(NONE, |foot| foot.face);
        }
        if track.other == NONE {
            return None;
        }
        let other = self.seen(skin.walk(self.point, track.other, self.mask));
        if other.foot.face == track.own || other.distance.abs() > reach.other {
            track.other = NONE;
            return None;
        }
        track.other = other.foot.face;
        track.slack = 0.0;
        Some(other)
    }

    /// Whether skin with this normal can be what the cloth lies on.
    fn is_under(&self, normal: Vector3) -> bool {
        self.outward.dot(&normal) > FACING
    }

    /// Whether the vertex is in front of a place.
    fn is_before(&self, foot: &Foot) -> bool {
        foot.offset.dot(&self.skin.pseudonormal(foot)) > 0.0
    }

    /// Whether cloth can have slid from one place to the other.
    fn is_same_skin(&self, a: &Foot, b: &Foot) -> bool {
        let jump = self.reach.jump;
        a.face == b.face
            || ((a.point - b.point).norm_squared() < jump * jump
                && self.skin.smooth_normal(a).dot(&self.skin.smooth_normal(b)) > 0.0)
    }

    /// A place as the vertex sees it.
    fn seen(&self, foot: Foot) -> Near {
        let distance = foot.distance_squared.sqrt();
        let is_behind = foot.offset.dot(&self.skin.pseudonormal(&foot)) < 0.0;
        let normal = match (distance > TOUCHING, is_behind) {
            (false, _) => unit(self.skin.smooth_normal(&foot)),
            (true, false) => foot.offset / distance,
            (true, true) => -foot.offset / distance,
        };
        Near {
            foot,
            normal,
            distance: if is_behind { -distance } else { distance },
        }
    }
}
