//! `garnet drape`: a garment on bodies.

mod args;
mod choice;
mod outputs;
mod prepared;
mod ready;
mod report;
mod simulated;
mod summary;
mod timing;
mod warning;

use std::{
    path::{Path, PathBuf},
    sync::{Arc, atomic::AtomicBool},
};

use anyhow::Context;
use garnet::{
    Body, BoundGarment, Drape, Garment, Point3, PosedBody, TriMesh, Warp,
    data::SceneReport,
    drape::{Refit, Take},
    io::{self, Frame, MotionOptions, PoseSource, RestSource, Target},
    mesh::edge_stretch,
    package::Moment,
};

pub(crate) use args::DrapeArgs;
pub(crate) use args::{InputArgs, Job, Simulation, Source, SourceFiles, UpName, units};
use outputs::{body_out_of, check_outputs, outputs_on};
pub(crate) use prepared::Prepared;
use ready::{Found, Method, Ready};
pub(crate) use report::WarningReport;
use report::{
    BodyReport, DrapeOutput, DrapeReport, DrapeSeconds, GarmentReport, OnceSeconds,
    PenetrationReport, PoseReport, RepeatedSeconds, StepsReport, Stretch,
};
use timing::timed;
pub(crate) use warning::warnings_of;
use warning::{Problem, Warning};

use crate::{
    console::{Console, print_document},
    failure::ExitStatus,
    machine, output,
};

/// Reads, binds, drapes on each body, writes and reports.
pub(crate) fn run(args: DrapeArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    do_job(|| Job::new(args), console)
}

/// Does the job that `make` checks.
pub(crate) fn do_job(
    make: impl FnOnce() -> anyhow::Result<Job>,
    console: &Console,
) -> anyhow::Result<ExitStatus> {
    let (done, total) = timed(|| {
        let job = make()?;
        let (prepared, read) = timed(|| Prepared::read(&job.source));
        let prepared = prepared?;
        let outputs = outputs_on(&prepared.targets, &job);
        check_outputs(&prepared, &outputs, &job)?;
        for note in &prepared.notes {
            console.summary(&format_args!("note: {note}"));
        }
        let ((bound, bind), found) =
            rayon::join(|| timed(|| Bound::new(prepared)), || Found::read(&job));
        let mut ready = Ready::new(bound?, found?, &job, console)?;
        let drapes = drape_all(&mut ready, &job, &outputs, console)?;
        let seconds = OnceSeconds {
            read,
            bind,
            total: 0.0,
        };
        anyhow::Ok((report_of(ready, &job, drapes, seconds), job))
    });
    let (mut report, job) = done?;
    report.seconds.total = total;
    publish(&report, &job, console)?;
    Ok(judge(&report, &job, console))
}

/// The garment, bound, and what it is draped on.
struct Bound {
    garment: Arc<BoundGarment>,
    /// How it came to the body, if it was made for another one.
    refit: Option<Arc<Refit>>,
    garment_file: io::ObjFile,
    garment_frame: Frame,
    /// Edges of the polygons of the garment.
    edges: Vec<[u32; 2]>,
    /// Pairs of its faces that run through each other at rest.
    crossings_at_rest: usize,
    rest: RestSource,
    targets: Vec<Target>,
    pose: Option<PoseSource>,
    motion: MotionOptions,
    warnings: Vec<Warning>,
}

impl Bound {
    fn new(prepared: Prepared) -> anyhow::Result<Self> {
        let Prepared {
            garment_file,
            garment_frame,
            garment,
            refit,
            rest,
            body,
            targets,
            pose,
            motion,
            notes: _,
        } = prepared;
        let unusual = || unusual(&garment, &body);
        let edges = || garment_file.polygon_edges();
        let bind = || Garment::new(garment.clone()).bind(&body);
        let (bound, (found, edges)) = rayon::join(bind, || rayon::join(unusual, edges));
        let garment = bound.with_context(|| {
            let (garment, body) = (garment_file.path().display(), rest.path.display());
            format!("cannot bind `{garment}` to `{body}`")
        })?;
        let crossings_at_rest = garment.cloth_crossings(garment.mesh().positions())?;
        let start = warning::of_start(&garment);
        let at = |path: &Path| {
            let path = path.to_path_buf();
            move |problem| Warning {
                path: path.clone(),
                problem,
            }
        };
        let small = garment_file.num_small_faces();
        let small = (small > 0).then_some(Problem::SmallFaces(small));
        let held = warning::of_body_in(garment.mesh(), garment.body());
        let start = small.into_iter().chain(held).chain(start);
        let of_garment = found.garment.into_iter().chain(start);
        let of_garment = of_garment.map(at(garment_file.path()));
        let warnings = of_garment.chain(found.body.into_iter().map(at(&rest.path)));
        Ok(Self {
            warnings: warnings.collect(),
            garment: Arc::new(garment),
            refit: refit.map(Arc::new),
            garment_file,
            garment_frame,
            edges,
            crossings_at_rest,
            rest,
            targets,
            pose,
            motion,
        })
    }
}

impl Bound {
    /// The garment as it was made `[vertex]`, in metres: what stretch is measured against.
    fn rest_positions(&self) -> &[Point3] {
        let made = (self.refit.as_ref()).map_or(&*self.garment, |refit| refit.garment());
        made.mesh().positions()
    }
}

/// What is unusual about the two meshes.
struct Unusual {
    garment: Vec<Problem>,
    body: Vec<Problem>,
}

fn unusual(garment: &TriMesh, body: &Body) -> Unusual {
    let of_body = || warning::of_body(body);
    let (garment, body) = rayon::join(|| warning::of_garment(garment), of_body);
    Unusual { garment, body }
}

fn drape_all(
    ready: &mut Ready,
    job: &Job,
    outputs: &[PathBuf],
    console: &Console,
) -> anyhow::Result<Vec<DrapeOutput>> {
    let bound = &ready.bound;
    for folder in job.folder.iter().chain(&job.new_folders) {
        output::open_folder(folder)?;
    }
    let has_named = bound.targets.iter().any(|target| target.stem.is_some());
    if let Some(folder) = job.body_out.as_ref().filter(|_| has_named) {
        output::open_folder(folder)?;
    }
    let is_take = bound.pose.is_some() && bound.targets.len() > 1 && !job.frames_alone;
    let mut take = is_take.then(|| Take::new(&ready.draper));
    let bar = console.progress(bound.targets.len());
    let mut drapes = Vec::with_capacity(bound.targets.len());
    for (target, output) in bound.targets.iter().zip(outputs) {
        bar.set_message(target.path.display().to_string());
        let (drape, problems) = drape_one((ready, take.as_mut()), target, output, job, console)?;
        let warnings = problems.into_iter().map(|problem| Warning {
            path: output.clone(),
            problem,
        });
        drapes.push((drape, warnings.collect::<Vec<_>>()));
        bar.inc(1);
    }
    bar.finish_and_clear();
    let (drapes, warnings): (Vec<_>, Vec<_>) = drapes.into_iter().unzip();
    ready.bound.warnings.extend(warnings.into_iter().flatten());
    Ok(drapes)
}

#[expect(
    clippy::too_many_lines,
    reason = "a part of the report after the other"
)]
fn drape_one(
    (ready, take): (&Ready, Option<&mut Take<'_>>),
    target: &Target,
    output: &Path,
    job: &Job,
    console: &Console,
) -> anyhow::Result<(DrapeOutput, Vec<Problem>)> {
    let bound = &ready.bound;
    let mut times = Vec::with_capacity(job.repeat as usize);
    let mut draped = drape_timed(ready, target, console)?;
    times.push(draped.time);
    for _ in 1..job.repeat {
        draped = drape_timed(ready, target, console)?;
        times.push(draped.time);
    }
    let Draped {
        posed,
        mut drape,
        simulated,
        mut time,
    } = draped;
    let mut steps = None;
    if let Some(take) = take {
        let drape_untangle = drape.seconds.untangle;
        let frame = take.go_on(&posed, drape)?;
        time.untangle += frame.drape.seconds.untangle - drape_untangle;
        steps = Some(StepsReport::of(&frame));
        drape = frame.drape;
    }
    let provenance = &drape.provenance;
    let fallback = provenance.fallback.as_ref().map(ToString::to_string);
    let unsettled = (provenance.unrelaxed.as_ref()).map(|error| {
        let error = anyhow::Error::new(Arc::clone(error)).context("the cloth does not settle");
        format!("{error:#}")
    });
    let is_from_rest = provenance.relaxed_from == Some(Moment::Start);
    let rest = bound.rest_positions();
    let (free, trapped): (Vec<[u32; 2]>, Vec<[u32; 2]>) = bound
        .edges
        .iter()
        .partition(|edge| !edge.iter().any(|&vertex| is_trapped(&drape, vertex)));
    let stretch = edge_stretch(rest, &drape.positions, &free)?;
    let stretch_at_trapped = edge_stretch(rest, &drape.positions, &trapped)?;
    let mut problems: Vec<Problem> = warning::of_fit(posed.max_residual()).into_iter().collect();
    problems.extend((fallback.clone()).map(|reason| Problem::Fallback(reason, is_from_rest)));
    problems.extend(unsettled.map(Problem::Unsettled));
    problems.extend(warning::of_stretch(&stretch));
    let balance = (simulated.as_ref()).and_then(|simulated| simulated.balance.as_ref());
    problems.extend(simulated.as_ref().and_then(warning::of_rest));
    let failed = balance.filter(|balance| !balance.is_reached);
    problems.extend(failed.map(|found| Problem::OutOfBalance(found.steps, found.residual)));
    let inside = if let Some(report) = &drape.report {
        problems.extend(warning::of_result(report));
        None
    } else {
        let draped = bound
            .garment
            .mesh()
            .with_positions(drape.positions.clone())?;
        let found = PenetrationReport::of(&draped, posed.skin(), simulated.is_some());
        problems.extend(warning::of_penetration(&found));
        Some(found)
    };
    let cloth_crossings = bound.garment.cloth_crossings(&drape.positions)?;
    let positions = bound.garment_frame.to_file(drape.positions);
    let write = || bound.garment_file.write_with_positions(output, &positions);
    let (written, write) = timed(write);
    written?;
    if let Some(path) = &job.body_out {
        write_body(&body_out_of(path, target), &bound.rest, &posed)?;
    }
    time.write = write;
    let output = DrapeOutput {
        target: target.path.display().to_string(),
        output: output.display().to_string(),
        fit_residual_m: posed.max_residual(),
        has_other_shape: posed.shape_offsets().is_some(),
        untangle: drape.report.as_ref().map(Into::into),
        penetration: inside,
        simulated,
        fallback,
        steps,
        cloth_crossings,
        cloth_crossings_at_rest: bound.crossings_at_rest,
        stretch: Stretch {
            p50: stretch.p50,
            p99: stretch.p99,
            max: stretch.max,
            edges: stretch.count,
            max_at_trapped: (!trapped.is_empty()).then_some(stretch_at_trapped.max),
        },
        seconds: time,
        repeated: RepeatedSeconds::of(&times),
    };
    Ok((output, problems))
}

/// Whether a vertex is caught where the body runs through itself.
fn is_trapped(drape: &Drape, vertex: u32) -> bool {
    drape
        .is_trapped
        .get(vertex as usize)
        .is_some_and(|&is_trapped| is_trapped)
}

/// A garment on a body, and how long it took.
struct Draped {
    posed: PosedBody,
    drape: Drape,
    simulated: Option<SceneReport>,
    time: DrapeSeconds,
}

fn drape_timed(ready: &Ready, target: &Target, console: &Console) -> anyhow::Result<Draped> {
    let Ready { bound, draper, .. } = ready;
    let (posed, fit) = timed(|| target.posed(bound.garment.body()));
    let posed = posed?;
    let cannot = || {
        let garment = bound.garment_file.path().display();
        format!("cannot drape `{garment}` on `{}`", target.path.display())
    };
    let placed = match &ready.method {
        Method::Simulation(simulated) => {
            let placed = simulated.drape((bound, draper), target, &posed, console);
            placed.map(|(placed, report)| (placed, Some(report)))
        }
        Method::Warp | Method::Network(_) => {
            let placed = draper.place(&posed, &AtomicBool::new(false));
            placed
                .map(|placed| (placed, None))
                .map_err(anyhow::Error::from)
        }
    };
    let (placed, simulated) = placed.with_context(cannot)?;
    let drape = draper.untangle(placed).with_context(cannot)?;
    let time = DrapeSeconds {
        fit,
        warp: drape.seconds.warp,
        network: drape.seconds.predict,
        settle: drape.seconds.relax,
        untangle: drape.seconds.untangle,
        write: 0.0,
    };
    Ok(Draped {
        posed,
        drape,
        simulated,
        time,
    })
}

/// Writes a posed body with the text of the rest body's OBJ, or plainly if there is none.
fn write_body(path: &Path, rest: &RestSource, posed: &PosedBody) -> anyhow::Result<()> {
    let positions = rest.file_frame.to_file(posed.skin().positions().to_vec());
    if let Some(file) = &rest.file {
        file.write_with_positions(path, &positions)?;
    } else {
        let faces = posed.skin().faces().to_vec();
        io::write_obj(path, &TriMesh::new(positions, faces)?)?;
    }
    Ok(())
}

/// The report of a job that is done.
fn report_of(
    ready: Ready,
    job: &Job,
    drapes: Vec<DrapeOutput>,
    seconds: OnceSeconds,
) -> DrapeReport {
    let (method, settle_frames) = (ready.method_name(), ready.relax_frames());
    let (network, simulation) = (ready.network_report(), ready.simulation_report());
    let Ready { bound, choice, .. } = ready;
    let untangle = job.options.untangle;
    let shown = |path: &Path| path.display().to_string();
    let rest = bound.garment.body().rest();
    DrapeReport {
        schema: job.schema,
        version: env!("CARGO_PKG_VERSION"),
        garment: GarmentReport {
            path: shown(bound.garment_file.path()),
            vertices: bound.garment_file.num_vertices(),
            faces: bound.garment_file.num_polygons(),
            triangles: bound.garment.mesh().num_faces(),
            nodes: bound.garment.cloth().rest_nodes().len(),
            layered: bound.garment.num_layered(),
            units: bound.garment_frame.unit.to_string(),
            up: bound.garment_frame.up.to_string(),
        },
        rest_body: BodyReport {
            path: shown(&bound.rest.path),
            rig: shown(&bound.rest.rig_path),
            vertices: rest.num_vertices(),
            triangles: rest.num_faces(),
            joints: bound.garment.body().skeleton().num_joints(),
            units: bound.rest.frame.unit.to_string(),
            up: bound.rest.frame.up.to_string(),
        },
        pose: bound.pose.as_ref().map(|pose| PoseReport {
            path: shown(&pose.path),
            clip: pose.clip.clone(),
            frame: (pose.frames).map_or(Some(0), garnet::body::motion::FrameRange::first),
            frames: pose.frames.map(|frames| frames.to_string()),
            on_ground: bound.motion.on_ground,
            in_place: bound.motion.in_place,
            fps: bound.motion.fps,
        }),
        method,
        network,
        choice,
        simulation,
        settle_frames,
        untangled: untangle.is_some(),
        clearance_m: untangle.map(|options| options.clearance),
        max_penetration_m: job.max_penetration,
        max_crossing_faces: job.max_crossing,
        threads: rayon::current_num_threads(),
        repeat: job.repeat,
        drapes,
        peak_bytes: machine::peak_bytes(),
        seconds,
        warnings: bound.warnings.iter().map(WarningReport::from).collect(),
    }
}

fn method_name(warp: Warp) -> &'static str {
    match warp {
        Warp::Linear => "lbs",
        Warp::DualQuaternion => "dqs",
        Warp::Shape => "warp",
    }
}

/// Tells people and programs what was done.
fn publish(report: &DrapeReport, job: &Job, console: &Console) -> anyhow::Result<()> {
    if let Some(path) = &job.report {
        let mut text = serde_json::to_string_pretty(report)?;
        text.push('\n');
        output::write(path, text.as_bytes())?;
    }
    if console.is_json() || job.prints_report {
        print_document(report)?;
    }
    summary::tell(report, job.folder.as_deref(), console);
    Ok(())
}

/// Whether the result is within the limits that the user set.
fn judge(report: &DrapeReport, job: &Job, console: &Console) -> ExitStatus {
    if let Some(choice) = report.choice.as_ref().filter(|choice| !choice.is_met) {
        console.exceeded(&choice.text);
        return ExitStatus::LimitExceeded;
    }
    let depth = |drape: &DrapeOutput| match (&drape.untangle, &drape.penetration) {
        (Some(untangle), _) => untangle.deepest_m,
        (None, Some(found)) => found.deepest_m,
        (None, None) => 0.0,
    };
    let crossing = |drape: &DrapeOutput| match (&drape.untangle, &drape.penetration) {
        (Some(untangle), _) => untangle.crossing_faces,
        (None, Some(found)) => found.crossing_faces,
        (None, None) => 0,
    };
    let mut status = ExitStatus::Done;
    let of = report.drapes.len();
    let drapes = || report.drapes.iter();
    let worst = drapes().max_by(|a, b| depth(a).total_cmp(&depth(b)));
    if let (Some(limit), Some(worst)) = (job.max_penetration, worst)
        && depth(worst) > limit
    {
        console.exceeded(&format_args!(
            "{} of {of} drapes end deeper than {} mm in the body, the worst {:.1} mm (`{}`)",
            drapes().filter(|drape| depth(drape) > limit).count(),
            1e3 * limit,
            1e3 * depth(worst),
            worst.output
        ));
        status = ExitStatus::LimitExceeded;
    }
    let worst = drapes().max_by_key(|drape| crossing(drape));
    if let (Some(limit), Some(worst)) = (job.max_crossing, worst)
        && crossing(worst) > limit
    {
        console.exceeded(&format_args!(
            "{} of {of} drapes cross the skin with more than {limit} faces, the worst with {} (`{}`)",
            drapes().filter(|drape| crossing(drape) > limit).count(),
            crossing(worst),
            worst.output
        ));
        status = ExitStatus::LimitExceeded;
    }
    status
}
