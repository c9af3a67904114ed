//! Drapes on all bodies: one a thread, and in order where frames go on from each other.

use std::{
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use anyhow::Context;
use garnet::{
    Drape, Point3, PosedBody,
    data::SceneReport,
    drape::{KeyFrame, KeySpacing, Placed, PlacedBy},
    io::largest_distance,
    mesh::edge_stretch,
    package::Moment,
};
use rayon::prelude::*;

use super::{
    args::{Job, Shard},
    chain::{Chain, Linked},
    followed::Followed,
    hide::Hiding,
    lying::{fallen, lies_along_z},
    outputs::bodies_folder,
    prepared::Prepared,
    ready::{Method, Ready},
    report::{
        DrapeOutput, DrapeSeconds, LimbReport, PenetrationReport, RepeatedSeconds, StepsReport,
        Stretch,
    },
    sink::{Sink, note_of_time, write_files},
    strained,
    timing::timed,
    viewing::Viewing,
    warning::{self, Problem, Warning},
};
use crate::{
    console::Console,
    failure::refused,
    interrupt::{Interrupted, stop_flag},
    output,
    workers::in_order,
};

/// Frames that are draped before those of a part at least, so that its cloth comes from where that
/// of the part before it goes. Fewer let cloth jump from part to part; more are made twice.
const WARM_UP: usize = 24;

/// Frames of a motion that are looked at together, each on a thread, once they have gone on from
/// each other. More keep threads busier, and take memory.
const LOOKED_AT: usize = 8;

/// The part of the targets that is draped.
pub(super) struct Part {
    /// How many of them come first to warm up, and are not written.
    pub(super) warm_up: usize,
    /// How many come last, which those before are smoothed with, and are not written.
    pub(super) after: usize,
    /// Where drapes go, those that are not written too.
    pub(super) outputs: Vec<PathBuf>,
}

impl Part {
    /// The part of the job, of whose targets the others are left out.
    pub(super) fn of(
        job: &Job,
        prepared: &mut Prepared,
        mut outputs: Vec<PathBuf>,
    ) -> anyhow::Result<Self> {
        let Some(Shard { number, count }) = job.shard else {
            return Ok(Self {
                warm_up: 0,
                after: 0,
                outputs,
            });
        };
        let all = prepared.targets.len();
        if all < count {
            return Err(refused(
                format!("`--shard {number}/{count}` has no drape for each part"),
                format!("there are {all} drapes"),
                format!("make {all} parts or fewer"),
            ));
        }
        let [first, end] = [number - 1, number].map(|part| all * part / count);
        let (warm_up, after) = if is_take(prepared.pose.is_some(), all, job) {
            let start = first.saturating_sub(WARM_UP);
            let last = (end + job.smooth).next_multiple_of(KeySpacing::LONGEST);
            // From key to key, which are those of the whole.
            let start = start - start % KeySpacing::LONGEST;
            (first - start, (last + 1).min(all) - end)
        } else {
            (0, 0)
        };
        prepared.targets.truncate(end + after);
        prepared.targets.drain(..first - warm_up);
        outputs.truncate(end + after);
        outputs.drain(..first - warm_up);
        Ok(Self {
            warm_up,
            after,
            outputs,
        })
    }

    /// Whether a target is written.
    fn holds(&self, number: usize) -> bool {
        (self.warm_up..self.outputs.len() - self.after).contains(&number)
    }
}

/// Whether targets are frames that go on from each other.
fn is_take(is_posed: bool, num_targets: usize, job: &Job) -> bool {
    is_posed && num_targets > 1 && !job.frames_alone
}

/// Of garments with layers more pairs of faces through each other than this, for each of their
/// faces, are warned of. Layers that keep their order have half as many in wide poses; a higher
/// value warns of fewer.
const MOST_PAIRS: f64 = 0.04;

/// What came of all drapes.
pub(super) struct All {
    pub(super) drapes: Vec<DrapeOutput>,
    pub(super) hidden_faces: Option<usize>,
    /// How many threads shared a drape.
    pub(super) threads: usize,
}

/// Drapes on all targets, writes and reports.
#[expect(clippy::too_many_lines, reason = "a step after the other")]
pub(super) fn drape_all(
    ready: &mut Ready,
    job: &Job,
    part: &Part,
    console: &Console,
) -> anyhow::Result<All> {
    let bound = &ready.bound;
    let count = bound.targets.len();
    let num_written = count - part.warm_up - part.after;
    let is_streamed = job.cache.is_some() || job.body_cache.is_some() || job.follows;
    let stop = if is_streamed {
        stop_flag()?
    } else {
        Arc::default()
    };
    if let Some(note) = note_of_time(bound, job) {
        console.summary(&note);
    }
    let followed = followed(ready, job, &stop, console)?;
    for folder in job.folder.iter().chain(&job.new_folders) {
        output::open_folder(folder)?;
    }
    if let Some(folder) = bodies_folder(&bound.targets, job) {
        output::open_folder(folder)?;
    }
    let mut sink = Sink::open(bound, job, num_written)?;
    let mut hiding = job.hide.as_ref().map(|path| Hiding::new(path, bound));
    let mut viewing = job.view.as_deref().map(Viewing::new);
    // A part of a motion is one, too, if it has a frame alone.
    let goes_on = is_take(bound.pose.is_some(), count, job);
    let mut chain = goes_on.then(|| Chain::new(&ready.draper, job.smooth));
    let keys = keys(ready, (job, goes_on), &stop)?;
    let threads = rayon::current_num_threads().min(keys.len());
    let is_shared = threads < 2 || job.repeat > 1;
    let bar = console.progress(count);
    let mut drapes = Vec::with_capacity(num_written);
    let frame = Frame {
        ready,
        job,
        part,
        goes_on,
        has_between: keys.len() < count,
        stop: &stop,
        followed: followed.as_ref(),
        console: (count == 1).then_some(console),
    };
    let mut last: Option<(Vec<Point3>, Vec<Point3>)> = None;
    let mut write = |number: usize, finished: Finished| -> anyhow::Result<()> {
        let target = &bound.targets[number];
        bar.set_message(target.path.display().to_string());
        let Finished {
            posed,
            drape,
            mut output,
            problems,
        } = finished;
        if job.follows {
            let now = (drape.positions.clone(), posed.skin().positions().to_vec());
            let (cloth, body) = last.as_ref().unwrap_or(&now);
            output.steps = Some(StepsReport {
                cloth_m: largest_distance(cloth, &now.0),
                body_m: largest_distance(body, &now.1),
                held_back: 0,
                is_between: false,
            });
            last = Some(now);
        }
        bar.inc(1);
        if !part.holds(number) {
            return Ok(());
        }
        if let Some(hiding) = &mut hiding {
            hiding.see(bound, &drape, &posed);
        }
        if let Some(viewing) = &mut viewing {
            let fitting = ready.fitting.as_ref().ok();
            viewing.see((bound, target), fitting, &drape, &posed)?;
        }
        let (pushed, seconds) = timed(|| sink.push(&drape.positions, &posed));
        pushed?;
        output.seconds.write += seconds;
        let path = &part.outputs[number];
        let warnings = problems.into_iter().map(|problem| Warning {
            path: path.clone(),
            problem,
        });
        drapes.push((output, warnings.collect::<Vec<_>>()));
        Ok(())
    };
    let mut linked = Vec::new();
    let mut take_up = |at: usize, made: Made| match (made, chain.as_mut()) {
        (Made::Finished(finished), _) => write(keys[at], *finished),
        (Made::Draped(draped, key), Some(chain)) => {
            let before = at.checked_sub(1).map_or(0, |before| keys[before] + 1);
            let mut between = before..keys[at];
            let mut link = |next| frame.link(next, &mut linked, &mut write);
            between.try_for_each(|number| {
                link(frame.between(number, (keys[at], key.as_deref()), chain)?)
            })?;
            link(chain.go_on(keys[at], *draped, key.map(|key| *key))?)
        }
        (Made::Draped(draped, _), None) => {
            write(keys[at], frame.finished(keys[at], *draped, None)?)
        }
    };
    let made = |at: usize| frame.made(keys[at]);
    let mut done = if is_shared {
        (0..keys.len()).try_for_each(|at| take_up(at, made(at)?))
    } else {
        in_order(keys.len(), threads, made, &mut take_up)
    };
    while let (Ok(()), Some(chain)) = (&done, chain.as_mut()) {
        let Some(next) = chain.next_left()? else {
            break;
        };
        done = frame.link(Some(next), &mut linked, &mut write);
    }
    let done = done.and_then(|()| frame.look_at(&mut linked, &mut write));
    bar.finish_and_clear();
    if stop.load(Ordering::Relaxed) {
        return Err(anyhow::Error::new(Interrupted {
            told: told_of_stop(job),
        }));
    }
    done?;
    sink.finish()?;
    followed.map_or(Ok(()), Followed::remove)?;
    let hidden_faces = hiding.map(|hiding| hiding.finish(bound)).transpose()?;
    viewing.map_or(Ok(()), |viewing| {
        viewing.finish(bound, &job.source, console)
    })?;
    let (drapes, warnings): (Vec<_>, Vec<_>) = drapes.into_iter().unzip();
    ready.bound.warnings.extend(warnings.into_iter().flatten());
    Ok(All {
        drapes,
        hidden_faces,
        threads: if is_shared {
            rayon::current_num_threads()
        } else {
            1
        },
    })
}

/// The targets that are draped by themselves: all of them, or key frames of a motion.
///
/// A warp costs no more than what lies between keys, and what is simulated is asked for as that.
fn keys(
    ready: &Ready,
    (job, goes_on): (&Job, bool),
    stop: &AtomicBool,
) -> anyhow::Result<Vec<usize>> {
    let bound = &ready.bound;
    let is_each = job.key_spacing == KeySpacing::NONE;
    if !goes_on || is_each || !matches!(ready.method, Method::Network(_)) {
        return Ok((0..bound.targets.len()).collect());
    }
    let transforms = bound.targets.par_iter().map(|target| {
        if stop.load(Ordering::Relaxed) {
            anyhow::bail!("stopped");
        }
        let posed = target.posed(bound.garment.body())?;
        Ok(posed.posed_from_rest().to_vec())
    });
    let transforms = transforms.collect::<anyhow::Result<Vec<_>>>()?;
    Ok(job.key_spacing.keys(&bound.garment, &transforms))
}

/// What is told if files of all frames are left before they are whole.
fn told_of_stop(job: &Job) -> String {
    let files = job.cache.iter().chain(&job.body_cache);
    let names: Vec<String> = files
        .map(|file| format!("`{}`", file.path.display()))
        .collect();
    format!("{} is as it was before; begin anew", names.join(" and "))
}

/// The frames of a motion along which the cloth is simulated, if it is.
fn followed(
    ready: &Ready,
    job: &Job,
    stop: &AtomicBool,
    console: &Console,
) -> anyhow::Result<Option<Followed>> {
    let (Method::Simulation(simulated), Some(simulator), true) =
        (&ready.method, ready.draper.simulator(), job.follows)
    else {
        return Ok(None);
    };
    let what = (&ready.bound, &**simulator, simulated.quality());
    Followed::new(what, job, stop, console).map(Some)
}

/// What all drapes of a job share.
#[derive(Clone, Copy)]
pub(super) struct Frame<'a> {
    ready: &'a Ready,
    job: &'a Job,
    part: &'a Part,
    /// Whether frames go on from each other.
    goes_on: bool,
    /// Whether frames lie between those that are draped by themselves.
    has_between: bool,
    stop: &'a AtomicBool,
    /// The frames that were simulated one after the other, if they were.
    followed: Option<&'a Followed>,
    /// What draws a bar for each drape, if there is one alone.
    console: Option<&'a Console>,
}

/// What can be made of a frame apart from the others.
enum Made {
    /// All of it.
    Finished(Box<Finished>),
    /// What the next step starts from, and what frames before and after it lie between, if any do.
    Draped(Box<Draped>, Option<Box<KeyFrame>>),
}

/// A garment on a body, and how long it took.
pub(super) struct Draped {
    pub(super) posed: PosedBody,
    pub(super) drape: Drape,
    pub(super) simulated: Option<SceneReport>,
    pub(super) time: DrapeSeconds,
    pub(super) repeated: Option<RepeatedSeconds>,
}

/// A drape with all that is told of it.
pub(super) struct Finished {
    pub(super) posed: PosedBody,
    pub(super) drape: Drape,
    pub(super) output: DrapeOutput,
    pub(super) problems: Vec<Problem>,
}

impl<'a> Frame<'a> {
    /// Of a job with one target.
    pub(super) fn alone(
        ready: &'a Ready,
        (job, part): (&'a Job, &'a Part),
        (console, stop): (&'a Console, &'a AtomicBool),
    ) -> Self {
        Self {
            ready,
            job,
            part,
            goes_on: false,
            has_between: false,
            stop,
            followed: None,
            console: Some(console),
        }
    }
}

impl Frame<'_> {
    fn made(&self, number: usize) -> anyhow::Result<Made> {
        if self.stop.load(Ordering::Relaxed) {
            anyhow::bail!("stopped");
        }
        let mut draped = self.draped(number)?;
        let mut times = vec![draped.time];
        for _ in 1..self.job.repeat {
            draped = self.draped(number)?;
            times.push(draped.time);
        }
        draped.repeated = RepeatedSeconds::of(&times);
        if self.goes_on {
            let key = || KeyFrame::new(&self.ready.draper, &draped.posed, draped.drape.clone());
            let key = self.has_between.then(key).transpose()?.map(Box::new);
            return Ok(Made::Draped(Box::new(draped), key));
        }
        let finished = self.finished(number, draped, None)?;
        Ok(Made::Finished(Box::new(finished)))
    }

    fn draped(&self, number: usize) -> anyhow::Result<Draped> {
        let Ready { bound, draper, .. } = self.ready;
        let target = &bound.targets[number];
        let (posed, fit) = timed(|| target.posed(bound.garment.body()));
        let posed = posed?;
        if let Some(followed) = self.followed {
            let positions = followed.positions(number)?;
            let by = PlacedBy::Simulation;
            let placed = Placed::at(&bound.garment, &posed, &positions, by)?;
            let drape = draper.untangle(placed);
            return Ok(Draped {
                posed,
                drape: drape.with_context(|| self.cannot(number))?,
                simulated: None,
                time: DrapeSeconds {
                    fit,
                    ..DrapeSeconds::default()
                },
                repeated: None,
            });
        }
        self.draped_on(number, posed, fit)
    }

    fn cannot(&self, number: usize) -> String {
        let bound = &self.ready.bound;
        let garment = bound.garment_file.path().display();
        let target = bound.targets[number].path.display();
        format!("cannot drape `{garment}` on `{target}`")
    }

    /// A drape on a body, to pose which it took `fit` seconds.
    pub(super) fn draped_on(
        &self,
        number: usize,
        posed: PosedBody,
        fit: f64,
    ) -> anyhow::Result<Draped> {
        let Ready { bound, draper, .. } = self.ready;
        let target = &bound.targets[number];
        let cannot = || self.cannot(number);
        let placed = match &self.ready.method {
            Method::Simulation(simulated) => {
                let speaks = (self.console, self.stop);
                let placed = simulated.drape((bound, draper), target, &posed, speaks);
                placed.map(|(placed, report)| (placed, Some(report)))
            }
            Method::Warp | Method::Network(_) => {
                let placed = draper.place(&posed, self.stop);
                placed
                    .map(|placed| (placed, None))
                    .map_err(anyhow::Error::from)
            }
        };
        let (placed, simulated) = placed.with_context(cannot)?;
        let drape = draper.untangle(placed).with_context(cannot)?;
        let time = DrapeSeconds::of(&drape, fit);
        Ok(Draped {
            posed,
            drape,
            simulated,
            time,
            repeated: None,
        })
    }

    /// A frame that lies between the key frame that the chain has and the next one.
    fn between(
        &self,
        number: usize,
        next: (usize, Option<&KeyFrame>),
        chain: &mut Chain<'_>,
    ) -> anyhow::Result<Option<Linked>> {
        let Ready { bound, .. } = self.ready;
        let (posed, fit) = timed(|| bound.targets[number].posed(bound.garment.body()));
        chain.go_between(number, (posed?, fit), next, self.stop)
    }

    /// Keeps a frame that goes on from the last one, until there are enough to look at.
    fn link(
        &self,
        next: Option<Linked>,
        linked: &mut Vec<Linked>,
        write: &mut impl FnMut(usize, Finished) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        linked.extend(next);
        if linked.len() < LOOKED_AT {
            return Ok(());
        }
        self.look_at(linked, write)
    }

    /// Finishes frames that went on from each other, each on a thread, and writes them in order.
    fn look_at(
        &self,
        linked: &mut Vec<Linked>,
        write: &mut impl FnMut(usize, Finished) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let finished = linked.par_drain(..).map(|next| {
            let finished = self.finished(next.number, next.draped, Some(next.steps));
            (next.number, finished)
        });
        let finished: Vec<_> = finished.collect();
        let mut finished = finished.into_iter();
        finished.try_for_each(|(number, finished)| write(number, finished?))
    }

    /// A drape, written where it has a file of its own.
    #[expect(
        clippy::too_many_lines,
        reason = "a part of the report after the other"
    )]
    pub(super) fn finished(
        &self,
        number: usize,
        draped: Draped,
        steps: Option<StepsReport>,
    ) -> anyhow::Result<Finished> {
        let bound = &self.ready.bound;
        let Draped {
            posed,
            drape,
            simulated,
            mut time,
            repeated,
        } = draped;
        let provenance = &drape.provenance;
        let fallback = provenance.fallback.as_ref().map(ToString::to_string);
        let unsettled = (provenance.unrelaxed.as_ref()).map(|error| {
            let error = anyhow::Error::new(Arc::clone(error)).context("the cloth does not settle");
            format!("{error:#}")
        });
        let beyond = provenance.beyond.as_ref().map(ToString::to_string);
        let unsettled = unsettled.or(provenance.worsened.map(|worsened| worsened.to_string()));
        let is_from_rest = provenance.relaxed_from == Some(Moment::Start);
        let rest = bound.rest_positions();
        let (free, trapped): (Vec<[u32; 2]>, Vec<[u32; 2]>) = bound
            .edges
            .iter()
            .partition(|edge| !edge.iter().any(|&vertex| is_trapped(&drape, vertex)));
        let stretch = edge_stretch(rest, &drape.positions, &free)?;
        let stretch_at_trapped = edge_stretch(rest, &drape.positions, &trapped)?;
        let mut problems: Vec<Problem> =
            warning::of_fit(posed.max_residual()).into_iter().collect();
        // Poses of the library and of motions know what is up.
        let lies = bound.pose.is_none() && lies_along_z(&posed);
        problems.extend(lies.then_some(Problem::Lies));
        problems.extend((fallback.clone()).map(|reason| Problem::Fallback(reason, is_from_rest)));
        problems.extend(beyond.clone().map(Problem::Beyond));
        problems.extend(unsettled.clone().map(Problem::Unsettled));
        problems.extend(warning::of_falling(provenance));
        let back = provenance.unrelaxed_share;
        problems.extend((back > 0.0).then_some(Problem::PartlySettled(back)));
        let draped = self.ready.draped(provenance.relaxed_from.is_some());
        problems.extend(strained::of_stretch(&stretch, draped));
        problems.extend(strained::of_caught(&stretch_at_trapped));
        let balance = (simulated.as_ref()).and_then(|simulated| simulated.balance.as_ref());
        let of_rest = simulated.as_ref().and_then(warning::of_rest);
        problems.extend(of_rest.map(|moving| fallen(&drape.positions, &posed).unwrap_or(moving)));
        let failed = balance.filter(|balance| !balance.is_reached);
        problems.extend(failed.map(|found| Problem::OutOfBalance(found.steps, found.residual)));
        let penetration = if let Some(report) = &drape.report {
            problems.extend(warning::of_result(report));
            None
        } else {
            let mesh = bound.garment.mesh();
            let draped = mesh.with_positions(drape.positions.clone())?;
            let is_simulated = simulated.is_some() || self.followed.is_some();
            let scale = is_simulated.then(|| bound.garment.cloth().scale());
            let found = PenetrationReport::of(&draped, posed.skin(), scale);
            problems.extend(warning::of_penetration(&found));
            Some(found)
        };
        let cloth_crossings = bound.garment.cloth_crossings(&drape.positions)?;
        let crossed = cloth_crossings.saturating_sub(bound.crossings_at_rest);
        let few = MOST_PAIRS * bound.garment.mesh().num_faces() as f64;
        if bound.garment.num_layered() > 0 && crossed as f64 > few {
            problems.push(Problem::LayersCross(crossed));
        }
        let limbs = (bound.tubes).limbs_outside(&bound.garment, &drape.positions, &posed)?;
        let joints = bound.garment.body().skeleton().joints();
        let limbs = limbs.into_iter().map(|limb| LimbReport {
            joint: joints[limb.joint].name.clone(),
            share: limb.share,
        });
        let limbs_outside: Vec<LimbReport> = limbs.collect();
        let told = limbs_outside.iter();
        let told = told.map(|limb| Problem::LimbOutside(limb.joint.clone(), limb.share));
        problems.extend(told);
        let fitting = self.ready.fitting.as_ref().ok();
        let (target, output) = (&bound.targets[number], &self.part.outputs[number]);
        let fit = fitting.and_then(|it| it.of((bound, target), &drape.positions, &posed));
        if self.part.holds(number) {
            let place = (target, output.as_path());
            let write = || write_files(bound, self.job, place, &drape.positions, &posed);
            let (written, write) = timed(write);
            written?;
            time.write = write;
        }
        let expectation = self.ready.expectation(&posed);
        let output = DrapeOutput {
            target: target.path.display().to_string(),
            output: output.display().to_string(),
            fit_residual_m: posed.max_residual(),
            has_other_shape: posed.shape_offsets().is_some(),
            untangle: drape.report.as_ref().map(Into::into),
            penetration,
            simulated,
            fallback,
            beyond,
            familiarity: expectation.map(|(familiarity, _)| familiarity),
            expected_m: expectation.and_then(|(_, expected)| expected),
            unsettled,
            steps,
            cloth_crossings,
            limbs_outside,
            cloth_crossings_at_rest: bound.crossings_at_rest,
            stretch: Stretch {
                p50: stretch.p50,
                p99: stretch.p99,
                max: stretch.max,
                edges: stretch.count,
                max_at_trapped: (!trapped.is_empty()).then_some(stretch_at_trapped.max),
            },
            is_fit_told: fit.as_ref().is_some_and(|fit| fit.is_told),
            fit: fit.map(|fit| fit.regions),
            seconds: time,
            repeated,
        };
        Ok(Finished {
            posed,
            drape,
            output,
            problems,
        })
    }
}

/// Whether a vertex is caught where the body runs through itself.
fn is_trapped(drape: &Drape, vertex: u32) -> bool {
    drape
        .is_trapped
        .get(vertex as usize)
        .is_some_and(|&is_trapped| is_trapped)
}
