//! The contacts of a garment between one refresh and the next.

use rayon::prelude::*;

use crate::contact::plane::{Brake, Plane, PlaneOptions};
use crate::contact::seeker::{FACING, NONE, Near, Reach, Seeker, Track};
use crate::contact::skin::{Skin, unit};
use crate::contact::unrest::Unrest;
use crate::xpbd::particles::Particles;
use crate::{Point3, Vector3};

/// Follows the skin under all vertices.
///
/// In a narrow gap between two skins cloth keeps a third of it to its own skin: a second layer has
/// room on the other side. Where limbs run through each other cloth lies near the middle of what
/// they share, as if both gave way. Where the skin is so crumpled that a vertex is pushed to and
/// fro, it is held instead.
#[derive(Debug, Clone)]
pub(crate) struct Contacts {
    tracks: Vec<Track>,
    unrest: Vec<Unrest>,
    pub(super) wear: Wear,
    pub(crate) planes: Vec<Plane>,
    /// Whether a vertex lies between two skins with no room for two layers of cloth, or is caught.
    pub(crate) is_squeezed: Vec<bool>,
}

/// What of the cloth counts where it is held `[vertex]`.
#[derive(Debug, Clone)]
pub(super) struct Wear {
    /// The parts of the skin that each vertex may touch.
    pub(super) masks: Vec<u32>,
    /// What friction is multiplied by at the vertices of ribs and waistbands; 0 at others.
    pub(super) grips: Vec<f32>,
    pub(super) reach: Reach,
    turn: u32,
    /// Whether tracks are what vertices are taken to lie on, before they were ever followed.
    is_guess: bool,
    /// 1 if the faces of the cloth look away from the skin, −1 if towards it, 0 if not yet known.
    orientation: f32,
    normals: Vec<Vector3>,
}

/// What is remembered of some vertices.
struct Share<'a> {
    first_vertex: usize,
    tracks: &'a mut [Track],
    unrest: &'a mut [Unrest],
    is_squeezed: &'a mut [bool],
}

/// Vertices whose skin is looked for by one thread at a time.
const CHUNK: usize = 256;

/// About so many vertices tell which way the cloth looks.
const VOTERS: usize = 500;

/// Each vertex asks the whole skin at every so many refreshes; in between it walks.
const TURNS: u32 = 4;

/// Between skins without room cloth lies so far from the middle, towards its own skin, m.
const LAYERS: f32 = 0.0015;

/// Inside another part of the body whose skin is not near cloth keeps this distance to its own, m.
const SQUEEZED: f32 = 5e-4;

/// Between two skins without room cloth loses velocity at this rate, 1/s: it is caught there.
const SQUEEZED_DRAG: f32 = 300.0;

/// The time from one refresh to the next.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Interval {
    /// Length of a substep, in seconds.
    pub(crate) step: f32,
    pub(crate) num_substeps: u32,
    /// Cloth behind the skin comes out at no more than this, m/s.
    pub(crate) max_push_speed: f32,
    /// Coefficient of friction of the fabric on skin, and the share of it that acts; ribs that grip
    /// keep all.
    pub(crate) friction: f32,
    pub(crate) friction_share: f32,
    /// Whether vertices near the skin may change to other skin than that which they can walk to.
    pub(crate) may_change: bool,
}

impl Interval {
    /// How far a plane rises in a substep so that a vertex comes out by `missing` metres, or as far
    /// as it may, until the next refresh.
    fn max_rise(self, missing: f32) -> f32 {
        (self.max_push_speed * self.step).min(missing.max(0.0) / self.num_substeps as f32)
    }

    fn drag(self) -> Brake {
        Brake::Drag(1.0 - (-SQUEEZED_DRAG * self.step).exp())
    }

    fn brake(self, grip: f32) -> Brake {
        Brake::Friction(if grip > 0.0 {
            grip * self.friction
        } else {
            self.friction_share * self.friction
        })
    }
}

/// A place that holds a vertex, and how far from the skin, in metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hold {
    pub(super) near: Near,
    pub(super) clearance: f32,
}

impl Contacts {
    /// `masks` says which parts each vertex may touch; 0 for vertices that touch none. `grips` is
    /// what friction is multiplied by at ribs and waistbands, 0 elsewhere; `likely_faces` are those
    /// that vertices lie on, if that is known.
    pub(crate) fn new(
        masks: Vec<u32>,
        grips: Vec<f32>,
        thickness: f32,
        likely_faces: Option<&[u32]>,
    ) -> Self {
        Self {
            tracks: match likely_faces {
                Some(faces) => faces.iter().map(|&face| Track::on(face)).collect(),
                None => vec![Track::on(NONE); masks.len()],
            },
            unrest: vec![Unrest::default(); masks.len()],
            planes: Vec::with_capacity(2 * masks.len()),
            is_squeezed: vec![false; masks.len()],
            wear: Wear {
                normals: Vec::new(),
                masks,
                grips,
                reach: Reach::of(thickness),
                turn: 0,
                is_guess: likely_faces.is_some(),
                orientation: 0.0,
            },
        }
    }

    /// Vertices were on these faces of the skin `[vertex]`, or on none.
    pub(crate) fn take_up(&mut self, faces: &[u32]) {
        self.tracks = faces.iter().map(|&face| Track::on(face)).collect();
        self.wear.is_guess = false;
    }

    /// The face of the skin that each vertex is on `[vertex]`, [`NONE`] for none.
    pub(crate) fn own_faces(&self) -> Vec<u32> {
        self.tracks.iter().map(Track::hint).collect()
    }

    /// Makes the planes anew for the skin as it is.
    pub(crate) fn refresh(
        &mut self,
        skin: &Skin,
        faces: &[[u32; 3]],
        particles: &Particles,
        interval: Interval,
    ) {
        self.look(skin, faces, particles);
        let wear = &self.wear;
        let tracks = self.tracks.par_chunks_mut(CHUNK);
        let unrest = self.unrest.par_chunks_mut(CHUNK);
        let is_squeezed = self.is_squeezed.par_chunks_mut(CHUNK);
        let chunks = tracks.zip(unrest).zip(is_squeezed).enumerate();
        let planes = chunks.map(|(chunk, ((tracks, unrest), is_squeezed))| {
            let share = Share {
                first_vertex: chunk * CHUNK,
                tracks,
                unrest,
                is_squeezed,
            };
            share.planes(wear, skin, particles, interval)
        });
        let planes: Vec<Vec<Plane>> = planes.collect();
        self.wear.is_guess = false;
        self.planes.clear();
        self.planes.extend(planes.into_iter().flatten());
    }

    /// Gets ready to say where vertices are held.
    pub(super) fn look(&mut self, skin: &Skin, faces: &[[u32; 3]], particles: &Particles) {
        self.wear.measure_normals(faces, particles);
        if self.wear.orientation == 0.0 {
            self.wear.orientation = self.wear.vote(skin, particles, &self.tracks);
        }
        self.wear.turn = (self.wear.turn + 1) % TURNS;
    }

    /// The places that hold a vertex at `point`, which stays on the skin that it is on; that of the
    /// own skin last.
    pub(super) fn follow(
        &mut self,
        vertex: usize,
        point: Point3,
        skin: &Skin,
    ) -> [Option<Hold>; 2] {
        let track = &mut self.tracks[vertex];
        self.wear.holds(vertex, point, skin, (track, NONE), false)
    }
}

impl Share<'_> {
    /// The planes that hold the vertices.
    fn planes(
        self,
        wear: &Wear,
        skin: &Skin,
        particles: &Particles,
        interval: Interval,
    ) -> Vec<Plane> {
        let mut planes = Vec::with_capacity(2 * self.tracks.len());
        let of_vertices = self
            .tracks
            .iter_mut()
            .zip(self.unrest)
            .zip(self.is_squeezed);
        let mut hint = NONE;
        for (place, ((track, unrest), is_squeezed)) in of_vertices.enumerate() {
            let vertex = self.first_vertex + place;
            let point = particles.position(vertex);
            *is_squeezed = false;
            if track.is_free(point, skin) {
                continue;
            }
            let holds = wear.holds(vertex, point, skin, (track, hint), interval.may_change);
            // The next vertex is one of those around.
            hint = track.hint();
            let thickness = wear.reach.thickness;
            let is_caught = holds[1].is_some_and(|Hold { near, .. }| {
                let moves = skin.velocity(&near.foot) != Vector3::zeros();
                unrest.is_caught(near.normal, moves)
            });
            let mut held = holds.iter().flatten();
            *is_squeezed = is_caught || held.any(|hold| hold.clearance < thickness);
            for Hold { near, clearance } in holds.into_iter().flatten() {
                let clearance = if is_caught {
                    clearance.min(near.distance)
                } else {
                    clearance
                };
                planes.push(Plane::new(&PlaneOptions {
                    vertex: vertex as u32,
                    normal: near.normal,
                    distance: near.distance,
                    clearance,
                    drift: skin.velocity(&near.foot) * interval.step,
                    max_rise: interval.max_rise(clearance - near.distance),
                    brake: if is_caught || clearance < thickness {
                        interval.drag()
                    } else {
                        interval.brake(wear.grips[vertex])
                    },
                }));
            }
        }
        planes
    }
}

impl Wear {
    /// The places that hold a vertex at `point`; that of the own skin last, because the last plane
    /// wins.
    fn holds(
        &self,
        vertex: usize,
        point: Point3,
        skin: &Skin,
        (track, hint): (&mut Track, u32),
        may_change: bool,
    ) -> [Option<Hold>; 2] {
        if self.masks[vertex] == 0 {
            return [None; 2];
        }
        let seeker = Seeker {
            skin,
            reach: &self.reach,
            point,
            mask: self.masks[vertex],
            outward: self.orientation * self.normals[vertex],
            hint,
        };
        if self.is_guess {
            seeker.guess(track);
        }
        let is_turn = may_change && vertex as u32 % TURNS == self.turn;
        let own = seeker.own(track, is_turn);
        let other = seeker.other(track, own, is_turn);
        holds(skin, &self.reach, own, other)
    }

    /// Which way the faces of most of the cloth near the skin look; 1 or −1.
    fn vote(&self, skin: &Skin, particles: &Particles, tracks: &[Track]) -> f32 {
        let stride = self.masks.len().div_ceil(VOTERS).max(1);
        let voters = (0..self.masks.len()).into_par_iter().step_by(stride);
        let votes = voters.map(|vertex| {
            let seeker = Seeker {
                skin,
                reach: &self.reach,
                point: particles.position(vertex),
                mask: self.masks[vertex],
                outward: Vector3::zeros(),
                hint: NONE,
            };
            let hint = tracks[vertex].hint();
            let foot = seeker.nearest(self.reach.far, hint, |_| true);
            foot.map_or(0.0, |foot| {
                f64::from(self.normals[vertex].dot(&skin.face_normal(foot.face)))
            })
        });
        let votes: Vec<f64> = votes.collect();
        if votes.iter().sum::<f64>() < 0.0 {
            -1.0
        } else {
            1.0
        }
    }

    fn measure_normals(&mut self, faces: &[[u32; 3]], particles: &Particles) {
        self.normals.clear();
        self.normals.resize(self.masks.len(), Vector3::zeros());
        for face in faces {
            let [a, b, c] = face.map(|vertex| Point3::from(particles.bases[vertex as usize].xyz()));
            let normal = (b - a).cross(&(c - a));
            for &vertex in face {
                self.normals[vertex as usize] += normal;
            }
        }
        for normal in &mut self.normals {
            *normal = unit(*normal);
        }
    }
}

/// The places that hold a vertex; that of the own skin last, because the last plane wins.
fn holds(skin: &Skin, reach: &Reach, own: Option<Near>, other: Option<Near>) -> [Option<Hold>; 2] {
    let thickness = reach.thickness;
    let is_held =
        |near: &Near, depth: f32| near.distance < thickness + reach.band && near.distance > -depth;
    let at = |near: Near, clearance: f32| Some(Hold { near, clearance });
    let other = other.filter(|near| is_held(near, reach.other_depth));
    let own = own.filter(|near| is_held(near, reach.depth));
    match (own, other) {
        (Some(own), Some(other)) if own.normal.dot(&other.normal) < FACING => {
            let gap = (other.foot.point - own.foot.point).dot(&own.normal);
            let middle = 0.5 * gap.max(-reach.other_depth);
            let to_own = LAYERS.max(gap / 6.0);
            let clearance = |distance: f32| thickness.min(distance);
            [
                at(other, clearance(middle + to_own)),
                at(own, clearance(middle - to_own)),
            ]
        }
        (Some(own), _) if skin.is_buried(own.foot.face) => [None, at(own, SQUEEZED.min(thickness))],
        (own, other) => [
            other
                .filter(|near| !skin.is_buried(near.foot.face))
                .and_then(|near| at(near, thickness)),
            own.and_then(|near| at(near, thickness)),
        ],
    }
}
