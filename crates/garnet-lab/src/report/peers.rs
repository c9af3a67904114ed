//! Other programs on one scene, as `benches/peers` prints them.

use std::{collections::BTreeSet, error::Error, fs, path::Path};

use serde::Deserialize;

use super::{HeadArguments, markdown::Grid};

/// `garnet.peer/1`, as far as the table needs it.
#[derive(Debug, Deserialize)]
struct Peer {
    name: String,
    settings: String,
    garment: String,
    pose: String,
    machine: String,
    seconds: f64,
    is_at_rest: bool,
    distance_m: f64,
    inside: usize,
    crossing_faces: usize,
    stretch_p99: f64,
}

impl Peer {
    fn row(&self) -> Vec<String> {
        let time = if self.seconds < 1.0 {
            format!("{:.1} ms", 1e3 * self.seconds)
        } else {
            format!("{:.1} s", self.seconds)
        };
        vec![
            format!("{}: {}", self.name, self.settings),
            time,
            if self.is_at_rest { "yes" } else { "no" }.to_owned(),
            format!("{:.1} mm", 1e3 * self.distance_m),
            self.inside.to_string(),
            self.crossing_faces.to_string(),
            format!("{:.1} %", 1e2 * (self.stretch_p99 - 1.0)),
        ]
    }
}

/// A row a line of the file.
pub(super) fn text(file: &Path, head: &HeadArguments) -> Result<String, Box<dyn Error>> {
    let name = file.display();
    let lines = fs::read_to_string(file).map_err(|error| format!("`{name}`: {error}"))?;
    let mut peers = Vec::new();
    for (number, line) in lines.lines().enumerate() {
        let peer: Peer = serde_json::from_str(line)
            .map_err(|error| format!("`{name}`, line {}: {error}", number + 1))?;
        peers.push(peer);
    }
    let mut grid = Grid::new(&[
        "program",
        "time",
        "at rest",
        "distance",
        "vertices inside",
        "faces across the skin",
        "strain p99",
    ]);
    for peer in &peers {
        grid.push(peer.row());
    }
    let scenes = |peer: &Peer| format!("`{}`, `{}`, {}", peer.garment, peer.pose, peer.machine);
    let scenes: BTreeSet<String> = peers.iter().map(scenes).collect();
    let facts: Vec<String> = scenes.into_iter().collect();
    Ok(head.text(&facts) + &grid.text())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_line_is_a_row() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("peers.jsonl");
        let line = r#"{"name": "other", "settings": "fine", "garment": "tshirt", "pose": "wave",
            "machine": "one", "seconds": 0.0123, "is_at_rest": true, "distance_m": 0.0057,
            "inside": 3, "crossing_faces": 4, "stretch_p99": 1.25, "deepest": 0.1}"#;
        fs::write(&file, line.replace('\n', "") + "\n").unwrap();
        let head = HeadArguments {
            commit: Some("abc".to_owned()),
        };
        let found = text(&file, &head).unwrap();
        assert!(
            found.starts_with("`tshirt`, `wave`, one; commit abc.\n\n"),
            "{found}"
        );
        let row = found.lines().last().unwrap();
        let fields: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let expected = [
            "other: fine",
            "12.3 ms",
            "yes",
            "5.7 mm",
            "3",
            "4",
            "25.0 %",
        ];
        assert_eq!(fields, expected);
        fs::write(&file, "{}\n").unwrap();
        let error = text(&file, &head).unwrap_err().to_string();
        assert!(error.contains("line 1"), "{error}");
    }
}
