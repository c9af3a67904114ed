//! The scores of a network on examples.

use garnet_knn::Surface;
use garnet_mesh::Point3;
use garnet_mesh::{Topology, TriMesh, edge_stretches};
use garnet_net::{GarNet, NetError, Predictor};

use crate::context::{Example, TrainingContext};
use crate::scores::{Compared, Tally};
use crate::{Scores, Stage, TrainError};

/// Distance and loss of a network that has diverged; finite, because JSON knows no infinity.
const DIVERGED: f64 = 1e9;

/// What a validation finds.
#[derive(Debug)]
pub(crate) struct Validation {
    pub(crate) scores: Scores,
    /// Mean of the weighted loss over the scenes.
    pub(crate) loss: f64,
}

/// Measures a network on examples; nothing is untangled.
///
/// A network that has diverged is [`DIVERGED`] away from the teacher: any other is better.
pub(crate) fn validate(
    stage: &Stage,
    context: &TrainingContext,
    model: &GarNet,
    examples: &[Example],
) -> Result<Validation, TrainError> {
    let mut predictor: Option<Predictor> = None;
    let mut drape = |example: &Example| {
        let graph = example.graph.clone();
        if let Some(predictor) = &mut predictor {
            predictor.rebind(graph)?;
            return predictor.predict(&example.input());
        }
        let new = Predictor::new(model.clone(), graph, context.sampling.clone())?;
        predictor.insert(new).predict(&example.input())
    };
    validate_drapes(stage, context, &mut drape, examples)
}

/// Measures what drapes examples; nothing is untangled.
pub(crate) fn validate_drapes(
    stage: &Stage,
    context: &TrainingContext,
    drape: &mut dyn FnMut(&Example) -> Result<Vec<Point3>, NetError>,
    examples: &[Example],
) -> Result<Validation, TrainError> {
    let mesh = &stage.package.mesh;
    let topology = Topology::new(mesh.num_vertices(), mesh.faces());
    let rest_body = stage.package.body.rest();
    let mut skin = Surface::new(rest_body);
    let mut tally = Tally::default();
    let mut loss = 0.0;
    for example in examples {
        let Ok(predicted) = drape(example) else {
            let scores = Scores {
                distance: DIVERGED,
                ..Scores::default()
            };
            let loss = DIVERGED;
            return Ok(Validation { scores, loss });
        };
        let body = TriMesh::new(example.body.clone(), rest_body.faces().to_vec())?;
        let body = garnet_net::losses::LossBody::new(&body)?;
        let target = context.losses.target(&example.draped)?;
        let losses = context.losses.measure(&predicted, &target, &body)?;
        loss += losses.total();
        skin.refit(&example.body).map_err(NetError::from)?;
        tally.add(Compared {
            predicted: &predicted,
            draped: &example.draped,
            faces: mesh.faces(),
            stretches: edge_stretches(&example.rest, &predicted, topology.edges())?,
            skin: &skin,
            losses: &losses,
        })?;
    }
    Ok(Validation {
        scores: tally.scores(),
        loss: loss / examples.len().max(1) as f64,
    })
}
