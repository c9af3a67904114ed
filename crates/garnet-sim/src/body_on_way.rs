//! The body between two frames of its motion.

use crate::contact::Skin;
use crate::rest_shape::check_count;
use crate::{MovingBody, Point3, Schedule, SimError, Vector3};

/// The farthest that the body may move in a frame, in metres.
const MAX_BODY_TRAVEL: f32 = 0.25;

/// While the body moves, folds of its skin are looked for in every so many frames.
const FRAMES_OF_FOLDS: u32 = 3;

/// A body on its way, and the air that goes along with it.
///
/// It is always where the next substeps begin: [`advance`](BodyOnWay::advance) may run beside the
/// substeps before.
pub(crate) struct BodyOnWay<'a> {
    body: MovingBody<'a>,
    skin: Skin,
    from: Vec<Point3>,
    to: Vec<Point3>,
    /// Where the air is at the end of the frame `[garment vertex]`; empty if it stands still.
    air: Vec<Point3>,
    wind: Vec<(Vector3, f32)>,
    motion_frames: u32,
    motion_part: [f32; 2],
    /// How far the time of the body is at each share of the motion.
    pace: fn(f32) -> f32,
    refreshes: u32,
    /// From one refresh to the next, in seconds.
    interval: f32,
    time: f32,
}

impl<'a> BodyOnWay<'a> {
    /// A body that starts and ends its way gently.
    pub(crate) fn new(body: MovingBody<'a>, schedule: &Schedule) -> Result<Self, SimError> {
        Self::at_pace(body, schedule, eased)
    }

    /// A body whose time runs evenly: it is in the middle of a longer motion.
    pub(crate) fn evenly(body: MovingBody<'a>, schedule: &Schedule) -> Result<Self, SimError> {
        Self::at_pace(body, schedule, |time| time)
    }

    fn at_pace(
        body: MovingBody<'a>,
        schedule: &Schedule,
        pace: fn(f32) -> f32,
    ) -> Result<Self, SimError> {
        let time = if schedule.motion_frames == 0 {
            1.0
        } else {
            pace(schedule.motion_part[0])
        };
        let from = (body.motion)(time);
        Ok(Self {
            body,
            skin: Skin::new(body.collider, from.clone())?,
            to: from.clone(),
            from,
            air: Vec::new(),
            wind: Vec::new(),
            motion_frames: schedule.motion_frames,
            motion_part: schedule.motion_part,
            pace,
            refreshes: schedule.refreshes_per_frame,
            interval: schedule.frame_seconds / schedule.refreshes_per_frame as f32,
            time,
        })
    }

    /// The skin where the substeps begin.
    pub(crate) fn skin(&self) -> &Skin {
        &self.skin
    }

    /// How far the air next to each garment vertex moves in the frame, in metres, and how loose the
    /// cloth is there `[vertex]`; empty if the air stands still.
    pub(crate) fn wind(&self) -> &[(Vector3, f32)] {
        &self.wind
    }

    /// Goes to the start of the motion, or to where the body stands if it has no frames.
    pub(crate) fn begin(&mut self, num_frames: u32) -> Result<(), SimError> {
        if num_frames == 0 {
            return self.arrive();
        }
        self.air = self.air_at(0)?;
        self.begin_frame(0)
    }

    /// Goes from where the substeps after a refresh of a frame begin to where they end.
    pub(crate) fn advance(&mut self, frame: u32, refresh: u32) -> Result<(), SimError> {
        if refresh + 1 < self.refreshes {
            self.begin_interval(refresh + 1)
        } else if frame + 1 < self.motion_frames {
            self.begin_frame(frame + 1)
        } else {
            self.arrive()
        }
    }

    /// Asks the motion where the body is at the end of a frame.
    fn begin_frame(&mut self, frame: u32) -> Result<(), SimError> {
        if frame > 0 && frame.is_multiple_of(FRAMES_OF_FOLDS) {
            self.skin.find_folds();
        }
        self.time = self.time_of(frame + 1);
        std::mem::swap(&mut self.from, &mut self.to);
        self.to = (self.body.motion)(self.time);
        check_count("positions of the collider", self.to.len(), self.from.len())?;
        let topology = &self.body.collider.adjacency().topology;
        for (vertex, (from, to)) in self.from.iter().zip(&self.to).enumerate() {
            let distance = (to - from).norm();
            // Nothing lies on a vertex that no face names.
            if distance > MAX_BODY_TRAVEL && !topology.vertex_faces(vertex).is_empty() {
                return Err(SimError::MotionTooFast {
                    vertex,
                    distance,
                    max: MAX_BODY_TRAVEL,
                });
            }
        }
        let air = self.air_at(frame + 1)?;
        if let Some(wind) = self.body.wind {
            let moves = self.air.iter().zip(&air).map(|(from, to)| to - from);
            self.wind.clear();
            self.wind.extend(moves.zip(wind.looseness.iter().copied()));
        }
        self.air = air;
        self.begin_interval(0)
    }

    /// Where the air is at the beginning of a frame.
    fn air_at(&self, frame: u32) -> Result<Vec<Point3>, SimError> {
        let Some(wind) = self.body.wind else {
            return Ok(Vec::new());
        };
        let air = (wind.motion)(self.time_of(frame));
        check_count("positions of the air", air.len(), wind.looseness.len())?;
        Ok(air)
    }

    /// The time of the motion at the beginning of a frame.
    fn time_of(&self, frame: u32) -> f32 {
        let [from, to] = self.motion_part;
        let share = frame as f32 / self.motion_frames as f32;
        (self.pace)(from + (to - from) * share)
    }

    /// Moves the skin to the beginning of an interval of the frame.
    fn begin_interval(&mut self, refresh: u32) -> Result<(), SimError> {
        let start = self.between(refresh);
        let end = self.between(refresh + 1);
        self.move_skin(&start)?;
        self.skin.head_for(&end, self.interval);
        Ok(())
    }

    /// Moves the skin to its last place.
    fn arrive(&mut self) -> Result<(), SimError> {
        let last = std::mem::take(&mut self.to);
        self.move_skin(&last)?;
        self.to = last;
        self.skin.stand();
        if self.motion_frames > 0 {
            self.skin.find_folds();
        }
        Ok(())
    }

    fn move_skin(&mut self, positions: &[Point3]) -> Result<(), SimError> {
        let time = self.time;
        self.skin
            .move_to(positions)
            .map_err(|source| SimError::Motion { time, source })
    }

    fn between(&self, refresh: u32) -> Vec<Point3> {
        let share = refresh as f32 / self.refreshes as f32;
        let pairs = self.from.iter().zip(&self.to);
        pairs.map(|(from, to)| from + (to - from) * share).collect()
    }
}

/// A time from 0 to 1 that starts and ends gently: 3 t² − 2 t³.
fn eased(time: f32) -> f32 {
    time * time * (3.0 - 2.0 * time)
}
