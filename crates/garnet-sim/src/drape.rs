//! From the garment's start to its place on the body in the end.

use std::ops::ControlFlow;

use crate::contact::Skin;
use crate::reference::{Balance, balance};
use crate::report::{Penetration, SelfIntersections, Speeds, Strain, free};
use crate::rest_shape::check_count;
use crate::solver::Solver;
use crate::{
    Cloth, DrapeReport, Energy, MovingBody, Point3, Scene, Schedule, SimError, Stage, Vector3,
};

/// A draped garment.
#[derive(Debug, Clone, PartialEq)]
pub struct Drape {
    /// Where the vertices are `[vertex]`, in metres.
    pub positions: Vec<Point3>,
    /// Where they were when the body had come to its last place, before they settled, in metres; outside of
    /// the body as the vertices in the end are.
    pub arrived: Vec<Point3>,
    /// Where they were when the body was [midway](crate::MIDWAY), in metres, outside of the body in the same way; empty if that
    /// was not simulated.
    pub midway: Vec<Point3>,
    /// How well they lie.
    pub report: DrapeReport,
}

/// What happens during a run.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum Event<'a> {
    /// A frame is done.
    Frame {
        /// How many frames are done.
        num_done: u64,
        /// How many there will be.
        num_frames: u64,
        /// Substeps done over substeps of the whole run: what a bar shows.
        progress: f32,
        /// Where the garment is `[vertex]`, in metres.
        positions: &'a [Point3],
    },
    /// All frames are done, and the cloth is being brought into balance.
    Balance {
        /// How many steps are done.
        num_done: u64,
        /// How many there will be at most.
        max_steps: u64,
        /// The largest force left over on a vertex, over the mean weight of a vertex.
        residual: f64,
    },
}

/// Edges more often as long as at rest than this are torn.
const TORN: f32 = 10.0;

/// Speeds are measured over the frames of the last so many seconds.
const SPEED_SECONDS: f32 = 0.1;

/// The farthest that the body may move in a frame, in metres.
const MAX_BODY_TRAVEL: f32 = 0.25;

/// While the body moves, folds of its skin are looked for in every so many frames.
const FRAMES_OF_FOLDS: u32 = 3;

/// Simulates a scene.
///
/// Substeps run on one thread; contacts are looked for on those that rayon has. The same scene and schedule give
/// the same bytes on any number of them. The motion of the body is asked at equal frames of a time that starts and ends gently. The observer hears of each
/// frame, and may break off.
///
/// # Errors
///
/// What [`Scene::check`] and [`Schedule::check`] refuse; [`SimError::Collider`],
/// [`SimError::Motion`] or [`SimError::MotionTooFast`] for a body that is not usable;
/// [`SimError::Exploded`] or [`SimError::Torn`] if the cloth does not hold together;
/// [`SimError::Stopped`] if the observer breaks off.
///
/// # Examples
///
/// A square of cotton falls on a ball.
///
/// ```
/// use garnet_mesh::primitives::{grid, icosphere};
/// use garnet_sim::{
///     Cloth, Collider, Fabric, MovingBody, Point3, Quality, RestShape, Scene, Schedule, drape,
/// };
/// use std::ops::ControlFlow;
///
/// let square = grid(12, 12, [0.4, 0.4]);
/// let rest = RestShape::Worn(square.positions().to_vec());
/// let cloth = Cloth::new(square.faces(), square.num_vertices(), &rest, &Fabric::cotton())?;
/// let over_the_ball = |p: &Point3| Point3::new(p.x, 0.11, p.y);
/// let start: Vec<Point3> = square.positions().iter().map(over_the_ball).collect();
///
/// let ball = icosphere(3, 0.1);
/// let collider = Collider::new(ball.faces(), ball.num_vertices())?;
/// let scene = Scene {
///     cloth: &cloth,
///     start: &start,
///     body: Some(MovingBody {
///         collider: &collider,
///         motion: &|_| ball.positions().to_vec(),
///         wind: None,
///         allowed_parts: None,
///     }),
/// };
/// let schedule = Schedule::for_quality(Quality::Fast, cloth.mean_edge_length());
/// let draped = drape(&scene, &schedule, &mut |_| ControlFlow::Continue(()))?;
/// assert_eq!(draped.report.penetration.num_inside, 0);
/// assert!(draped.positions.iter().all(|p| p.y < 0.12));
/// # Ok::<(), garnet_sim::SimError>(())
/// ```
pub fn drape(
    scene: &Scene<'_>,
    schedule: &Schedule,
    observer: &mut dyn FnMut(Event<'_>) -> ControlFlow<()>,
) -> Result<Drape, SimError> {
    let mut run = run(scene, schedule, observer)?;
    let mut balance = None;
    let mut speeds = run.clock.speeds(&run.positions);
    if schedule.balance_steps > 0 {
        let found = run.balanced(scene, schedule, observer)?;
        if found.settled.is_settled {
            speeds = Speeds::STILL;
        }
        balance = Some(found);
    }
    let num_freed = run.free();
    let strain = run.strain(scene.cloth)?;
    let Run {
        solver,
        skin,
        clock,
        positions,
        arrived,
        midway,
    } = run;
    let report = DrapeReport {
        strain,
        rib_strain: Strain::of_ribs(scene.cloth, &positions),
        speeds,
        balance,
        num_freed,
        penetration: skin.as_ref().map_or_else(Penetration::default, |body| {
            Penetration::of(&positions, body.skin.surface())
        }),
        self_intersections: SelfIntersections::of(scene.cloth, &positions, solver.is_trapped()),
        energy: Energy::of(scene.cloth, &positions, schedule.gravity),
        num_substeps: clock.substeps_done,
        seconds: clock.seconds(),
    };
    Ok(Drape {
        positions,
        arrived,
        midway,
        report,
    })
}

/// Simulates a scene as [`drape`] does, but tells only where the vertices are in the end `[vertex]`, in metres: for
/// runs so short that making the report would be felt.
///
/// # Errors
///
/// Those of [`drape`].
pub fn settle(
    scene: &Scene<'_>,
    schedule: &Schedule,
    observer: &mut dyn FnMut(Event<'_>) -> ControlFlow<()>,
) -> Result<Vec<Point3>, SimError> {
    let mut run = run(scene, schedule, observer)?;
    if schedule.balance_steps > 0 {
        run.balanced(scene, schedule, observer)?;
    }
    run.free();
    run.strain(scene.cloth)?;
    Ok(run.positions)
}

/// What the steps have come to.
struct Run<'a> {
    solver: Solver<'a>,
    skin: Option<BodyOnWay<'a>>,
    clock: Clock<'a>,
    positions: Vec<Point3>,
    arrived: Vec<Point3>,
    midway: Vec<Point3>,
}

/// Takes all steps of a schedule.
fn run<'a>(
    scene: &Scene<'a>,
    schedule: &'a Schedule,
    observer: &mut dyn FnMut(Event<'_>) -> ControlFlow<()>,
) -> Result<Run<'a>, SimError> {
    scene.check()?;
    schedule.check()?;
    let mut skin = scene
        .body
        .map(|body| BodyOnWay::new(body, schedule))
        .transpose()?;
    let mut solver = Solver::new(scene, schedule);
    let mut clock = Clock::new(schedule);
    let (mut arrived, mut midway) = (Vec::new(), Vec::new());
    let motion = Stage {
        frames: schedule.motion_frames,
        rate: schedule.motion_rate,
        extra_drag: 0.0,
        friction: schedule.motion_friction,
    };
    let stages = std::iter::once(&motion).chain(&schedule.stages);
    for (index, stage) in stages.enumerate() {
        let num_substeps = schedule.substeps(stage.rate);
        solver.begin_stage(*stage);
        if index > 1 {
            solver.keep_contacts();
        }
        for frame in 0..stage.frames {
            if let (0, Some(skin)) = (index, &mut skin) {
                skin.begin_frame(frame)?;
                let wind = skin.wind(frame)?;
                solver.set_wind(&wind);
                // The body is on its way already, and the cloth on it.
                if frame == 0 && schedule.motion_part[0] > 0.0 {
                    solver.set_off();
                }
            }
            for refresh in 0..schedule.refreshes_per_frame {
                if let (0, Some(skin)) = (index, &mut skin) {
                    skin.begin_interval(refresh)?;
                }
                solver.refresh(skin.as_ref().map(|skin| &skin.skin), clock.frames_done);
                for _ in 0..num_substeps {
                    solver.substep();
                }
                clock.substeps_done += u64::from(num_substeps);
            }
            clock.frames_done += 1;
            solver.check(clock.seconds())?;
            let positions = solver.positions();
            let event = clock.event(&positions);
            if observer(event).is_break() {
                return Err(SimError::Stopped {
                    seconds: clock.seconds(),
                });
            }
            if index == 0 && frame + 1 == schedule.midway_frame() {
                midway.clone_from(&positions);
                if let Some(skin) = &skin {
                    skin.free_at_end(&mut midway)?;
                }
            }
            clock.remember(positions);
        }
        if index == 0 {
            arrived = solver.positions();
            if let Some(skin) = &mut skin {
                solver.set_wind(&[]);
                skin.arrive()?;
                if stage.frames > 0 {
                    free(&mut arrived, skin.skin.surface());
                }
            }
        }
    }
    Ok(Run {
        positions: solver.positions(),
        solver,
        skin,
        clock,
        arrived,
        midway,
    })
}

impl Run<'_> {
    /// Lets the reference solver go on from where the steps have come to.
    fn balanced(
        &mut self,
        scene: &Scene<'_>,
        schedule: &Schedule,
        observer: &mut dyn FnMut(Event<'_>) -> ControlFlow<()>,
    ) -> Result<Balance, SimError> {
        let max_steps = u64::from(schedule.balance_steps);
        let mut watch = |num_done: usize, residual: f64| {
            observer(Event::Balance {
                num_done: num_done as u64,
                max_steps,
                residual,
            })
        };
        let contacts = || self.solver.contacts().clone();
        let ground = (self.skin.as_ref()).map(|skin| (&skin.skin, contacts()));
        let (positions, found) = balance(scene, schedule, ground, &self.positions, &mut watch)
            .map_err(|error| match error {
                SimError::Stopped { .. } => SimError::Stopped {
                    seconds: self.clock.seconds(),
                },
                other => other,
            })?;
        self.positions = positions;
        Ok(found)
    }

    /// Moves vertices out of the skin; returns how many.
    fn free(&mut self) -> usize {
        let Some(body) = &self.skin else { return 0 };
        free(&mut self.positions, body.skin.surface())
    }

    /// How much the edges are strained, if none is torn.
    fn strain(&self, cloth: &Cloth) -> Result<Strain, SimError> {
        let strain = Strain::of(cloth, &self.positions);
        if strain.max.is_nan() || strain.max > TORN - 1.0 {
            return Err(SimError::Torn {
                vertices: cloth.springs()[strain.max_edge].vertices,
                factor: strain.max + 1.0,
                seconds: self.clock.seconds(),
            });
        }
        Ok(strain)
    }
}

/// The body between two frames of its motion.
struct BodyOnWay<'a> {
    body: MovingBody<'a>,
    skin: Skin,
    from: Vec<Point3>,
    to: Vec<Point3>,
    motion_frames: u32,
    motion_part: [f32; 2],
    refreshes: u32,
    /// From one refresh to the next, in seconds.
    interval: f32,
    time: f32,
}

impl<'a> BodyOnWay<'a> {
    fn new(body: MovingBody<'a>, schedule: &Schedule) -> Result<Self, SimError> {
        let time = if schedule.motion_frames == 0 {
            1.0
        } else {
            eased(schedule.motion_part[0])
        };
        let from = (body.motion)(time);
        Ok(Self {
            body,
            skin: Skin::new(body.collider, from.clone())?,
            to: from.clone(),
            from,
            motion_frames: schedule.motion_frames,
            motion_part: schedule.motion_part,
            refreshes: schedule.refreshes_per_frame,
            interval: schedule.frame_seconds / schedule.refreshes_per_frame as f32,
            time,
        })
    }

    /// Asks the motion where the body is at the end of a frame.
    fn begin_frame(&mut self, frame: u32) -> Result<(), SimError> {
        if frame > 0 && frame.is_multiple_of(FRAMES_OF_FOLDS) {
            self.skin.find_folds();
        }
        self.time = self.time_of(frame + 1);
        std::mem::swap(&mut self.from, &mut self.to);
        self.to = (self.body.motion)(self.time);
        if self.to.len() != self.from.len() {
            return Err(SimError::Count {
                what: "positions of the collider",
                found: self.to.len(),
                expected: self.from.len(),
            });
        }
        for (vertex, (from, to)) in self.from.iter().zip(&self.to).enumerate() {
            let distance = (to - from).norm();
            if distance > MAX_BODY_TRAVEL {
                return Err(SimError::MotionTooFast {
                    vertex,
                    distance,
                    max: MAX_BODY_TRAVEL,
                });
            }
        }
        Ok(())
    }

    /// How far the air next to each garment vertex moves in a frame, in metres, and how loose the cloth
    /// is there `[vertex]`; empty if the air stands still.
    fn wind(&self, frame: u32) -> Result<Vec<(Vector3, f32)>, SimError> {
        let Some(wind) = self.body.wind else {
            return Ok(Vec::new());
        };
        let [from, to] = [frame, frame + 1].map(|frame| (wind.motion)(self.time_of(frame)));
        for positions in [&from, &to] {
            check_count(
                "positions of the air",
                positions.len(),
                wind.looseness.len(),
            )?;
        }
        let moves = from.iter().zip(&to).map(|(from, to)| to - from);
        Ok(moves.zip(wind.looseness.iter().copied()).collect())
    }

    /// The time of the motion at the beginning of a frame.
    fn time_of(&self, frame: u32) -> f32 {
        let [from, to] = self.motion_part;
        let share = frame as f32 / self.motion_frames as f32;
        eased(from + (to - from) * share)
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

    /// Moves vertices out of the skin where it is at the end of the frame.
    fn free_at_end(&self, points: &mut [Point3]) -> Result<(), SimError> {
        let time = self.time;
        let skin = self.skin.surface().moved(self.to.clone());
        free(
            points,
            &skin.map_err(|source| SimError::Motion { time, source })?,
        );
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

/// Where the run is.
struct Clock<'a> {
    schedule: &'a Schedule,
    frames_done: u64,
    substeps_done: u64,
    num_frames: u64,
    num_substeps: u64,
    /// The positions at the beginning of the time over which speeds are measured, and that frame.
    before: Option<(Vec<Point3>, u64)>,
}

impl<'a> Clock<'a> {
    fn new(schedule: &'a Schedule) -> Self {
        Self {
            schedule,
            frames_done: 0,
            substeps_done: 0,
            num_frames: schedule.num_frames(),
            num_substeps: schedule.num_substeps(),
            before: None,
        }
    }

    fn seconds(&self) -> f32 {
        self.frames_done as f32 * self.schedule.frame_seconds
    }

    fn event<'b>(&self, positions: &'b [Point3]) -> Event<'b> {
        Event::Frame {
            num_done: self.frames_done,
            num_frames: self.num_frames,
            progress: self.substeps_done as f32 / self.num_substeps as f32,
            positions,
        }
    }

    /// Keeps the positions from which speeds are measured.
    fn remember(&mut self, positions: Vec<Point3>) {
        let wanted = (SPEED_SECONDS / self.schedule.frame_seconds).round() as u64;
        if self.frames_done + wanted.max(1) <= self.num_frames {
            self.before = Some((positions, self.frames_done));
        }
    }

    fn speeds(&self, positions: &[Point3]) -> Speeds {
        match &self.before {
            Some((before, frame)) => {
                let frames = (self.frames_done - frame) as f32;
                Speeds::between(before, positions, frames * self.schedule.frame_seconds)
            }
            None => Speeds::between(positions, positions, 1.0),
        }
    }
}
