//! What is told about a training.

use std::{fmt, path::Path, time::Duration};

use garnet::train::{EpochRecord, Scores, Trained};
use serde::Serialize;

/// What a training has come to. SI units.
#[derive(Debug, Serialize)]
pub(crate) struct TrainReport {
    schema: &'static str,
    variant: String,
    weights: String,
    /// The folder with curves, log and state.
    training: String,
    epochs: u32,
    /// Whether the patience ended it.
    ended_early: bool,
    best_epoch: u32,
    /// The validation before the first step: the warp, unless weights were fine-tuned.
    valid_at_start: Option<Scores>,
    /// None if the data set has no scenes to validate by.
    valid: Option<Scores>,
    test: Option<Scores>,
    /// Mean distance to the teacher on the test split once the cloth has settled.
    settled_error_m: Option<f64>,
    seconds: f64,
}

impl TrainReport {
    pub(crate) fn new(
        trained: &Trained,
        folder: &Path,
        start: Option<&EpochRecord>,
        time: Duration,
    ) -> Self {
        Self {
            schema: "garnet.train/1",
            variant: trained.name.clone(),
            weights: trained.weights.display().to_string(),
            training: folder.display().to_string(),
            epochs: trained.epochs,
            ended_early: trained.epochs < trained.epochs_asked,
            best_epoch: trained.best.epoch,
            valid_at_start: start.map(|start| start.valid),
            valid: trained.valid,
            test: trained.test,
            settled_error_m: trained.settled_error,
            seconds: time.as_secs_f64(),
        }
    }
}

impl fmt::Display for TrainReport {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let figures = |scores: &Scores| {
            format!(
                "{:.2} mm, {:.2}°",
                1e3 * scores.distance,
                scores.normal.to_degrees()
            )
        };
        let (name, minutes) = (&self.variant, self.seconds / 60.0);
        if self.epochs == 0 {
            write!(formatter, "fitted `{name}` in {minutes:.1} min")?;
        } else {
            let early = if self.ended_early { ", early" } else { "" };
            write!(
                formatter,
                "trained `{name}` in {} epochs{early}, {minutes:.1} min; the best is epoch {}",
                self.epochs, self.best_epoch
            )?;
        }
        let valid = self.valid.as_ref();
        let valid = valid.map_or_else(|| "not measured: no scenes in `valid`".to_owned(), figures);
        write!(formatter, "\n  validation {valid}")?;
        if let Some(start) = &self.valid_at_start {
            write!(formatter, " (at the start {})", figures(start))?;
        }
        if let Some(test) = &self.test {
            write!(formatter, "\n  test {}", figures(test))?;
        }
        if let Some(error) = self.settled_error_m {
            write!(formatter, "; settled {:.2} mm", 1e3 * error)?;
        }
        write!(formatter, "\nwrote {}", self.weights)?;
        if self.epochs == 0 {
            return Ok(());
        }
        write!(formatter, "; curves and log are in {}", self.training)
    }
}
