//! From the garment's start to its place on the body in the end.

use std::ops::ControlFlow;

use garnet_knn::TORN_STRETCH;

use crate::body_on_way::BodyOnWay;
use crate::reference::{Balance, balance};
use crate::report::{Lost, Penetration, SelfIntersections, Speeds, Strain, free};
use crate::solver::Solver;
use crate::{Cloth, DrapeReport, Energy, Point3, Scene, Schedule, SimError, Stage};

/// Cloth that was simulated, and the report.
#[derive(Debug, Clone, PartialEq)]
pub struct Drape {
    /// Where the vertices are `[vertex]`, in metres.
    pub positions: Vec<Point3>,
    /// Where they were when the body had come to its last place, before they settled, in metres;
    /// outside of the body as the vertices in the end are.
    pub arrived: Vec<Point3>,
    /// Where they were when the body was [midway](crate::Moment::Midway), in metres, outside of the
    /// body in the same way; empty if that was not simulated.
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

/// Cloth with an edge that is longer than this over its length at rest has flown apart and is
/// refused. Lower ones refuse cloth that is torn at one edge alone.
const FLOWN_APART: f32 = 5.0 * TORN_STRETCH;

/// Speeds are measured over the frames of the last so many seconds.
const SPEED_SECONDS: f32 = 0.1;

/// Simulates cloth on a body that moves to its pose.
///
/// Each of the [patches](Schedule::patches) takes a substep on one of the threads that rayon has,
/// while another one moves the body; contacts are looked for on all of them. The same scene and
/// schedule give the same bytes on any number of them. The motion of the body is asked at equal
/// frames of a time that starts and ends gently. The observer hears of each frame, and may break
/// off.
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
///         likely_faces: None,
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
    run.check_whole(scene.cloth)?;
    let Run {
        solver,
        skin,
        clock,
        positions,
        arrived,
        midway,
    } = run;
    let surface = skin.as_ref().map(|body| body.skin().surface());
    let report = DrapeReport {
        strain: Strain::of(scene.cloth, &positions),
        rib_strain: Strain::of_ribs(scene.cloth, &positions),
        speeds,
        balance,
        num_freed,
        penetration: surface.map_or_else(Penetration::default, |skin| {
            Penetration::of(&positions, skin, 1.0)
        }),
        lost: surface.map_or_else(Lost::default, |skin| Lost::of(&positions, skin)),
        self_intersections: SelfIntersections::of(scene.cloth, &positions, solver.is_squeezed()),
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

/// Simulates a scene as [`drape`] does, but tells only where the vertices are in the end
/// `[vertex]`, in metres: for runs so short that making the report would be felt.
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
    run.check_whole(scene.cloth)?;
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
    let body = || scene.body.map(|body| BodyOnWay::new(body, schedule));
    let (body, mut solver) = rayon::join(body, || Solver::new(scene, schedule));
    let mut skin = body.transpose()?;
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
        if stage.frames > 0 {
            solver.begin_stage(*stage);
        }
        if index > 1 {
            solver.keep_contacts();
        }
        let moves = index == 0;
        if let Some(body) = skin.as_mut().filter(|_| moves) {
            body.begin(stage.frames)?;
        }
        for frame in 0..stage.frames {
            if let Some(body) = skin.as_ref().filter(|_| moves) {
                solver.set_wind(body.wind());
                // The body is on its way already, and the cloth on it.
                if frame == 0 && schedule.motion_part[0] > 0.0 {
                    solver.set_off();
                }
            }
            for refresh in 0..schedule.refreshes_per_frame {
                solver.refresh(skin.as_ref().map(BodyOnWay::skin), clock.frames_done);
                let mut advanced = Ok(());
                solver.step(|| {
                    if let Some(body) = skin.as_mut().filter(|_| moves) {
                        advanced = body.advance(frame, refresh);
                    }
                });
                advanced?;
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
            if moves && frame + 1 == schedule.midway_frame() {
                midway.clone_from(&positions);
                if let Some(body) = &skin {
                    free(&mut midway, body.skin().surface());
                }
            }
            clock.remember(positions);
        }
        if moves {
            arrived = solver.positions();
            solver.set_wind(&[]);
            if let Some(body) = skin.as_ref().filter(|_| stage.frames > 0) {
                free(&mut arrived, body.skin().surface());
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
        let ground = (self.skin.as_ref()).map(|skin| (skin.skin(), contacts()));
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
        free(&mut self.positions, body.skin().surface())
    }

    /// Refuses cloth of which an edge is torn; tells the one that is the longest against its length
    /// at rest.
    fn check_whole(&self, cloth: &Cloth) -> Result<(), SimError> {
        let factors = cloth.springs().iter().map(|spring| {
            let [a, b] = spring
                .vertices
                .map(|vertex| self.positions[vertex as usize]);
            ((a - b).norm() / spring.rest_length, spring.vertices)
        });
        // Of all numbers NaN is the largest in this order.
        let longest = factors.reduce(|a, b| if b.0.total_cmp(&a.0).is_gt() { b } else { a });
        match longest {
            Some((factor, vertices)) if factor.is_nan() || factor > FLOWN_APART => {
                Err(SimError::Torn {
                    vertices,
                    factor,
                    seconds: self.clock.seconds(),
                })
            }
            _ => Ok(()),
        }
    }
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
