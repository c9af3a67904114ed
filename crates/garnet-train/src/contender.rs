//! A way to drape, ready to be timed.

use std::time::Instant;

use garnet_mesh::Point3;
use garnet_net::{Checkpoint, Cost, GarNetConfig, Predictor, Start};

use crate::network_input::predicted;
use crate::{Candidate, Stage, StagedScene, TrainError, warp_of};

/// A candidate, bound to the garment.
#[derive(Debug)]
pub(crate) struct Contender {
    name: String,
    start: Start,
    predictor: Option<Predictor>,
    cost: Option<Cost>,
}

/// A drape that is not untangled yet.
#[derive(Debug)]
pub(crate) struct Draped {
    /// `[vertex]`, in metres.
    pub(crate) positions: Vec<Point3>,
    /// Time of skinning or warp, in seconds.
    pub(crate) warp: f64,
    /// Time of the network with all that it needs of a scene, in seconds.
    pub(crate) network: Option<f64>,
}

impl Contender {
    /// Reads the weights, if it has any.
    pub(crate) fn new(stage: &Stage, candidate: &Candidate) -> Result<Self, TrainError> {
        let package = &stage.package;
        let (name, start, predictor) = match candidate {
            Candidate::Skinning => ("dqs", Start::DualQuaternion, None),
            Candidate::Warp => ("warp", Start::Shape, None),
            Candidate::Model { name, weights } => {
                let graph = stage.template().graph.clone();
                let config = Checkpoint::header(weights)?.config;
                // Sewing parameters may be those of bodies alone.
                let zeros = vec![0.0; config.num_sewing_parameters];
                let graph = graph.with_sewing_parameters(&zeros)?;
                let rest = package.body.rest().positions();
                let template = package.mesh.positions();
                let predictor = Predictor::load(weights, graph, template, rest)?;
                (name.as_str(), config.start, Some(predictor))
            }
        };
        let cost = predictor.as_ref().map(|predictor| {
            let config = predictor.model().config();
            config.cost(package.mesh.num_vertices(), predictor.num_body_points())
        });
        Ok(Self {
            name: name.to_owned(),
            start,
            cost: cost.transpose()?,
            predictor,
        })
    }

    /// `dqs`, `warp`, or the name of the model.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Size and work of the network, if it is one.
    pub(crate) fn cost(&self) -> Option<Cost> {
        self.cost
    }

    /// What the network is made of, if it is one.
    pub(crate) fn config(&self) -> Option<&GarNetConfig> {
        let predictor = self.predictor.as_ref();
        predictor.map(|predictor| predictor.model().config())
    }

    /// Memory that the network keeps between scenes, in bytes.
    pub(crate) fn num_bytes(&self) -> Option<usize> {
        self.predictor.as_ref().map(Predictor::num_bytes)
    }

    /// Drapes without untangling.
    pub(crate) fn drape(&mut self, staged: &StagedScene) -> Result<Draped, TrainError> {
        self.draped(staged).map_err(|source| TrainError::Scene {
            scene: staged.name,
            source: Box::new(source),
        })
    }

    fn draped(&mut self, staged: &StagedScene) -> Result<Draped, TrainError> {
        let worn = &staged.worn;
        let Some(predictor) = &mut self.predictor else {
            let start = Instant::now();
            let nodes = worn.garment.warped(&staged.posed, warp_of(self.start))?;
            let warp = start.elapsed().as_secs_f64();
            return Ok(Draped {
                positions: worn.garment.weld().scatter(&nodes),
                warp,
                network: None,
            });
        };
        let graph = worn.graph.clone();
        let graph = match predictor.model().config().num_sewing_parameters {
            0 => graph.with_sewing_parameters(&[])?,
            _ => graph,
        };
        predictor.rebind(graph)?;
        let start = Instant::now();
        let warped = staged.warped(self.start)?;
        let warp = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let positions = predicted(predictor, &warped, &worn.body, &staged.posed)?;
        Ok(Draped {
            positions,
            warp,
            network: Some(start.elapsed().as_secs_f64()),
        })
    }
}
