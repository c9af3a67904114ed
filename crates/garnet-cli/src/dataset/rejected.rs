//! What is told of data sets whose scenes were rejected for the most part.

use std::{collections::BTreeMap, fmt};

use garnet::data::{DatasetManifest, Sizing};
use serde::Serialize;

use super::report::RejectionReport;
use crate::failure::refused;

/// That more than half of the scenes were rejected, and what to do about it.
#[derive(Debug, Serialize)]
pub(super) struct MostlyRejected {
    rejected: usize,
    scenes: usize,
    /// The most frequent kind.
    kind: String,
    /// How many are of that kind.
    of_kind: usize,
    /// What was measured of one of them.
    reason: String,
    hint: String,
}

impl MostlyRejected {
    /// None if half of the scenes or more were accepted.
    pub(super) fn of(
        manifest: &DatasetManifest,
        accepted: usize,
        rejections: &[RejectionReport],
    ) -> Option<Self> {
        if rejections.len() <= accepted {
            return None;
        }
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for rejection in rejections {
            *counts.entry(&rejection.kind).or_default() += 1;
        }
        let (&kind, &of_kind) = counts.iter().max_by_key(|&(_, &count)| count)?;
        let example = rejections.iter().find(|rejection| rejection.kind == kind)?;
        Some(Self {
            rejected: rejections.len(),
            scenes: accepted + rejections.len(),
            kind: kind.to_owned(),
            of_kind,
            reason: example.reason.clone(),
            hint: hint(manifest, kind),
        })
    }

    /// Whether no scene was accepted.
    pub(super) fn are_all(&self) -> bool {
        self.rejected == self.scenes
    }

    /// The error that the data set has no scenes.
    pub(super) fn failure(&self) -> anyhow::Error {
        refused(
            "the data set has no scenes",
            self.cause(),
            self.hint.as_str(),
        )
    }

    fn cause(&self) -> String {
        let Self {
            rejected,
            scenes,
            kind,
            of_kind,
            reason,
            ..
        } = self;
        format!(
            "{rejected} of {scenes} scenes were rejected, {of_kind} of them for {kind}: {reason}"
        )
    }
}

impl fmt::Display for MostlyRejected {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}; {}", self.cause(), self.hint)
    }
}

fn hint(manifest: &DatasetManifest, kind: &str) -> String {
    let is_fast = manifest.quality.as_deref() == Some("fast");
    let has_pattern = manifest.garment.pattern.is_some();
    let wears_template = manifest.sizing == Sizing::OneSize;
    let change = match kind {
        "unsettled" if is_fast => "`--quality teacher` settles for longer",
        "strain" if has_pattern && wears_template => {
            "`--sizing made-to-measure` cuts a garment for each body"
        }
        "wearing" if !manifest.vary.is_empty() => "`--vary` with narrower ranges is easier to wear",
        "body" | "pose" | "wearing" | "simulation" => "`--json` lists each rejected scene",
        _ => "`--keep-all` keeps such scenes, to look at them",
    };
    format!("{change}; other arguments need another folder")
}
