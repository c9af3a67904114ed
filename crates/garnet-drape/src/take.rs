//! A take: frames of a motion, draped in order.
//!
//! Draped alone, cloth may lie on the one side of an arm in a frame and on the other in the next,
//! or in another fold, though the body has hardly moved. In a take each frame goes on from the last
//! one: its cloth is carried along with the body, and goes from there towards where the frame's own
//! drape has it, by no more than a [`StepLimit`] a frame. What is carried stays on its side of the
//! skin. Where nothing jumps, the frames are those that are draped alone, to the bit.
//!
//! Not every frame needs a drape of its own: between [`KeyFrame`]s it goes along with both.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use garnet_mesh::{Point3, Vector3};
use garnet_skin::{BodyAtHome, PosedBody, Warp, Weld, blended_transforms};
use garnet_untangle::{UntangleOptions, UntangleReport};
use nalgebra::{Isometry3, UnitQuaternion};
use rayon::prelude::*;

use crate::{Drape, DrapeSeconds, Draper, Error, KeyFrame};

/// Nodes that one task handles. Results do not depend on it, nor on the number of threads.
const CHUNK: usize = 1024;

/// A node that untangling moves farther than this was thrown, in metres. Less costs a second
/// untangling in more frames.
pub(crate) const FAR: f32 = 0.008;

/// Cloth that went on from the last frame may cross the skin in so many more faces than the frame's
/// own drape does: where an arm leaves the cloth that it has reached through, what is carried hangs
/// on it. More keeps such cloth longer and lets it go farther at once. Tried: 8, 40, 1000
/// (docs/experiments/053).
const MORE_CROSSING: usize = 40;

/// By how much cloth may go on, from one frame to the next, beyond being carried by the body.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StepLimit {
    /// Where the body keeps still, in metres a frame. Lower is calmer, and cloth lags behind longer
    /// where it has to come from one side of a limb to the other.
    pub still: f32,
    /// More than that, as a share of the step that the body makes there. Lower is calmer, and cloth
    /// lags behind in fast motion.
    pub share: f32,
}

impl Default for StepLimit {
    fn default() -> Self {
        Self {
            still: 0.003,
            share: 0.5,
        }
    }
}

impl StepLimit {
    /// No limit: each frame is as it is alone.
    pub const NONE: Self = Self {
        still: f32::INFINITY,
        share: 0.0,
    };

    /// The same with another step where the body keeps still, in metres a frame.
    #[must_use]
    pub fn with_still(self, still: f32) -> Self {
        Self { still, ..self }
    }

    /// The limit where the body makes a step of `step` metres.
    fn at(self, step: f32) -> f32 {
        self.still + self.share * step
    }
}

/// A frame of a take.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct TakeFrame {
    /// The drape.
    pub drape: Drape,
    /// Nodes that have not come as far as the frame's own drape has them.
    pub held_back: usize,
    /// The farthest that a vertex has come since the last frame, in metres; 0 in the first.
    pub step: f32,
    /// The farthest that a vertex of the body has come, in metres; 0 in the first.
    pub body_step: f32,
    /// Whether it lies between two key frames, with no drape of its own.
    pub is_between: bool,
}

/// Drapes the frames of a motion in order, each from the last one.
#[derive(Debug, Clone)]
pub struct Take<'a> {
    draper: &'a Draper,
    limit: StepLimit,
    last: Option<Last>,
}

/// The end of a frame.
#[derive(Debug, Clone)]
struct Last {
    /// Positions of the cloth `[node]`, near the body at home, in metres.
    cloth: Vec<Point3>,
    carrier: Carrier,
    /// Positions `[vertex]` of cloth and body where the target stands, in metres.
    vertices: Vec<Point3>,
    body: Vec<Point3>,
}

/// What carries cloth along with the body, near the body at home.
#[derive(Debug, Clone)]
pub(crate) struct Carrier {
    /// The warp `[node]`, in metres.
    warped: Vec<Point3>,
    /// How the body turns the nodes `[node]`.
    turns: Vec<UnitQuaternion<f32>>,
}

impl Carrier {
    pub(crate) fn new(draper: &Draper, body: &PosedBody) -> Result<Self, Error> {
        let cloth = draper.garment().cloth();
        let transforms = blended_transforms(cloth.weights(), body.posed_from_rest());
        Ok(Self {
            warped: cloth.warped_nodes(body, Warp::Shape)?,
            turns: transforms
                .iter()
                .map(|one: &Isometry3<f32>| one.rotation)
                .collect(),
        })
    }

    /// Offsets of nodes from the warp `[node]`, turned back to rest, in metres.
    pub(crate) fn offsets(&self, nodes: &[Point3]) -> Vec<Vector3> {
        let places = nodes.iter().zip(&self.warped).zip(&self.turns);
        places
            .map(|((place, warped), turn)| turn.inverse() * (place - warped))
            .collect()
    }

    /// Where nodes are at such offsets from the warp `[node]`, which are turned back to rest.
    pub(crate) fn placed(&self, offsets: &[Vector3]) -> Vec<Point3> {
        self.moved(&self.warped, offsets, 1.0)
    }

    /// Nodes moved by a share of `ways` `[node]`, which are turned back to rest.
    pub(crate) fn moved(&self, nodes: &[Point3], ways: &[Vector3], share: f32) -> Vec<Point3> {
        let places = nodes.iter().zip(ways).zip(&self.turns);
        places
            .map(|((place, way), turn)| place + turn * (way * share))
            .collect()
    }
}

impl<'a> Take<'a> {
    /// A take that has not begun.
    pub fn new(draper: &'a Draper) -> Self {
        Self {
            draper,
            limit: StepLimit::default(),
            last: None,
        }
    }

    /// The same with another limit.
    #[must_use]
    pub fn with_limit(self, limit: StepLimit) -> Self {
        Self { limit, ..self }
    }

    /// Drapes the next frame.
    ///
    /// # Errors
    ///
    /// As [`Draper::drape_until`].
    pub fn drape(&mut self, body: &PosedBody, stop: &AtomicBool) -> Result<TakeFrame, Error> {
        let alone = self.draper.drape_until(body, stop)?;
        self.go_on(body, alone)
    }

    /// The next frame, of which the draper has already made the drape `alone`: frames alone can be
    /// made by several threads, what follows from one frame to the next has to be in order.
    ///
    /// # Errors
    ///
    /// [`Error::Skin`] or [`Error::Untangle`] if `body` is not of the body that the garment was
    /// bound to.
    ///
    /// # Panics
    ///
    /// If `alone` has fewer positions than the garment.
    pub fn go_on(&mut self, body: &PosedBody, alone: Drape) -> Result<TakeFrame, Error> {
        let start = Instant::now();
        let garment = self.draper.garment();
        let weld = garment.cloth().weld();
        let home = body.at_home(garment.body())?;
        let carrier = Carrier::new(self.draper, home.body())?;
        let goal = weld.gather(&home.from_target(alone.positions.clone()));
        let mut frame = TakeFrame::new(alone);
        let mut cloth = goal;
        if let Some(last) = &self.last {
            let (reached, held_back) = last.reached(&carrier, &cloth, self.limit);
            if held_back > 0 {
                let own = frame.drape.report.as_ref();
                let most = own.map_or(0, |own| own.crossing_faces) + MORE_CROSSING;
                let thrown = farthest(&reached, &cloth);
                if let Some(freed) = self.freed(&home, reached, thrown, most)? {
                    frame.held_back = held_back;
                    cloth = freed.take_nodes(&mut frame.drape, &home, weld);
                }
            }
        }
        frame.drape.seconds.untangle += start.elapsed().as_secs_f64();
        self.end(&mut frame, body, cloth, carrier);
        Ok(frame)
    }

    /// The next frame, which lies between two keys at a `share` of the way from the first to the
    /// second. If it cannot be freed of penetrations there it is draped by itself.
    ///
    /// # Errors
    ///
    /// As [`Draper::drape_until`].
    pub fn go_between(
        &mut self,
        body: &PosedBody,
        keys: [&KeyFrame; 2],
        share: f32,
        stop: &AtomicBool,
    ) -> Result<TakeFrame, Error> {
        let start = Instant::now();
        let garment = self.draper.garment();
        let home = body.at_home(garment.body())?;
        let carrier = Carrier::new(self.draper, home.body())?;
        let goal = keys[0].between(keys[1], share, &carrier);
        let (reached, held_back) = match &self.last {
            Some(last) => last.reached(&carrier, &goal, self.limit),
            None => (goal.clone(), 0),
        };
        let reports = keys.map(|key| key.drape().report.as_ref());
        let most = |of: fn(&UntangleReport) -> usize| reports.map(|one| one.map_or(0, of));
        let most = |of| most(of).into_iter().max().unwrap_or(0);
        let crossing = most(|report| report.crossing_faces) + MORE_CROSSING;
        let thrown = farthest(&reached, &goal).max(FAR);
        let freed = self.freed(&home, reached, thrown, crossing)?;
        let inside = most(|report| report.inside);
        let Some(freed) = freed.filter(|freed| freed.inside() <= inside) else {
            return self.drape(body, stop);
        };
        let nearest = keys[usize::from(share > 0.5)].drape();
        let mut frame = TakeFrame::new(nearest.clone());
        frame.held_back = held_back;
        frame.is_between = true;
        let cloth = freed.take_nodes(&mut frame.drape, &home, garment.cloth().weld());
        frame.drape.seconds = DrapeSeconds {
            untangle: start.elapsed().as_secs_f64(),
            ..DrapeSeconds::default()
        };
        self.end(&mut frame, body, cloth, carrier);
        Ok(frame)
    }

    /// Measures the steps of a frame, and keeps what the next one goes on from.
    fn end(
        &mut self,
        frame: &mut TakeFrame,
        body: &PosedBody,
        cloth: Vec<Point3>,
        carrier: Carrier,
    ) {
        if let Some(last) = &self.last {
            frame.step = farthest(&last.vertices, &frame.drape.positions);
            frame.body_step = farthest(&last.body, body.skin().positions());
        }
        self.last = Some(Last {
            cloth,
            carrier,
            vertices: frame.drape.positions.clone(),
            body: body.skin().positions().to_vec(),
        });
    }

    /// The cloth at `reached` `[node]`, freed of penetrations if that was asked for; `None` if that
    /// throws a node farther than [`FAR`] and `most_thrown`, in metres, or leaves more faces than
    /// `most_crossing` across the skin.
    ///
    /// Cloth that was carried leaves by the skin nearest to it. Where that throws a node far, as
    /// between two parts of the body that close on it, it leaves by the side that it belongs to.
    fn freed(
        &self,
        home: &BodyAtHome<'_>,
        reached: Vec<Point3>,
        most_thrown: f32,
        most_crossing: usize,
    ) -> Result<Option<Freed>, Error> {
        let Some(options) = self.draper.options().untangle else {
            return Ok(Some(Freed {
                nodes: reached,
                found: None,
            }));
        };
        let garment = self.draper.garment();
        let body = home.body();
        let untangled = |options: &UntangleOptions| garment.freed(body, &reached, options);
        let carried = options.for_simulated();
        let nearest = untangled(&carried)?;
        let thrown = farthest(&reached, &nearest.positions_nodes);
        let (best, is_near) = if thrown <= FAR {
            (nearest, true)
        } else {
            let sided = untangled(&UntangleOptions {
                keeps_sides: false,
                ..carried
            })?;
            let is_free = sided.report.inside <= nearest.report.inside;
            let other = farthest(&reached, &sided.positions_nodes);
            if is_free && other < thrown {
                (sided, other <= most_thrown)
            } else {
                (nearest, thrown <= most_thrown)
            }
        };
        let is_good = is_near && best.report.crossing_faces <= most_crossing;
        Ok(is_good.then_some(Freed {
            nodes: best.positions_nodes,
            found: Some((best.is_trapped, best.report)),
        }))
    }
}

/// Cloth that was freed of penetrations, if that was asked for.
struct Freed {
    /// Positions `[node]`, in metres.
    nodes: Vec<Point3>,
    /// Which nodes are trapped, and what untangling tells; none if it was not asked for.
    found: Option<(Vec<bool>, UntangleReport)>,
}

impl Freed {
    /// Vertices that are left inside the body.
    fn inside(&self) -> usize {
        self.found.as_ref().map_or(0, |(_, report)| report.inside)
    }

    /// Makes it the drape of a frame, and gives its positions `[node]`.
    fn take_nodes(self, drape: &mut Drape, home: &BodyAtHome<'_>, weld: &Weld) -> Vec<Point3> {
        drape.positions = home.to_target(weld.scatter(&self.nodes));
        if let Some((is_trapped, report)) = self.found {
            drape.is_trapped = weld.scatter(&is_trapped);
            drape.report = Some(report);
        }
        self.nodes
    }
}

impl TakeFrame {
    /// A frame that is draped alone, and the first one.
    fn new(drape: Drape) -> Self {
        Self {
            drape,
            held_back: 0,
            step: 0.0,
            body_step: 0.0,
            is_between: false,
        }
    }
}

impl Last {
    /// Where the cloth gets in the next frame on its way to `goal` `[node]`, and how many nodes do
    /// not get there.
    fn reached(
        &self,
        carrier: &Carrier,
        goal: &[Point3],
        limit: StepLimit,
    ) -> (Vec<Point3>, usize) {
        let of_node = |node: usize| {
            let turn = carrier.turns[node] * self.carrier.turns[node].inverse();
            let (from, to) = (self.carrier.warped[node], carrier.warped[node]);
            let carried = to + turn * (self.cloth[node] - from);
            let way = goal[node] - carried;
            let (length, most) = (way.norm(), limit.at((to - from).norm()));
            if length <= most {
                (goal[node], false)
            } else {
                (carried + way * (most / length), true)
            }
        };
        let nodes = (0..goal.len()).into_par_iter().with_min_len(CHUNK);
        let reached: Vec<(Point3, bool)> = nodes.map(of_node).collect();
        let held_back = reached.iter().filter(|(_, is_held)| *is_held).count();
        (
            reached.into_iter().map(|(place, _)| place).collect(),
            held_back,
        )
    }
}

/// The farthest that a point has come, in metres.
pub(crate) fn farthest(from: &[Point3], to: &[Point3]) -> f32 {
    let squared = from.iter().zip(to).map(|(a, b)| (b - a).norm_squared());
    squared.fold(0.0, f32::max).sqrt()
}
