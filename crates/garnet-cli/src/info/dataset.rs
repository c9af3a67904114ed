//! What is in a data set.

use std::path::Path;

use garnet::data::{Dataset, Sizing, Split};
use serde::Serialize;

use super::table::Table;

/// What is in a data set.
#[derive(Debug, Serialize)]
pub(crate) struct DatasetInfo {
    garment: String,
    vertices: Option<usize>,
    /// Quality of the simulation; none of drapes made elsewhere.
    quality: Option<String>,
    protocol: &'static str,
    sizing: &'static str,
    is_mixed: bool,
    seed: u64,
    shards: usize,
    bytes: u64,
    splits: Vec<SplitInfo>,
}

/// What is there of a split.
#[derive(Debug, Serialize)]
struct SplitInfo {
    name: &'static str,
    bodies: usize,
    /// How many the whole data set has.
    bodies_asked: u32,
    scenes: usize,
    rejected: usize,
}

impl DatasetInfo {
    pub(crate) fn is_at(folder: &Path) -> bool {
        folder.join("dataset.json").is_file()
    }

    pub(crate) fn read(folder: &Path) -> anyhow::Result<Self> {
        let dataset = Dataset::open(folder)?;
        let manifest = &dataset.manifest;
        let mut vertices = None;
        let mut splits = Split::ALL.map(|split| SplitInfo {
            name: split.name(),
            bodies: 0,
            bodies_asked: manifest.bodies.of(split),
            scenes: 0,
            rejected: 0,
        });
        for shard in dataset.shards() {
            let shard = shard?;
            let named = splits.iter_mut();
            for split in named.filter(|split| split.name == shard.split.name()) {
                split.bodies += shard.bodies.len();
                split.scenes += shard.scenes.len();
                split.rejected += shard.rejections.len();
            }
            let first = shard.scenes.first();
            vertices = vertices.or(first.map(|scene| scene.garment.len()));
        }
        Ok(Self {
            garment: manifest.garment.name.clone(),
            vertices,
            quality: manifest.quality.clone(),
            protocol: manifest.protocol.name(),
            sizing: match manifest.sizing {
                Sizing::OneSize => "one size",
                Sizing::MadeToMeasure => "made to measure",
            },
            is_mixed: manifest.mixed,
            seed: manifest.seed,
            shards: dataset.num_shards(),
            bytes: dataset.num_bytes()?,
            splits: splits.into(),
        })
    }

    pub(crate) fn fill(&self, table: &mut Table) {
        table.row("kind", "data set");
        table.row("garment", &self.garment);
        if let Some(vertices) = self.vertices {
            table.row("vertices", vertices);
        }
        let quality = self.quality.as_deref();
        table.row("quality", quality.unwrap_or("made elsewhere"));
        table.row("protocol", self.protocol);
        table.row("sizing", self.sizing);
        table.row(
            "poses",
            if self.is_mixed {
                "mixed"
            } else {
                "of sequences"
            },
        );
        table.row("seed", self.seed);
        table.row("shards", self.shards);
        table.row("size", format!("{:.1} MB", self.bytes as f64 / 1e6));
        for split in &self.splits {
            let SplitInfo {
                name,
                bodies,
                bodies_asked,
                scenes,
                rejected,
            } = split;
            let told = format!(
                "{scenes} scenes on {bodies} of {bodies_asked} bodies, {rejected} rejected"
            );
            table.row(&format!("  {name}"), told);
        }
    }
}
