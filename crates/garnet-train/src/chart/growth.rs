//! What drapes of the same garment cost with more and fewer vertices.

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use garnet_data::{Moment, Rung, Split};
use garnet_drape::{BodyPath, Quality, Settling};
use garnet_net::{BodySampling, GarNetConfig, GarmentGraph, Model, ModelHeader};
use garnet_skin::{PosedBody, Warp, WarpedGarment};
use garnet_untangle::{Binding, UntangleOptions, untangle};
use serde::{Deserialize, Serialize};

use crate::network_input::predicted;
use crate::{Percentiles, SceneName, Stage, TrainError};

/// What is measured at each number of vertices.
#[derive(Debug, Clone, PartialEq)]
pub struct GrowthOptions {
    /// Networks by name; they are made anew with random weights, which cost as much as any.
    pub networks: Vec<(String, GarNetConfig)>,
    /// How drapes are untangled.
    pub untangle: UntangleOptions,
    /// How often each drape is repeated.
    pub repeats: usize,
    /// Simulations of garments with at most this many vertices.
    pub most_simulated: usize,
}

/// Median wall times at a number of vertices, in seconds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CostAt {
    /// Vertices that were asked for.
    pub asked: usize,
    /// Vertices of the garment.
    pub vertices: usize,
    /// The warp by pose and shape, with the frames that networks are told.
    pub warp: f64,
    /// The networks by name, each from the warped garment on.
    pub networks: Vec<(String, f64)>,
    /// Untangling of the warp.
    pub untangle: f64,
    /// Settling of the warp for [`Moment::settle_frames`]; none of garments that come apart on all bodies.
    #[serde(default)]
    pub settle: Option<f64>,
    /// The simulation in the quality of a teacher; none where it would take too long or fails.
    pub simulation: Option<f64>,
}

/// What a weight file says about itself.
///
/// # Errors
///
/// [`TrainError::Checkpoint`].
pub fn header_of(weights: &Path) -> Result<ModelHeader, TrainError> {
    Ok(ModelHeader::read(weights)?)
}

/// The bodies of scenes, as targets of the garment of the package.
///
/// # Errors
///
/// Those of the data set.
pub fn targets(
    stage: &Stage,
    split: Split,
    scenes: &[SceneName],
) -> Result<Vec<PosedBody>, TrainError> {
    let mut bodies = Vec::new();
    let keep = |name| scenes.contains(&name);
    stage.for_each_of(split, keep, Ok, &mut |staged| {
        let places = staged.posed.skin().positions();
        bodies.push(stage.package.body.fitted(places)?);
        Ok(())
    })?;
    Ok(bodies)
}

/// Times the stages of drapes of the package's garment with about `asked` vertices on bodies; none
/// if it cannot be made with so many.
///
/// # Errors
///
/// Those of a garment that cannot be cut, bound or draped.
pub fn cost_at(
    stage: &Stage,
    bodies: &[PosedBody],
    asked: usize,
    options: &GrowthOptions,
) -> Result<Option<CostAt>, TrainError> {
    let stop = AtomicBool::new(false);
    let Some(rung) = Rung::new(&stage.package, asked, &stop)? else {
        return Ok(None);
    };
    let package = &stage.package;
    let mesh = rung.garment.mesh();
    let mut networks = Vec::with_capacity(options.networks.len());
    for (name, config) in &options.networks {
        let graph = GarmentGraph::new(mesh, &vec![0.0; config.num_sewing_parameters])?;
        let config = graph.configured(config.clone());
        let rest = package.body.rest().positions();
        let sampling = BodySampling::for_garment(rest, mesh.positions(), &config)?;
        networks.push((name, Model::untrained(&config, 1, graph, sampling)?));
    }
    let binding = Binding::new(&rung.garment)?;
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); 2 + networks.len()];
    // The first drape of each body warms up.
    for round in 0..=options.repeats.max(1) {
        for body in bodies {
            let found = drape(stage, &rung, &binding, &mut networks, body, options)?;
            if round > 0 {
                times
                    .iter_mut()
                    .zip(found)
                    .for_each(|(times, time)| times.push(time));
            }
        }
    }
    let mut medians = times.into_iter().map(|times| Percentiles::of(times).median);
    let mut next = || medians.next().unwrap_or(0.0);
    let (warp, untangle) = (next(), next());
    let names = networks.iter().map(|(name, _)| (*name).clone());
    Ok(Some(CostAt {
        asked,
        vertices: mesh.num_vertices(),
        warp,
        untangle,
        networks: names.map(|name| (name, next())).collect(),
        settle: settled(stage, &rung, bodies, options.repeats)?,
        simulation: (mesh.num_vertices() <= options.most_simulated)
            .then(|| simulated(stage, &rung, bodies.first()?))
            .flatten(),
    }))
}

/// Times of warp, untangling and networks.
fn drape(
    stage: &Stage,
    rung: &Rung,
    binding: &Binding,
    networks: &mut [(&String, Model)],
    body: &PosedBody,
    options: &GrowthOptions,
) -> Result<Vec<f64>, TrainError> {
    let (garment, own) = (&rung.garment, &stage.package.body);
    let start = Instant::now();
    let by_shape = WarpedGarment::new(garment, own, body, Warp::Shape)?;
    let warp = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let nodes = garment.weld().gather(&by_shape.positions);
    untangle(garment, binding, body, &nodes, &options.untangle)?;
    let mut times = vec![warp, start.elapsed().as_secs_f64()];
    for (_, model) in networks {
        let warp = model.warp();
        let warped = WarpedGarment::new(garment, own, body, warp)?;
        let start = Instant::now();
        predicted(model, &warped, own, body)?;
        times.push(start.elapsed().as_secs_f64());
    }
    Ok(times)
}

/// Median time of settling the warp on the bodies where it can; a warp may tear fine cloth beyond that.
fn settled(
    stage: &Stage,
    rung: &Rung,
    bodies: &[PosedBody],
    repeats: usize,
) -> Result<Option<f64>, TrainError> {
    let stop = AtomicBool::new(false);
    let settling = Settling::of(Moment::Rest);
    let own = &stage.package.body;
    let mut times = Vec::new();
    for body in bodies {
        let warped = rung.garment.warped(body, Warp::Shape)?;
        let from = rung.garment.weld().scatter(&warped);
        for _ in 0..repeats.max(1) {
            let start = Instant::now();
            let settled = (rung.teacher).settled(own, body, &from, settling, &stop);
            if settled.is_err() {
                break;
            }
            times.push(start.elapsed().as_secs_f64());
        }
    }
    Ok((!times.is_empty()).then(|| Percentiles::of(times).median))
}

fn simulated(stage: &Stage, rung: &Rung, body: &PosedBody) -> Option<f64> {
    let stop = AtomicBool::new(false);
    let start = Instant::now();
    let path = BodyPath::to_posed(&stage.package.body, body);
    let drape = rung
        .teacher
        .drape(&path, Quality::Teacher, &stop, &mut |_| {});
    drape.ok().map(|_| start.elapsed().as_secs_f64())
}
