//! Key frames of a take: those that are draped by themselves, with others between them.
//!
//! From one frame of a recording to the next a body hardly moves, and its cloth hardly finds other
//! folds. So not each of them is predicted and relaxed. Where the body has moved far enough, a
//! frame is a key. Between two keys cloth lies, as the body sees it, on the way from the one to the
//! other.

use garnet_mesh::{Point3, Vector3};
use garnet_skin::{PosedBody, blended_transforms};
use nalgebra::Isometry3;
use rayon::prelude::*;

use crate::take::{Carrier, farthest};
use crate::{BoundGarment, Drape, Draper, Error};

/// A tilt of the body against the vertical is as far as what is at this distance from its root
/// moves by it, in metres: cloth then hangs another way. Longer makes more keys where bodies fall.
const TILTED: f32 = 0.5;

/// The joints of the body may move so many times as far as the cloth's own warp from a key to the
/// next: an arm that comes to cloth which does not follow it pushes it. Less makes more keys of
/// steps and swings.
const JOINTS: f32 = 4.0;

/// How far a body moves from a key frame to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct KeySpacing {
    /// The farthest that a node of the warp moves against the root of the body, in metres; joints
    /// move four times as far. Lower costs more drapes; higher lets frames between keys differ more
    /// from what they are alone.
    pub apart: f32,
}

impl Default for KeySpacing {
    fn default() -> Self {
        Self { apart: 0.02 }
    }
}

impl KeySpacing {
    /// All frames are keys.
    pub const NONE: Self = Self { apart: 0.0 };

    /// Each frame whose number is a multiple of this is a key, however still the body keeps: parts
    /// of a motion that start and end there have the same keys as the whole. More keeps more frames
    /// waiting for their keys.
    pub const LONGEST: usize = 12;

    /// The same with another distance, in metres.
    #[must_use]
    pub fn with_apart(self, apart: f32) -> Self {
        Self { apart }
    }

    /// Which frames are keys, in order: of each frame, how its body moves the skin from rest
    /// `[frame][joint]`. The first and the last are.
    ///
    /// # Panics
    ///
    /// If there is another number of transforms than joints of the body of the garment.
    pub fn keys(&self, garment: &BoundGarment, transforms: &[Vec<Isometry3<f32>>]) -> Vec<usize> {
        let mut keys = Vec::new();
        let mut last: Option<Places> = None;
        for (number, frame) in transforms.iter().enumerate() {
            let now = Places::new(garment, frame);
            let is_far = (last.as_ref()).is_none_or(|last| now.from(last) >= self.apart);
            let is_end = number + 1 == transforms.len();
            if is_far || is_end || number % Self::LONGEST == 0 {
                keys.push(number);
                last = Some(now);
            }
        }
        keys
    }
}

/// Where warp and joints of a frame are, as the root of the body sees them.
struct Places {
    /// `[node]`, in metres.
    nodes: Vec<Point3>,
    /// `[joint]`, in metres.
    joints: Vec<Point3>,
    /// The vertical.
    up: Vector3,
}

impl Places {
    fn new(garment: &BoundGarment, transforms: &[Isometry3<f32>]) -> Self {
        let cloth = garment.cloth();
        let skeleton = garment.body().skeleton();
        let root = skeleton.parents_first().first();
        let root = root.map_or_else(Isometry3::identity, |&root| transforms[root]);
        let seen = root.inverse();
        let blended = blended_transforms(cloth.weights(), transforms);
        let nodes = blended.par_iter().zip(cloth.rest_nodes());
        let joints = transforms.iter().zip(skeleton.joints());
        Self {
            joints: joints
                .map(|(one, joint)| seen * (one * joint.rest_position))
                .collect(),
            nodes: nodes.map(|(one, rest)| seen * (one * rest)).collect(),
            up: seen * Vector3::y(),
        }
    }

    /// How far they are from those of another frame, in metres of the warp.
    fn from(&self, other: &Self) -> f32 {
        let nodes = farthest(&other.nodes, &self.nodes);
        let joints = farthest(&other.joints, &self.joints) / JOINTS;
        let tilt = TILTED * (self.up - other.up).norm();
        nodes.max(joints).max(tilt)
    }
}

/// A frame that was draped by itself, for others to lie between it and the next.
#[derive(Debug, Clone)]
pub struct KeyFrame {
    drape: Drape,
    /// Offsets from the warp `[node]`, turned back to rest, in metres.
    offsets: Vec<Vector3>,
}

impl KeyFrame {
    /// Of what `draper` has made of `body`.
    ///
    /// # Errors
    ///
    /// [`Error::Skin`] if `body` is not of the body that the garment was bound to.
    ///
    /// # Panics
    ///
    /// If the drape has fewer positions than the garment.
    pub fn new(draper: &Draper, body: &PosedBody, drape: Drape) -> Result<Self, Error> {
        let garment = draper.garment();
        let home = body.at_home(garment.body())?;
        let carrier = Carrier::new(draper, home.body())?;
        let weld = garment.cloth().weld();
        let nodes = weld.gather(&home.from_target(drape.positions.clone()));
        Ok(Self {
            offsets: carrier.offsets(&nodes),
            drape,
        })
    }

    /// The drape of this key frame.
    pub fn drape(&self) -> &Drape {
        &self.drape
    }

    /// Where cloth is between this key and the next `[node]`, in metres, on a body near home: at
    /// this one at a `share` of 0, at the next one at 1.
    pub(crate) fn between(&self, next: &Self, share: f32, carrier: &Carrier) -> Vec<Point3> {
        let pairs = self.offsets.iter().zip(&next.offsets);
        let offsets: Vec<Vector3> = pairs.map(|(a, b)| a.lerp(b, share)).collect();
        carrier.placed(&offsets)
    }
}
