//! Drapes beside those of the teacher.

use garnet_mesh::{Point3, RestEdge, Topology, edge_stretches, pattern_stretches};
use garnet_net::NetError;
use garnet_net::losses::{LossBody, LossConfig, Losses};

use crate::scores::{Compared, Errors, Tally};
use crate::{Stage, StagedScene, TrainError};

/// What all drapes of a garment are measured with.
#[derive(Debug)]
pub(crate) struct Measure {
    losses: Losses,
    edges: Edges,
}

/// The edges whose stretch is measured.
#[derive(Debug)]
enum Edges {
    /// Against their lengths in the pattern that all wear, in metres; without those of ribs and
    /// waistbands.
    Pattern(Vec<RestEdge>),
    /// Against their lengths as each body wears them at rest.
    Worn(Vec<[u32; 2]>),
}

impl Measure {
    pub(crate) fn new(stage: &Stage) -> Result<Self, TrainError> {
        let mesh = &stage.package.mesh;
        let pattern = if stage.is_made_to_measure() {
            None
        } else {
            stage.package.flat_edges()?
        };
        let worn = || {
            Topology::new(mesh.num_vertices(), mesh.faces())
                .edges()
                .to_vec()
        };
        Ok(Self {
            losses: Losses::new(mesh, &LossConfig::paper())?,
            edges: pattern.map_or_else(|| Edges::Worn(worn()), Edges::Pattern),
        })
    }

    /// Adds a drape to a tally.
    pub(crate) fn add(
        &self,
        tally: &mut Tally,
        staged: &StagedScene,
        predicted: &[Point3],
    ) -> Result<Errors, TrainError> {
        let mesh = staged.worn.garment.mesh();
        let skin = staged.posed.skin();
        let rest = staged.worn.body.rest();
        let body = rest.with_positions(skin.positions().to_vec())?;
        let target = self.losses.target(&staged.draped)?;
        let losses = self
            .losses
            .measure(predicted, &target, &LossBody::new(&body)?);
        let losses = losses.map_err(|error: NetError| TrainError::Scene {
            scene: staged.name,
            source: Box::new(error.into()),
        })?;
        let stretches = match &self.edges {
            Edges::Pattern(edges) => pattern_stretches(predicted, edges)?,
            Edges::Worn(edges) => edge_stretches(mesh.positions(), predicted, edges)?,
        };
        tally.add(Compared {
            predicted,
            draped: &staged.draped,
            faces: mesh.faces(),
            stretches,
            skin,
            losses: &losses,
        })
    }
}
