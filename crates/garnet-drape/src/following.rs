//! Cloth that follows a recorded motion at its own speed.

use std::sync::atomic::AtomicBool;

use garnet_mesh::Point3;
use garnet_sim::{Event, MovingCloth, Quality, Schedule, go_along};
use garnet_skin::{Body, PosedBody, Warp};

use crate::simulator::{Simulator, check_stop, stopping};
use crate::{BodyPath, Error, PackageError};

/// Steps of cloth are no longer than this, in seconds: recordings with fewer frames a second get
/// some between.
const LONGEST_FRAME: f64 = 1.0 / 60.0;

/// Velocity lost to the air, 1/s: less lets cloth swing on longer, more holds it back where the
/// body runs.
const AIR: f32 = 1.0;

/// No vertex becomes faster than this, m/s.
const MAX_SPEED: f32 = 40.0;

impl Simulator {
    /// The cloth at rest on the first frame of a recording: the body goes there from its rest, as
    /// for a drape. `body` is that which the garment was bound to.
    ///
    /// # Errors
    ///
    /// As [`Simulator::drape`], and [`Error::Skin`] for another body.
    pub fn ready(
        &self,
        body: &Body,
        first: &PosedBody,
        quality: Quality,
        stop: &AtomicBool,
        observer: &mut dyn FnMut(Event<'_>),
    ) -> Result<MovingCloth, Error> {
        let home = first.at_home(body)?;
        let path = BodyPath::to_posed(body, home.body());
        let drape = self.drape(&path, quality, stop, observer)?;
        let vertices = home.to_target(drape.positions);
        Ok(MovingCloth::at_rest(self.of_vertices(&vertices)))
    }

    /// Steps the cloth from the first of some frames of a recording to the last, which are
    /// `seconds` apart. The result are positions of the garment's mesh `[frame][vertex]` in each
    /// frame after the first, in metres, and what the next frames go on from.
    ///
    /// Between frames the skin goes straight.
    ///
    /// # Errors
    ///
    /// As [`Simulator::drape`], and [`Error::Skin`] for bodies that are not of the garment's body.
    ///
    /// # Panics
    ///
    /// If there are fewer than two frames.
    pub fn follow(
        &self,
        frames: &[PosedBody],
        seconds: f64,
        from: &MovingCloth,
        quality: Quality,
        stop: &AtomicBool,
    ) -> Result<(Vec<Vec<Point3>>, MovingCloth), Error> {
        assert!(frames.len() > 1, "a way has two ends");
        let garment = self.garment();
        let between = ((seconds / LONGEST_FRAME) - 1e-6).ceil().max(1.0);
        let ways = frames.len() - 1;
        let steps = between as usize * ways;
        let place = |time: f32| {
            let step = (time * steps as f32).round() as usize;
            let frame = (step / between as usize).min(ways - 1);
            let share = step as f64 / between - frame as f64;
            (frame, share as f32)
        };
        let motion = |time: f32| {
            let (frame, share) = place(time);
            let ends = [frame, frame + 1].map(|frame| frames[frame].skin().positions());
            self.simulated_skin(between_points(ends[0], ends[1], share))
        };
        // Only the start asks for the air.
        let warped = |frame: usize| -> Result<Vec<Point3>, Error> {
            let nodes = garment.warped_nodes(&frames[frame], Warp::Shape)?;
            Ok(self.simulated(&nodes))
        };
        let ends = [warped(0)?, warped(1)?];
        let carried = |time: f32| match place(time) {
            (0, share) => between_points(&ends[0], &ends[1], share),
            _ => ends[1].clone(),
        };
        let schedule = self.layered(schedule(
            &self.schedule(quality),
            steps as u32,
            (seconds / between) as f32,
        ));
        let mut seen = Vec::with_capacity(ways);
        let left = self.with_scene(&motion, &carried, |scene| {
            let mut observer = |event: Event<'_>| {
                if let Event::Frame {
                    num_done,
                    positions,
                    ..
                } = event
                    && num_done.is_multiple_of(between as u64)
                {
                    seen.push(self.vertices(positions));
                }
            };
            go_along(scene, &schedule, from, &mut stopping(stop, &mut observer))
        });
        check_stop(stop)?;
        let left = left.map_err(|error| PackageError::from(self.named(error)))?;
        Ok((seen, left))
    }
}

/// The schedule of a stretch: as finely as cloth settles in the end, with no air that carries it.
fn schedule(of: &Schedule, frames: u32, frame_seconds: f32) -> Schedule {
    let rate = of.stages.last().map_or(of.motion_rate, |stage| stage.rate);
    Schedule {
        frame_seconds,
        motion_frames: frames,
        motion_part: [0.0, 1.0],
        motion_rate: rate,
        motion_friction: 1.0,
        stages: Vec::new(),
        balance_steps: 0,
        carry: 0.0,
        drag: AIR,
        max_speed: MAX_SPEED,
        ..of.clone()
    }
}

fn between_points(from: &[Point3], to: &[Point3], share: f32) -> Vec<Point3> {
    let pairs = from.iter().zip(to);
    pairs.map(|(from, to)| from + (to - from) * share).collect()
}
