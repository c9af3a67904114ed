//! Weights that are stored anew in fewer bits.
//!
//! For deformations that poses and shapes predict: what they predict from then on is what the
//! rounded numbers predict, so that `garnet eval` has to judge them again. Networks beside a
//! deformation that start from it are bound to it anew.

use std::{
    fs,
    path::{Path, PathBuf},
};

use burn::tensor::Device;
use clap::Args;
use garnet_net::{Checkpoint, Precision, pose_space::PoseSpace};

use crate::Outcome;

/// What to store anew.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Weights of a deformation, as `models/tshirt/falling.safetensors`.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Bits of their numbers: f32, f16 or i8.
    #[arg(long, default_value = "i8", value_parser = precision)]
    precision: Precision,
}

fn precision(name: &str) -> Result<Precision, String> {
    serde_json::from_value(serde_json::Value::from(name)).map_err(|error| error.to_string())
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    for path in &arguments.files {
        let mut space = PoseSpace::load(path)?;
        if let Some(stored) = space.record.get_mut("precision") {
            *stored = serde_json::to_value(arguments.precision)?;
        }
        let before = fs::metadata(path)?.len();
        let old = space.checksum().to_owned();
        space.save(path, arguments.precision)?;
        bind_anew(path, &old, PoseSpace::load(path)?.checksum())?;
        let after = fs::metadata(path)?.len();
        let in_mb = |bytes: u64| bytes as f64 / 1e6;
        println!(
            "{}: {:.2} MB, was {:.2} MB",
            path.display(),
            in_mb(after),
            in_mb(before)
        );
    }
    Ok(())
}

/// Tells networks beside a deformation, which start from it, that its checksum is another one. Their
/// own weights are stored in 16 bits.
fn bind_anew(path: &Path, old: &str, new: &str) -> Outcome {
    let folder = path.parent().ok_or("the file is in no folder")?;
    for file in fs::read_dir(folder)? {
        let file = file?.path();
        let Ok(mut network) = Checkpoint::load(&file, &Device::flex()) else {
            continue;
        };
        if network.pose_space.as_deref() == Some(old) {
            network.pose_space = Some(new.to_owned());
            network.save(&file, Precision::F16)?;
            println!("{}: starts from it", file.display());
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn precisions_go_by_the_names_of_configurations() {
        assert_eq!(precision("i8").unwrap(), Precision::I8);
        assert_eq!(precision("f16").unwrap(), Precision::F16);
        assert!(precision("i4").is_err());
    }
}
