//! How far a data set is.

use std::{
    collections::BTreeMap,
    sync::{Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use garnet::data::DatasetEvent;
use indicatif::ProgressBar;

use crate::console::Console;

/// Without a terminal a line is written this often.
const BETWEEN_LINES: Duration = Duration::from_mins(1);

/// Counts scenes, draws a bar on a terminal and writes a line a minute elsewhere.
pub(super) struct Progress<'a> {
    console: &'a Console,
    state: Mutex<State>,
}

struct State {
    bar: ProgressBar,
    start: Instant,
    last_line: Instant,
    scenes: usize,
    /// Scenes of an earlier run.
    before: usize,
    accepted: usize,
    rejected: BTreeMap<String, usize>,
    tried: u64,
}

impl<'a> Progress<'a> {
    pub(super) fn new(console: &'a Console) -> Self {
        let now = Instant::now();
        Self {
            console,
            state: Mutex::new(State {
                bar: ProgressBar::hidden(),
                start: now,
                last_line: now,
                scenes: 0,
                before: 0,
                accepted: 0,
                rejected: BTreeMap::new(),
                tried: 0,
            }),
        }
    }

    pub(super) fn tell(&self, event: &DatasetEvent) {
        let mut state = self.state();
        match event {
            DatasetEvent::Planned {
                scenes,
                done,
                tried,
            } => {
                state.bar = self.console.progress(*scenes);
                state.bar.set_position(*done as u64);
                state.bar.reset_eta();
                (state.scenes, state.before, state.tried) = (*scenes, *done, *tried);
                (state.start, state.last_line) = (Instant::now(), Instant::now());
                return;
            }
            DatasetEvent::Accepted { .. } => state.accepted += 1,
            DatasetEvent::Rejected { rejection, .. } => {
                *state.rejected.entry(rejection.kind.clone()).or_default() += 1;
                self.console.detail(&format_args!(
                    "rejected scene {} of body {} ({}): {}",
                    rejection.pose, rejection.body, rejection.sequence, rejection.reason
                ));
            }
            _ => return,
        }
        state.bar.inc(1);
        let text = state.text();
        state.bar.set_message(text.clone());
        if state.bar.is_hidden() && state.last_line.elapsed() >= BETWEEN_LINES {
            state.last_line = Instant::now();
            self.console.summary(&text);
        }
    }

    pub(super) fn finish(&self) {
        self.state().bar.finish_and_clear();
    }

    /// Bodies of the population that were looked at.
    pub(super) fn tried(&self) -> u64 {
        self.state().tried
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn text(&self) -> String {
        let rejected: usize = self.rejected.values().sum();
        let done = self.accepted + rejected;
        let seconds = self.start.elapsed().as_secs_f64().max(1e-3);
        let rate = done as f64 / seconds;
        let left = (self.scenes - self.before).saturating_sub(done) as f64 / rate;
        format!(
            "{}/{} scenes, {rejected} rejected, {:.0} an hour, {:.0} min left",
            self.before + done,
            self.scenes,
            3600.0 * rate,
            left / 60.0
        )
    }
}
