//! `garnet body`: bodies from measures, at rest or in poses.

mod args;
mod report;

use std::{
    path::{Path, PathBuf},
    time::Instant,
};

use anyhow::Context;
use garnet::{
    Body, Point3, Pose, Rig, TriMesh,
    body::{
        motion::FrameRange,
        shape::{BodyParameters, ParametricBody, Population},
    },
    io::{
        Frame, NamedPose, ObjFile, OwnBody, PoseError, PoseSource, Posing, is_rig, rig_beside,
        write_obj, write_rig_npz,
    },
    skin::Method,
};
use rayon::prelude::*;

pub(crate) use args::BodyArgs;
use report::{BodyOutput, BodyReport, Tape};

use crate::{
    console::{Console, print_document},
    failure::{ExitStatus, Hint, refused},
    output,
};

/// How many bodies are built at a time while others are written.
const BATCH: usize = 64;

/// Makes bodies, poses them, writes them and tells their measures.
pub(crate) fn run(args: &BodyArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    let start = Instant::now();
    let source = pose_source(args);
    if let Some(source) = &source {
        // Before any body is made.
        source.check()?;
    }
    if args.frames.is_some() && args.motion.is_none() {
        return Err(refused(
            "`--frames` is given without `--motion`",
            "it is for frames of a motion",
            "name the frames behind the file, as `--pose walk.bvh:0:9`, or leave out `--frames`",
        ));
    }
    let has_up = args.pose_up.direction().is_some();
    args.placing.check(source.as_ref(), has_up)?;
    let is_several = args.sample.is_some() || source.as_ref().is_some_and(PoseSource::is_several);
    let is_folder = is_several || output::names_folder(&args.output);
    if is_folder {
        output::check_output_folder(&args.output)?;
    } else {
        output::check_obj(&args.output)?;
    }
    let mut report = BodyReport {
        schema: "garnet.body/1",
        bodies: Vec::new(),
        notes: Vec::new(),
        seconds: 0.0,
    };
    if let Some(count) = args.sample {
        output::check_table(&args.output.join("measures.csv"), "file,sex,mass_kg,bmi")?;
        sample(count, args, source.as_ref(), console, &mut report)?;
        let table = report::table_of(&report.bodies);
        output::write(&args.output.join("measures.csv"), table.as_bytes())?;
    } else {
        let outputs = Outputs::new(args, is_folder, None);
        write_subject(
            &subject(args)?,
            (source.as_ref(), args),
            &outputs,
            &mut report,
        )
        .map_err(|error| match error.downcast::<PoseError>() {
            Ok(error) => error.of_rig(&rig_of(args)).into(),
            Err(error) => error,
        })?;
    }
    report.seconds = start.elapsed().as_secs_f64();
    publish(&report, args, console)?;
    Ok(ExitStatus::Done)
}

/// A body that is to be written, and what it was made from.
struct Subject {
    body: Body,
    tape: Option<Tape>,
    /// An own body's OBJ.
    file: Option<(ObjFile, Frame)>,
    /// What an own body shows, where that is not the pose that poses start from.
    shown: Option<(Vec<Point3>, Pose)>,
    notes: Vec<String>,
}

impl Subject {
    fn built(parameters: &BodyParameters) -> anyhow::Result<Self> {
        let built = ParametricBody::build(parameters).hint(|| {
            "measures are in centimetres; leave out what is not known: it is predicted from the \
             rest"
                .to_owned()
        })?;
        Ok(Self {
            tape: Some(Tape::new(parameters, &built)),
            body: built.into_body(),
            file: None,
            shown: None,
            notes: Vec::new(),
        })
    }
}

fn subject(args: &BodyArgs) -> anyhow::Result<Subject> {
    let Some(path) = &args.own else {
        args.rig_args.refuse("the built-in body is asked for")?;
        return Subject::built(&args.parameters());
    };
    let options = args.rig_args.clone().options();
    let own = OwnBody::read_with(path, args.rig.as_deref(), &options)?;
    let mut notes: Vec<String> = own.notes.iter().map(ToString::to_string).collect();
    if own.file.is_none() && own.frame != Frame::OURS {
        notes.push(format!(
            "`{}` is in {}, {} up; bodies of a rig are written in metres, y up",
            path.display(),
            own.frame.unit,
            own.frame.up
        ));
    }
    Ok(Subject {
        body: own.body,
        tape: None,
        file: own.file,
        shown: own.shown,
        notes,
    })
}

/// Where the skeleton of a body of the user's is.
fn rig_of(args: &BodyArgs) -> PathBuf {
    let Some(own) = &args.own else {
        return PathBuf::new();
    };
    let beside = rig_beside(own);
    match &args.rig {
        Some(rig) => rig.clone(),
        None if beside.is_file() && !is_rig(own) => beside,
        None => own.clone(),
    }
}

/// Where a body goes.
struct Outputs<'a> {
    /// The file, or the folder of several.
    path: &'a Path,
    is_folder: bool,
    /// Number of the body in a sample.
    number: Option<u32>,
    coarse: bool,
    /// The files that are read.
    inputs: Vec<PathBuf>,
}

impl<'a> Outputs<'a> {
    fn new(args: &'a BodyArgs, is_folder: bool, number: Option<u32>) -> Self {
        Self {
            path: &args.output,
            is_folder,
            number,
            coarse: args.coarse,
            inputs: inputs_of(args),
        }
    }

    /// Refuses poses and a rig that would take the place of what is read.
    fn check_apart(&self, poses: &[NamedPose]) -> anyhow::Result<()> {
        let mut all = vec![self.rig()];
        all.extend(poses.iter().map(|pose| self.obj(Some(pose))));
        if poses.is_empty() {
            all.push(self.obj(None));
        }
        let all: Vec<&Path> = all.iter().map(PathBuf::as_path).collect();
        let inputs: Vec<&Path> = self.inputs.iter().map(PathBuf::as_path).collect();
        output::check_apart(&all, &inputs)
    }

    fn body_stem(&self) -> String {
        self.number
            .map_or_else(|| "body".to_owned(), |number| format!("body_{number:05}"))
    }

    fn obj(&self, pose: Option<&NamedPose>) -> PathBuf {
        if !self.is_folder {
            return self.path.to_path_buf();
        }
        let name = match (self.number, pose) {
            (None, Some(pose)) => pose.stem.clone(),
            (_, None) => self.body_stem(),
            (Some(_), Some(pose)) => format!("{}_{}", self.body_stem(), pose.stem),
        };
        self.path.join(name + ".obj")
    }

    fn rig(&self) -> PathBuf {
        if self.is_folder {
            self.path.join(self.body_stem() + ".rig.npz")
        } else {
            rig_beside(self.path)
        }
    }
}

/// The files of a body of the user's and of its poses.
fn inputs_of(args: &BodyArgs) -> Vec<PathBuf> {
    let own = args.own.iter();
    // A rig needs none beside it: what lies there is what was written for it before.
    let beside = own.clone().filter(|own| !is_rig(own));
    let beside = beside.map(|own| rig_beside(own));
    let pose = args.pose.iter().map(|pose| pose.path.clone());
    let named = own.chain(&args.rig).chain(&args.motion).cloned();
    named.chain(beside).chain(pose).collect()
}

fn sample(
    count: u32,
    args: &BodyArgs,
    source: Option<&PoseSource>,
    console: &Console,
    report: &mut BodyReport,
) -> anyhow::Result<()> {
    output::open_folder(&args.output)?;
    let _lock = output::lock_folder(&args.output)?;
    let population = Population::new(args.seed);
    let bar = console.progress(count as usize);
    let numbers: Vec<u32> = (0..count).collect();
    for batch in numbers.chunks(BATCH) {
        let build = |&number: &u32| {
            let parameters = population.sample(u64::from(number));
            let subject = Subject::built(&parameters);
            subject.with_context(|| format!("cannot build body {number} of the sample"))
        };
        let built: Vec<anyhow::Result<Subject>> = batch.par_iter().map(build).collect();
        for (&number, subject) in batch.iter().zip(built) {
            let outputs = Outputs::new(args, true, Some(number));
            write_subject(&subject?, (source, args), &outputs, report)?;
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    Ok(())
}

/// Poses a body and writes it.
fn write_subject(
    subject: &Subject,
    (source, args): (Option<&PoseSource>, &BodyArgs),
    outputs: &Outputs<'_>,
    report: &mut BodyReport,
) -> anyhow::Result<()> {
    let Posing { poses, notes, .. } = match source {
        Some(source) => source.read(&subject.body, &args.placing.options())?,
        None => Posing::default(),
    };
    let of_tape = subject.tape.iter().filter(|_| outputs.number.is_none());
    let of_tape = of_tape.flat_map(Tape::conflicts);
    let notes = notes.iter().map(ToString::to_string);
    for note in subject.notes.iter().cloned().chain(of_tape).chain(notes) {
        if !report.notes.contains(&note) {
            report.notes.push(note);
        }
    }
    outputs.check_apart(&poses)?;
    let rig_path = outputs.rig();
    output::check_sidecar(&rig_path, subject.body.skeleton())?;
    // That of a sample is open.
    if outputs.is_folder && outputs.number.is_none() {
        output::open_folder(outputs.path)?;
    }
    let rig = if outputs.coarse {
        coarse_rig(&subject.body)?
    } else {
        Rig {
            rest_pose: subject.shown.as_ref().map(|(_, pose)| pose.clone()),
            ..Rig::from(subject.body.clone())
        }
    };
    write_rig_npz(&rig_path, &rig)?;
    let rest = || match &subject.shown {
        Some((positions, _)) => positions.clone(),
        None => subject.body.rest().positions().to_vec(),
    };
    let mut write = |pose: Option<&NamedPose>, positions: Vec<Point3>| -> anyhow::Result<()> {
        let path = outputs.obj(pose);
        let vertices = write_body(&path, subject, positions, outputs.coarse)?;
        report.bodies.push(BodyOutput {
            output: path.display().to_string(),
            rig: rig_path.display().to_string(),
            vertices,
            pose: pose.map(|pose| pose.label.clone()),
            tape: subject.tape.clone(),
        });
        Ok(())
    };
    if source.is_none() {
        return write(None, rest());
    }
    for pose in &poses {
        let positions = subject
            .body
            .posed_positions(&pose.pose, Method::DualQuaternion)?;
        write(Some(pose), positions)?;
    }
    Ok(())
}

fn write_body(
    path: &Path,
    subject: &Subject,
    positions: Vec<Point3>,
    coarse: bool,
) -> anyhow::Result<usize> {
    let num_vertices = positions.len();
    if let Some((file, frame)) = &subject.file {
        file.write_with_positions(path, &frame.to_file(positions))?;
        return Ok(num_vertices);
    }
    let mesh = if coarse {
        ParametricBody::coarse(&positions)
    } else {
        TriMesh::new(positions, subject.body.rest().faces().to_vec())?
    };
    write_obj(path, &mesh)?;
    Ok(mesh.num_vertices())
}

/// The rig of the coarse level.
fn coarse_rig(body: &Body) -> anyhow::Result<Rig> {
    let kept = ParametricBody::coarse_vertices();
    let rows = kept
        .iter()
        .map(|&vertex| body.weights().vertex(vertex as usize).collect());
    let rows: Vec<Vec<(usize, f32)>> = rows.collect();
    let weights = garnet::SkinWeights::from_influences(body.skeleton().num_joints(), rows)?;
    let mesh = ParametricBody::coarse(body.rest().positions());
    Ok(Rig::from(Body::new(
        mesh,
        body.skeleton().clone(),
        weights,
    )?))
}

fn pose_source(args: &BodyArgs) -> Option<PoseSource> {
    let motion = args.motion.as_ref().map(|path| PoseSource {
        path: path.clone(),
        clip: None,
        frames: Some(args.frames.unwrap_or(FrameRange::ALL)),
        up: None,
    });
    let source = motion.or_else(|| args.pose.clone());
    let up = args.pose_up.direction();
    source.map(|source| PoseSource { up, ..source })
}

fn publish(report: &BodyReport, args: &BodyArgs, console: &Console) -> anyhow::Result<()> {
    for note in &report.notes {
        console.summary(&format_args!("note: {note}"));
    }
    if console.is_json() {
        return print_document(report);
    }
    match report.bodies.as_slice() {
        [body] => {
            let pose = body
                .pose
                .as_ref()
                .map_or("at rest".to_owned(), |pose| format!("posed by `{pose}`"));
            console.summary(&format_args!(
                "wrote `{}`, {pose}, and `{}`",
                body.output, body.rig
            ));
            if let Some(tape) = &body.tape {
                console.summary(tape);
            }
        }
        bodies => console.summary(&format_args!(
            "wrote {} bodies into `{}` in {:.1} s",
            bodies.len(),
            args.output.display(),
            report.seconds
        )),
    }
    Ok(())
}
