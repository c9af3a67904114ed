//! Drapes freed of penetrations, and how long that takes.

use std::time::Instant;

use garnet_mesh::Point3;
use garnet_untangle::{Binding, UntangleOptions, UntangleReport, untangle};
use serde::{Deserialize, Serialize};

use crate::contender::Draped;
use crate::{StagedScene, TrainError};

/// What is done to drapes before they are measured a second time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Finish {
    /// Nothing: they are measured once.
    None,
    /// They are freed of penetrations.
    Untangle(UntangleOptions),
}

/// What is not as it should be in drapes that are done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Left {
    /// Vertices inside the body that are not caught where it runs through itself.
    pub inside: usize,
    /// Vertices that are caught there.
    pub trapped: usize,
    /// Faces that cross the skin and have no trapped vertex; none if they were not looked for.
    pub crossing_faces: Option<usize>,
}

impl Left {
    /// Of no scenes.
    pub(crate) const NOTHING: Self = Self {
        inside: 0,
        trapped: 0,
        crossing_faces: Some(0),
    };

    /// Adds what was left in another scene.
    pub(crate) fn add(&mut self, other: Self) {
        self.inside += other.inside;
        self.trapped += other.trapped;
        let faces = self.crossing_faces.zip(other.crossing_faces);
        self.crossing_faces = faces.map(|(ours, theirs)| ours + theirs);
    }
}

impl From<&UntangleReport> for Left {
    fn from(report: &UntangleReport) -> Self {
        Self {
            inside: report.inside,
            trapped: report.trapped,
            crossing_faces: Some(report.crossing_faces),
        }
    }
}

/// A drape that was untangled.
#[derive(Debug)]
pub(crate) struct Finished {
    /// `[vertex]`, in metres.
    pub(crate) positions: Vec<Point3>,
    pub(crate) left: Left,
    /// How long it took.
    pub(crate) seconds: f64,
}

impl Finished {
    /// Untangles a drape `[vertex]`; one that was learned or simulated as such.
    pub(crate) fn new(
        staged: &StagedScene,
        binding: &Binding,
        draped: &Draped,
        options: &UntangleOptions,
    ) -> Result<Self, TrainError> {
        let garment = &staged.worn.garment;
        let options = match draped.network {
            _ if draped.is_simulated => options.for_simulated(),
            Some(_) => options.for_drapes(),
            None => *options,
        };
        let start = Instant::now();
        let nodes = garment.weld().gather(&draped.positions);
        let untangled = untangle(garment, binding, &staged.posed, &nodes, &options)?;
        let positions = garment.weld().scatter(&untangled.positions);
        Ok(Self {
            positions,
            left: (&untangled.report).into(),
            seconds: start.elapsed().as_secs_f64(),
        })
    }
}
