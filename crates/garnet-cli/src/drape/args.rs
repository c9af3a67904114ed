//! The arguments of `drape`, and the checked job that they make.

use std::path::{Path, PathBuf};

use anyhow::ensure;
use clap::{Args, builder::ArgPredicate};
use garnet::{
    DrapeOptions,
    drape::KeySpacing,
    io::{ObjFile, PoseSource, SceneFiles, SceneUnits},
    package::{GarmentPackage, Limit, Quality, StoredFabric},
};

pub(crate) use super::names::{MethodName, NetworkChoice, Shard, UpName, units};
use super::sink::CacheFile;
use crate::{
    cut_args::CutArgs,
    fabric,
    failure::{Hint, refused},
    models,
    motion::MotionArgs,
    output,
    parse::{count, millimetres, milliseconds, settle_frames, tolerance},
    rig_args::{PoseUp, RigArgs},
};

/// All arguments that a job of `--batch` may have, and the command beside it may not.
pub(super) const OF_A_JOB: [&str; 43] = [
    "output",
    "layers",
    "body_out",
    "hide",
    "view",
    "export_inputs",
    "method",
    "budget",
    "tolerance",
    "settle",
    "fabric",
    "shard",
    "clearance",
    "no_untangle",
    "frames_alone",
    "key_spacing",
    "smooth",
    "max_penetration",
    "max_crossing",
    "report",
    "repeat",
    "garment",
    "bodies",
    "scene",
    "rig",
    "rest_body",
    "pose",
    "pose_up",
    "place",
    "size",
    "sleeve",
    "length",
    "ease",
    "units",
    "up",
    "ground",
    "in_place",
    "fps",
    "keep_flips",
    "keep_arms",
    "mesh",
    "joints",
    "betas",
];

/// Arguments of `drape`.
#[derive(Debug, Clone, Args)]
#[command(
    after_long_help = LONG_HELP,
    override_usage = "garnet drape [OPTIONS] --output <OUT> [GARMENT] [BODY]...\n       garnet \
                      drape --batch <JOBS>",
    mut_arg("garment", |garment| garment.required_unless_present_any(["scene", "batch"]))
)]
pub(crate) struct DrapeArgs {
    #[command(flatten)]
    pub(super) input: InputArgs,
    /// Where the drape goes: an OBJ, or a GLB with the body; for several bodies a folder of OBJ, or
    /// one file of all frames: .pc2, .mdd, .npz or .glb; for an outfit, or if it ends with `/`, a
    /// folder.
    #[arg(
        short,
        long,
        value_name = "OUT",
        required = false,
        required_unless_present = "batch",
        default_value_if("batch", ArgPredicate::IsPresent, ".")
    )]
    pub(super) output: PathBuf,
    /// Do all drapes that a file lists, and print a line of JSON for each: objects with `garment`,
    /// `bodies`, and options of `drape` as keys, in a list (.json) or one a line (.jsonl), or a
    /// table with such columns (.csv); see docs/guide/many-machines.md.
    #[arg(long, value_name = "JOBS", conflicts_with_all = OF_A_JOB)]
    pub(super) batch: Option<PathBuf>,
    /// Another garment, OBJ or package, over GARMENT and the layers before: an outfit.
    #[arg(long = "layer", value_name = "GARMENT", value_parser = models::package_or_file)]
    pub(super) layers: Vec<PathBuf>,
    /// With `--pose`: write the posed body, as the drape is written; a folder for several OBJ.
    #[arg(long, value_name = "OUT", requires = "pose")]
    pub(super) body_out: Option<PathBuf>,
    /// Write which faces of the body the garment covers in all drapes, so that they need not be
    /// drawn: JSON, or a number a line if it ends with .txt.
    #[arg(long, value_name = "FILE")]
    pub(super) hide: Option<PathBuf>,
    /// Write a page that shows the drapes on their bodies in a browser, colored by stretch,
    /// distance to the skin or problems, as HTML.
    #[arg(long, value_name = "HTML")]
    pub(super) view: Option<PathBuf>,
    /// Write the inputs and outputs of the network on the body, for other implementations:
    /// arrays as safetensors (docs/guide/pytorch.md).
    #[arg(long, hide_short_help = true, value_name = "FILE")]
    pub(super) export_inputs: Option<PathBuf>,
    /// A variant of the package: fast, balanced, accurate, or one of the paper's networks (naive,
    /// global, local …); or auto (its default, else warp), warp, dqs, lbs, sim.
    #[arg(long, value_name = "METHOD", default_value = "auto", value_parser = MethodName::parse)]
    method: MethodName,
    /// Take the most accurate variant of the package that drapes within this time on this machine,
    /// in milliseconds.
    #[arg(long, value_name = "MS", value_parser = milliseconds, conflicts_with = "tolerance", allow_negative_numbers = true)]
    budget: Option<f64>,
    /// Take the cheapest variant of the package whose drapes are within this distance of the
    /// simulation, the mean over vertices, in nine of ten scenes of its validation in such poses,
    /// in millimetres.
    #[arg(long, value_name = "MM", value_parser = tolerance, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Simulate the cloth for so many frames of 1/60 s from where it was put; a single warp that
    /// stays strained, from rest [default: by the method, see docs/reference/options.md].
    #[arg(long, value_name = "FRAMES", value_parser = settle_frames, allow_negative_numbers = true)]
    settle: Option<u32>,
    /// Fabric of all that is simulated: silk, jersey, interlock, cotton, knit or denim
    /// [default: that of the package, else cotton].
    #[arg(long, value_name = "NAME")]
    fabric: Option<String>,
    /// Drape the K-th of N parts of the bodies or frames, each on a machine of its own.
    #[arg(long, hide_short_help = true, value_name = "K/N", value_parser = Shard::parse)]
    shard: Option<Shard>,
    /// Smallest distance between cloth and skin, in millimetres
    /// [default: 2; less on fingers and dolls, more on giants].
    #[arg(long, hide_short_help = true, value_name = "MM", value_parser = millimetres, conflicts_with = "no_untangle", allow_negative_numbers = true)]
    clearance: Option<f32>,
    /// Leave the warp as it is, penetrations included.
    #[arg(long, hide_short_help = true)]
    no_untangle: bool,
    /// Drape each frame of a motion as if it were the only one.
    #[arg(long, hide_short_help = true)]
    frames_alone: bool,
    /// How far the body moves, in millimetres, between frames of a motion that a network drapes by
    /// themselves; those between go along with both, which is several times as fast; 0 drapes each
    /// [default: 20]
    #[arg(long, hide_short_help = true, value_name = "MM", conflicts_with = "frames_alone", value_parser = millimetres, allow_negative_numbers = true)]
    key_spacing: Option<f32>,
    /// Smooth what is left of jumps between the frames of a motion, over so many frames to either
    /// side; cloth keeps out of the skin and does not lag behind [default of FRAMES: 3].
    #[arg(long, value_name = "FRAMES", num_args = 0..=1, default_missing_value = "3", conflicts_with = "frames_alone", value_parser = clap::value_parser!(u8).range(1..=12), allow_negative_numbers = true)]
    smooth: Option<u8>,
    /// End with 1 if cloth is deeper in the body than this, in millimetres.
    #[arg(long, hide_short_help = true, value_name = "MM", value_parser = millimetres, allow_negative_numbers = true)]
    max_penetration: Option<f32>,
    /// End with 1 if more faces of the garment than this cross the skin, without those that the
    /// body traps.
    #[arg(long, hide_short_help = true, value_name = "FACES", value_parser = count, allow_negative_numbers = true)]
    max_crossing: Option<usize>,
    /// Write the report as JSON; `-` is stdout.
    #[arg(long, value_name = "FILE")]
    pub(super) report: Option<PathBuf>,
    /// Drape each body this often, and report median and p95 of the times.
    #[arg(long, hide_short_help = true, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u32).range(1..=100_000), allow_negative_numbers = true)]
    repeat: u32,
}

/// Garment and bodies, as `drape` and `simulate` take them.
#[derive(Debug, Clone, Args)]
pub(crate) struct InputArgs {
    /// Garment, as OBJ, lying on the rest body, or a garment package.
    #[arg(
        index = 1,
        value_name = "GARMENT",
        value_parser = models::package_or_file,
        required_unless_present = "scene",
        conflicts_with = "scene"
    )]
    pub(crate) garment: Option<PathBuf>,
    /// Bodies to drape it on, as OBJ, GLB or npz; with `--pose`, the rest body.
    #[arg(index = 2, value_name = "BODY", value_parser = models::package_or_file, conflicts_with = "scene")]
    pub(crate) bodies: Vec<PathBuf>,
    /// Take garment, bodies, weights and pose from a `drape-scene/1` file.
    #[arg(long, value_name = "SCENE.json", conflicts_with_all = ["rig", "rest_body", "units", "up"])]
    pub(super) scene: Option<PathBuf>,
    /// Skeleton and weights: npz, GLB, glTF, VRM or JSON
    /// [default: `<body>.rig.npz` beside the body].
    #[arg(long, value_name = "FILE")]
    pub(super) rig: Option<PathBuf>,
    /// Body on which the garment lies, as OBJ or GLB [default: the rest mesh of the rig].
    #[arg(long, value_name = "OBJ")]
    pub(super) rest_body: Option<PathBuf>,
    /// Pose the rest body, instead of taking the pose from BODY: a pose file, a frame of a motion
    /// (BVH, npz as in AMASS, GLB, pose JSON), several as FIRST:END:STEP, in seconds as 1s:2.5s, or
    /// a pose of the library.
    #[arg(long, value_name = "FILE[:CLIP][:FRAMES]|NAME")]
    pub(super) pose: Option<PoseSource>,
    /// Axis that points up in the motion of `--pose`.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "AXIS",
        default_value = "auto",
        allow_hyphen_values = true
    )]
    pose_up: PoseUp,
    #[command(flatten)]
    motion: MotionArgs,
    #[command(flatten)]
    pub(super) rig_args: RigArgs,
    /// Bring a garment to the rest body that does not lie on it: unit, axis, place, size and
    /// sleeves are found by its openings and the skin.
    #[arg(long, conflicts_with = "scene")]
    place: bool,
    #[command(flatten)]
    cut: CutArgs,
    /// Unit of the files: m, dm, cm, mm, in, ft or auto; or two, of garment and bodies: `cm,m`.
    #[arg(long, hide_short_help = true, value_name = "UNIT", default_value = "auto", value_parser = units)]
    units: SceneUnits,
    /// Axis of the files that points up.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "AXIS",
        default_value = "auto"
    )]
    up: UpName,
}

const LONG_HELP: &str = "\
Several garment packages before BODY are an outfit, the inner first: `garnet drape jeans tshirt body.obj -o outfit/` \
drapes the jeans on the body and the T-shirt on body and jeans. So does `--layer`, of OBJ files, too: \
`garnet drape trousers.obj body.obj --layer shirt.obj --layer coat.obj -o outfit/`.

The rig of a body is found in this order: --rig; that of the garment package, unless --rest-body is given \
or the rig beside BODY is of another topology; `<rest body>.rig.npz` beside the OBJ of --rest-body; `<body>.rig.npz` beside BODY. \
The garment of a package is brought to a human body of any other topology. Without --pose, the pose and shape of BODY are \
recovered from its vertices, which must be those of the rest body.

Motions are carried over by the names of the joints, with the turn of each; they go where the recording has them, \
scaled by the length of the legs, unless --ground or --in-place say otherwise. A pose file is JSON: {\"schema\": \"garnet.pose/1\", \"joints\": {\"left_knee\": [0.5, 0, 0, \
0.866025]}, \"root_translation\": [0, 0, 0]}, rotations as [x, y, z, w] about the axes of the \
world at rest; with \"frames\", a list of such poses.";

/// An outfit: the arguments of each of its garments, the inner first.
#[derive(Debug)]
pub(super) struct OutfitArgs {
    pub(super) garments: Vec<DrapeArgs>,
    pub(super) folder: PathBuf,
    pub(super) report: Option<PathBuf>,
}

impl DrapeArgs {
    /// The garment or package.
    pub(super) fn garment(&self) -> Option<&Path> {
        self.input.garment.as_deref()
    }

    /// How many packages follow the one that is the garment.
    fn num_packages_after_first(&self) -> usize {
        let given = self.input.garment.iter().chain(&self.input.bodies);
        let packages = given.take_while(|path| GarmentPackage::is_at(path));
        packages.count().saturating_sub(1)
    }

    /// The outfit, if there are several packages before the body, or layers.
    pub(super) fn outfit(&self) -> anyhow::Result<Option<OutfitArgs>> {
        let first = self.input.garment.as_ref();
        let others = self.num_packages_after_first();
        if others == 0 && self.layers.is_empty() {
            return Ok(None);
        }
        let Some(first) = first else {
            return Err(refused(
                "`--layer` is given with `--scene`",
                "the garments of an outfit lie on one rest body, which is named with them",
                "name the garment of the scene, and the body",
            ));
        };
        let (over, bodies) = self.input.bodies.split_at(others);
        let inner = std::iter::once(first).chain(over);
        let garments: Vec<&PathBuf> = inner.chain(&self.layers).collect();
        let one = "an outfit is draped once, on one body in one pose";
        let what = "leave it out, or drape the garments one by one";
        let refused_options = [
            (bodies.len() > 1, "a second body"),
            (self.input.is_motion(), "`--pose` with several frames"),
            (self.shard.is_some(), "`--shard`"),
            (self.repeat > 1, "`--repeat`"),
            (self.hide.is_some(), "`--hide`"),
            (self.smooth.is_some(), "`--smooth`"),
        ];
        if let Some((_, option)) = refused_options.iter().find(|(is_given, _)| *is_given) {
            return Err(refused(
                format!("{option} is given for an outfit"),
                one,
                what,
            ));
        }
        if CacheFile::of(&self.output).is_some() {
            return Err(refused(
                format!(
                    "an outfit cannot be written into `{}`",
                    self.output.display()
                ),
                "each garment has an OBJ of its own",
                "name a folder with `-o`",
            ));
        }
        output::check_output_folder(&self.output)?;
        let mut names: Vec<PathBuf> = Vec::new();
        let garments = garments.iter().enumerate().map(|(number, &garment)| {
            let mut args = self.clone();
            args.input.garment = Some(garment.clone());
            args.input.bodies = bodies.to_vec();
            args.layers = Vec::new();
            args.report = None;
            if number > 0 {
                args.body_out = None;
            }
            args.output = if GarmentPackage::is_at(garment) {
                output::name_in(&self.output, &stem_of(garment))
            } else {
                output::name_in(&self.output, garment)
            };
            if names.contains(&args.output) {
                return Err(refused(
                    format!(
                        "two garments lead to the output `{}`",
                        args.output.display()
                    ),
                    format!("`{}` has the name of another one", garment.display()),
                    "outputs are named after the files, or the folders of packages: rename one",
                ));
            }
            names.push(args.output.clone());
            Ok(args)
        });
        Ok(Some(OutfitArgs {
            garments: garments.collect::<anyhow::Result<_>>()?,
            folder: self.output.clone(),
            report: self.report.clone(),
        }))
    }
}

/// What the output of a package is named after, with an extension for that to be taken away.
pub(super) fn stem_of(package: &Path) -> PathBuf {
    let whole = std::fs::canonicalize(package).unwrap_or_default();
    let name = package
        .file_name()
        .or(whole.file_name())
        .unwrap_or_default();
    let mut name = name.to_os_string();
    name.push(".obj");
    PathBuf::from(name)
}

/// What is to be done, checked as far as that goes without reading files.
#[derive(Debug)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a choice of the user"
)]
pub(crate) struct Job {
    /// That of the report.
    pub(crate) schema: &'static str,
    pub(crate) source: Source,
    /// One for each target; none where the frames of a motion name them.
    pub(crate) outputs: Vec<PathBuf>,
    /// The file of all frames that they go to instead.
    pub(crate) cache: Option<CacheFile>,
    /// The file of all frames that the bodies go to.
    pub(crate) body_cache: Option<CacheFile>,
    /// Where it is told which faces of the body are covered.
    pub(crate) hide: Option<PathBuf>,
    /// Where a page shows the drapes.
    pub(crate) view: Option<PathBuf>,
    /// Where the inputs and outputs of the network go.
    pub(crate) export_inputs: Option<PathBuf>,
    /// Whether the cloth is simulated along the motion, instead of on each pose.
    pub(crate) follows: bool,
    /// Whether that goes on where it was stopped.
    pub(crate) resumes: bool,
    /// Which part of the targets is draped; all without it.
    pub(crate) shard: Option<Shard>,
    /// Fabric of what is simulated, instead of that of the package or cotton.
    pub(crate) fabric: Option<StoredFabric>,
    /// The folder that the outputs go to, if there are several.
    pub(crate) folder: Option<PathBuf>,
    /// Whether there may be several drapes.
    is_several: bool,
    /// Whether these are frames of a motion.
    is_motion: bool,
    /// Folders that single outputs go to.
    pub(crate) new_folders: Vec<PathBuf>,
    /// What a single output in a folder is named after.
    stem: PathBuf,
    pub(crate) body_out: Option<PathBuf>,
    pub(crate) report: Option<PathBuf>,
    /// Whether the report goes to stdout.
    pub(crate) prints_report: bool,
    pub(crate) options: DrapeOptions,
    /// Whether the user has said how far cloth keeps from the skin.
    pub(crate) has_own_clearance: bool,
    /// How the garment is simulated; none if it is warped.
    pub(crate) simulation: Option<Simulation>,
    /// Which network moves the warped garment.
    pub(crate) network: NetworkChoice,
    /// What the network is chosen by, if not by its name.
    pub(crate) limit: Option<Limit>,
    /// For how many frames the cloth settles where it was put; none leaves that to what puts it.
    pub(crate) settle: Option<u32>,
    /// In metres.
    pub(crate) max_penetration: Option<f32>,
    /// Faces that may cross the skin.
    pub(crate) max_crossing: Option<usize>,
    pub(crate) repeat: u32,
    /// Whether frames of a motion do not go on from each other.
    pub(crate) frames_alone: bool,
    /// How far the body moves between frames that are draped by themselves.
    pub(crate) key_spacing: KeySpacing,
    /// Over how many frames to either side a motion is smoothed; 0 for none.
    pub(crate) smooth: usize,
}

/// How a garment is simulated.
#[derive(Debug, Clone)]
pub(crate) struct Simulation {
    pub(crate) quality: Quality,
    /// Instead of the fabric of the package, or of cotton.
    pub(crate) fabric: Option<StoredFabric>,
    /// Where an OBJ is written for each frame.
    pub(crate) frames: Option<PathBuf>,
}

/// Where garment and bodies come from.
#[derive(Debug)]
pub(crate) enum Source {
    /// A scene names them all.
    Scene(PathBuf),
    /// Each was named.
    Files(Box<SourceFiles>),
}

/// The files of a drape without a scene.
#[derive(Debug)]
pub(crate) struct SourceFiles {
    /// The package that the garment is from.
    pub(crate) package: Option<PathBuf>,
    /// How its garment is cut anew.
    pub(crate) cut: CutArgs,
    pub(crate) scene: SceneFiles,
}

impl Job {
    pub(crate) fn new(args: DrapeArgs) -> anyhow::Result<Self> {
        let mut job = Self::of_input(args.input, args.output)?;
        job.take_report(args.report)?;
        job.body_cache = args.body_out.as_deref().and_then(CacheFile::of);
        let body_out = match (args.body_out, &job.body_cache) {
            (Some(path), Some(_)) => {
                output::check_file(&path)?;
                Some(path)
            }
            (path, _) => path.map(|path| job.named(path)).transpose()?,
        };
        if let Some(path) = &args.hide {
            output::check_kinds(
                path,
                "covered faces are written as JSON or text",
                &["json", "txt"],
            )?;
            output::check_hidden(path)?;
        }
        job.hide = args.hide;
        args.view.as_deref().map_or(Ok(()), output::check_page)?;
        job.view = args.view;
        job.take_export(args.export_inputs)?;
        job.shard = args.shard;
        if job.shard.is_some() && !job.is_several {
            return Err(refused(
                "`--shard` is for several drapes",
                "there is one",
                "give several bodies, or a range of frames with `--pose FILE:FIRST:END`",
            ));
        }
        let of_motions = [
            (args.smooth.is_some(), "--smooth"),
            (args.key_spacing.is_some(), "--key-spacing"),
            (args.frames_alone, "--frames-alone"),
        ];
        job.check_motion(&of_motions)?;
        job.fabric = args.fabric.as_deref().map(fabric::fabric).transpose()?;
        job.options = DrapeOptions::default().with_warp(args.method.warp());
        if let Some(clearance) = args.clearance {
            job.options = job.options.with_clearance(clearance);
            job.has_own_clearance = true;
        }
        if args.no_untangle {
            job.options = job.options.without_untangling();
        }
        job.options.relax_frames = args.settle;
        job.simulation = (args.method == MethodName::Sim).then_some(Simulation {
            quality: Quality::Teacher,
            fabric: job.fabric.clone(),
            frames: None,
        });
        job.network = args.method.network();
        job.limit = (args.budget.map(Limit::Seconds)).or(args.tolerance.map(Limit::Distance));
        if job.limit.is_some() && args.method != MethodName::Auto {
            return Err(refused(
                "`--method` names what drapes",
                "`--budget` and `--tolerance` choose it",
                "leave out one of them",
            ));
        }
        if args.method == MethodName::Sim && args.settle.is_some_and(|frames| frames > 0) {
            return Err(refused(
                "`--settle` is for what a network or the warp has put",
                "`--method sim` simulates all the way",
                "leave out one of them",
            ));
        }
        job.settle = args.settle;
        job.body_out = body_out;
        job.max_penetration = args.max_penetration;
        job.max_crossing = args.max_crossing;
        job.repeat = args.repeat;
        job.frames_alone = args.frames_alone;
        job.key_spacing = args.key_spacing.map_or_else(KeySpacing::default, |apart| {
            KeySpacing::default().with_apart(apart)
        });
        job.smooth = args.smooth.map_or(0, usize::from);
        Ok(job)
    }

    /// Refuses options that are for the frames of a motion, each with whether it was given.
    fn check_motion(&self, options: &[(bool, &str)]) -> anyhow::Result<()> {
        let mut given = options.iter().filter(|(is_given, _)| *is_given);
        match given.next() {
            Some((_, name)) if !self.is_motion => Err(refused(
                format!("`{name}` is for the frames of a motion"),
                "no range of frames is draped",
                format!("name one with `--pose FILE:FIRST:END`, or leave out `{name}`"),
            )),
            _ => Ok(()),
        }
    }

    /// Takes where the inputs of a network go.
    fn take_export(&mut self, path: Option<PathBuf>) -> anyhow::Result<()> {
        if let Some(path) = &path {
            output::check_kinds(
                path,
                "inputs of a network are written as safetensors",
                &["safetensors"],
            )?;
            output::check_file(path)?;
            if self.is_several {
                return Err(refused(
                    "`--export-inputs` is for one drape",
                    "there are several",
                    "give one body, or one frame with `--pose FILE:FRAME`",
                ));
            }
        }
        self.export_inputs = path;
        Ok(())
    }

    /// The garment as it is, once on each body, into `output`.
    pub(crate) fn of_input(input: InputArgs, output: PathBuf) -> anyhow::Result<Self> {
        let has_frames = input.pose.as_ref().is_some_and(PoseSource::is_several);
        let is_several = input.bodies.len() > 1 || has_frames;
        let mut outputs = Vec::new();
        let cache = CacheFile::of(&output);
        if cache.is_some() {
            output::check_file(&output)?;
        } else if is_several {
            output::check_drape_folder(&output)?;
            if !has_frames {
                outputs = output::names_in(&output, &input.bodies)?;
            }
        }
        let mut job = Self {
            schema: "garnet.drape/1",
            stem: input.stem(),
            source: Source::Scene(PathBuf::new()),
            outputs,
            cache: None,
            folder: (is_several && cache.is_none()).then(|| output.clone()),
            is_several,
            is_motion: has_frames,
            body_cache: None,
            hide: None,
            view: None,
            export_inputs: None,
            follows: false,
            resumes: false,
            shard: None,
            fabric: None,
            new_folders: Vec::new(),
            body_out: None,
            report: None,
            prints_report: false,
            options: DrapeOptions::default().without_untangling(),
            has_own_clearance: false,
            simulation: None,
            network: NetworkChoice::None,
            limit: None,
            settle: None,
            max_penetration: None,
            max_crossing: None,
            repeat: 1,
            frames_alone: true,
            key_spacing: KeySpacing::NONE,
            smooth: 0,
        };
        if !is_several && cache.is_none() {
            job.outputs = vec![job.named(output)?];
        }
        job.cache = cache;
        job.source = input.source()?;
        Ok(job)
    }

    /// Where the one output goes that `path` names, of a folder into that; several outputs have a
    /// folder of their own.
    fn named(&mut self, path: PathBuf) -> anyhow::Result<PathBuf> {
        if self.is_several {
            output::check_drape_folder(&path)?;
            return Ok(path);
        }
        if !output::names_folder(&path) {
            output::check_drape(&path)?;
            return Ok(path);
        }
        output::check_output_folder(&path)?;
        let name = output::name_in(&path, &self.stem);
        self.new_folders.push(path);
        Ok(name)
    }

    /// Where the report goes.
    pub(crate) fn take_report(&mut self, report: Option<PathBuf>) -> anyhow::Result<()> {
        self.prints_report = report.as_ref().is_some_and(|path| path.as_os_str() == "-");
        self.report = report.filter(|_| !self.prints_report);
        self.report.as_deref().map_or(Ok(()), output::check_report)
    }
}

impl InputArgs {
    /// What a single output in a folder is named after: the body, or else its pose, or the scene.
    fn stem(&self) -> PathBuf {
        let pose = self.pose.as_ref().map(|pose| &pose.path);
        let named = self.bodies.first().or(pose).or(self.scene.as_ref());
        named.cloned().unwrap_or_default()
    }

    /// Whether a range of frames is asked for.
    pub(crate) fn is_motion(&self) -> bool {
        self.pose.as_ref().is_some_and(PoseSource::is_several)
    }

    fn source(self) -> anyhow::Result<Source> {
        let garment = match (self.scene, self.garment) {
            (Some(scene), _) if self.pose.is_some() => {
                let scene = scene.display();
                return Err(refused(
                    "`--scene` takes no `--pose`",
                    format!("`{scene}` names the body that the garment goes to"),
                    format!(
                        "name the garment of the scene and its body: `garnet drape GARMENT --rig {scene} --pose \
                         ... -o OUT`"
                    ),
                ));
            }
            (Some(scene), _) => return Ok(Source::Scene(scene)),
            (None, Some(garment)) => garment,
            (None, None) => anyhow::bail!("neither a garment nor a scene is given"),
        };
        if let Some(pose) = &self.pose {
            // Before anything is read.
            pose.check()?;
        }
        if let Some(package) = (self.bodies.iter()).find(|body| GarmentPackage::is_at(body)) {
            let (package, garment) = (package.display(), garment.display());
            return Err(refused(
                format!("`{package}` is given as a body"),
                "it is a garment package",
                format!(
                    "the garment comes first, then the body: `{package} {garment}`; `garnet drape` takes \
                     several packages before the body for an outfit, the inner one first"
                ),
            ));
        }
        let package = GarmentPackage::is_at(&garment).then(|| garment.clone());
        if package.is_none() && garment.is_dir() {
            return Err(refused(
                format!("there is no garment at `{}`", garment.display()),
                "the folder is no garment package: it has no `garment.toml`",
                "name the OBJ of a garment, or the folder of a garment package",
            ));
        }
        if let Some(error) = models::unknown(&garment) {
            return Err(error);
        }
        if !garment.exists() {
            // Told before what else is missing.
            ObjFile::read(&garment)?;
        }
        if let Some(package) = package.as_ref().filter(|_| self.place) {
            return Err(refused(
                format!("`{}` cannot be placed", package.display()),
                "the garment of a package lies on the body of the package, which tells where it \
                 belongs",
                "leave out `--place`",
            ));
        }
        let mut scene = SceneFiles::new(garment);
        if let Some(folder) = &package {
            let manifest = GarmentPackage::read_manifest(folder)?;
            manifest.check_rig(folder)?;
            scene.garment = GarmentPackage::template_at(folder);
            scene.own_rig = Some(folder.join(&manifest.rest_body.rig));
        }
        let pose_up = self.pose_up.direction();
        (self.motion).check(self.pose.as_ref(), pose_up.is_some())?;
        scene.rig = self.rig;
        scene.bodies = self.bodies;
        scene.rest_body = self.rest_body;
        scene.pose = self.pose.map(|pose| PoseSource {
            up: pose_up,
            ..pose
        });
        scene.rig_options = self.rig_args.options();
        scene.motion = self.motion.options();
        scene.units = self.units;
        scene.up = self.up.axis();
        scene.place = self.place;
        let files = SourceFiles {
            package,
            cut: self.cut,
            scene,
        };
        files.check()?;
        Ok(Source::Files(Box::new(files)))
    }
}

impl SourceFiles {
    fn check(&self) -> anyhow::Result<()> {
        let scene = &self.scene;
        if scene.bodies.is_empty() {
            let rest = [&scene.rig, &scene.own_rig, &scene.rest_body];
            let can_pose = rest.into_iter().any(Option::is_some);
            let is_posed = scene.pose.is_some() && can_pose;
            ensure_posed(is_posed, self.package.as_deref())?;
        }
        if scene.pose.is_some() && scene.bodies.len() > 1 {
            return Err(refused(
                "`--pose` poses one body",
                format!("{} bodies are given", scene.bodies.len()),
                "drape them one by one, or give posed bodies without `--pose`",
            ));
        }
        Ok(())
    }
}

fn ensure_posed(is_posed: bool, package: Option<&Path>) -> anyhow::Result<()> {
    let check = || -> anyhow::Result<()> {
        ensure!(is_posed, "no body is given");
        Ok(())
    };
    check().hint(|| {
        let hint = if package.is_some() {
            "give the OBJ of the body after the package, or a pose for its own body, as `--pose wave`"
        } else {
            "give the OBJ of the body after the garment, or `--pose` with `--rig` or `--rest-body`"
        };
        hint.to_owned()
    })
}
