//! `garnet drape`: a garment on bodies.

mod args;
mod choice;
mod learned;
mod outputs;
mod prepared;
mod report;
mod settled;
mod simulated;
mod summary;
mod timing;
mod warning;

use std::path::{Path, PathBuf};

use anyhow::Context;
use garnet::{
    Body, BoundGarment, Drape, DrapeOptions, Draper, Garment, Moment, Point3, PosedBody, Refit,
    TriMesh, Warp,
    data::SceneReport,
    edge_stretch,
    io::{self, Frame, PoseSource, RestSource, Target},
    package::Settling,
};

pub(crate) use args::DrapeArgs;
pub(crate) use args::{InputArgs, Job, Simulation, Source, SourceFiles, UpName, units};
use choice::ChoiceReport;
use learned::{Found, Learned, Unbound};
use outputs::{body_out_of, check_outputs, outputs_on};
pub(crate) use prepared::Prepared;
pub(crate) use report::WarningReport;
use report::{
    BodyReport, DrapeOutput, DrapeReport, DrapeSeconds, GarmentReport, OnceSeconds,
    PenetrationReport, PoseReport, RepeatedSeconds, Stretch,
};
use settled::Settler;
use simulated::Teaching;
use timing::timed;
pub(crate) use warning::warnings_of;
use warning::{Problem, Warning};

use crate::{
    console::{Console, print_document},
    failure::{ExitStatus, Hint},
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
        let read_network = || match job.limit {
            None => Unbound::find(&job.network, &job.source),
            Some(_) => Ok(Found::NotAsked),
        };
        let ((bound, bind), unbound) = rayon::join(|| timed(|| Bound::new(prepared)), read_network);
        let mut bound = bound?;
        if let Some(simulation) = &job.simulation {
            bound.teacher = Some(Teaching::new(&bound, simulation, &job.source)?);
        }
        let found = match job.limit {
            None => unbound?.bound_to(&bound)?,
            Some(limit) => {
                let (found, choice) = choice::choose(&bound, &job, limit, console)?;
                if choice.is_met {
                    console.summary(&format_args!("note: {}", choice.text));
                }
                bound.choice = Some(choice);
                found
            }
        };
        match found {
            Found::Network(learned) => bound.learned = Some(*learned),
            Found::NotAsked => {}
            Found::NoneInPackage => console.summary(
                &"note: the package has no trained network: the garment is warped and untangled",
            ),
        }
        let settles = match (&bound.choice, &bound.learned) {
            (Some(choice), _) => choice.settles(),
            (None, learned) => learned.as_ref().is_some_and(Learned::settles),
        };
        let of_warp = Settling::of(Moment::Rest);
        let mut settling = (bound.learned.as_ref()).map_or(of_warp, Learned::settling);
        if !settles {
            settling.frames = 0;
        }
        match Settler::find(&bound, &job, settling) {
            Ok(settler) => bound.settler = settler,
            Err(error) if job.settle.is_some() => return Err(error),
            // A template that was cut and put on can be simulated, on its own body at least.
            Err(error) if bound.is_of_package(&job) => {
                return Err(error).hint(|| {
                    "the package is damaged: make it anew, or take a copy of it".to_owned()
                });
            }
            Err(error) => bound.warnings.push(Warning {
                path: bound.garment_file.path().to_path_buf(),
                problem: Problem::Unsettled(format!("{error:#}")),
            }),
        }
        let drapes = drape_all(&mut bound, &job, &outputs, console)?;
        let seconds = OnceSeconds {
            read,
            bind,
            total: 0.0,
        };
        let choice = bound.choice.take();
        anyhow::Ok((bound.report(&job, drapes, (seconds, choice)), job))
    });
    let (mut report, job) = done?;
    report.seconds.total = total;
    publish(&report, &job, console)?;
    Ok(judge(&report, &job, console))
}

/// The garment, bound, and what it is draped on.
struct Bound {
    garment: BoundGarment,
    /// How it came to the body, if it was made for another one.
    refit: Option<Refit>,
    garment_file: io::ObjFile,
    garment_frame: Frame,
    /// Edges of the polygons of the garment.
    edges: Vec<[u32; 2]>,
    body: Body,
    rest: RestSource,
    targets: Vec<Target>,
    pose: Option<PoseSource>,
    /// The simulation, if that is the method.
    teacher: Option<Teaching>,
    /// The network, if one drapes.
    learned: Option<Learned>,
    /// The simulation of what was put, if it settles.
    settler: Option<Settler>,
    /// How that was chosen, if it was.
    choice: Option<ChoiceReport>,
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
        let start = warning::of_start(&garment);
        let at = |path: &Path| {
            let path = path.to_path_buf();
            move |problem| Warning {
                path: path.clone(),
                problem,
            }
        };
        let of_garment = found.garment.into_iter().chain(start);
        let of_garment = of_garment.map(at(garment_file.path()));
        let warnings = of_garment.chain(found.body.into_iter().map(at(&rest.path)));
        Ok(Self {
            warnings: warnings.collect(),
            garment,
            refit,
            garment_file,
            garment_frame,
            edges,
            body,
            rest,
            targets,
            pose,
            teacher: None,
            learned: None,
            settler: None,
            choice: None,
        })
    }
}

impl Bound {
    /// Whether the garment is that of a package, on the body of the package.
    fn is_of_package(&self, job: &Job) -> bool {
        let has_package = matches!(&job.source, Source::Files(files) if files.package.is_some());
        has_package && self.refit.is_none()
    }

    /// The garment as it was made `[vertex]`, in metres: what stretch is measured against.
    fn rest_positions(&self) -> &[Point3] {
        let made = (self.refit.as_ref()).map_or(&self.garment, Refit::garment);
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
    bound: &mut Bound,
    job: &Job,
    outputs: &[PathBuf],
    console: &Console,
) -> anyhow::Result<Vec<DrapeOutput>> {
    for folder in job.folder.iter().chain(&job.new_folders) {
        output::open_folder(folder)?;
    }
    let has_named = bound.targets.iter().any(|target| target.stem.is_some());
    if let Some(folder) = job.body_out.as_ref().filter(|_| has_named) {
        output::open_folder(folder)?;
    }
    let mut way = Way {
        draper: Draper::with_options(job.options),
        learned: bound.learned.take(),
        settler: bound.settler.take(),
    };
    let bar = console.progress(bound.targets.len());
    let mut drapes = Vec::with_capacity(bound.targets.len());
    for (target, output) in bound.targets.iter().zip(outputs) {
        bar.set_message(target.path.display().to_string());
        let (drape, problems) = drape_one(bound, &mut way, target, output, job, console)?;
        let warnings = problems.into_iter().map(|problem| Warning {
            path: output.clone(),
            problem,
        });
        drapes.push((drape, warnings.collect::<Vec<_>>()));
        bar.inc(1);
    }
    bar.finish_and_clear();
    bound.learned = way.learned;
    bound.settler = way.settler;
    let (drapes, warnings): (Vec<_>, Vec<_>) = drapes.into_iter().unzip();
    bound.warnings.extend(warnings.into_iter().flatten());
    Ok(drapes)
}

/// What drapes.
struct Way {
    draper: Draper,
    learned: Option<Learned>,
    settler: Option<Settler>,
}

fn drape_one(
    bound: &Bound,
    way: &mut Way,
    target: &Target,
    output: &Path,
    job: &Job,
    console: &Console,
) -> anyhow::Result<(DrapeOutput, Vec<Problem>)> {
    let mut times = Vec::with_capacity(job.repeat as usize);
    let mut draped = drape_timed(bound, way, target, console)?;
    times.push(draped.time);
    for _ in 1..job.repeat {
        draped = drape_timed(bound, way, target, console)?;
        times.push(draped.time);
    }
    let Draped {
        posed,
        drape,
        simulated,
        fallback,
        unsettled,
        mut time,
    } = draped;
    let rest = bound.rest_positions();
    let (free, trapped): (Vec<[u32; 2]>, Vec<[u32; 2]>) = bound
        .edges
        .iter()
        .partition(|edge| !edge.iter().any(|&vertex| is_trapped(&drape, vertex)));
    let stretch = edge_stretch(rest, &drape.positions, &free)?;
    let stretch_at_trapped = edge_stretch(rest, &drape.positions, &trapped)?;
    let mut problems: Vec<Problem> = warning::of_fit(posed.max_residual()).into_iter().collect();
    let is_from_rest = time.settle > 0.0;
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
    /// Why the network was not used.
    fallback: Option<String>,
    /// Why the cloth was left where it was put.
    unsettled: Option<String>,
    time: DrapeSeconds,
}

fn drape_timed(
    bound: &Bound,
    way: &mut Way,
    target: &Target,
    console: &Console,
) -> anyhow::Result<Draped> {
    let (posed, fit) = timed(|| target.posed(&bound.body));
    let target_body = posed?;
    let cannot = || {
        let garment = bound.garment_file.path().display();
        format!("cannot drape `{garment}` on `{}`", target.path.display())
    };
    let home = target_body.at_home(&bound.body).with_context(cannot)?;
    let posed = home.body();
    let Way {
        draper,
        learned,
        settler,
    } = way;
    let is_on_way = learned.as_ref().is_some_and(Learned::is_on_way);
    let (mut network, mut fallback) = (0.0, None);
    let (brought, mut warp) = timed(|| match (&bound.teacher, learned) {
        (Some(teaching), _) => teaching.drape(bound, target, &home, console),
        (None, Some(learned)) => {
            let (moved, seconds) = learned.drape(bound, posed)?;
            (network, fallback) = (seconds, moved.fallback);
            Ok((moved.garment, None))
        }
        (None, None) => Ok((draper.warp(&bound.garment, posed)?, None)),
    });
    warp -= network;
    let (mut warped, simulated) = brought.with_context(cannot)?;
    let (mut settle, mut unsettled) = (0.0, None);
    let settled = settler.as_ref().and_then(|settler| match fallback {
        None => Some(settler.settled(bound, posed, &warped)),
        // Of a motion that is simulated in any case the network has told the first half.
        Some(_) if is_on_way => Some(settler.whole_way(bound, posed)),
        // What fell back to the warp is far from where cloth rests.
        Some(_) => None,
    });
    let is_settled = matches!(settled, Some(Ok(_)));
    match settled {
        Some(Ok(settled)) => (warped, settle) = settled,
        Some(Err(error)) => unsettled = Some(format!("{error:#}")),
        None => {}
    }
    let is_left_on_way = is_on_way && fallback.is_none() && !is_settled;
    if is_left_on_way {
        warped = draper.warp(&bound.garment, posed).with_context(cannot)?;
    }
    let (drape, untangle) = timed(|| draper.finish(&bound.garment, posed, &warped));
    let mut drape = drape.with_context(cannot)?;
    drape.positions = home.to_target(drape.positions);
    let time = DrapeSeconds {
        fit,
        warp,
        network,
        settle,
        untangle,
        write: 0.0,
    };
    drop(home);
    Ok(Draped {
        posed: target_body,
        drape,
        simulated,
        fallback: match fallback {
            Some(reason) => Some(reason.to_string()),
            None if is_left_on_way => {
                Some("what is midway could not be simulated further".to_owned())
            }
            None => None,
        },
        unsettled,
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

impl Bound {
    fn report(
        &self,
        job: &Job,
        drapes: Vec<DrapeOutput>,
        (seconds, choice): (OnceSeconds, Option<ChoiceReport>),
    ) -> DrapeReport {
        let DrapeOptions { warp, untangle } = job.options;
        let shown = |path: &Path| path.display().to_string();
        let rest = self.body.rest();
        DrapeReport {
            schema: job.schema,
            version: env!("CARGO_PKG_VERSION"),
            garment: GarmentReport {
                path: shown(self.garment_file.path()),
                vertices: self.garment_file.num_vertices(),
                faces: self.garment_file.num_polygons(),
                triangles: self.garment.mesh().num_faces(),
                nodes: self.garment.cloth().rest().len(),
                units: self.garment_frame.unit.to_string(),
                up: self.garment_frame.up.to_string(),
            },
            rest_body: BodyReport {
                path: shown(&self.rest.path),
                rig: shown(&self.rest.rig_path),
                vertices: rest.num_vertices(),
                triangles: rest.num_faces(),
                joints: self.body.skeleton().num_joints(),
                units: self.rest.frame.unit.to_string(),
                up: self.rest.frame.up.to_string(),
            },
            pose: self.pose.as_ref().map(|pose| PoseReport {
                path: shown(&pose.path),
                frame: pose.frames.map_or(0, garnet::motion::FrameRange::first),
            }),
            method: match (&self.teacher, &self.learned) {
                (Some(_), _) => "sim".to_owned(),
                (None, Some(learned)) => learned.name().to_owned(),
                (None, None) => method_name(warp).to_owned(),
            },
            network: self.learned.as_ref().map(Learned::report),
            choice,
            simulation: self.teacher.as_ref().map(Teaching::report),
            settle_frames: self.settler.as_ref().map_or(0, Settler::frames),
            untangled: untangle.is_some(),
            clearance_m: untangle.map(|options| options.clearance),
            max_penetration_m: job.max_penetration,
            max_crossing_faces: job.max_crossing,
            threads: rayon::current_num_threads(),
            repeat: job.repeat,
            drapes,
            peak_bytes: machine::peak_bytes(),
            seconds,
            warnings: self.warnings.iter().map(WarningReport::from).collect(),
        }
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
