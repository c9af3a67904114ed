//! A way to drape, ready to be timed.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use garnet_drape::{Drape, DrapeOptions, Draper, Network, Placed};
use garnet_net::{Cost, GarNetConfig, Model, Moment};
use garnet_skin::Warp;

use crate::simulators::Simulators;
use crate::{Candidate, Finish, Stage, StagedScene, TrainError, Worn};

/// A candidate, bound to the garment.
#[derive(Debug)]
pub(crate) struct BoundCandidate<'a> {
    name: String,
    warp: Warp,
    model: Option<Arc<Model>>,
    cost: Option<Cost>,
    /// For how many frames cloth settles, and who simulates it.
    settle: Option<(u32, Simulators<'a>)>,
    /// What drapes the last garment.
    last: Option<(Arc<Worn>, Draper)>,
}

impl<'a> BoundCandidate<'a> {
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
                (name.as_str(), model.warp(), Some(Arc::new(model)), *settle)
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
            settle: (settle > 0 || is_on_way).then(|| (settle, Simulators::new(stage))),
            last: None,
        })
    }

    /// `dqs`, `warp`, or the name of the model.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// The moment at which the network predicts the cloth; rest, of skinning and warp.
    pub(crate) fn moment(&self) -> Moment {
        (self.model.as_ref()).map_or(Moment::Rest, |model| model.moment())
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
        self.model.as_ref().and_then(|model| model.config())
    }

    /// Memory that the network keeps between scenes, in bytes.
    pub(crate) fn num_bytes(&self) -> Option<usize> {
        self.model.as_ref().map(|model| model.num_bytes())
    }

    /// Drapes as `garnet drape` does, and gives the garment before and after untangling to `take`.
    pub(crate) fn drape<T>(
        &mut self,
        staged: &StagedScene,
        finish: Finish,
        take: impl FnOnce(&Draper, &Placed<'_>, Option<Drape>) -> Result<T, TrainError>,
    ) -> Result<T, TrainError> {
        let mut drape = || {
            let options = DrapeOptions::default().with_warp(self.warp);
            let options = match finish {
                Finish::None => options.without_untangling(),
                Finish::Untangle(untangle) => options.with_untangling(untangle),
            };
            let draper = self.draper(staged)?.clone().with_options(options);
            let placed = draper.place(&staged.posed, &AtomicBool::new(false))?;
            let drape = match finish {
                Finish::None => None,
                Finish::Untangle(_) => Some(draper.untangle(placed.clone())?),
            };
            Ok((draper, placed, drape))
        };
        let (draper, placed, drape) = drape().map_err(|source: TrainError| TrainError::Scene {
            scene: staged.name,
            source: Box::new(source),
        })?;
        take(&draper, &placed, drape)
    }

    /// What drapes the garment of a scene.
    fn draper(&mut self, staged: &StagedScene) -> Result<&Draper, TrainError> {
        let last = self.last.take();
        let known = last.filter(|(worn, _)| Arc::ptr_eq(worn, &staged.worn));
        let known = match known {
            Some(known) => known,
            None => (Arc::clone(&staged.worn), self.new_draper(staged)?),
        };
        Ok(&self.last.insert(known).1)
    }

    fn new_draper(&mut self, staged: &StagedScene) -> Result<Draper, TrainError> {
        let garment = staged.worn.ready()?;
        let draper = Draper::new(Arc::clone(&garment));
        let Some(model) = &self.model else {
            return Ok(draper);
        };
        let graph = staged.worn.graph.clone();
        let network = Network::for_size(Arc::clone(model), &garment, graph)?;
        let Some((frames, simulators)) = &mut self.settle else {
            return Ok(draper.with_network(network, 0));
        };
        let simulator = simulators.of(staged)?;
        Ok(draper
            .with_network(network, *frames)
            .with_simulator(simulator))
    }
}
