//! The second chart: what stages cost with more and fewer vertices.

use garnet::train::{
    Candidate, GarNetConfig,
    chart::{CostAt, GrowthOptions, PowerLaw, cost_at, header_of, targets},
};
use serde::Serialize;

use super::{
    Chosen, Job, SPLIT,
    args::ChartArgs,
    methods::{Method, Way},
    record::{Keeper, Record},
};
use crate::train::advised;

/// The network that is taken if the package has none.
const PRESET: &str = "small";

/// Exponents are fitted to garments with at least so many vertices, if there are two: below, what does
/// not grow with the garment counts.
const FITTED_FROM: usize = 5_000;

/// How a cost grows.
#[derive(Debug, Serialize)]
pub(super) struct Series {
    pub(super) name: String,
    /// Vertices and median seconds.
    pub(super) points: Vec<[f64; 2]>,
    /// The law through the upper points, in seconds.
    pub(super) law: Option<PowerLaw>,
    /// The least number of vertices that the law is fitted to.
    pub(super) fitted_from: f64,
}

/// The second chart.
#[derive(Debug, Serialize)]
pub(super) struct GrowthReport {
    pub(super) series: Vec<Series>,
    /// Bodies that each garment is draped on.
    pub(super) scenes: usize,
}

/// Times the stages for each number of vertices that is not there yet.
pub(super) fn measure(job: &Job, keeper: &mut Keeper) -> anyhow::Result<()> {
    let sizes = job.args.sizes();
    if sizes.is_empty() {
        return Ok(());
    }
    let networks = networks(job.methods, &keeper.record)?;
    let made_of = networks.iter().map(|(name, config)| {
        let config = serde_json::to_string(config).unwrap_or_default();
        format!("{name} {config}")
    });
    let made_of: Vec<String> = made_of.collect();
    if keeper.record.growth_networks != made_of {
        keeper.record.growth_networks = made_of;
        keeper.record.growth.clear();
    }
    // Simulations that were left out before may be asked for now.
    let most_simulated = if job.args.teacher_scenes == 0 {
        0
    } else {
        job.args.most_simulated
    };
    let is_whole = |cost: &CostAt| {
        let is_simulated = cost.simulation.is_some() || cost.vertices > most_simulated;
        is_simulated && cost.settle.is_some()
    };
    keeper.record.growth.retain(is_whole);
    let known = |record: &Record, asked| record.growth.iter().any(|cost| cost.asked == asked);
    let missing: Vec<usize> = (sizes.into_iter())
        .filter(|&asked| !known(&keeper.record, asked))
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    let bodies = targets(job.stage, SPLIT, &job.scenes.growth).map_err(advised)?;
    let options = GrowthOptions {
        networks,
        untangle: job.args.untangle(),
        repeats: job.args.repeat,
        most_simulated,
    };
    let bar = job.console.progress(missing.len());
    for asked in missing {
        bar.set_message(format!("{asked} vertices"));
        match cost_at(job.stage, &bodies, asked, &options) {
            Ok(Some(cost)) => keeper.record.growth.push(cost),
            Ok(None) => job.console.detail(&format_args!(
                "the garment cannot be made with {asked} vertices: it has no pattern"
            )),
            Err(error) => job.console.warning(&format_args!(
                "the garment with {asked} vertices is left out: {error}"
            )),
        }
        keeper.record.growth.sort_by_key(|cost| cost.vertices);
        keeper.write()?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(())
}

/// The cheapest and the most expensive network of the package; one untrained if it has none.
fn networks(methods: &[Method], record: &Record) -> anyhow::Result<Vec<(String, GarNetConfig)>> {
    let mut costs = Vec::new();
    for method in methods {
        let Way::Drape(Candidate::Model {
            weights, settle: 0, ..
        }) = &method.way
        else {
            continue;
        };
        let cost = record.find(&method.name).and_then(|known| known.cost);
        costs.push((cost.map_or(0, |cost| cost.flops), &method.name, weights));
    }
    costs.sort_by_key(|(flop, ..)| *flop);
    let mut networks = Vec::with_capacity(costs.len());
    for (_, name, weights) in costs {
        let config = header_of(weights)?.config;
        networks.extend(config.map(|config| (name.clone(), config)));
    }
    if networks.len() > 2 {
        networks.drain(1..networks.len() - 1);
    }
    if networks.is_empty() {
        networks.push((PRESET.to_owned(), GarNetConfig::preset(PRESET)?));
    }
    Ok(networks)
}

impl GrowthReport {
    /// Of what was measured; none if nothing was.
    pub(super) fn new(args: &ChartArgs, scenes: &Chosen, record: &Record) -> Option<Self> {
        let sizes = args.sizes();
        let costs = record.growth.iter();
        let costs: Vec<&CostAt> = costs.filter(|cost| sizes.contains(&cost.asked)).collect();
        let first = costs.first()?;
        let mut series = vec![
            Series::new("warp", &costs, |cost| Some(cost.warp)),
            Series::new("untangle", &costs, |cost| Some(cost.untangle)),
        ];
        for (number, (name, _)) in first.networks.iter().enumerate() {
            let name = format!("network {name}");
            series.push(Series::new(&name, &costs, |cost| {
                cost.networks.get(number).map(|(_, seconds)| *seconds)
            }));
        }
        series.push(Series::new("settle", &costs, |cost| cost.settle));
        series.push(Series::new("simulation", &costs, |cost| cost.simulation));
        series.retain(|series| !series.points.is_empty());
        Some(Self {
            series,
            scenes: scenes.growth.len(),
        })
    }
}

impl Series {
    fn new(name: &str, costs: &[&CostAt], seconds: impl Fn(&CostAt) -> Option<f64>) -> Self {
        let point = |cost: &&CostAt| Some([cost.vertices as f64, seconds(cost)?]);
        let points: Vec<[f64; 2]> = costs.iter().filter_map(point).collect();
        // Patterns are not triangulated to the exact number.
        let from = 0.9 * FITTED_FROM as f64;
        let upper: Vec<[f64; 2]> = points
            .iter()
            .copied()
            .filter(|point| point[0] > from)
            .collect();
        let fitted = if upper.len() < 2 { &points } else { &upper };
        Self {
            name: name.to_owned(),
            law: PowerLaw::fit(fitted),
            fitted_from: fitted.first().map_or(0.0, |point| point[0]),
            points,
        }
    }
}
