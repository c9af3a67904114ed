//! The arguments of `garment`: those of a pattern come from the pattern.

use std::path::PathBuf;

use clap::{Arg, ArgMatches, Args, Command, FromArgMatches, Subcommand, error::ErrorKind};
use garnet::{
    io::SceneUnits,
    pattern::{GarmentKind, ParameterSpec, ParameterUnit, Parameters, PatternError, VERTEX_RANGE},
};

use crate::{
    cut_args::{SizeChoice, check_size, size, told},
    drape::{UpName, units},
    rig_args::RigArgs,
};

/// Arguments of `garment`.
#[derive(Debug, Args)]
pub(crate) struct GarmentArgs {
    #[command(subcommand)]
    pub(crate) source: GarmentSource,
}

/// Where a garment comes from.
#[derive(Debug)]
pub(crate) enum GarmentSource {
    /// A sewing pattern.
    Pattern(Box<PatternArgs>),
    /// A mesh of the user's.
    Own(Box<OwnArgs>),
}

/// Arguments of a sewing pattern.
#[derive(Debug)]
pub(crate) struct PatternArgs {
    pub(crate) parameters: Parameters,
    pub(crate) common: PatternOptions,
}

/// What all sewing patterns have.
#[derive(Debug, Args)]
pub(crate) struct PatternOptions {
    /// Folder of the package.
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: PathBuf,
    /// Number of vertices, met within 2 %.
    #[arg(
        long,
        value_name = "N",
        default_value = "5000",
        allow_negative_numbers = true,
        value_parser = vertices
    )]
    pub(crate) vertices: usize,
    /// Cut it in a size, XS to 3XL or, as trousers, waist and inner leg in inches (32x34), instead
    /// of to the measures of the body; auto is the one that fits the body best.
    #[arg(long, value_name = "SIZE", value_parser = size)]
    pub(crate) size: Option<SizeChoice>,
    /// Body to cut it for and to put it on: an OBJ of the built-in body at rest with its rig, or
    /// the rig [default: a mean of both sexes, 172 cm tall, with a body mass index of 23].
    #[arg(long, value_name = "BODY")]
    pub(crate) body: Option<PathBuf>,
    /// Fabric: silk, jersey, interlock, cotton, knit or denim [default: that of the garment].
    #[arg(long, value_name = "NAME")]
    pub(crate) fabric: Option<String>,
    /// Name of the garment [default: that of the pattern].
    #[arg(long, value_name = "NAME", value_parser = name)]
    pub(crate) name: Option<String>,
}

/// Arguments of `from-obj`.
#[derive(Debug, Args)]
pub(crate) struct OwnArgs {
    /// Garment, as OBJ, lying on the rest body.
    #[arg(value_name = "OBJ")]
    pub(crate) garment: PathBuf,
    /// Body on which the garment lies, as OBJ [default: the rest mesh of the rig].
    #[arg(long, value_name = "OBJ")]
    pub(crate) rest_body: Option<PathBuf>,
    /// Skeleton and weights: npz, GLB, glTF, VRM or JSON [default: `<rest body>.rig.npz`].
    #[arg(long, value_name = "FILE")]
    pub(crate) rig: Option<PathBuf>,
    /// How the rig is read.
    #[command(flatten)]
    pub(crate) rig_args: RigArgs,
    /// Folder of the package.
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: PathBuf,
    /// Fabric: silk, jersey, interlock, cotton, knit or denim.
    #[arg(long, value_name = "NAME", default_value = "cotton")]
    pub(crate) fabric: String,
    /// Name of the garment [default: that of the file].
    #[arg(long, value_name = "NAME", value_parser = name)]
    pub(crate) name: Option<String>,
    /// Bring a garment to the rest body that does not lie on it: unit, axis, place, size and
    /// sleeves are found by its openings and the skin.
    #[arg(long)]
    pub(crate) place: bool,
    /// Unit of the OBJ files: m, dm, cm, mm or auto; or two, of garment and body: `cm,m`. Packages
    /// are in metres.
    #[arg(long, value_name = "UNIT", default_value = "auto", value_parser = units)]
    pub(crate) units: SceneUnits,
    /// Axis of the OBJ files that points up, which is y in packages.
    #[arg(long, value_name = "AXIS", default_value = "auto")]
    pub(crate) up: UpName,
}

/// The longest name of a garment, in characters.
const MAX_NAME: usize = 80;

/// A name that can stand in a line of a message and in the name of a file.
pub(crate) fn name(text: &str) -> Result<String, String> {
    let is_bad = |letter: char| letter.is_control() || matches!(letter, '/' | '\\');
    let is_name =
        !text.trim().is_empty() && text.trim() == text && text.chars().count() <= MAX_NAME;
    if is_name && !text.chars().any(is_bad) && !matches!(text, "." | "..") {
        return Ok(text.to_owned());
    }
    Err(format!(
        "expected a name of 1 to {MAX_NAME} letters, without line breaks, slashes, and spaces around it"
    ))
}

const OWN: &str = "from-obj";

impl Subcommand for GarmentSource {
    fn augment_subcommands(command: Command) -> Command {
        let mut command = command;
        for kind in GarmentKind::ALL {
            let about = format!(
                "{}, cut from a pattern, sewn and put on a body",
                named(kind)
            );
            let pattern = PatternOptions::augment_args(Command::new(kind.name()));
            let specs = kind.specs().iter().map(argument);
            command = command.subcommand(pattern.about(about).args(specs));
        }
        let own = OwnArgs::augment_args(Command::new(OWN));
        command
            .subcommand(own.about("A garment of your own"))
            .subcommand_required(true)
    }

    fn augment_subcommands_for_update(command: Command) -> Command {
        Self::augment_subcommands(command)
    }

    fn has_subcommand(name: &str) -> bool {
        name == OWN || name.parse::<GarmentKind>().is_ok()
    }
}

/// A number of vertices; the pattern tells whether it can have so many.
fn vertices(text: &str) -> Result<usize, String> {
    let [least, most] = VERTEX_RANGE;
    let expected = |_| format!("expected a number from {least} to {most}");
    text.parse().map_err(expected)
}

impl FromArgMatches for GarmentSource {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let missing = || clap::Error::new(ErrorKind::MissingSubcommand);
        let (name, matches) = matches.subcommand().ok_or_else(missing)?;
        if name == OWN {
            return Ok(Self::Own(Box::new(OwnArgs::from_arg_matches(matches)?)));
        }
        let refused = |error: &PatternError| {
            clap::Error::raw(ErrorKind::ValueValidation, format!("{}\n", told(error)))
        };
        let kind: GarmentKind = name
            .parse()
            .map_err(|error: PatternError| refused(&error))?;
        let mut parameters = kind.parameters();
        for spec in kind.specs() {
            if let Some(&shown) = matches.get_one::<f64>(spec.name) {
                parameters
                    .set(spec.name, shown / 100.0)
                    .map_err(|error| refused(&error))?;
            }
        }
        let common = PatternOptions::from_arg_matches(matches)?;
        if let Some(SizeChoice::Named(size)) = common.size {
            check_size(size, kind).map_err(|error| refused(&error))?;
        }
        Ok(Self::Pattern(Box::new(PatternArgs { parameters, common })))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// A garment as the help calls it.
const fn named(kind: GarmentKind) -> &'static str {
    match kind {
        GarmentKind::Tshirt => "A T-shirt",
        GarmentKind::Sweater => "A sweater",
        GarmentKind::Dress => "A dress",
        GarmentKind::Jeans => "Jeans",
    }
}

/// A value in centimetres or per cent, within the range of its parameter.
fn value(spec: &ParameterSpec, text: &str) -> Result<f64, String> {
    let [low, high] = spec.range;
    match text.parse::<f64>() {
        Ok(value) if (low - ROUNDING..=high + ROUNDING).contains(&(value / 100.0)) => Ok(value),
        _ => Err(format!(
            "it lies between {} and {}",
            spec.shown(low),
            spec.shown(high)
        )),
    }
}

/// What is typed in centimetres may miss the end of a range by this.
const ROUNDING: f64 = 1e-9;

/// The argument of a parameter: centimetres, or per cent.
fn argument(spec: &'static ParameterSpec) -> Arg {
    let (unit, value_name) = match spec.unit {
        ParameterUnit::Metre => ("cm", "CM"),
        ParameterUnit::Share => ("%", "PERCENT"),
    };
    let [low, high] = spec.range.map(|value| (1000.0 * value).round() / 10.0);
    let default = (1000.0 * spec.default).round() / 10.0;
    let mut help = spec.help.to_owned();
    if let Some(first) = help.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    Arg::new(spec.name)
        .long(spec.name)
        .value_name(value_name)
        .value_parser(move |text: &str| value(spec, text))
        .allow_negative_numbers(true)
        .help_heading("Pattern")
        .help(format!(
            "{help}, {low} to {high} {unit} [default: {default}]"
        ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_of_one_line_and_no_paths() {
        for good in ["tee", "My T-shirt, size 3", "Röckchen", "a.b"] {
            assert_eq!(name(good).as_deref(), Ok(good));
        }
        for bad in [
            "", " ", "../../x", "a/b", "a\\b", "a\nb", "a\u{7}", "..", " a",
        ] {
            assert!(name(bad).is_err(), "{bad:?}");
        }
        assert!(name(&"a".repeat(1000)).is_err());
    }

    #[test]
    fn values_outside_the_range_of_a_parameter_are_refused() {
        for spec in GarmentKind::ALL.into_iter().flat_map(GarmentKind::specs) {
            for end in spec.range {
                assert!(
                    value(spec, &(100.0 * end).to_string()).is_ok(),
                    "{}",
                    spec.name
                );
            }
            for text in ["nan", "inf", "1e6", "-1e6", "12cm", ""] {
                assert!(value(spec, text).is_err(), "{} {text}", spec.name);
            }
        }
    }

    #[test]
    fn each_garment_has_a_line_of_its_own() {
        let command = GarmentSource::augment_subcommands(Command::new("garment"));
        let abouts = command.get_subcommands().map(|command| {
            let about = command.get_about().map(ToString::to_string);
            about.unwrap_or_default()
        });
        let mut abouts: Vec<String> = abouts.collect();
        abouts.sort();
        abouts.dedup();
        assert_eq!(abouts.len(), GarmentKind::ALL.len() + 1);
        assert!(abouts.iter().any(|about| about.contains("of your own")));
    }
}
