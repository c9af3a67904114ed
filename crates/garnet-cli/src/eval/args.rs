//! The arguments of `eval`.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, ValueEnum};
use garnet::{
    data::Split,
    package::{GarmentPackage, Manifest},
    train::{Candidate, Finish},
    untangle::UntangleOptions,
};

use super::curves;
use crate::{
    failure::Hint,
    hints::did_you_mean_or,
    models, output,
    parse::{millimetres, settle_frames},
};

/// Arguments of `eval`.
#[derive(Debug, Args)]
pub(crate) struct EvalArgs {
    /// Garment package.
    #[arg(value_name = "PACKAGE", value_parser = models::package_or_file)]
    pub(crate) package: PathBuf,
    /// Data set of the garment.
    #[arg(value_name = "DATASET")]
    pub(crate) dataset: PathBuf,
    /// Variants of the package, or weight files, beside the skinning and the warp [default: all
    /// variants].
    #[arg(long, value_name = "NAME|FILE", value_delimiter = ',')]
    model: Vec<String>,
    /// The scenes to measure on; models are chosen by `valid` and judged by `test`.
    #[arg(long, value_name = "SPLIT", default_value = "test")]
    split: SplitName,
    /// Measure networks also with the cloth simulated for so many frames of 1/60 s; 0 leaves that
    /// out [default: as `drape` takes, see docs/reference/options.md].
    #[arg(long, hide_short_help = true, value_name = "FRAMES", value_parser = settle_frames, allow_negative_numbers = true)]
    settle: Option<u32>,
    /// Measure drapes as the networks leave them only.
    #[arg(long, hide_short_help = true)]
    no_untangle: bool,
    /// Smallest distance between cloth and skin after untangling, in millimetres.
    #[arg(long, hide_short_help = true, value_name = "MM", default_value = "2", value_parser = millimetres, allow_negative_numbers = true)]
    clearance: f32,
    /// Write the report as JSON.
    #[arg(long, value_name = "FILE")]
    pub(crate) report: Option<PathBuf>,
    /// Write the shares of vertices and normals under thresholds: `ap.csv`, `ap-distance.svg` and
    /// `ap-normal.svg`.
    #[arg(long, value_name = "DIR")]
    pub(crate) curves: Option<PathBuf>,
    /// End with 1 if the mean distance of a network is above this, in millimetres.
    #[arg(long, value_name = "MM", value_parser = millimetres, allow_negative_numbers = true)]
    pub(crate) max_error: Option<f32>,
}

/// A part of a data set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SplitName {
    /// What networks learn from.
    Train,
    /// What networks are chosen by.
    Valid,
    /// What networks are judged by.
    Test,
}

impl EvalArgs {
    /// Refuses outputs that cannot be written.
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        self.report
            .as_deref()
            .map_or(Ok(()), output::check_report)?;
        let Some(folder) = &self.curves else {
            return Ok(());
        };
        output::check_folder(folder)?;
        output::check_table(&folder.join("ap.csv"), "curve,threshold,")
    }

    /// Refuses outputs that would take the place of a file of the package or the data set, or of
    /// weights.
    pub(crate) fn check_apart(&self, manifest: &Manifest) -> anyhow::Result<()> {
        let curves = self.curves.iter();
        let curves = curves.flat_map(|folder| curves::FILES.map(|name| folder.join(name)));
        let outputs: Vec<PathBuf> = self.report.iter().cloned().chain(curves).collect();
        check_apart(
            &outputs,
            (&self.package, manifest),
            &self.dataset,
            &self.model,
        )
    }

    pub(crate) fn split(&self) -> Split {
        match self.split {
            SplitName::Train => Split::Train,
            SplitName::Valid => Split::Valid,
            SplitName::Test => Split::Test,
        }
    }

    pub(crate) fn finish(&self) -> Finish {
        if self.no_untangle {
            return Finish::None;
        }
        Finish::Untangle(UntangleOptions {
            clearance: self.clearance,
            ..UntangleOptions::default()
        })
    }

    /// Skinning, warp, and the models.
    pub(crate) fn candidates(
        &self,
        package: &GarmentPackage,
        is_size: bool,
    ) -> anyhow::Result<Vec<Candidate>> {
        candidates(&self.package, package, &self.model, self.settle, is_size)
    }
}

/// Refuses outputs that would take the place of a file of a package or a data set, or of weights
/// among the models.
pub(crate) fn check_apart(
    outputs: &[PathBuf],
    (package, manifest): (&Path, &Manifest),
    dataset: &Path,
    models: &[String],
) -> anyhow::Result<()> {
    let mut read = output::files_of_package(package, manifest);
    read.extend(output::files_of_dataset(dataset));
    read.extend(models.iter().map(PathBuf::from));
    let [outputs, read] = [outputs, &read].map(|paths| paths.iter().map(PathBuf::as_path));
    output::check_apart(&outputs.collect::<Vec<_>>(), &read.collect::<Vec<_>>())
}

/// Skinning, warp, and models of a package in a folder by name or file, each also settled; all of
/// the package if none are named. Scenes may be of another size.
pub(crate) fn candidates(
    folder: &Path,
    package: &GarmentPackage,
    models: &[String],
    settle: Option<u32>,
    is_size: bool,
) -> anyhow::Result<Vec<Candidate>> {
    let variants = &package.manifest.variants;
    let all = variants.iter().map(|variant| variant.name.clone());
    let names: Vec<String> = if models.is_empty() {
        all.collect()
    } else {
        models.to_vec()
    };
    let mut candidates = vec![Candidate::Skinning, Candidate::Warp];
    for name in names {
        let path = Path::new(&name);
        let is_file = path
            .extension()
            .is_some_and(|extension| extension == "safetensors");
        let weights = if is_file {
            path.to_path_buf()
        } else {
            let cannot = || format!("cannot measure `{name}` of `{}`", folder.display());
            let weights = if is_size {
                package.manifest.weights_of_sizes(folder, &name)
            } else {
                package.manifest.weights_of(folder, &name)
            };
            weights.with_context(cannot).hint(|| {
                let known = variants.iter();
                let known = known.flat_map(|variant| variant.aliases.iter().chain([&variant.name]));
                let advice = "`garnet train` adds variants to a package";
                did_you_mean_or(&name, known.map(String::as_str), advice)
            })?
        };
        // As a drape relaxes it.
        let variant = package.manifest.variant(&name);
        let frames = settle.or_else(|| variant?.settle_frames);
        candidates.extend(Candidate::of_weights(&name, &weights, frames)?);
    }
    Ok(candidates)
}
