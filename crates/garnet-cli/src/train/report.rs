//! What is told about a training.

use std::{fmt, path::Path, time::Duration};

use garnet::train::{DefaultVariant, DrapeScores, EpochRecord, Scores, Trained, WhyDefault};
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
    /// Whole drapes of the validation split, which the default is chosen by.
    valid_drapes: Option<DrapeScores>,
    /// Settled drapes of the test split.
    settled: Option<DrapeScores>,
    /// What the package drapes with if no variant is asked for.
    default: DefaultReport,
    seconds: f64,
}

/// The default of a package.
#[derive(Debug, Serialize)]
struct DefaultReport {
    variant: String,
    /// Mean distance to the teacher on the validation split, if it is known.
    valid_error_m: Option<f64>,
    /// `asked`, `best` on validation, `unknown`: how good it is there is not known, and so it
    /// stays, or `no-score`: no variant has one, because all scenes fell back.
    why: &'static str,
}

impl From<&DefaultVariant> for DefaultReport {
    fn from(default: &DefaultVariant) -> Self {
        Self {
            variant: default.name.clone(),
            valid_error_m: default.valid_error,
            why: match default.why {
                WhyDefault::Asked => "asked",
                WhyDefault::Best => "best",
                WhyDefault::NoScore => "no-score",
                _ => "unknown",
            },
        }
    }
}

impl fmt::Display for DefaultReport {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = &self.variant;
        match (self.why, self.valid_error_m) {
            ("asked", _) => write!(formatter, "the default is `{name}`, as asked for"),
            (_, Some(error)) => write!(
                formatter,
                "the default is `{name}`, the best on validation: {:.2} mm",
                1e3 * error
            ),
            ("no-score", _) => write!(
                formatter,
                "the default is `{name}`, which has no score: it fell back in all scenes of `valid`; \
                 `--default` chooses another"
            ),
            (_, None) => write!(
                formatter,
                "the default is still `{name}`, of which it is not known how good it is on validation; `--default` \
                 chooses another"
            ),
        }
    }
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
            settled_error_m: trained.settled.map(|settled| settled.distance),
            valid_drapes: trained.valid_drapes,
            settled: trained.settled,
            default: DefaultReport::from(&trained.default),
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
        if let Some(drapes) = &self.valid_drapes {
            match drapes.familiar_distance {
                Some(error) => write!(formatter, "; whole drapes {:.2} mm", 1e3 * error)?,
                None => write!(formatter, "; whole drapes have no score")?,
            }
            fell_back(formatter, drapes)?;
        }
        if let Some(test) = &self.test {
            write!(formatter, "\n  test {}", figures(test))?;
        }
        if let Some(drapes) = &self.settled {
            write!(formatter, "; settled {:.2} mm", 1e3 * drapes.distance)?;
            fell_back(formatter, drapes)?;
        }
        write!(formatter, "\nwrote {}", self.weights)?;
        if self.epochs > 0 {
            write!(formatter, "; curves and log are in {}", self.training)?;
        }
        write!(formatter, "\n{}", self.default)
    }
}

/// In how many scenes the variant was not taken, if there are any.
fn fell_back(formatter: &mut fmt::Formatter<'_>, drapes: &DrapeScores) -> fmt::Result {
    match (drapes.fallbacks, drapes.scenes) {
        (0, _) => Ok(()),
        (count, scenes) => write!(formatter, ", {count} of {scenes} scenes fell back"),
    }
}
