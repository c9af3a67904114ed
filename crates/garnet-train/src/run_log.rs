//! The log of a training: loss curves as CSV, and one JSON document to compare runs by.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use garnet_mesh::write_atomically;
use garnet_net::GarNetConfig;
use garnet_net::losses::Term;
use serde::Serialize;

use crate::state::{FirstTerm, Progress};
use crate::{Began, EpochRecord, TrainConfig, TrainError};

/// The files of a log, in the folder of the training.
#[derive(Debug)]
pub(crate) struct RunLog {
    folder: PathBuf,
    head: Option<Head>,
}

/// What a run started from.
#[derive(Debug, Clone, Serialize)]
struct Head {
    schema: &'static str,
    version: &'static str,
    name: String,
    dataset: String,
    base: Option<String>,
    train_scenes: usize,
    valid_scenes: usize,
    vertices: usize,
    body_points: usize,
    parameters: u64,
    flops: u64,
    /// Of each term, before the first step: its mean over the first scenes, and its weight.
    first_terms: Vec<FirstTerm>,
    config: TrainConfig,
    network: GarNetConfig,
}

#[derive(Debug, Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    head: &'a Head,
    epochs: &'a [EpochRecord],
}

impl RunLog {
    /// Of the training in a folder.
    pub(crate) fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_path_buf(),
            head: None,
        }
    }

    /// Writes what a run starts from, and the configuration as a file that can be trained with
    /// again.
    pub(crate) fn begin(
        &mut self,
        progress: &Progress,
        network: &GarNetConfig,
        began: &Began,
    ) -> Result<(), TrainError> {
        self.head = Some(Head {
            schema: "garnet.training-log/1",
            version: env!("CARGO_PKG_VERSION"),
            name: progress.name.clone(),
            dataset: progress.dataset.clone(),
            base: progress.base.clone(),
            train_scenes: began.num_train,
            valid_scenes: began.num_valid,
            vertices: began.num_vertices,
            body_points: began.num_body_points,
            parameters: began.parameters,
            flops: began.flops,
            first_terms: progress.first_terms.clone(),
            config: progress.config.clone(),
            network: network.clone(),
        });
        self.write("config.toml", &progress.config.to_text()?)?;
        self.epochs(&progress.epochs)
    }

    /// Writes the epochs so far.
    pub(crate) fn epochs(&self, epochs: &[EpochRecord]) -> Result<(), TrainError> {
        self.write("losses.csv", &csv(epochs))?;
        let Some(head) = &self.head else {
            return Ok(());
        };
        let text = serde_json::to_string_pretty(&Document { head, epochs });
        let mut text = text.map_err(|error| TrainError::State {
            path: self.folder.join("log.json"),
            reason: error.to_string(),
        })?;
        text.push('\n');
        self.write("log.json", &text)
    }

    fn write(&self, name: &str, text: &str) -> Result<(), TrainError> {
        let path = self.folder.join(name);
        Ok(write_atomically(path, |writer| {
            writer.write_all(text.as_bytes())
        })?)
    }
}

/// One line an epoch: rate, losses, terms without their weights, validation; units in the head.
fn csv(epochs: &[EpochRecord]) -> String {
    let mut text = String::from("epoch,learning_rate,loss,valid_loss");
    for term in Term::ALL {
        let _ = write!(text, ",{}", term.name());
    }
    text += ",valid_distance_mm,valid_normal_deg,valid_inside_percent,valid_deepest_mm";
    text += ",valid_mean_curvature,valid_rayleigh,valid_stretch_p99,best\n";
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:e}"));
    for record in epochs {
        let _ = write!(
            text,
            "{},{:e},{},{:e}",
            record.epoch,
            record.learning_rate,
            number(record.loss),
            record.valid_loss
        );
        for term in Term::ALL {
            let _ = write!(text, ",{}", number(record.terms.get(term.name()).copied()));
        }
        let valid = &record.valid;
        let _ = writeln!(
            text,
            ",{:.4},{:.4},{:.4},{:.3},{:e},{:e},{:.4},{}",
            1e3 * valid.distance,
            valid.normal.to_degrees(),
            1e2 * valid.inside,
            1e3 * valid.deepest,
            valid.mean_curvature,
            valid.rayleigh,
            valid.stretch_p99,
            u8::from(record.is_best)
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::Scores;

    #[test]
    fn lines_have_as_many_fields_as_the_head() {
        let record = |epoch, loss| EpochRecord {
            epoch,
            learning_rate: 1e-3,
            loss,
            terms: BTreeMap::from([("vertex".to_owned(), 0.25)]),
            skipped: 0,
            valid_loss: 0.5,
            valid: Scores {
                distance: 0.0123,
                ..Scores::default()
            },
            is_best: epoch == 1,
        };
        let text = csv(&[record(0, None), record(1, Some(0.75))]);
        let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(lines.len(), 3);
        assert!(lines.iter().all(|line| line.len() == lines[0].len()));
        let at = |name: &str| lines[0].iter().position(|field| *field == name).unwrap();
        assert_eq!(lines[2][at("valid_distance_mm")], "12.3000");
        assert_eq!(lines[2][at("vertex")], "2.5e-1");
        assert_eq!((lines[1][at("loss")], lines[2][at("loss")]), ("", "7.5e-1"));
    }
}
