//! Drapes beside those of the teacher.

use garnet_mesh::{Point3, Topology, edge_stretches};
use garnet_net::NetError;
use garnet_net::losses::{LossBody, LossConfig, Losses};

use crate::scores::{Compared, Errors, Tally};
use crate::{Stage, StagedScene, TrainError};

/// What all drapes of a garment are measured with.
#[derive(Debug)]
pub(crate) struct Measure {
    losses: Losses,
    edges: Vec<[u32; 2]>,
    /// Edges and their lengths in the pattern that all wear, in metres.
    pattern: Option<Vec<([u32; 2], f32)>>,
}

impl Measure {
    pub(crate) fn new(stage: &Stage) -> Result<Self, TrainError> {
        let mesh = &stage.package.mesh;
        let topology = Topology::new(mesh.num_vertices(), mesh.faces());
        Ok(Self {
            losses: Losses::new(mesh, &LossConfig::paper())?,
            edges: topology.edges().to_vec(),
            pattern: if stage.is_made_to_measure() {
                None
            } else {
                stage.package.flat_edges()
            },
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
        tally.add(&Compared {
            predicted,
            draped: &staged.draped,
            faces: mesh.faces(),
            stretches: self.stretches(mesh.positions(), predicted)?,
            skin,
            losses: &losses,
        })
    }

    /// Length over rest length of the edges, those of ribs and waistbands apart where a pattern tells them.
    fn stretches(&self, rest: &[Point3], predicted: &[Point3]) -> Result<Vec<f32>, TrainError> {
        let Some(pattern) = &self.pattern else {
            return Ok(edge_stretches(rest, predicted, &self.edges)?);
        };
        let stretch = |&([a, b], rest_length): &([u32; 2], f32)| {
            (predicted[a as usize] - predicted[b as usize]).norm() / rest_length
        };
        Ok(pattern.iter().map(stretch).collect())
    }
}
