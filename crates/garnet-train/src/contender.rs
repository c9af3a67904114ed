//! A way to drape, ready to be timed.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use garnet_data::{DataError, Put, Settling};
use garnet_mesh::Point3;
use garnet_net::{Aim, Cost, GarNetConfig, Model, Start};

use crate::network_input::predicted;
use crate::teachers::Teachers;
use crate::{Candidate, Stage, StagedScene, TrainError, warp_of};

/// A candidate, bound to the garment.
#[derive(Debug)]
pub(crate) struct Contender<'a> {
    name: String,
    start: Start,
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

/// Where a model puts cloth.
pub const fn put_of(aim: Aim) -> Put {
    match aim {
        Aim::Rest => Put::AtRest,
        Aim::Arrival => Put::AtArrival,
        Aim::Falling => Put::Falling,
        Aim::Midway => Put::Midway,
    }
}

impl<'a> Contender<'a> {
    /// Reads the weights, if it has any.
    pub(crate) fn new(stage: &'a Stage, candidate: &Candidate) -> Result<Self, TrainError> {
        stage.check_aim(Aim::Rest)?;
        let package = &stage.package;
        let (name, start, model, settle) = match candidate {
            Candidate::Skinning => ("dqs", Start::DualQuaternion, None, 0),
            Candidate::Warp => ("warp", Start::Shape, None, 0),
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
                (name.as_str(), model.start(), Some(model), *settle)
            }
        };
        // Where cloth is midway is on no body before the rest of the motion.
        let is_midway = (model.as_ref()).is_some_and(|model| model.aim() == Aim::Midway);
        let num_vertices = package.mesh.num_vertices();
        let cost = model.as_ref().map(|model| model.cost(num_vertices));
        Ok(Self {
            name: Candidate::settled_name(name, settle),
            start,
            cost: cost.transpose()?,
            model,
            settle: (settle > 0 || is_midway).then(|| (settle, Teachers::new(stage))),
        })
    }

    /// `dqs`, `warp`, or the name of the model.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// What the network tells; where the cloth rests, of skinning and warp.
    pub(crate) fn aim(&self) -> Aim {
        self.model.as_ref().map_or(Aim::Rest, Model::aim)
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
            let nodes = worn.garment.warped(&staged.posed, warp_of(self.start))?;
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
        let put = put_of(model.aim());
        let start = Instant::now();
        let posed = staged.posed_for(model.aim())?;
        let warped = staged.warped(self.start, &posed)?;
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
            let settling = Settling { put, frames };
            match teacher.settled(own, &staged.posed, &positions, settling, &stop) {
                Ok(settled) => {
                    positions = settled;
                    is_simulated = settling.finds_folds();
                    settle = Some(start.elapsed().as_secs_f64());
                }
                // As in `garnet drape`: cloth that flies apart stays where it was put, if that is on the body.
                Err(DataError::Sim(_)) if put != Put::Midway => {}
                Err(DataError::Sim(_)) => {
                    let nodes = worn.garment.warped(&staged.posed, warp_of(self.start))?;
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
