//! The middle of a drape: a network predicts where the cloth is, and the simulation relaxes it.

use std::borrow::Cow;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use garnet_knn::TORN_STRETCH;
use garnet_mesh::{Point3, StretchSummary, edge_stretch};
use garnet_net::ReferenceCase;
use garnet_sim::{DrapeReport, Event, Moment, Quality};
use garnet_skin::{BodyAtHome, PosedBody, Warp};
use tracing::{debug, info};

use crate::draper::Brought;
use crate::network::Predicted;
use crate::{
    BodyPath, BoundGarment, DrapeSeconds, Draper, Error, Fallback, Network, PackageError, Placed,
    PlacedBy, Provenance, Refit, Settling, Simulator,
};

/// Relaxed cloth with an edge longer than this over its length at rest hangs on a limb that it
/// would have to go through: half as much again as torn, so that what a contact strains for a
/// moment does not count. Lower, more drapes are simulated from rest, which takes seconds.
const CAUGHT_STRETCH: f32 = 1.5 * TORN_STRETCH;

/// Warped cloth that has settled is strained if 1 % of its edges are longer than this over their
/// length at rest, or one is torn: simulated cloth has 1.02 to 1.1. Lower, more drapes are
/// simulated from rest.
const STRAINED: f32 = 1.2;

/// How strained cloth is, less of which is better.
type Measure = fn(&StretchSummary) -> f32;

/// What stands between warp and untangling.
#[derive(Debug, Clone, Default)]
pub(crate) struct Learned {
    /// How the garment came to the body, if it was made for another one: the network knows that
    /// one.
    refit: Option<Arc<Refit>>,
    network: Option<Arc<Network>>,
    /// For how many frames what the network predicts is relaxed.
    relax_frames: u32,
    simulator: Option<Arc<Simulator>>,
}

/// Cloth that was relaxed.
struct Settled {
    /// Positions `[node]`, in metres.
    nodes: Vec<Point3>,
    /// From where, and for how long.
    relaxation: Settling,
    /// Why it was not from where the network put it.
    fallback: Option<Fallback>,
    /// How much of it is falling in the end, from 0 to 1.
    falling: f32,
}

/// How far a simulation is.
pub struct Progress<'a> {
    /// What the simulation says.
    pub event: &'a Event<'a>,
    simulator: &'a Simulator,
    home: &'a BodyAtHome<'a>,
}

impl Progress<'_> {
    /// Positions `[vertex]` of the garment at the end of a frame, in metres, where the target
    /// stands; `None` of other events.
    pub fn frame(&self) -> Option<Vec<Point3>> {
        match self.event {
            Event::Frame { positions, .. } => {
                Some(self.home.to_target(self.simulator.vertices(positions)))
            }
            _ => None,
        }
    }
}

impl std::fmt::Debug for Progress<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Progress").finish_non_exhaustive()
    }
}

impl Draper {
    /// The same with a network, which was bound to this garment, or to the garment of its
    /// [refit](Draper::with_refit). What it predicts is relaxed for so many frames of a sixtieth of
    /// a second, where there is a [simulator](Draper::with_simulator).
    #[must_use]
    pub fn with_network(mut self, network: impl Into<Arc<Network>>, relax_frames: u32) -> Self {
        self.learned.network = Some(network.into());
        self.learned.relax_frames = relax_frames;
        self
    }

    /// The same with a simulator of this garment, to relax what was brought.
    #[must_use]
    pub fn with_simulator(mut self, simulator: impl Into<Arc<Simulator>>) -> Self {
        self.learned.simulator = Some(simulator.into());
        self
    }

    /// The same for a garment that was brought from the body that it was made for.
    #[must_use]
    pub fn with_refit(mut self, refit: impl Into<Arc<Refit>>) -> Self {
        self.learned.refit = Some(refit.into());
        self
    }

    /// The network, if there is one.
    pub fn network(&self) -> Option<&Arc<Network>> {
        self.learned.network.as_ref()
    }

    /// How the garment came to the body, if it was made for another one.
    pub fn refit(&self) -> Option<&Refit> {
        self.learned.refit.as_deref()
    }

    /// The simulator, if there is one.
    pub fn simulator(&self) -> Option<&Arc<Simulator>> {
        self.learned.simulator.as_ref()
    }

    /// The moment at which the cloth is brought, and for how long it is relaxed from there; without
    /// a network not at all, unless the [options](crate::DrapeOptions::relax_frames) say so.
    pub fn relaxation(&self) -> Settling {
        let network = self.learned.network.as_ref();
        let known = network.map_or(Settling::of(Moment::Rest), |network| {
            Settling::of_predicted(network.moment())
        });
        Settling {
            frames: (self.options.relax_frames).unwrap_or(self.learned.relax_frames),
            ..known
        }
    }

    /// Simulates the garment while the body goes from its rest to its target, and until it rests.
    ///
    /// `observer` is told how far it is; `stop` ends it.
    ///
    /// # Errors
    ///
    /// As [`Simulator::drape`]; [`Error::NoSimulator`] without one.
    pub fn simulate<'a>(
        &self,
        body: &'a PosedBody,
        quality: Quality,
        stop: &AtomicBool,
        observer: &mut dyn FnMut(Progress<'_>),
    ) -> Result<(Placed<'a>, DrapeReport), Error> {
        let simulator = self.simulator().ok_or(Error::NoSimulator)?;
        let home = body.at_home(self.garment.body())?;
        let start = Instant::now();
        let path = BodyPath::to_posed(self.garment.body(), home.body());
        let mut watch = |event: Event<'_>| {
            observer(Progress {
                event: &event,
                simulator,
                home: &home,
            });
        };
        let simulated = simulator.drape(&path, quality, stop, &mut watch)?;
        let mut brought = Brought {
            nodes: self.garment.cloth().weld().gather(&simulated.positions),
            by: PlacedBy::Simulation,
            unrelaxed: None,
            provenance: Provenance::default(),
            seconds: DrapeSeconds::default(),
        };
        brought.provenance.relaxed_from = Some(Moment::Start);
        brought.seconds.warp = start.elapsed().as_secs_f64();
        debug!(seconds = brought.seconds.warp, ?quality, "simulated");
        Ok((Placed::new(home, brought), simulated.report))
    }

    /// The garment brought to a body at home.
    pub(crate) fn brought(&self, body: &PosedBody, stop: &AtomicBool) -> Result<Brought, Error> {
        let mut brought = match self.network() {
            Some(network) => self.predicted(network, body)?,
            None => self.warped(body, self.options.warp)?,
        };
        let relaxation = self.relaxation();
        let is_on_way = relaxation.from.is_on_way();
        let is_at_rest = relaxation.from == Moment::Rest;
        let relaxed = match (&brought.provenance.fallback, &self.learned.simulator) {
            (_, None) => None,
            (None, _) if !relaxation.takes_time() => None,
            (None, Some(simulator)) => {
                let from = self.garment.cloth().weld().scatter(&brought.nodes);
                Some((simulator, from, relaxation))
            }
            // Of a motion that is simulated in any case the network would have told the first half.
            (Some(_), Some(simulator)) if is_on_way => {
                let from = self.garment.mesh().positions().to_vec();
                let relaxation = relaxation.begun_again();
                Some((simulator, from, relaxation))
            }
            // What fell back to the warp is far from where cloth rests.
            (Some(_), _) => None,
        };
        if let Some((simulator, from, relaxation)) = relaxed {
            let start = Instant::now();
            match self.settled(simulator, body, &from, relaxation, stop) {
                Ok(settled) => {
                    let Settled {
                        nodes: settled,
                        relaxation,
                        fallback,
                        falling,
                    } = settled;
                    brought.provenance.falling_share = falling;
                    brought.provenance.fallback = brought.provenance.fallback.or(fallback);
                    let before = std::mem::replace(&mut brought.nodes, settled);
                    // What was to rest already is a drape.
                    brought.unrelaxed = is_at_rest.then_some((before, brought.by));
                    brought.by = match brought.by {
                        PlacedBy::Warp if !relaxation.finds_folds() => PlacedBy::Network,
                        _ => PlacedBy::Simulation,
                    };
                    brought.provenance.relaxed_from = Some(relaxation.from);
                    brought.seconds.relax = start.elapsed().as_secs_f64();
                    let (seconds, frames) = (brought.seconds.relax, relaxation.frames);
                    debug!(seconds, frames, from = ?relaxation.from, "relaxed");
                }
                Err(PackageError::Stopped) => return Err(PackageError::Stopped.into()),
                Err(error) => {
                    info!(%error, "left as it was before it was to be relaxed");
                    brought.provenance.unrelaxed = Some(Arc::new(error.into()));
                }
            }
        }
        let is_left = is_on_way
            && brought.provenance.fallback.is_none()
            && brought.provenance.relaxed_from.is_none();
        if is_left {
            // Cloth on the way is on no body yet.
            let warped = self.warped(body, Warp::Shape)?;
            (brought.nodes, brought.by) = (warped.nodes, warped.by);
            brought.seconds.warp += warped.seconds.warp;
            info!(reason = %Fallback::OnTheWay, "fell back to the warp");
            brought.provenance.fallback = Some(Fallback::OnTheWay);
        }
        Ok(brought)
    }

    /// The garment relaxed from vertices `from`; from rest, if it was caught on the body on the
    /// way.
    fn settled(
        &self,
        simulator: &Simulator,
        body: &PosedBody,
        from: &[Point3],
        relaxation: Settling,
        stop: &AtomicBool,
    ) -> Result<Settled, PackageError> {
        let settle = |from: &[Point3], relaxation: Settling| {
            let own = self.garment.body();
            let (settled, falling) =
                simulator.settled_and_falling(own, body, from, relaxation, stop)?;
            Ok(Settled {
                nodes: self.garment.cloth().weld().gather(&settled),
                relaxation,
                fallback: None,
                falling,
            })
        };
        let first = settle(from, relaxation)?;
        let Some((reason, measure)) = self.unfit(&first, relaxation) else {
            return Ok(first);
        };
        let relaxation = relaxation.begun_again();
        match settle(self.garment.mesh().positions(), relaxation) {
            Ok(again)
                if measure(&self.stretch(&again.nodes)) < measure(&self.stretch(&first.nodes)) =>
            {
                info!(%reason, "simulated from the body at rest");
                Ok(Settled {
                    fallback: Some(reason),
                    ..again
                })
            }
            Err(PackageError::Stopped) => Err(PackageError::Stopped),
            _ => Ok(first),
        }
    }

    /// Why cloth that has settled is to be simulated from the body at rest instead, and by what
    /// that is to be better.
    fn unfit(&self, settled: &Settled, by: Settling) -> Option<(Fallback, Measure)> {
        let stretch = self.stretch(&settled.nodes);
        let is_of_network = by.from.is_on_way() && by.from != Moment::Start;
        if is_of_network && by.finds_folds() {
            let is_caught = stretch.max > CAUGHT_STRETCH;
            let stretch = stretch.max;
            return is_caught.then_some((Fallback::Torn { stretch }, |found| found.max));
        }
        let is_warped = self.network().is_none() && by.from == Moment::Rest;
        let may_simulate = is_warped && self.options.simulates_strained;
        let strain: Measure = |found| (found.p99 / STRAINED).max(found.max / TORN_STRETCH);
        let reason = Fallback::Strained {
            p99: stretch.p99,
            longest: stretch.max,
        };
        (may_simulate && strain(&stretch) > 1.0).then_some((reason, strain))
    }

    /// How much longer the edges of cloth `[node]` are than at rest.
    fn stretch(&self, nodes: &[Point3]) -> StretchSummary {
        let cloth = self.garment.cloth();
        let found = edge_stretch(cloth.rest_nodes(), nodes, cloth.topology().edges());
        found.unwrap_or_default()
    }

    /// What the network is told of a body and what it says, for other implementations: see
    /// [`Network::case`]; `None` without a network.
    ///
    /// # Errors
    ///
    /// As [`Draper::drape`].
    pub fn network_case(&self, body: &PosedBody) -> Result<Option<ReferenceCase>, Error> {
        let Some(network) = self.network() else {
            return Ok(None);
        };
        let home = body.at_home(self.garment.body())?;
        let seen = self.seen_by(network, home.body())?;
        network.case(self.known_garment(), &seen).map(Some)
    }

    /// The body that a network is asked about: at its moment, and of the kind that it knows.
    fn seen_by<'a>(
        &self,
        network: &Network,
        body: &'a PosedBody,
    ) -> Result<Cow<'a, PosedBody>, Error> {
        let own = self.garment.body();
        let moment = network.moment();
        let mut seen = Cow::Borrowed(body);
        if moment.is_on_way() {
            let path = BodyPath::to_posed(own, body);
            seen = Cow::Owned(path.posed(own, moment.motion_share())?);
        }
        if let Some(refit) = self.refit() {
            seen = Cow::Owned(refit.stand_in(seen.skin().positions())?);
        }
        Ok(seen)
    }

    /// The garment as the network knows it.
    fn known_garment(&self) -> &BoundGarment {
        self.refit().map_or(&*self.garment, Refit::garment)
    }

    /// The garment where the network predicts it, or, if that is not to be trusted, warped.
    fn predicted(&self, network: &Network, body: &PosedBody) -> Result<Brought, Error> {
        let start = Instant::now();
        let moment = network.moment();
        let seen = &*self.seen_by(network, body)?;
        let garment = self.known_garment();
        let warped = network.warped(garment, seen)?;
        let predicting = Instant::now();
        let predicted = network.predict(garment, seen, &warped)?;
        let predict = predicting.elapsed().as_secs_f64();
        let (positions, beyond) = match predicted {
            Predicted::At(positions) => (positions, None),
            Predicted::Beyond(positions, reason) => (positions, Some(reason)),
            Predicted::Unfamiliar(reason) => {
                info!(%reason, "the network is not trusted");
                let mut warped = self.warped(body, Warp::Shape)?;
                warped.provenance.fallback = Some(Fallback::Unfamiliar(reason));
                warped.seconds.predict = predict;
                warped.seconds.warp = start.elapsed().as_secs_f64() - predict;
                return Ok(warped);
            }
        };
        let mut brought = Brought {
            nodes: self.garment.cloth().weld().gather(&positions),
            by: PlacedBy::Network,
            unrelaxed: None,
            provenance: Provenance::default(),
            seconds: DrapeSeconds::default(),
        };
        debug!(seconds = predict, ?moment, "predicted");
        if let Some(reason) = &beyond {
            info!(%reason, "the network predicts the nearest body that it knows");
        }
        brought.provenance.predicted = Some(moment);
        brought.provenance.beyond = beyond;
        brought.seconds.predict = predict;
        brought.seconds.warp = start.elapsed().as_secs_f64() - predict;
        Ok(brought)
    }
}
