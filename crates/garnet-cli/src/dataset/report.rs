//! What is told about a data set.

use std::{collections::BTreeMap, fmt, path::Path, time::Duration};

use garnet::data::{Dataset, SceneReport, Split};
use serde::Serialize;

use super::rejected::MostlyRejected;
use crate::hints::Hinting;

/// What a data set has got.
#[derive(Debug, Serialize)]
pub(crate) struct DatasetReport {
    schema: &'static str,
    folder: String,
    garment: String,
    fingerprint: String,
    shards: usize,
    splits: BTreeMap<&'static str, SplitReport>,
    /// Scenes rejected, by reason.
    rejected: BTreeMap<String, usize>,
    /// Each rejected scene.
    rejections: Vec<RejectionReport>,
    /// Bodies of the population that were looked at, if the garment does not fit all.
    #[serde(skip_serializing_if = "Option::is_none")]
    bodies_tried: Option<u64>,
    /// Medians over the scenes, and the worst.
    measured: Option<Measured>,
    bytes: u64,
    seconds: f64,
    /// What to do if more than half of the scenes were rejected.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) mostly_rejected: Option<MostlyRejected>,
}

#[derive(Debug, Default, Serialize)]
struct SplitReport {
    bodies: usize,
    scenes: usize,
    rejected: usize,
}

#[derive(Debug, Serialize)]
pub(super) struct RejectionReport {
    split: &'static str,
    body: u32,
    pose: u32,
    sequence: String,
    pub(super) kind: String,
    pub(super) reason: String,
}

/// What the simulation measured: median and worst of the scenes that were accepted.
#[derive(Debug, Serialize)]
struct Measured {
    strain_p99: [f32; 2],
    moving: [f32; 2],
    self_intersections: [u32; 2],
    trapped_intersections: [u32; 2],
}

impl DatasetReport {
    pub(crate) fn new(
        dataset: &Dataset,
        folder: &Path,
        tried: Option<u64>,
        time: Duration,
    ) -> anyhow::Result<Self> {
        let mut splits: BTreeMap<&'static str, SplitReport> = BTreeMap::new();
        let mut rejected: BTreeMap<String, usize> = BTreeMap::new();
        let mut rejections = Vec::new();
        let mut reports: Vec<SceneReport> = Vec::new();
        for split in Split::ALL {
            splits.insert(split.name(), SplitReport::default());
        }
        for shard in dataset.shards() {
            let shard = shard.hinting()?;
            let split = splits.entry(shard.split.name()).or_default();
            split.bodies += shard.bodies.len();
            split.scenes += shard.scenes.len();
            split.rejected += shard.rejections.len();
            reports.extend(shard.scenes.into_iter().filter_map(|scene| scene.report));
            for rejection in shard.rejections {
                *rejected.entry(rejection.kind.clone()).or_default() += 1;
                rejections.push(RejectionReport {
                    split: shard.split.name(),
                    body: rejection.body,
                    pose: rejection.pose,
                    sequence: rejection.sequence,
                    kind: rejection.kind,
                    reason: rejection.reason,
                });
            }
        }
        let accepted = splits.values().map(|split| split.scenes).sum();
        let mostly_rejected = MostlyRejected::of(&dataset.manifest, accepted, &rejections);
        Ok(Self {
            schema: "garnet.dataset-report/1",
            folder: folder.display().to_string(),
            garment: dataset.manifest.garment.name.clone(),
            fingerprint: dataset.manifest.fingerprint().to_string(),
            shards: dataset.num_shards(),
            splits,
            rejected,
            rejections,
            bodies_tried: tried,
            measured: Measured::of(&reports),
            bytes: dataset.num_bytes().hinting()?,
            seconds: time.as_secs_f64(),
            mostly_rejected,
        })
    }
}

impl Measured {
    fn of(reports: &[SceneReport]) -> Option<Self> {
        let of = |value: fn(&SceneReport) -> f32| {
            let mut values: Vec<f32> = reports.iter().map(value).collect();
            values.sort_by(f32::total_cmp);
            Some([*values.get(values.len() / 2)?, *values.last()?])
        };
        let pairs = |value: fn(&SceneReport) -> u32| {
            let mut values: Vec<u32> = reports.iter().map(value).collect();
            values.sort_unstable();
            Some([*values.get(values.len() / 2)?, *values.last()?])
        };
        Some(Self {
            strain_p99: of(|report| report.strain_p99)?,
            moving: of(|report| report.moving)?,
            self_intersections: pairs(|report| report.self_intersections)?,
            trapped_intersections: pairs(|report| report.squeezed_intersections)?,
        })
    }
}

impl fmt::Display for DatasetReport {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "data set `{}` of `{}`: {} shards, {:.0} MB",
            self.folder,
            self.garment,
            self.shards,
            self.bytes as f64 / 1e6
        )?;
        for (name, split) in &self.splits {
            write!(
                formatter,
                "\n  {name}: {} scenes on {} bodies, {} rejected",
                split.scenes, split.bodies, split.rejected
            )?;
        }
        for (kind, count) in &self.rejected {
            write!(formatter, "\n  rejected for {kind}: {count}")?;
        }
        if let Some(measured) = &self.measured {
            let [median, worst] = measured.strain_p99;
            write!(
                formatter,
                "\n  strain that 1 % of the edges exceed: median {:.1} %, worst {:.1} %",
                100.0 * median,
                100.0 * worst
            )?;
        }
        Ok(())
    }
}
