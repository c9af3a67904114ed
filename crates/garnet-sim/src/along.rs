//! Cloth that goes on with a body at the speed of a recording.

use std::ops::ControlFlow;

use crate::body_on_way::BodyOnWay;
use crate::report::free;
use crate::rest_shape::check_count;
use crate::solver::Solver;
use crate::{Event, Point3, Scene, Schedule, SimError, Stage, Vector3};

/// Cloth between two stretches of a recording: all that the next one goes on from.
#[derive(Debug, Clone, PartialEq)]
pub struct MovingCloth {
    /// Where the vertices are `[vertex]`, in metres.
    pub positions: Vec<Point3>,
    /// How fast they are `[vertex]`, m/s; empty for cloth that lay at rest and sets off with the
    /// body: with the velocity of the [air](crate::Wind) that goes along.
    pub velocities: Vec<Vector3>,
    /// The face of the skin that each was last on `[vertex]`, `u32::MAX` for none; empty if that is
    /// not known.
    pub faces: Vec<u32>,
}

impl MovingCloth {
    /// Cloth that lies at rest `[vertex]`, in metres.
    pub fn at_rest(positions: Vec<Point3>) -> Self {
        Self {
            positions,
            velocities: Vec::new(),
            faces: Vec::new(),
        }
    }
}

/// Steps cloth through a stretch of a recording: the motion of a schedule alone, in which the time
/// of the body runs evenly, and no stage of settling.
///
/// [`Scene::start`] is where the garment was put on, which tells what is near what of it; the cloth
/// is at `from`. The observer is told of each frame; what it sees is freed of the skin as a drape
/// is, what the next frame starts from is not.
///
/// The same stretch gives the same bytes on any number of threads. A recording that is cut into
/// stretches differs from one that is not, because what cloth touches is looked for anew.
///
/// # Errors
///
/// As [`drape`](crate::drape), and [`SimError::Count`] if `from` is of another garment.
pub fn go_along(
    scene: &Scene<'_>,
    schedule: &Schedule,
    from: &MovingCloth,
    observer: &mut dyn FnMut(Event<'_>) -> ControlFlow<()>,
) -> Result<MovingCloth, SimError> {
    scene.check()?;
    schedule.check()?;
    let count = scene.cloth.num_vertices();
    check_count("positions of the garment", from.positions.len(), count)?;
    if !from.velocities.is_empty() {
        check_count("velocities of the garment", from.velocities.len(), count)?;
    }
    if !from.faces.is_empty() {
        check_count("faces that vertices lie on", from.faces.len(), count)?;
    }
    let mut body = match scene.body {
        Some(body) => Some(BodyOnWay::evenly(body, schedule)?),
        None => None,
    };
    let mut solver = Solver::new(scene, schedule);
    solver.begin_stage(Stage {
        frames: schedule.motion_frames,
        rate: schedule.motion_rate,
        extra_drag: 0.0,
        friction: schedule.motion_friction,
    });
    if let Some(body) = &mut body {
        body.begin(schedule.motion_frames)?;
        solver.set_wind(body.wind());
    }
    solver.take_up(from);
    solver.set_wind(&[]);
    let num_frames = u64::from(schedule.motion_frames);
    for frame in 0..schedule.motion_frames {
        for refresh in 0..schedule.refreshes_per_frame {
            solver.refresh(body.as_ref().map(BodyOnWay::skin), u64::from(frame));
            let mut advanced = Ok(());
            solver.step(|| {
                if let Some(body) = &mut body {
                    advanced = body.advance(frame, refresh);
                }
            });
            advanced?;
        }
        let num_done = u64::from(frame) + 1;
        let seconds = num_done as f32 * schedule.frame_seconds;
        solver.check(seconds)?;
        let mut seen = solver.positions();
        if let Some(body) = &body {
            free(&mut seen, body.skin().surface());
        }
        let event = Event::Frame {
            num_done,
            num_frames,
            progress: num_done as f32 / num_frames as f32,
            positions: &seen,
        };
        if observer(event).is_break() {
            return Err(SimError::Stopped { seconds });
        }
    }
    Ok(solver.left())
}
