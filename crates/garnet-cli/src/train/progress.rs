//! How far a training is.

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use garnet::train::{Began, EpochRecord, TrainEvent, TrainJob};
use indicatif::ProgressBar;

use super::curves;
use crate::console::Console;

/// Bars between two messages are drawn this often at most.
const BETWEEN_MESSAGES: Duration = Duration::from_millis(200);

/// Tells what a training starts from and how each epoch went; draws a bar on a terminal.
pub(super) struct Progress<'a> {
    console: &'a Console,
    name: String,
    epochs: u32,
    curves: PathBuf,
    records: Vec<EpochRecord>,
    bar: ProgressBar,
    last_message: Instant,
    /// When the first scene of this run was done, and its number.
    first: Option<(Instant, u64)>,
    /// Scenes done and left.
    place: [u64; 2],
    has_warned: bool,
}

impl<'a> Progress<'a> {
    pub(super) fn new(console: &'a Console, job: &TrainJob, folder: &Path) -> Self {
        Self {
            console,
            name: job.recipe.name.clone(),
            epochs: job.config.epochs,
            curves: folder.join("losses.svg"),
            records: Vec::new(),
            bar: ProgressBar::hidden(),
            last_message: Instant::now(),
            first: None,
            place: [0, 0],
            has_warned: false,
        }
    }

    pub(super) fn tell(&mut self, event: TrainEvent) {
        match event {
            TrainEvent::Read { split, done, total } => {
                self.count(done, total, &format!("scenes read of `{}`", split.name()));
            }
            TrainEvent::Searched {
                round,
                rounds,
                left_out,
            } => {
                self.bar.finish_and_clear();
                self.round("", [round, rounds], left_out);
            }
            TrainEvent::RegionSearched {
                region,
                regions,
                round,
                rounds,
                left_out,
            } => {
                let of_region = format!("region {}/{regions}, ", region + 1);
                // Another region may be learning.
                let bar = &self.bar;
                bar.suspend(|| self.round(&of_region, [round, rounds], left_out));
            }
            TrainEvent::RegionLearned {
                region,
                regions,
                pass,
                passes,
                loss,
            } => {
                self.advance(regions * passes);
                self.bar.set_message(format!(
                    "pass {pass} of region {}/{regions}: {:.2} % left",
                    region + 1,
                    100.0 * loss
                ));
            }
            TrainEvent::Began(began) => self.begin(began),
            TrainEvent::Scene {
                epoch,
                done,
                total,
                loss,
            } => {
                if self.first.is_none() {
                    self.first = Some((Instant::now(), done));
                    self.bar.finish_and_clear();
                    self.bar = self.console.progress(total as usize);
                    self.bar.set_position(done);
                    self.bar.reset_eta();
                }
                self.place = [done, total - done];
                self.bar.set_position(done);
                if self.last_message.elapsed() >= BETWEEN_MESSAGES {
                    self.last_message = Instant::now();
                    self.bar
                        .set_message(format!("epoch {epoch}/{}, loss {loss:.3e}", self.epochs));
                }
            }
            TrainEvent::Skipped(trouble) => {
                self.console.warning(&format_args!("no step: {trouble}"));
            }
            TrainEvent::Epoch(record) => self.epoch(record),
            TrainEvent::Settled { done, total } => self.count(done, total, "scenes settle"),
            TrainEvent::NotSettled { why } => {
                self.console
                    .warning(&format_args!("drapes that settle were not measured: {why}"));
            }
            _ => {}
        }
    }

    /// A round of a search is over.
    fn round(&self, of_what: &str, [round, rounds]: [u32; 2], left_out: f64) {
        self.console.summary(&format_args!(
            "{of_what}round {round}/{rounds}: scenes of other bodies and sequences are missed by {:.2} mm",
            1e3 * left_out
        ));
    }

    /// So many of so many scenes are done.
    fn count(&mut self, done: usize, total: usize, what: &str) {
        if done == 1 {
            self.bar.finish_and_clear();
            self.bar = self.console.progress(total);
            self.bar.set_message(what.to_owned());
        }
        self.bar.set_position(done as u64);
    }

    /// One more of so many passes of all regions.
    fn advance(&mut self, total: u32) {
        if self.bar.length() != Some(u64::from(total)) {
            self.bar.finish_and_clear();
            self.bar = self.console.progress(total as usize);
        }
        self.bar.inc(1);
    }

    /// The validation before the first step.
    pub(super) fn start(&self) -> Option<&EpochRecord> {
        self.records.first()
    }

    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn begin(&mut self, began: Began) {
        self.bar.finish_and_clear();
        self.console.summary(&format_args!(
            "training `{}`: {:.2} M weights, {:.2} GFLOP a drape of {} vertices on {} body points; \
             {} scenes, {} for validation",
            self.name,
            began.parameters as f64 / 1e6,
            began.flops as f64 / 1e9,
            began.num_vertices,
            began.num_body_points,
            began.num_train,
            began.num_valid,
        ));
        let when = if began.past.len() > 1 {
            "now"
        } else {
            "at the start"
        };
        for value in began.terms.iter().filter(|value| value.weight > 0.0) {
            self.console.summary(&format_args!(
                "  {}: {:.3e} {when}, times {} is {:.3e}",
                value.term.name(),
                value.value,
                value.weight,
                value.weight * value.value
            ));
        }
        if let Some(start) = began.past.first() {
            self.console
                .summary(&format_args!("epoch 0: {}", measured(start)));
        }
        if began.past.len() > 1 {
            let done = began.past.len() - 1;
            self.console.summary(&format_args!(
                "going on after epoch {done} of {}",
                self.epochs
            ));
        }
        self.records = began.past;
    }

    fn epoch(&mut self, record: EpochRecord) {
        let line = format!(
            "epoch {}/{}: loss {:.3e}, {}{}{}",
            record.epoch,
            self.epochs,
            record.loss.unwrap_or(f64::NAN),
            measured(&record),
            if record.is_best {
                ", the best so far"
            } else {
                ""
            },
            self.left()
        );
        if self.bar.is_hidden() {
            self.console.summary(&line);
        } else {
            self.bar.suspend(|| self.console.summary(&line));
        }
        self.records.push(record);
        let drawn = curves::draw(&self.curves, &self.name, &self.records);
        if let (Err(error), false) = (drawn, self.has_warned) {
            // The curves are in the CSV as well; the training goes on.
            self.console
                .warning(&format_args!("no loss curves: {error:#}"));
            self.has_warned = true;
        }
    }

    fn left(&self) -> String {
        let (Some((since, first)), [done, left]) = (self.first, self.place) else {
            return String::new();
        };
        if done <= first || left == 0 {
            return String::new();
        }
        let seconds = since.elapsed().as_secs_f64() / (done - first) as f64 * left as f64;
        format!("; {:.0} min left", (seconds / 60.0).ceil())
    }
}

/// What a validation found.
fn measured(record: &EpochRecord) -> String {
    let valid = &record.valid;
    format!(
        "validation {:.2} mm, {:.2}°, {:.2} % inside",
        1e3 * valid.distance,
        valid.normal.to_degrees(),
        1e2 * valid.inside
    )
}
