//! Several garments on one body, the inner first.

use std::{
    path::{Path, PathBuf},
    sync::{Arc, atomic::AtomicBool},
};

use anyhow::Context;
use garnet::{
    Drape, PosedBody,
    drape::{LayerPair, Outfit},
    package::GarmentPackage,
};
use serde::Serialize;

use super::{
    Bound,
    all::{All, Draped, Frame, Part},
    args::{Job, OutfitArgs},
    judge,
    outputs::{check_outputs, files_in, outputs_on},
    prepared::Prepared,
    ready::{Found, Ready},
    report::{DrapeReport, OnceSeconds},
    report_of, summary,
    tailored::by_wearer,
    timing::{readable, timed},
    viewing::Viewing,
    warning::Warning,
};
use crate::{
    console::{Console, print_document},
    failure::{ExitStatus, refused},
    output,
    view::write_drapes,
};

/// Of layers of which a larger share of the faces of one crosses the other it is told that they
/// have no room. Those that fit stay below it where people stand; see docs/experiments/058.
const MOST_CROSSING: f64 = 0.02;

/// A garment that is wider than the one under it by this all round has room for it, in metres.
const LEAST_ROOM: f64 = 0.02;

/// What was draped over each other, and what runs through each other. SI units.
#[derive(Debug, Serialize)]
pub(super) struct OutfitReport {
    schema: &'static str,
    version: &'static str,
    /// The reports of the garments, the inner first.
    garments: Vec<DrapeReport>,
    layers: Vec<LayerReport>,
    seconds: f64,
}

/// How two garments run through each other.
#[derive(Debug, Serialize)]
struct LayerReport {
    /// Of the inner and the outer garment, among those of the outfit.
    #[serde(skip)]
    places: [usize; 2],
    inner: String,
    outer: String,
    /// Faces of the outer garment that cross the inner one.
    outer_crossing: usize,
    outer_faces: usize,
    /// Faces of the inner garment that cross the outer one.
    inner_crossing: usize,
    inner_faces: usize,
    /// Vertices of the inner garment that lie outside of the outer one. Vertices at one place count
    /// once.
    inner_outside: usize,
    inner_vertices: usize,
    /// The larger share of the faces of one that cross the other.
    crossing_share: f64,
}

/// One garment of the outfit, ready to be draped.
struct Garment {
    name: String,
    job: Job,
    part: Part,
    ready: Ready,
    read: f64,
    bind: f64,
}

/// Drapes one garment after the other, parts them, writes and reports.
pub(super) fn run(
    args: OutfitArgs,
    console: &Console,
) -> anyhow::Result<(ExitStatus, OutfitReport)> {
    let (folder, report_path) = (args.folder.clone(), args.report.clone());
    let (done, seconds) = timed(|| drape_all(args, console));
    let (garments, layers) = done?;
    let mut statuses = Vec::with_capacity(garments.len());
    for (report, job) in &garments {
        summary::tell(report, None, console);
        statuses.push(judge(report, job, console));
    }
    let mut prints = console.is_json();
    let report = OutfitReport {
        schema: "garnet.outfit/1",
        version: env!("CARGO_PKG_VERSION"),
        garments: garments.into_iter().map(|(report, _)| report).collect(),
        layers,
        seconds,
    };
    for layer in &report.layers {
        console.summary(&format_args!(
            "`{}` over `{}`: {:.2} % of the faces of one cross the other, {} vertices of the inner one are outside",
            layer.outer,
            layer.inner,
            100.0 * layer.crossing_share,
            layer.inner_outside
        ));
        if layer.crossing_share > MOST_CROSSING {
            console.warning(&advice(layer, &report.garments));
        }
    }
    console.summary(&format_args!(
        "dressed in {} garments in `{}` in {}",
        report.garments.len(),
        folder.display(),
        readable(seconds)
    ));
    if let Some(path) = report_path {
        if path.as_os_str() == "-" {
            prints = true;
        } else {
            let mut text = serde_json::to_string_pretty(&report)?;
            text.push('\n');
            output::write(&path, text.as_bytes())?;
        }
    }
    if prints {
        print_document(&report)?;
    }
    let worst = statuses
        .into_iter()
        .find(|status| *status != ExitStatus::Done);
    Ok((worst.unwrap_or(ExitStatus::Done), report))
}

/// What to do about layers that cross, by how wide they are where both go round the body.
fn advice(layer: &LayerReport, garments: &[DrapeReport]) -> String {
    let (inner, outer) = (&layer.inner, &layer.outer);
    let [inner_fit, outer_fit] = layer.places.map(|place| {
        let drape = garments[place].drapes.first();
        let fit = drape.and_then(|drape| drape.fit.as_deref());
        fit.unwrap_or_default()
    });
    let room = inner_fit.iter().filter_map(|fit| {
        let over = outer_fit.iter().find(|over| over.region == fit.region)?;
        Some(over.garment_m - fit.garment_m)
    });
    let least = room.fold(f64::INFINITY, f64::min);
    if least.is_finite() && least > LEAST_ROOM {
        return format!(
            "`{inner}` has room under `{outer}`, but the pose or the body presses them together: \
             `garnet render --color-by problems` shows where; a smaller size of `{inner}` folds less"
        );
    }
    format!(
        "`{inner}` has hardly room under `{outer}`: it may belong over it (name them in the other \
         order), or under a larger size"
    )
}

type Reports = Vec<(DrapeReport, Job)>;

fn drape_all(args: OutfitArgs, console: &Console) -> anyhow::Result<(Reports, Vec<LayerReport>)> {
    if let Some(path) = args.report.as_ref().filter(|path| path.as_os_str() != "-") {
        output::check_report(path)?;
    }
    check_apart(&args)?;
    let is_new = !args.folder.is_dir();
    // Each garment has a file in it, which is checked before any is read.
    output::open_folder(&args.folder)?;
    let mut told = Vec::new();
    let ready = args
        .garments
        .into_iter()
        .map(|args| ready_garment(args, &mut told, console));
    let ready = ready.collect::<anyhow::Result<Vec<_>>>();
    let done = ready.and_then(|garments| drape(garments, console));
    if is_new && done.is_err() {
        // It stays if there is something in it.
        let _ = std::fs::remove_dir(&args.folder);
    }
    done
}

/// Refuses drapes that would take the place of a file of another garment.
fn check_apart(args: &OutfitArgs) -> anyhow::Result<()> {
    let outputs: Vec<&Path> = args
        .garments
        .iter()
        .map(|args| args.output.as_path())
        .collect();
    let mut read = Vec::new();
    for garment in args.garments.iter().filter_map(|args| args.garment()) {
        if GarmentPackage::is_at(garment) {
            read.extend(files_in(garment)?);
        } else {
            read.push(garment.to_path_buf());
        }
    }
    output::check_apart(
        &outputs,
        &read.iter().map(PathBuf::as_path).collect::<Vec<_>>(),
    )
}

/// Reads and binds a garment. What was noted of the files of all garments is in `told`.
fn ready_garment(
    args: super::DrapeArgs,
    told: &mut Vec<String>,
    console: &Console,
) -> anyhow::Result<Garment> {
    let job = Job::new(args)?;
    let (prepared, read) = timed(|| Prepared::read(&job.source));
    let prepared = prepared?;
    let outputs = outputs_on(&prepared.targets, &job);
    check_outputs(&prepared, &outputs, &job)?;
    if prepared.targets.len() != 1 {
        return Err(refused(
            format!("there are {} bodies for an outfit", prepared.targets.len()),
            "an outfit is draped on one body in one pose",
            "drape it on them one by one",
        ));
    }
    for note in &prepared.notes {
        if !told.contains(note) {
            console.summary(&format_args!("note: {note}"));
            told.push(note.clone());
        }
    }
    let name = outputs.first().and_then(|path| path.file_stem());
    let name = name.unwrap_or_default().to_string_lossy().into_owned();
    let part = Part {
        warm_up: 0,
        after: 0,
        outputs,
    };
    // There is one target, and so one wearer.
    let of_wearer = by_wearer(prepared, part, &job)?.into_iter().next();
    let (prepared, part) = of_wearer.context("there is nothing to drape on")?;
    let cut = prepared.cut.clone();
    let bind = || timed(|| Bound::new(prepared));
    let (bound, bind, found) = Found::beside(&job, cut.as_deref(), bind)?;
    let ready = Ready::new(bound, found, &job, console)?;
    Ok(Garment {
        name,
        job,
        part,
        ready,
        read,
        bind,
    })
}

impl Garment {
    fn frame<'a>(&'a self, console: &'a Console, stop: &'a AtomicBool) -> Frame<'a> {
        Frame::alone(&self.ready, (&self.job, &self.part), (console, stop))
    }
}

fn drape(
    mut garments: Vec<Garment>,
    console: &Console,
) -> anyhow::Result<(Reports, Vec<LayerReport>)> {
    let stop = Arc::new(AtomicBool::new(false));
    let mut outfit = Outfit::default();
    let mut drapes: Vec<Draped> = Vec::with_capacity(garments.len());
    for garment in &garments {
        let Ready { bound, draper, .. } = &garment.ready;
        let (wearer, fit) = timed(|| {
            let posed = bound.targets[0].posed(bound.garment.body())?;
            let wearer = outfit.wearer_for(draper, posed);
            wearer.with_context(|| {
                let name = &garment.name;
                format!("`{name}` and what is worn under it are not of one body")
            })
        });
        let wearer = wearer?;
        let body = outfit.body_for(draper, &wearer)?;
        let frame = garment.frame(console, &stop);
        let mut draped = frame.draped_on(0, body, fit)?;
        draped.posed = wearer.clone();
        let (put_on, seconds) =
            timed(|| outfit.put_on(draper.clone(), wearer, draped.drape.clone()));
        put_on?;
        draped.time.untangle += seconds;
        drapes.push(draped);
    }
    outfit.free()?;
    let layers = outfit.layers()?.into_iter();
    let layers = layers
        .map(|pair| LayerReport::new(&garments, pair))
        .collect();
    for (draped, drape) in drapes.iter_mut().zip(outfit.into_drapes()) {
        draped.drape = drape;
    }
    let mut reports = Vec::with_capacity(garments.len());
    let mut shown = Vec::with_capacity(garments.len());
    for (garment, draped) in garments.iter_mut().zip(drapes) {
        let seconds = draped.time.fit + draped.time.of_drape();
        let finished = garment.frame(console, &stop).finished(0, draped, None)?;
        let path = &garment.part.outputs[0];
        let warnings = finished.problems.into_iter().map(|problem| Warning {
            path: path.clone(),
            problem,
        });
        garment.ready.bound.warnings.extend(warnings);
        shown.push((finished.drape, finished.posed));
        reports.push((finished.output, seconds));
    }
    view(&garments, &shown, console)?;
    let reports = garments
        .into_iter()
        .zip(reports)
        .map(|(garment, (output, drape))| {
            let all = All {
                drapes: vec![output],
                hidden_faces: None,
                threads: rayon::current_num_threads(),
            };
            let seconds = OnceSeconds {
                read: garment.read,
                bind: garment.bind,
                drape,
                total: garment.read + garment.bind + drape,
            };
            let report = report_of(garment.ready, &garment.job, all, seconds);
            (report, garment.job)
        });
    Ok((reports.collect(), layers))
}

/// Writes the page of all garments on their body, if one is asked for.
fn view(
    garments: &[Garment],
    shown: &[(Drape, PosedBody)],
    console: &Console,
) -> anyhow::Result<()> {
    let Some(path) = garments.first().and_then(|inner| inner.job.view.as_deref()) else {
        return Ok(());
    };
    let bodies = garments
        .iter()
        .map(|garment| garment.ready.bound.rest_faces());
    let bodies: Vec<Vec<[u32; 3]>> = bodies.collect();
    let mut all = Vec::with_capacity(garments.len());
    for ((garment, body), (drape, posed)) in garments.iter().zip(&bodies).zip(shown) {
        let bound = &garment.ready.bound;
        let fitting = garment.ready.fitting.as_ref().ok();
        let mut viewing = Viewing::new(path);
        viewing.see((bound, &bound.targets[0]), fitting, drape, posed)?;
        all.push(viewing.drapes((bound, body), &garment.job.source));
    }
    write_drapes(all, path, console)
}

impl LayerReport {
    fn new(garments: &[Garment], pair: LayerPair) -> Self {
        let found = pair.count;
        Self {
            places: [pair.inner, pair.outer],
            inner: garments[pair.inner].name.clone(),
            outer: garments[pair.outer].name.clone(),
            outer_crossing: found.outer_crossing,
            outer_faces: found.outer_faces,
            inner_crossing: found.inner_crossing,
            inner_faces: found.inner_faces,
            inner_outside: found.inner_outside,
            inner_vertices: found.inner_nodes,
            crossing_share: found.crossing_share(),
        }
    }
}
