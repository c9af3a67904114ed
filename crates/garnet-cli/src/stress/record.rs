//! What was found so far: `cells.json`, from which a run goes on.

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use garnet::stress::{Cell, StressOptions};
use serde::{Deserialize, Serialize};

use crate::{failure::refused, input, output};

const SCHEMA: &str = "garnet.stress-cells/1";

/// Between two writes while cells come fast.
const BETWEEN_WRITES: Duration = Duration::from_secs(5);

/// All cells, with what they have in common.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Record {
    schema: String,
    version: String,
    /// Fingerprint of the positions of the template.
    template: String,
    /// The variants with the fingerprints of their weight files.
    variants: Vec<(String, String)>,
    seed: u64,
    cells: Vec<Cell>,
}

/// Keeps what was found.
pub(super) struct Keeper {
    path: PathBuf,
    record: Record,
    written: Instant,
}

impl Keeper {
    /// Of a folder; what another version or package has left there is refused.
    pub(super) fn open(
        folder: &Path,
        template: &str,
        variants: Vec<(String, String)>,
        options: &StressOptions,
    ) -> anyhow::Result<Self> {
        let path = folder.join("cells.json");
        let fresh = Record {
            schema: SCHEMA.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            template: template.to_owned(),
            variants,
            seed: options.seed,
            cells: Vec::new(),
        };
        let record = if path.is_file() {
            let name = path.display();
            let text = input::bytes(&path)?;
            let hint = "another folder, or remove the file to begin anew";
            let found: Record = serde_json::from_slice(&text).map_err(|error| {
                refused(format!("`{name}` holds no cells"), error.to_string(), hint)
            })?;
            let key = |record: &Record| {
                let Record {
                    schema,
                    version,
                    template,
                    variants,
                    seed,
                    ..
                } = record;
                format!("{schema} {version} {template} {variants:?} {seed}")
            };
            if key(&found) != key(&fresh) {
                return Err(refused(
                    format!("`{name}` is of another run"),
                    "its package, version or seed differs",
                    hint,
                ));
            }
            found
        } else {
            fresh
        };
        Ok(Self {
            path,
            record,
            written: Instant::now(),
        })
    }

    pub(super) fn cells(&self) -> &[Cell] {
        &self.record.cells
    }

    /// Keeps a cell; it is written soon.
    pub(super) fn keep(&mut self, cell: &Cell) -> anyhow::Result<()> {
        let is_same = |known: &&Cell| {
            known.axis == cell.axis
                && known.method == cell.method
                && known.level.to_bits() == cell.level.to_bits()
        };
        if self.record.cells.iter().any(|known| is_same(&known)) {
            return Ok(());
        }
        self.record.cells.push(cell.clone());
        if self.written.elapsed() < BETWEEN_WRITES {
            return Ok(());
        }
        self.write()
    }

    pub(super) fn write(&mut self) -> anyhow::Result<()> {
        self.written = Instant::now();
        output::write(&self.path, &serde_json::to_vec(&self.record)?)
    }
}
