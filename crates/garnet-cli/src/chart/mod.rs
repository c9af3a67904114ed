//! `garnet chart`: time against accuracy of all ways to drape a package.

mod args;
mod csv;
mod measure;
mod memory;
mod methods;
mod peers;
mod picture;
mod record;
mod report;
mod table;

use std::{path::Path, time::Instant};

use garnet::{
    data::{Dataset, Split},
    train::{SceneName, Stage, chart::spread},
};
use garnet_view::Chart;

pub(crate) use args::ChartArgs;
use methods::Method;
use record::{Keeper, Setting};
use report::ChartReport;

use crate::{
    console::{Console, print_data, print_document},
    dataset::read_package,
    failure::ExitStatus,
    hints::{advised, advised_on},
    output,
};

/// The split that methods are judged by.
const SPLIT: Split = Split::Test;

/// Measures what is not measured yet, draws, and prints the table.
pub(crate) fn run(args: &ChartArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    let start = Instant::now();
    args.check()?;
    let package = read_package(&args.package)?;
    args.check_apart(&package.manifest)?;
    let peers = args.peers.as_ref();
    let peers = peers.map(|path| peers::read(path, &package.manifest.name));
    let peers = peers.transpose()?.unwrap_or_default();
    let candidates = args.candidates(&package)?;
    let stage = Stage::new(package, Dataset::open(&args.dataset)?).map_err(advised)?;
    let scenes = Chosen::new(args, &stage)?;
    let methods = Method::all(candidates, &args.qualities())?;

    output::open_folder(&args.output)?;
    let _lock = output::lock_folder(&args.output)?;
    let mut keeper = Keeper::open(args, Setting::new(args, &stage))?;
    let job = Job {
        args,
        stage: &stage,
        methods: &methods,
        scenes: &scenes,
        console,
    };
    measure::drapes(&job, &mut keeper)?;
    measure::simulations(&job, &mut keeper)?;
    memory::measure(&job, &mut keeper)?;

    let measured = (&scenes, &keeper.record, peers);
    let report = ChartReport::new(args, &stage, &methods, measured, start);
    write(&args.output, &report)?;
    if console.is_json() {
        print_document(&report)?;
    } else {
        print_data(&table::text(&report))?;
    }
    console.summary(&format_args!(
        "charts and numbers are in `{}`",
        args.output.display()
    ));
    Ok(ExitStatus::Done)
}

/// What is measured.
struct Job<'a> {
    args: &'a ChartArgs,
    stage: &'a Stage,
    methods: &'a [Method],
    scenes: &'a Chosen,
    console: &'a Console,
}

/// The scenes that are draped.
struct Chosen {
    drapes: Vec<SceneName>,
    simulations: Vec<SceneName>,
    noise: Vec<SceneName>,
}

/// Scenes on which the noise floor is measured, at most.
const NOISE_SCENES: usize = 4;

impl Chosen {
    fn new(args: &ChartArgs, stage: &Stage) -> anyhow::Result<Self> {
        let all = stage.scene_names(SPLIT);
        let all = all.map_err(|error| advised_on(error, &args.dataset))?;
        let drapes = spread(&all, args.num_scenes(all.len()));
        let simulations = spread(&drapes, args.teacher_scenes);
        Ok(Self {
            // Drapes made elsewhere have no teacher, and no poses to turn a joint of.
            noise: match (args.noise_floor, &stage.dataset.manifest.quality) {
                (None, Some(_)) => spread(&simulations, NOISE_SCENES),
                _ => Vec::new(),
            },
            drapes,
            simulations,
        })
    }
}

fn write(folder: &Path, report: &ChartReport) -> anyhow::Result<()> {
    let mut text = serde_json::to_string_pretty(report)?;
    text.push('\n');
    output::write(&folder.join("chart.json"), text.as_bytes())?;
    output::write(&folder.join("chart.csv"), csv::methods(report).as_bytes())?;
    draw(folder, "chart", &picture::chart(report))
}

fn draw(folder: &Path, name: &str, chart: &Chart) -> anyhow::Result<()> {
    let svg = chart.to_svg()?;
    output::write(&folder.join(format!("{name}.svg")), svg.as_bytes())?;
    let png = chart.to_image()?.to_png_bytes()?;
    output::write(&folder.join(format!("{name}.png")), &png)
}
