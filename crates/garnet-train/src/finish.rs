//! What is done to drapes before they are measured, and what is left of penetrations.

use garnet_untangle::{UntangleOptions, UntangleReport};
use serde::{Deserialize, Serialize};

/// What is done to drapes before they are measured a second time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Finish {
    /// Nothing: they are measured once.
    None,
    /// They are freed of penetrations.
    Untangle(UntangleOptions),
}

/// Penetrations that are left in drapes that are done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PenetrationCount {
    /// Vertices inside the body that are not caught where it runs through itself.
    pub inside: usize,
    /// Vertices that are caught there.
    pub trapped: usize,
    /// Faces that cross the skin and have no trapped vertex; none if they were not looked for.
    pub crossing_faces: Option<usize>,
}

impl PenetrationCount {
    /// Of no scenes.
    pub(crate) const NOTHING: Self = Self {
        inside: 0,
        trapped: 0,
        crossing_faces: Some(0),
    };

    /// Of a drape that was untangled; nothing, of one that was not.
    pub(crate) fn of(drape: &garnet_drape::Drape) -> Self {
        drape.report.as_ref().map_or(Self::NOTHING, Self::from)
    }

    /// Adds what was left in another scene.
    pub(crate) fn add(&mut self, other: Self) {
        self.inside += other.inside;
        self.trapped += other.trapped;
        let faces = self.crossing_faces.zip(other.crossing_faces);
        self.crossing_faces = faces.map(|(ours, theirs)| ours + theirs);
    }
}

impl From<&UntangleReport> for PenetrationCount {
    fn from(report: &UntangleReport) -> Self {
        Self {
            inside: report.inside,
            trapped: report.trapped,
            crossing_faces: Some(report.crossing_faces),
        }
    }
}
