//! `garnet drape`: a garment on bodies.

mod all;
mod args;
mod batch;
mod chain;
mod choice;
mod exported;
mod fit;
mod followed;
mod held_body;
mod hide;
mod lying;
mod names;
mod outfit;
mod outputs;
mod prepared;
mod ready;
mod report;
mod simulated;
mod sink;
mod strained;
mod summary;
mod tailored;
mod timing;
mod told;
mod viewing;
mod warning;

use std::{path::Path, sync::Arc};

use anyhow::Context;
use garnet::{
    Body, BoundGarment, Garment, Point3, TriMesh, Warp,
    drape::{Refit, Tubes},
    io::{self, Frame, MotionOptions, PoseSource, RestSource, Target},
};

use tracing::info;

use all::{All, Part, drape_all};
pub(crate) use args::DrapeArgs;
pub(crate) use args::{InputArgs, Job, Simulation, Source, SourceFiles, UpName, units};
use held_body::of_body_in;
use outputs::{check_outputs, outputs_on};
pub(crate) use prepared::Prepared;
use ready::{Found, Ready};
pub(crate) use report::WarningReport;
use report::{BodyReport, DrapeOutput, DrapeReport, GarmentReport, OnceSeconds, PoseReport};
use tailored::{Cut, by_wearer};
use timing::timed;
pub(crate) use warning::warnings_of;
use warning::{Problem, Warning};

use crate::{
    console::{Console, print_document},
    failure::ExitStatus,
    interrupt::{Interrupted, tell_on_interrupt},
    machine, output,
};

/// Reads, binds, drapes on each body, writes and reports.
pub(crate) fn run(args: DrapeArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    if let Some(jobs) = &args.batch {
        return batch::run(jobs, console);
    }
    match args.outfit()? {
        Some(outfit) => {
            let told = format!(
                "`{}` has the garments that are done; begin anew",
                outfit.folder.display()
            );
            tell_on_interrupt(told, vec![outfit.folder.clone()], console)?;
            outfit::run(outfit, console).map(|(status, _)| status)
        }
        None => do_job(|| Job::new(args), console),
    }
}

/// Does the job that `make` checks.
pub(crate) fn do_job(
    make: impl FnOnce() -> anyhow::Result<Job>,
    console: &Console,
) -> anyhow::Result<ExitStatus> {
    let make = || {
        let job = make()?;
        let is_streamed = job.cache.is_some() || job.body_cache.is_some() || job.follows;
        if let Some(folder) = job.folder.as_ref().filter(|_| !is_streamed) {
            let told = format!(
                "`{}` has the drapes that are done; begin anew",
                folder.display()
            );
            let made = job.new_folders.iter().chain([folder]);
            tell_on_interrupt(told, made.cloned().collect(), console)?;
        }
        Ok(job)
    };
    let (report, job) = match done(make, console) {
        Err(error) if error.downcast_ref::<Interrupted>().is_some() => {
            console.failure(&error);
            return Ok(ExitStatus::Interrupted);
        }
        done => done?,
    };
    publish(&report, &job, console)?;
    Ok(judge(&report, &job, console))
}

/// Reads, binds, drapes on each body and writes; what was done is still to be told.
fn done(
    make: impl FnOnce() -> anyhow::Result<Job>,
    console: &Console,
) -> anyhow::Result<(DrapeReport, Job)> {
    let (done, total) = timed(|| {
        let job = make()?;
        let (prepared, read) = timed(|| Prepared::read(&job.source));
        let mut prepared = prepared?;
        told::read(&prepared, read);
        let all = outputs_on(&prepared.targets, &job);
        check_outputs(&prepared, &all, &job)?;
        let part = Part::of(&job, &mut prepared, all)?;
        for note in &prepared.notes {
            console.summary(&format_args!("note: {note}"));
        }
        let mut seconds = OnceSeconds {
            read,
            ..OnceSeconds::default()
        };
        let mut whole: Option<DrapeReport> = None;
        for (prepared, part) in by_wearer(prepared, part, &job)? {
            let cut = prepared.cut.clone();
            let bind = || timed(|| Bound::new(prepared));
            let (bound, bind, found) = Found::beside(&job, cut.as_deref(), bind)?;
            info!(seconds = bind, "bound");
            let mut ready = Ready::new(bound, found, &job, console)?;
            told::method(&ready, &job);
            if let Some(path) = &job.export_inputs {
                exported::write(&ready, path)?;
            }
            let (done, drape) = timed(|| drape_all(&mut ready, &job, &part, console));
            let done = done?;
            info!(
                seconds = drape,
                drapes = done.drapes.len(),
                threads_a_drape = done.threads,
                "draped and written"
            );
            seconds.bind += bind;
            seconds.drape += drape;
            let report = report_of(ready, &job, done, seconds);
            match &mut whole {
                None => whole = Some(report),
                Some(whole) => whole.extend(report),
            }
        }
        let report = whole.context("there is nothing to drape on")?;
        anyhow::Ok((report, job))
    });
    let (mut report, job) = done?;
    report.seconds.total = total;
    Ok((report, job))
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
    /// The limbs that are in its cloth at rest.
    tubes: Tubes,
    rest: RestSource,
    targets: Vec<Target>,
    pose: Option<PoseSource>,
    motion: MotionOptions,
    /// Seconds from each target to the next, if they are frames of a motion that says.
    frame_time: Option<f64>,
    /// The garment as it was cut for its wearer, if it was.
    cut: Option<Arc<Cut>>,
    /// Whether it is cut to the measures of its wearer, and no otherwise.
    is_made_for_wearer: bool,
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
            frame_time,
            cut,
            is_made_for_wearer,
            warnings,
            notes: _,
            tailoring: _,
            is_on_other: _,
            is_unit_named,
        } = prepared;
        let unusual = || unusual(&garment, &body);
        let edges = || garment_file.polygon_edges();
        let bind = || Garment::new(garment.clone()).bind(&body);
        let (bound, (found, edges)) = rayon::join(bind, || rayon::join(unusual, edges));
        let garment = bound.with_context(|| {
            let (garment, body) = (garment_file.path().display(), rest.path.display());
            format!("cannot bind `{garment}` to `{body}`")
        })?;
        let tubes = Tubes::new(&garment)?;
        let crossings_at_rest = garment.cloth_crossings(garment.mesh().positions())?;
        let start = warning::of_start(&garment);
        let at = |path: &Path| {
            let path = path.to_path_buf();
            move |problem| Warning {
                path: path.clone(),
                problem,
            }
        };
        let holes = warning::of_holes(&garment);
        let small = garment_file.num_small_faces();
        let small = (small > 0).then_some(Problem::SmallFaces(small));
        let held = of_body_in(&garment);
        let near = warning::of_rims(&garment);
        let sides = warning::of_sides(&garment);
        let unusual = match near {
            Some(_) => warning::sewn(found.garment, &garment),
            None => found.garment,
        };
        let start = small
            .into_iter()
            .chain(near)
            .chain(held)
            .chain(sides)
            .chain(start)
            .chain(holes);
        let of_garment = unusual.into_iter().chain(start);
        let of_garment = of_garment.map(at(garment_file.path()));
        let is_told = |problem: &Problem| {
            // Whoever has named the unit knows how tall the body is.
            !(is_unit_named && matches!(problem, Problem::SmallBody(_)))
        };
        let of_body = found.body.into_iter().filter(is_told);
        let of_body = of_body.map(at(&rest.path));
        let warnings = warnings.into_iter().chain(of_garment).chain(of_body);
        Ok(Self {
            is_made_for_wearer,
            warnings: warnings.collect(),
            garment: Arc::new(garment),
            refit: refit.map(Arc::new),
            garment_file,
            garment_frame,
            edges,
            crossings_at_rest,
            tubes,
            rest,
            targets,
            pose,
            motion,
            frame_time,
            cut,
        })
    }
}

impl Bound {
    /// The garment as it was made `[vertex]`, in metres: what stretch is measured against.
    fn rest_positions(&self) -> &[Point3] {
        let made = (self.refit.as_ref()).map_or(&*self.garment, |refit| refit.garment());
        made.mesh().positions()
    }

    /// The faces of the body, as its file has them: without those that close holes of the skin.
    fn rest_faces(&self) -> Vec<[u32; 3]> {
        match &self.rest.file {
            Some(file) => file.triangles(),
            None => self.garment.body().rest().faces().to_vec(),
        }
    }
}

/// What is unusual about the two meshes.
struct Unusual {
    garment: Vec<Problem>,
    body: Vec<Problem>,
}

fn unusual(garment: &TriMesh, body: &Body) -> Unusual {
    let of_body = || warning::of_body(body);
    let of_garment = || {
        let mut problems = warning::of_garment(garment);
        problems.extend(warning::of_openings(garment, body));
        problems
    };
    let (garment, body) = rayon::join(of_garment, of_body);
    Unusual { garment, body }
}

/// The report of a job that is done.
fn report_of(
    ready: Ready,
    job: &Job,
    All {
        drapes,
        hidden_faces,
        threads,
    }: All,
    seconds: OnceSeconds,
) -> DrapeReport {
    let (method, settle_frames) = (ready.method_name(), ready.relax_frames());
    let (network, simulation) = (ready.network_report(), ready.simulation_report());
    let no_fit = ready.fitting.as_ref().err().cloned();
    let Ready { bound, choice, .. } = ready;
    let untangle = ready.draper.options().untangle;
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
            over_holes: warning::num_over_holes(&bound.garment),
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
        threads_a_drape: threads,
        repeat: job.repeat,
        drapes_per_second: drapes.len() as f64 / seconds.drape.max(1e-9),
        hidden_faces,
        cuts: (bound.cut.iter()).map(|cut| cut.report.clone()).collect(),
        no_fit,
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
    let cache = job.cache.as_ref().map(|cache| cache.path.as_path());
    summary::tell(report, job.folder.as_deref().or(cache), console);
    Ok(())
}

/// Whether the result is within the limits that the user set.
fn judge(report: &DrapeReport, job: &Job, console: &Console) -> ExitStatus {
    if let Some(choice) = report.choice.as_ref().filter(|choice| !choice.is_met) {
        console.exceeded(std::slice::from_ref(&choice.text));
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
    let mut exceeded = Vec::new();
    let of = report.drapes.len();
    let drapes = || report.drapes.iter();
    let worst = drapes().max_by(|a, b| depth(a).total_cmp(&depth(b)));
    if let (Some(limit), Some(worst)) = (job.max_penetration, worst)
        && depth(worst) > limit
    {
        exceeded.push(format!(
            "{} of {of} drapes end deeper than {} mm in the body, the worst {:.1} mm (`{}`)",
            drapes().filter(|drape| depth(drape) > limit).count(),
            1e3 * limit,
            1e3 * depth(worst),
            worst.output
        ));
    }
    let worst = drapes().max_by_key(|drape| crossing(drape));
    if let (Some(limit), Some(worst)) = (job.max_crossing, worst)
        && crossing(worst) > limit
    {
        exceeded.push(format!(
            "{} of {of} drapes cross the skin with more than {limit} faces, the worst with {} (`{}`)",
            drapes().filter(|drape| crossing(drape) > limit).count(),
            crossing(worst),
            worst.output
        ));
    }
    if exceeded.is_empty() {
        return ExitStatus::Done;
    }
    console.exceeded(&exceeded);
    ExitStatus::LimitExceeded
}
