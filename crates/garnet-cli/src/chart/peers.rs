//! What other programs need for a drape, as the scripts in `benches/peers` measure it.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::{failure::refused, input};

const SCHEMA: &str = "garnet.peer/1";

/// A drape by another program, on a scene of its own; SI units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Peer {
    schema: String,
    pub(super) name: String,
    /// What was chosen of it.
    settings: String,
    garment: String,
    pub(super) pose: String,
    machine: String,
    /// Until the cloth was at rest, or was given up.
    pub(super) seconds: f64,
    pub(super) is_at_rest: bool,
    /// Mean distance from the drape of our simulator.
    pub(super) distance_m: f64,
    /// Vertices inside the body that are not trapped.
    pub(super) inside: usize,
    deepest: f64,
    pub(super) crossing_faces: usize,
    /// What 1 % of the edges exceed, over their length at rest.
    pub(super) stretch_p99: f64,
}

/// Reads a file of lines, one a peer.
pub(super) fn read(path: &Path, garment: &str) -> anyhow::Result<Vec<Peer>> {
    let text = input::text(path)?;
    let lines = text.lines().enumerate();
    let lines = lines.filter(|(_, line)| !line.trim().is_empty());
    let peers = lines.map(|(number, line)| {
        let cause = match serde_json::from_str::<Peer>(line) {
            Ok(peer) => match peer.problem(garment) {
                None => return Ok(peer),
                Some(problem) => problem,
            },
            Err(error) => error.to_string(),
        };
        Err(refused(
            format!("`{}`, line {}: no peer", path.display(), number + 1),
            cause,
            "the scripts in benches/peers print such lines",
        ))
    });
    peers.collect()
}

impl Peer {
    /// Why it cannot be drawn beside the drapes of a garment.
    fn problem(&self, garment: &str) -> Option<String> {
        let Self { schema, .. } = self;
        let is_place = |value: f64| value.is_finite() && value > 0.0;
        if schema != SCHEMA {
            Some(format!("its schema is `{schema}`, not `{SCHEMA}`"))
        } else if self.garment != garment {
            let found = &self.garment;
            Some(format!("it drapes `{found}`, not `{garment}`"))
        } else if !is_place(self.seconds) || !is_place(self.distance_m) {
            Some("its time and its distance must be above zero".to_owned())
        } else {
            None
        }
    }

    /// One line for people.
    pub(super) fn told(&self) -> String {
        let rest = if self.is_at_rest { "" } else { ", not at rest" };
        format!(
            "{} ({}): {:.1} s, {:.1} mm, {} vertices inside, {} faces cross the skin, strain p99 {:.1} %{rest}",
            self.name,
            self.settings,
            self.seconds,
            1e3 * self.distance_m,
            self.inside,
            self.crossing_faces,
            1e2 * (self.stretch_p99 - 1.0)
        )
    }
}
