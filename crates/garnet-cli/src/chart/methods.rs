//! The ways to drape.

use std::{fs, path::Path};

use anyhow::Context;
use garnet::{
    package::{Quality, quality_name},
    train::{Candidate, chart},
};
use serde::Serialize;

use super::record::Key;

/// What a way to drape is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Kind {
    /// Skinning or warp.
    Geometry,
    /// A network between warp and untangling.
    Network,
    /// The teacher.
    Simulation,
}

/// A way to drape.
#[derive(Debug, Clone)]
pub(super) struct Method {
    pub(super) name: String,
    pub(super) way: Way,
    /// For how many frames the cloth settles where a network has put it.
    pub(super) settle_frames: u32,
    /// Of a network.
    pub(super) weights: Option<Weights>,
}

/// How it drapes.
#[derive(Debug, Clone)]
pub(super) enum Way {
    Drape(Candidate),
    Simulation(Quality),
}

/// The weights of a network.
#[derive(Debug, Clone)]
pub(super) struct Weights {
    pub(super) checksum: String,
    /// Size of the file.
    pub(super) bytes: u64,
}

impl Method {
    /// Candidates, and the teacher in qualities.
    pub(super) fn all(
        candidates: Vec<Candidate>,
        qualities: &[Quality],
    ) -> anyhow::Result<Vec<Self>> {
        let drapes = candidates.into_iter().map(|candidate| {
            let (name, weights, settle_frames) = match &candidate {
                Candidate::Skinning => ("dqs".to_owned(), None, 0),
                Candidate::Warp => ("warp".to_owned(), None, 0),
                Candidate::Model {
                    name,
                    weights,
                    settle,
                } => (
                    Candidate::settled_name(&shown(name), *settle),
                    Some(Weights::of(weights)?),
                    *settle,
                ),
            };
            Ok(Self {
                name,
                settle_frames,
                way: Way::Drape(candidate),
                weights,
            })
        });
        let mut methods: Vec<Self> = drapes.collect::<anyhow::Result<_>>()?;
        methods.extend(qualities.iter().map(|&quality| Self {
            name: format!("simulation {}", quality_name(quality)),
            way: Way::Simulation(quality),
            settle_frames: 0,
            weights: None,
        }));
        Ok(methods)
    }

    /// What its samples belong together by.
    pub(super) fn key(&self) -> Key<'_> {
        let weights = self.weights.as_ref();
        Key {
            name: &self.name,
            weights: weights.map(|weights| weights.checksum.as_str()),
            settle_frames: self.settle_frames,
        }
    }

    pub(super) fn kind(&self) -> Kind {
        match (&self.way, &self.weights) {
            (Way::Simulation(_), _) => Kind::Simulation,
            (Way::Drape(_), Some(_)) => Kind::Network,
            (Way::Drape(_), None) => Kind::Geometry,
        }
    }
}

impl Weights {
    fn of(path: &Path) -> anyhow::Result<Self> {
        let header = chart::header_of(path)?;
        let mut bytes = 0;
        for file in &header.files {
            let metadata = fs::metadata(file);
            let metadata = metadata.with_context(|| format!("cannot read `{}`", file.display()))?;
            bytes += metadata.len();
        }
        Ok(Self {
            checksum: header.checksum,
            bytes,
        })
    }
}

/// The name of a variant, or of a file without its folder and ending.
pub(super) fn shown(name: &str) -> String {
    let path = Path::new(name);
    match path.extension() {
        Some(extension) if extension == "safetensors" => {
            let stem = path.file_stem().unwrap_or_default();
            stem.to_string_lossy().into_owned()
        }
        _ => name.to_owned(),
    }
}
