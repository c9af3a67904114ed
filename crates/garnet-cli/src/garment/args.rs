//! The arguments of `garment`: those of a pattern come from the pattern.

use std::path::PathBuf;

use clap::{Arg, ArgMatches, Args, Command, FromArgMatches, Subcommand, error::ErrorKind};
use garnet::pattern::{GarmentKind, ParameterSpec, ParameterUnit, Parameters, Size};

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
    #[arg(long, value_name = "N", default_value = "5000")]
    pub(crate) vertices: usize,
    /// Cut it in a size, XS to 3XL, instead of to the measures of the body.
    #[arg(long, value_name = "SIZE", value_parser = size)]
    pub(crate) size: Option<Size>,
    /// Body to cut it for and to put it on: an OBJ of the built-in body at rest with its rig, or the
    /// rig [default: the mean of both sexes, 172 cm].
    #[arg(long, value_name = "BODY")]
    pub(crate) body: Option<PathBuf>,
    /// Fabric: silk, jersey, interlock, cotton, knit or denim [default: that of the garment].
    #[arg(long, value_name = "NAME")]
    pub(crate) fabric: Option<String>,
    /// Name of the garment [default: that of the pattern].
    #[arg(long, value_name = "NAME")]
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
    /// Skeleton and weights: npz, GLB, glTF or JSON [default: `<rest body>.rig.npz`].
    #[arg(long, value_name = "FILE")]
    pub(crate) rig: Option<PathBuf>,
    /// Folder of the package.
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: PathBuf,
    /// Fabric: silk, jersey, interlock, cotton, knit or denim.
    #[arg(long, value_name = "NAME", default_value = "cotton")]
    pub(crate) fabric: String,
    /// Name of the garment [default: that of the file].
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Option<String>,
}

fn size(text: &str) -> Result<Size, String> {
    text.parse()
        .map_err(|error: garnet::pattern::PatternError| error.to_string())
}

const OWN: &str = "from-obj";

impl Subcommand for GarmentSource {
    fn augment_subcommands(command: Command) -> Command {
        let mut command = command;
        for kind in GarmentKind::ALL {
            let about = format!("Cut a {kind} from its pattern, sew it and put it on a body");
            let pattern = PatternOptions::augment_args(Command::new(kind.name()).about(about));
            let specs = kind.specs().iter().map(argument);
            command = command.subcommand(pattern.args(specs));
        }
        let own = Command::new(OWN).about("Make a package of a garment of your own");
        command
            .subcommand(OwnArgs::augment_args(own))
            .subcommand_required(true)
    }

    fn augment_subcommands_for_update(command: Command) -> Command {
        Self::augment_subcommands(command)
    }

    fn has_subcommand(name: &str) -> bool {
        name == OWN || name.parse::<GarmentKind>().is_ok()
    }
}

impl FromArgMatches for GarmentSource {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let missing = || clap::Error::new(ErrorKind::MissingSubcommand);
        let (name, matches) = matches.subcommand().ok_or_else(missing)?;
        if name == OWN {
            return Ok(Self::Own(Box::new(OwnArgs::from_arg_matches(matches)?)));
        }
        let refused = |error: &dyn std::fmt::Display| {
            clap::Error::raw(ErrorKind::ValueValidation, format!("{error}\n"))
        };
        let kind: GarmentKind = name.parse().map_err(|error| refused(&error))?;
        let mut parameters = kind.parameters();
        for spec in kind.specs() {
            if let Some(&shown) = matches.get_one::<f64>(spec.name) {
                parameters
                    .set(spec.name, shown / 100.0)
                    .map_err(|error| refused(&error))?;
            }
        }
        let common = PatternOptions::from_arg_matches(matches)?;
        Ok(Self::Pattern(Box::new(PatternArgs { parameters, common })))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

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
        .value_parser(clap::value_parser!(f64))
        .allow_negative_numbers(true)
        .help_heading("Pattern")
        .help(format!(
            "{help}, {low} to {high} {unit} [default: {default}]"
        ))
}
