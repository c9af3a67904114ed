//! The arguments of `stress`.

use std::path::{Path, PathBuf};

use clap::Args;
use garnet::{
    package::Manifest,
    stress::{AXES, Axis, Method, StressOptions},
};

use crate::{failure::refused, hints::did_you_mean_or, models, output};

/// Arguments of `stress`.
#[derive(Debug, Args)]
#[command(after_long_help = LONG_HELP)]
pub(crate) struct StressArgs {
    /// Garment package; without one, a T-shirt is cut into DIR.
    #[arg(value_name = "PACKAGE", value_parser = models::package_or_file)]
    pub(crate) package: Option<PathBuf>,
    /// Stress the garment and the body of a `drape-scene/1` file, which go into DIR as a package.
    #[arg(long, value_name = "JSON", conflicts_with = "package")]
    pub(crate) scene: Option<PathBuf>,
    /// Where table, picture and numbers go.
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: PathBuf,
    /// A few levels of each axis, none beyond what ours are to hold.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Axes, in place of all.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    axis: Vec<String>,
    /// Variants of the package, `simulator`, or `none`, beside the ways that need no network
    /// [default: fast, balanced, accurate].
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    method: Vec<String>,
    /// Seed of noise, holes and damage.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "S",
        default_value = "1",
        allow_negative_numbers = true
    )]
    pub(crate) seed: u64,
}

const LONG_HELP: &str = "\
Each axis makes a scene worse by degrees: a bent joint, a heavier body, noise on the skin, holes in \
it. Each method drapes it, and all are judged alike. A cell of the table is the highest level up to \
which a method holds, and what breaks at the next: a coordinate that is no number, a free vertex \
inside the body, an edge three times as long as at rest, cloth that jumps by 5 mm a degree more than \
the skin (and the simulator), ten seconds, an error.

The exit status is 1 if one of ours (the untangled warp and the variants) breaks at its bar or \
before.

DIR gets
  stress.md                the table, with a command for each failure
  stress.svg, stress.png   how deep cloth is inside along `joints`, or the first axis
  stress.json              all numbers
  cells.json               what was found so far: a run that was stopped goes on from there";

/// Variants that are taken by default, as far as a package has them.
const SHIPPED: [&str; 3] = ["fast", "balanced", "accurate"];

/// What is written.
const FILES: [&str; 5] = [
    "stress.md",
    "stress.svg",
    "stress.png",
    "stress.json",
    "cells.json",
];

impl StressArgs {
    /// Refuses an output that cannot be written.
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        output::check_output_folder(&self.output)
    }

    /// Refuses outputs that would take the place of a file of the package.
    pub(crate) fn check_apart(&self, folder: &Path, manifest: &Manifest) -> anyhow::Result<()> {
        let outputs = FILES.map(|name| self.output.join(name));
        let outputs: Vec<&Path> = outputs.iter().map(PathBuf::as_path).collect();
        let read = output::files_of_package(folder, manifest);
        output::check_apart(
            &outputs,
            &read.iter().map(PathBuf::as_path).collect::<Vec<_>>(),
        )
    }

    /// What is run on a package with these variants.
    pub(crate) fn options(&self, variants: &[String]) -> anyhow::Result<StressOptions> {
        let mut options = StressOptions::default();
        options.is_quick = self.quick;
        options.seed = self.seed;
        if !self.axis.is_empty() {
            let axes = self.axis.iter().map(|name| axis(name));
            options.axes = axes.collect::<anyhow::Result<_>>()?;
        }
        let of = |name: &String| Method::Variant(name.clone());
        if self.method.is_empty() {
            let shipped = variants
                .iter()
                .filter(|name| SHIPPED.contains(&name.as_str()));
            options.methods.extend(shipped.map(of));
        } else {
            for name in self.method.iter().filter(|name| *name != "none") {
                options.methods.push(match name.as_str() {
                    "simulator" => Method::Simulator,
                    _ if variants.contains(name) => of(name),
                    _ => return Err(no_method(name, variants)),
                });
            }
        }
        Ok(options)
    }
}

fn axis(name: &str) -> anyhow::Result<&'static Axis> {
    Axis::find(name).ok_or_else(|| {
        let names: Vec<&str> = AXES.iter().map(|axis| axis.name).collect();
        let all = format!("the axes are: {}", names.join(", "));
        refused(
            format!("there is no axis `{name}`"),
            "it is none of those that `stress` has",
            did_you_mean_or(name, names, &all),
        )
    })
}

fn no_method(name: &str, variants: &[String]) -> anyhow::Error {
    let mut names: Vec<&str> = variants.iter().map(String::as_str).collect();
    names.extend(["simulator", "none"]);
    let all = format!("expected one of {}", names.join(", "));
    refused(
        format!("there is no method `{name}`"),
        "it is no variant of the package",
        did_you_mean_or(name, names, &all),
    )
}
