//! `garnet poses` and `garnet variants`: what there is to choose from.

use std::{fmt::Write as _, path::PathBuf};

use clap::Args;
use garnet::{
    body::poses::{BodyAngles, Group, KeyPose, key_poses_of},
    package::Variant,
};
use serde::Serialize;
use serde_json::json;

use crate::{
    console::{Console, print_data, print_document},
    dataset::read_package,
    failure::ExitStatus,
    models,
};

/// Arguments of `variants`.
#[derive(Debug, Args)]
pub(crate) struct VariantsArgs {
    /// Garment package.
    #[arg(value_name = "PACKAGE", value_parser = models::package_or_file)]
    package: PathBuf,
}

/// A pose of the library.
#[derive(Debug, Serialize)]
struct PoseReport {
    name: &'static str,
    group: &'static str,
    /// What differs most from standing.
    note: String,
}

/// Angles that differ by less are not worth a word, in degrees.
const LEAST_BEND: f64 = 15.0;

/// The groups, with their names.
const GROUPS: [(Group, &str); 4] = [
    (Group::Everyday, "everyday"),
    (Group::Yoga, "yoga"),
    (Group::Dance, "dance"),
    (Group::Reach, "reach"),
];

/// Lists the poses of the library.
pub(crate) fn poses(console: &Console) -> anyhow::Result<ExitStatus> {
    let reports = GROUPS.into_iter().flat_map(|(group, name)| {
        let poses = key_poses_of(group).iter();
        poses.map(move |pose| PoseReport {
            name: pose.name,
            group: name,
            note: note(pose),
        })
    });
    let reports: Vec<PoseReport> = reports.collect();
    if console.is_json() {
        print_document(&json!({"schema": "garnet.poses/1", "poses": reports}))?;
        return Ok(ExitStatus::Done);
    }
    let width = reports
        .iter()
        .map(|report| report.name.len())
        .max()
        .unwrap_or(0);
    let mut lines = Vec::new();
    for (_, group) in GROUPS {
        lines.push(group.to_owned());
        let of_group = reports.iter().filter(|report| report.group == group);
        lines.extend(of_group.map(|PoseReport { name, note, .. }| {
            format!("  {name:width$}  {note}").trim_end().to_owned()
        }));
    }
    print_data(&lines.join("\n"))?;
    Ok(ExitStatus::Done)
}

/// The joints that are bent most, in words.
fn note(pose: &KeyPose) -> String {
    let BodyAngles {
        pelvis,
        spine,
        legs,
        arms,
        ..
    } = pose.angles;
    let most = |values: [f64; 2]| values[0].max(values[1]);
    let raised = arms.map(|arm| arm.flexion.hypot(arm.abduction));
    let found = [
        ("leaning", pelvis.flexion.abs()),
        ("trunk bent", spine.flexion.abs().max(spine.side.abs())),
        ("trunk turned", spine.turn.abs()),
        ("arms raised", most(raised)),
        ("elbows bent", most(arms.map(|arm| arm.elbow))),
        ("thighs raised", most(legs.map(|leg| leg.flexion))),
        ("legs spread", most(legs.map(|leg| leg.abduction))),
        ("knees bent", most(legs.map(|leg| leg.knee))),
    ];
    let mut bent: Vec<(&str, f64)> = found
        .into_iter()
        .filter(|(_, angle)| *angle > LEAST_BEND)
        .collect();
    bent.sort_by(|a, b| b.1.total_cmp(&a.1));
    let words = bent
        .iter()
        .take(3)
        .map(|(what, angle)| format!("{what} {angle:.0}\u{b0}"));
    words.collect::<Vec<_>>().join(", ")
}

/// A variant of a package.
#[derive(Debug, Serialize)]
struct VariantReport<'a> {
    name: &'a str,
    /// Other names that mean it.
    aliases: &'a [String],
    is_default: bool,
    /// Mean distance to the simulator on the test scenes of its training, in metres.
    error_m: Option<f64>,
    /// Time of a drape on the machine that measured it.
    seconds: Option<f64>,
}

impl<'a> VariantReport<'a> {
    fn new(variant: &'a Variant, default: Option<&Variant>) -> Self {
        Self {
            name: &variant.name,
            aliases: &variant.aliases,
            is_default: default.is_some_and(|default| default.name == variant.name),
            error_m: variant.settled_error.or(variant.distance_error),
            seconds: variant.settled_seconds.or(variant.seconds),
        }
    }

    fn line(&self, width: usize) -> String {
        let or_unknown = |number: Option<f64>, unit: &str, digits: usize| match number {
            Some(number) => format!("{:8.digits$} {unit}", 1e3 * number),
            None => format!("{:>8} {unit}", "-"),
        };
        let mut line = format!("{:width$}", self.name);
        line += &or_unknown(self.error_m, "mm", 2);
        line += &or_unknown(self.seconds, "ms", 0);
        if self.is_default {
            line += "  the default";
        }
        if !self.aliases.is_empty() {
            let _ = write!(line, "  (also {})", self.aliases.join(", "));
        }
        line
    }
}

/// Lists the variants of a package, the fastest first: their error against the simulator, and their
/// time.
pub(crate) fn variants(args: &VariantsArgs, console: &Console) -> anyhow::Result<ExitStatus> {
    let package = read_package(&args.package)?;
    let manifest = &package.manifest;
    let default = manifest.default_variant();
    let reports = manifest.variants.iter();
    let mut reports: Vec<_> = reports
        .map(|variant| VariantReport::new(variant, default))
        .collect();
    // The fastest first, and last what nobody has timed.
    let seconds = |report: &VariantReport| report.seconds.unwrap_or(f64::INFINITY);
    reports.sort_by(|a, b| seconds(a).total_cmp(&seconds(b)).then(a.name.cmp(b.name)));
    if console.is_json() {
        print_document(&json!({"schema": "garnet.variants/1", "variants": reports}))?;
        return Ok(ExitStatus::Done);
    }
    if reports.is_empty() {
        console.summary(&format_args!(
            "`{}` has no variants: `drape` warps it; `garnet train` makes some",
            args.package.display()
        ));
        return Ok(ExitStatus::Done);
    }
    let width = reports
        .iter()
        .map(|report| report.name.len())
        .max()
        .unwrap_or(0);
    let width = width.max("variant".len());
    let head = format!("{:width$}{:>8}   {:>8}", "variant", "error", "time");
    let lines = reports.iter().map(|report| report.line(width));
    let lines: Vec<String> = std::iter::once(head).chain(lines).collect();
    print_data(&lines.join("\n"))?;
    Ok(ExitStatus::Done)
}
