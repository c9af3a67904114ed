//! The arguments of `chart`.

use std::path::{Path, PathBuf};

use clap::Args;
use garnet::{
    package::{GarmentPackage, Manifest, Quality},
    train::Candidate,
    untangle::UntangleOptions,
};

use crate::{
    dataset::QualityName,
    eval, models, output,
    parse::{at_least_one, millimetres, settle_frames, tolerance},
};

/// Arguments of `chart`.
#[derive(Debug, Args)]
#[command(after_long_help = LONG_HELP)]
pub(crate) struct ChartArgs {
    /// Garment package.
    #[arg(value_name = "PACKAGE", value_parser = models::package_or_file)]
    pub(crate) package: PathBuf,
    /// Data set of the garment; its test split is draped.
    #[arg(value_name = "DATASET")]
    pub(crate) dataset: PathBuf,
    /// Where charts, tables and samples go.
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: PathBuf,
    /// Variants of the package, or weight files, beside the skinning and the warp [default: all
    /// variants].
    #[arg(long, value_name = "NAME|FILE", value_delimiter = ',')]
    model: Vec<String>,
    /// Drape by networks also with the cloth simulated for so many frames of 1/60 s; 0 leaves that
    /// out [default: as `drape` takes, see docs/reference/options.md].
    #[arg(long, hide_short_help = true, value_name = "FRAMES", value_parser = settle_frames, allow_negative_numbers = true)]
    settle: Option<u32>,
    /// Drape so many scenes, evenly spread over the split.
    #[arg(long, value_name = "N", default_value = "40", value_parser = at_least_one, allow_negative_numbers = true)]
    scenes: usize,
    /// Drape all scenes of the split.
    #[arg(long, conflicts_with = "scenes")]
    all: bool,
    /// Drape each scene so often; its time is the median.
    #[arg(long, hide_short_help = true, value_name = "N", default_value = "3", value_parser = at_least_one, allow_negative_numbers = true)]
    pub(crate) repeat: usize,
    /// Simulate so many scenes in each quality; 0 leaves the teacher out.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "N",
        default_value = "8",
        allow_negative_numbers = true
    )]
    pub(crate) teacher_scenes: usize,
    /// The qualities of the simulations.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "QUALITY",
        value_delimiter = ',',
        default_value = "fast,teacher,reference"
    )]
    quality: Vec<QualityName>,
    /// The noise floor of the teacher, in millimetres [default: measured on up to 4 scenes].
    #[arg(long, hide_short_help = true, value_name = "MM", value_parser = tolerance, allow_negative_numbers = true)]
    pub(crate) noise_floor: Option<f64>,
    /// Draw what other programs need too: lines of the scripts in benches/peers.
    #[arg(long, hide_short_help = true, value_name = "FILE")]
    pub(crate) peers: Option<PathBuf>,
    /// Smallest distance between cloth and skin after untangling, in millimetres.
    #[arg(long, hide_short_help = true, value_name = "MM", default_value = "2", value_parser = millimetres, allow_negative_numbers = true)]
    clearance: f32,
    /// Measure all anew.
    #[arg(long, hide_short_help = true)]
    pub(crate) fresh: bool,
}

const LONG_HELP: &str = "\
Each way to drape is timed on single scenes in this process, on the threads of `--threads`, from a \
posed body in memory to the drape; all ways drape a scene before the next one comes. Simulations are not \
untangled; the substeps of the teacher and of the reference run on one thread. Distances are those to the drapes of the data set: a simulation \
of the quality that made them has none, and is drawn at the noise floor, which is how far its drapes \
move when one shoulder turns by 0.001 rad.

DIR gets
  chart.svg, chart.png     time against distance, with the methods that no other beats in both
  chart.csv, chart.json    the same as numbers, with all other scores
  samples.json             all samples: a run that is repeated or was stopped goes on from there";

/// What is written.
const FILES: [&str; 5] = [
    "chart.svg",
    "chart.png",
    "chart.csv",
    "chart.json",
    "samples.json",
];

impl ChartArgs {
    /// Refuses an output that cannot be written.
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        output::check_folder(&self.output)?;
        output::check_table(&self.output.join("chart.csv"), "method,kind,")
    }

    /// Refuses outputs that would take the place of what is read.
    pub(crate) fn check_apart(&self, manifest: &Manifest) -> anyhow::Result<()> {
        let outputs = FILES.map(|name| self.output.join(name));
        let package = (self.package.as_path(), manifest);
        eval::check_apart(&outputs, package, &self.dataset, &self.model)?;
        let outputs: Vec<&Path> = outputs.iter().map(PathBuf::as_path).collect();
        let peers: Vec<&Path> = self.peers.iter().map(PathBuf::as_path).collect();
        output::check_apart(&outputs, &peers)
    }

    /// Skinning, warp, and the models.
    pub(crate) fn candidates(&self, package: &GarmentPackage) -> anyhow::Result<Vec<Candidate>> {
        eval::candidates(&self.package, package, &self.model, self.settle, false)
    }

    /// The qualities of the simulations, from the fastest.
    pub(crate) fn qualities(&self) -> Vec<Quality> {
        if self.teacher_scenes == 0 {
            return Vec::new();
        }
        let mut qualities: Vec<Quality> = self.quality.iter().map(|name| name.quality()).collect();
        qualities.sort_unstable();
        qualities.dedup();
        qualities
    }

    /// How many of so many scenes are draped.
    pub(crate) fn num_scenes(&self, total: usize) -> usize {
        if self.all { total } else { self.scenes }
    }

    /// How drapes are untangled.
    pub(crate) fn untangle(&self) -> UntangleOptions {
        UntangleOptions {
            clearance: self.clearance,
            ..UntangleOptions::default()
        }
    }
}
