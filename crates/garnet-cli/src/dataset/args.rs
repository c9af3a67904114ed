//! The arguments of `dataset`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use garnet::{
    data::{Counts, Protocol, Sizing, Variations},
    mesh::{Unit, UnitError},
    package::{GarmentPackage, Moment, Quality},
    pattern::{PatternError, Size},
};

use crate::{cut_args::told, failure::refused, models};

/// Arguments of `dataset`.
#[derive(Debug, Args)]
#[command(after_long_help = LONG_HELP)]
pub(crate) struct DatasetArgs {
    /// Garment package.
    #[arg(value_name = "GARMENT", value_parser = models::package_or_file)]
    pub(crate) garment: PathBuf,
    /// Folder of the data set.
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: PathBuf,
    /// Bodies for training, validation and test.
    #[arg(
        long,
        value_name = "TRAIN/VALID/TEST",
        default_value = "500/20/80",
        value_parser = counts,
        conflicts_with = "import"
    )]
    pub(crate) bodies: Counts,
    /// Scenes on each body.
    #[arg(
        long,
        value_name = "N",
        default_value = "8",
        value_parser = clap::value_parser!(u32).range(1..=10_000),
        conflicts_with = "import",
        allow_negative_numbers = true
    )]
    pub(crate) poses: u32,
    /// Put poses together, trunk and legs between two poses and arms of others, as more scenes for
    /// `train --more`.
    #[arg(long, hide_short_help = true, conflicts_with = "import")]
    pub(crate) mixed: bool,
    /// Noise of the poses' angles, as a share of the usual one; it stays within the ranges of
    /// motion.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "SHARE",
        default_value = "1",
        value_parser = noise,
        conflicts_with = "import",
        allow_negative_numbers = true
    )]
    pub(crate) noise: f64,
    /// What is new in validation and test.
    #[arg(
        long,
        value_name = "PROTOCOL",
        default_value = "unseen",
        conflicts_with = "import"
    )]
    pub(crate) protocol: ProtocolName,
    /// Named seed of bodies and poses.
    #[arg(
        long,
        value_name = "S",
        default_value = "1",
        conflicts_with = "import",
        allow_negative_numbers = true
    )]
    pub(crate) seed: u64,
    /// Quality of the simulation.
    #[arg(
        long,
        value_name = "QUALITY",
        default_value = "teacher",
        conflicts_with = "import"
    )]
    pub(crate) quality: QualityName,
    /// How far the simulation goes.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "END",
        default_value = "rest",
        conflicts_with = "import"
    )]
    pub(crate) until: UntilName,
    /// Who wears what [default: made-to-measure for jeans and with --vary, one-size for all else].
    #[arg(long, value_name = "SIZING", conflicts_with = "import")]
    pub(crate) sizing: Option<SizingName>,
    /// Size of the garment of the package, as XS or XL: bodies whom that fits wear it, for `train
    /// --more`.
    #[arg(
        long,
        value_name = "SIZE",
        value_parser = named_size,
        conflicts_with_all = ["import", "vary"]
    )]
    pub(crate) size: Option<Size>,
    /// Draw a parameter of the pattern for each body, in centimetres or per cent, of garments that
    /// are made to measure; may be given several times.
    #[arg(long, hide_short_help = true, value_name = "NAME=MIN:MAX", value_parser = variation, conflicts_with = "import")]
    pub(crate) vary: Vec<(String, [f64; 2])>,
    /// Keep the scenes that the checks would reject, to look at them.
    #[arg(long, hide_short_help = true, conflicts_with = "import")]
    pub(crate) keep_all: bool,
    /// Make the K-th of N parts of the data set, each on a machine of its own.
    #[arg(long, hide_short_help = true, value_name = "K/N", default_value = "1/1", value_parser = part, conflicts_with = "import")]
    pub(crate) shard: (u32, u32),
    /// Take drapes made elsewhere: a manifest, or a folder laid out as the shirts of Wang et
    /// al. 2018.
    #[arg(long, value_name = "JSON|DIR")]
    pub(crate) import: Option<PathBuf>,
    /// Name of the body's OBJ in each sample of such a folder.
    #[arg(long, hide_short_help = true, value_name = "NAME", requires = "import")]
    pub(crate) body_file: Option<String>,
    /// Unit of such a folder [default: m].
    #[arg(long, hide_short_help = true, value_name = "UNIT", requires = "import", value_parser = unit)]
    pub(crate) units: Option<Unit>,
}

const LONG_HELP: &str = "\
A data set that was begun goes on where it was: at most the scene that each thread was at is lost. \
Parts made on several machines (--shard) are one data set once their shards are in one folder.

A manifest is JSON: {\"schema\": \"garnet.import/1\", \"units\": \"m\", \"scenes\": [{\"split\": \
\"train\", \"body\": \"b1\", \"sequence\": \"walk\", \"body_mesh\": \"b1.obj\", \"garment_mesh\": \
\"g1.obj\"}]}, with meshes as OBJ, or as npz with an array `vertices` of floats, or of integers if the unit is \
mm. They are rest body and template of the package in other poses and shapes, with y up. A body, and a sequence, is in one split alone.";

/// Reads a size.
fn named_size(text: &str) -> Result<Size, String> {
    text.parse().map_err(|error: PatternError| told(&error))
}

/// Quality of a simulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum QualityName {
    /// For a first look.
    Fast,
    /// What networks learn from.
    Teacher,
    /// The way of the teacher, and balance by Newton's method in the end: half a minute a scene.
    Reference,
}

/// How far a simulation goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum UntilName {
    /// Until the cloth rests.
    Rest,
    /// Until the body comes to its last place, a third of the work: more scenes for
    /// `train --variant arrival --more`.
    Arrival,
    /// Until the body is halfway to it, a fifth of the work: more scenes for
    /// `train --variant midway --more`.
    Midway,
}

/// What is new in validation and test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProtocolName {
    /// Bodies and sequences of poses.
    Unseen,
    /// Bodies alone, as in GarNet++: all are in the same poses, of walks, yoga and dances.
    Paper,
}

/// Who wears what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SizingName {
    /// All wear the template; bodies that it does not fit are left out.
    OneSize,
    /// Each body wears a garment cut to its measures.
    MadeToMeasure,
}

impl QualityName {
    pub(crate) fn quality(self) -> Quality {
        match self {
            Self::Fast => Quality::Fast,
            Self::Teacher => Quality::Teacher,
            Self::Reference => Quality::Reference,
        }
    }
}

impl ProtocolName {
    pub(crate) fn protocol(self) -> Protocol {
        match self {
            Self::Unseen => Protocol::UnseenSequences,
            Self::Paper => Protocol::SeenPoses,
        }
    }
}

impl UntilName {
    pub(crate) fn until(self) -> Moment {
        match self {
            Self::Rest => Moment::Rest,
            Self::Arrival => Moment::Arrival,
            Self::Midway => Moment::Midway,
        }
    }
}

impl DatasetArgs {
    /// The parameters that are drawn for each body; refused if one is named twice.
    pub(crate) fn variations(&self) -> anyhow::Result<Variations> {
        let mut all = Variations::default();
        for (number, (name, range)) in self.vary.iter().enumerate() {
            if self.vary[..number].iter().any(|(other, _)| other == name) {
                return Err(refused(
                    format!("`--vary` names `{name}` twice"),
                    "a parameter is drawn from one range",
                    "leave out one of them",
                ));
            }
            all = all.with(name, *range);
        }
        Ok(all)
    }

    pub(crate) fn sizing(&self, package: &GarmentPackage) -> Sizing {
        let pattern = package.manifest.pattern.as_ref();
        match self.sizing {
            Some(SizingName::MadeToMeasure) => Sizing::MadeToMeasure,
            None if pattern.is_some_and(|pattern| pattern.kind == "jeans") => Sizing::MadeToMeasure,
            None if !self.vary.is_empty() => Sizing::MadeToMeasure,
            Some(SizingName::OneSize) | None => Sizing::OneSize,
        }
    }
}

fn noise(text: &str) -> Result<f64, String> {
    const MOST: f64 = 10.0;
    match text.parse() {
        Ok(share) if (0.0..=MOST).contains(&share) => Ok(share),
        _ => Err(format!("expected a share from 0 to {MOST}, as in 2.5")),
    }
}

fn counts(text: &str) -> Result<Counts, String> {
    const MOST: u32 = 1_000_000;
    let numbers: Option<Vec<u32>> = text.split('/').map(|word| word.parse().ok()).collect();
    let Some(&[train, valid, test]) = numbers.as_deref() else {
        return Err("expected three numbers of bodies, as in 500/20/80".to_owned());
    };
    if [train, valid, test].iter().any(|&count| count > MOST) {
        return Err(format!("expected {MOST} bodies at most for each"));
    }
    if train + valid + test == 0 {
        return Err("expected at least one body".to_owned());
    }
    Ok(Counts { train, valid, test })
}

/// A parameter and its range, in metres or shares.
fn variation(text: &str) -> Result<(String, [f64; 2]), String> {
    let read = || {
        let (name, range) = text.split_once('=')?;
        let (low, high) = range.split_once(':')?;
        let [low, high] = [low, high].map(|end| end.parse::<f64>().ok());
        let range = [low? / 100.0, high? / 100.0];
        (range[0] <= range[1]).then(|| (name.to_owned(), range))
    };
    read().ok_or_else(|| "expected a parameter and its range, as in sleeve=18:34".to_owned())
}

/// Number of the part, from 0, and of how many.
fn part(text: &str) -> Result<(u32, u32), String> {
    let numbers = text
        .split_once('/')
        .and_then(|(part, of)| Some((part.parse::<u32>().ok()?, of.parse::<u32>().ok()?)));
    match numbers {
        Some((part, of)) if (1..=of).contains(&part) => Ok((part - 1, of)),
        _ => Err("expected a part and the number of parts, as in 1/4".to_owned()),
    }
}

fn unit(text: &str) -> Result<Unit, String> {
    text.parse().map_err(|error: UnitError| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_three() {
        let expected = Counts {
            train: 5,
            valid: 0,
            test: 2,
        };
        assert_eq!(counts("5/0/2"), Ok(expected));
        for text in [
            "",
            "5",
            "5/1",
            "0/0/0",
            "1/1/1/1",
            "a/b/c",
            "-1/2/3",
            "9999999/1/1",
        ] {
            assert!(counts(text).is_err(), "{text}");
        }
    }

    #[test]
    fn variations_have_a_name_and_a_range() {
        let expected = ("sleeve".to_owned(), [0.18, 0.34]);
        assert_eq!(variation("sleeve=18:34"), Ok(expected));
        for text in [
            "sleeve",
            "sleeve=18",
            "sleeve=40:18",
            "sleeve=a:b",
            "sleeve=nan:1",
        ] {
            assert!(variation(text).is_err(), "{text}");
        }
    }

    #[test]
    fn parts_count_from_one() {
        assert_eq!(part("1/1"), Ok((0, 1)));
        assert_eq!(part("4/4"), Ok((3, 4)));
        for text in ["0/4", "5/4", "1", "1/0", "a/2"] {
            assert!(part(text).is_err(), "{text}");
        }
    }
}
