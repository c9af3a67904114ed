//! Weights that are stored anew in fewer bits.
//!
//! What they predict from then on is what the rounded numbers predict, so that `garnet eval` has to
//! judge them again. Networks that start from a deformation know it by its checksum: store the
//! deformation first, and train them on it.

use std::{fs, path::PathBuf};

use clap::Args;
use garnet_net::{Checkpoint, Precision, pose_space::PoseSpace};

use crate::Outcome;

/// What to store anew.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Weights of a deformation, as `models/tshirt/falling.safetensors`, or of a network.
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
    let precision = serde_json::to_value(arguments.precision)?;
    for path in &arguments.files {
        let before = fs::metadata(path)?.len();
        if Checkpoint::header(path).is_ok() {
            Checkpoint::repack(path, arguments.precision)?;
        } else {
            let mut space = PoseSpace::load(path)?;
            if let Some(stored) = space.record.get_mut("precision") {
                *stored = precision.clone();
            }
            space.save(path, arguments.precision)?;
        }
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
