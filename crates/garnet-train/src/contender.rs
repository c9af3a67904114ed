//! A way to drape, ready to be timed.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use garnet_drape::{PackageError, Settling};
use garnet_mesh::Point3;
use garnet_net::{Cost, GarNetConfig, Model, Moment};
use garnet_skin::Warp;

use crate::network_input::predicted;
use crate::teachers::Teachers;
use crate::{Candidate, Stage, StagedScene, TrainError};

/// A candidate, bound to the garment.
#[derive(Debug)]
pub(crate) struct Contender<'a> {
    name: String,
    warp: Warp,
    model: Option<Model>,
    cost: Option<Cost>,
    /// For how many frames cloth settles, and who simulates it.
    settle: Option<(u32, Teachers<'a>)>,
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
    /// Whether a simulation has given the cloth its folds.
    pub(crate) is_simulated: bool,
    /// Time of settling, in seconds; none if the cloth was left where the network had put it.
    pub(crate) settle: Option<f64>,
}

impl<'a> Contender<'a> {
    /// Reads the weights, if it has any.
    pub(crate) fn new(stage: &'a Stage, candidate: &Candidate) -> Result<Self, TrainError> {
        stage.check_moment(Moment::Rest)?;
        let package = &stage.package;
        let (name, warp, model, settle) = match candidate {
            Candidate::Skinning => ("dqs", Warp::DualQuaternion, None, 0),
            Candidate::Warp => ("warp", Warp::Shape, None, 0),
            Candidate::Model {
                name,
                weights,
                settle,
            } => {
                let graph = stage.template().graph.clone();
                // Sewing parameters may be those of bodies alone.
                let count = stage.num_sewing_parameters()?;
                let graph = graph.with_sewing_parameters(&vec![0.0; count])?;
                let rest = package.body.rest().positions();
                let template = package.mesh.positions();
                let model = Model::load(weights, graph, template, rest)?;
                (name.as_str(), model.warp(), Some(model), *settle)
            }
        };
        // Cloth on the way is on no body before the rest of the motion.
        let is_on_way = (model.as_ref()).is_some_and(|model| model.moment().is_on_way());
        let num_vertices = package.mesh.num_vertices();
        let cost = model.as_ref().map(|model| model.cost(num_vertices));
        Ok(Self {
            name: Candidate::settled_name(name, settle),
            warp,
            cost: cost.transpose()?,
            model,
            settle: (settle > 0 || is_on_way).then(|| (settle, Teachers::new(stage))),
        })
    }

    /// `dqs`, `warp`, or the name of the model.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// The moment at which the network predicts the cloth; rest, of skinning and warp.
    pub(crate) fn moment(&self) -> Moment {
        self.model.as_ref().map_or(Moment::Rest, Model::moment)
    }

    /// Whether cloth is simulated where the network has put it.
    pub(crate) fn is_simulated(&self) -> bool {
        self.settle.is_some()
    }

    /// For how many frames cloth settles.
    pub(crate) fn settle_frames(&self) -> u32 {
        self.settle.as_ref().map_or(0, |(frames, _)| *frames)
    }

    /// Size and work of the network, if it is one.
    pub(crate) fn cost(&self) -> Option<Cost> {
        self.cost
    }

    /// What the network is made of, if it is one.
    pub(crate) fn config(&self) -> Option<&GarNetConfig> {
        self.model.as_ref().and_then(Model::config)
    }

    /// Memory that the network keeps between scenes, in bytes.
    pub(crate) fn num_bytes(&self) -> Option<usize> {
        self.model.as_ref().map(Model::num_bytes)
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
        let Some(model) = &mut self.model else {
            let start = Instant::now();
            let nodes = worn.garment.warped(&staged.posed, self.warp)?;
            let warp = start.elapsed().as_secs_f64();
            return Ok(Draped {
                positions: worn.garment.weld().scatter(&nodes),
                warp,
                network: None,
                is_simulated: false,
                settle: None,
            });
        };
        model.rebind(worn.graph.clone())?;
        let from = model.moment();
        let start = Instant::now();
        let posed = staged.posed_for(from)?;
        let warped = staged.warped(self.warp, &posed)?;
        let warp = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let mut positions = predicted(model, &warped, &worn.body, &posed)?;
        let network = start.elapsed().as_secs_f64();
        let (mut settle, mut is_simulated) = (None, false);
        if let Some((frames, teachers)) = &mut self.settle {
            let teacher = teachers.of(staged)?;
            let start = Instant::now();
            let stop = AtomicBool::new(false);
            let (own, frames) = (&worn.body, *frames);
            let settling = Settling { from, frames };
            match teacher.settled(own, &staged.posed, &positions, settling, &stop) {
                Ok(settled) => {
                    positions = settled;
                    is_simulated = settling.finds_folds();
                    settle = Some(start.elapsed().as_secs_f64());
                }
                // As in `garnet drape`: cloth that flies apart stays where it was put, if that is on the body.
                Err(PackageError::Sim(_)) if !from.is_on_way() => {}
                Err(PackageError::Sim(_)) => {
                    let nodes = worn.garment.warped(&staged.posed, self.warp)?;
                    positions = worn.garment.weld().scatter(&nodes);
                }
                Err(error) => return Err(error.into()),
            }
        }
        Ok(Draped {
            positions,
            warp,
            network: Some(network),
            is_simulated,
            settle,
        })
    }
}
