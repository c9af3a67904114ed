//! The arguments that tell how a rig is read.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use garnet::{
    body::motion::Upward,
    io::{RigOptions, is_rig},
};

use crate::failure::refused;

/// How the rig is read.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct RigArgs {
    /// Of a GLB, glTF or VRM: a mesh that is the body, by its name; several by naming it again
    /// [default: all on one skeleton but hair, eyes and what is worn].
    #[arg(long, hide_short_help = true, value_name = "NAME")]
    mesh: Vec<String>,
    /// JSON that tells which joint is which, as {"head": "Bone.012"}, where names do not.
    #[arg(long, hide_short_help = true, value_name = "MAP.json")]
    joints: Option<PathBuf>,
    /// Shape of a model of the SMPL family: `1.5,-0.3`.
    #[arg(
        long,
        hide_short_help = true,
        value_name = "B,B,...",
        value_delimiter = ',',
        value_parser = beta,
        allow_hyphen_values = true
    )]
    betas: Vec<f64>,
}

impl RigArgs {
    /// Refuses what is asked of rigs where none is read, and why there is none.
    pub(crate) fn refuse(&self, why: &str) -> anyhow::Result<()> {
        let options = [
            (!self.mesh.is_empty(), "--mesh"),
            (self.joints.is_some(), "--joints"),
            (!self.betas.is_empty(), "--betas"),
        ];
        match options.into_iter().find(|(is_given, _)| *is_given) {
            Some((_, option)) => Err(refused(
                format!("`{option}` is given, and does nothing"),
                why.to_owned(),
                format!("it is for rigs: npz, GLB, glTF, VRM or JSON; leave out `{option}`"),
            )),
            None => Ok(()),
        }
    }

    /// The same if none of these files may be a rig.
    pub(crate) fn check<'a>(
        &self,
        files: impl IntoIterator<Item = &'a PathBuf>,
    ) -> anyhow::Result<()> {
        let is_any = |path: &PathBuf| is_rig(path) || path.extension().is_some_and(|e| e == "json");
        if files.into_iter().any(is_any) {
            return Ok(());
        }
        self.refuse("there is no rig among the files")
    }

    pub(crate) fn options(self) -> RigOptions {
        let mut options = RigOptions::default();
        options.meshes = self.mesh;
        options.joints = self.joints;
        options.betas = self.betas;
        options
    }
}

fn beta(text: &str) -> Result<f64, String> {
    let beta = text.trim().parse().ok();
    beta.filter(|beta: &f64| (*beta as f32).is_finite())
        .ok_or_else(|| "expected finite numbers, as in `1.5,-0.3`".to_owned())
}

/// The direction that points up in a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum PoseUp {
    /// As the bodies in it stand.
    Auto,
    /// As in files of graphics.
    Y,
    /// As in AMASS.
    Z,
    /// The x axis.
    X,
    /// As in the axes of a camera.
    #[value(name = "-y")]
    MinusY,
    /// Against the z axis.
    #[value(name = "-z")]
    MinusZ,
    /// Against the x axis.
    #[value(name = "-x")]
    MinusX,
}

impl PoseUp {
    pub(crate) fn direction(self) -> Option<Upward> {
        match self {
            Self::Auto => None,
            Self::Y => Some(Upward::Y),
            Self::Z => Some(Upward::Z),
            Self::X => Some(Upward::X),
            Self::MinusY => Some(Upward::MinusY),
            Self::MinusZ => Some(Upward::MinusZ),
            Self::MinusX => Some(Upward::MinusX),
        }
    }
}
