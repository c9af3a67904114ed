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

#[cfg(test)]
mod tests {
    use garnet_mesh::primitives::grid;

    use super::*;
    use crate::{Cloth, Fabric, Quality, RestShape};

    /// Far below what a frame moves, in metres.
    const ROUNDING: f32 = 2e-5;

    fn schedule(cloth: &Cloth, frames: u32) -> Schedule {
        Schedule {
            motion_frames: frames,
            stages: Vec::new(),
            drag: 0.0,
            carry: 0.0,
            ..Schedule::for_quality(Quality::Teacher, cloth.mean_edge_length())
        }
    }

    fn flag() -> (Cloth, Vec<Point3>) {
        let square = grid(8, 8, [0.4, 0.4]);
        let start = square.positions().to_vec();
        let rest = RestShape::Worn(start.clone());
        let count = square.num_vertices();
        let cloth = Cloth::new(square.faces(), count, &rest, &Fabric::cotton()).unwrap();
        (cloth, start)
    }

    fn along(cloth: &Cloth, start: &[Point3], frames: u32, from: &MovingCloth) -> MovingCloth {
        let scene = Scene {
            cloth,
            start,
            body: None,
        };
        let schedule = schedule(cloth, frames);
        let mut num_seen = 0;
        let mut watch = |event: Event<'_>| {
            num_seen += u32::from(matches!(event, Event::Frame { .. }));
            ControlFlow::Continue(())
        };
        let left = go_along(&scene, &schedule, from, &mut watch).unwrap();
        assert_eq!(num_seen, frames);
        left
    }

    #[test]
    fn cloth_falls_and_keeps_its_velocity_from_stretch_to_stretch() {
        let (cloth, start) = flag();
        let rest = MovingCloth::at_rest(start.clone());
        let whole = along(&cloth, &start, 12, &rest);
        let half = along(&cloth, &start, 6, &rest);
        let both = along(&cloth, &start, 6, &half);
        let time = 12.0 * schedule(&cloth, 12).frame_seconds;
        for (vertex, place) in start.iter().enumerate() {
            let fallen = place.y - whole.positions[vertex].y;
            let expected = 0.5 * crate::STANDARD_GRAVITY * time * time;
            assert!(
                (fallen - expected).abs() < 0.01 * expected,
                "{fallen} {expected}"
            );
            let speed = -whole.velocities[vertex].y;
            assert!(
                (speed - crate::STANDARD_GRAVITY * time).abs() < 0.01 * speed,
                "{speed}"
            );
            let apart = (whole.positions[vertex] - both.positions[vertex]).norm();
            assert!(apart < ROUNDING, "{apart}");
        }
    }

    #[test]
    fn cloth_of_another_garment_is_refused() {
        let (cloth, start) = flag();
        let scene = Scene {
            cloth: &cloth,
            start: &start,
            body: None,
        };
        let mut wrong = MovingCloth::at_rest(start.clone());
        wrong.velocities = vec![Vector3::zeros(); 3];
        let schedule = schedule(&cloth, 2);
        let error = go_along(
            &scene,
            &schedule,
            &wrong,
            &mut |_| ControlFlow::Continue(()),
        );
        assert!(matches!(error, Err(SimError::Count { found: 3, .. })));
    }
}
