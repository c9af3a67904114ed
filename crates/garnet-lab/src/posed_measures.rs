//! How far off the measures of posed bodies are that are told from their skin alone.
//!
//! Bodies of the population stand in all key poses of the library; the body of mean shape is fitted
//! to each. A row a measure: quantiles of the errors in millimetres, and the worst case.

use clap::Args;
use garnet_body::poses::{KeyPose, Poser, key_poses};
use garnet_body::shape::{
    BodyParameters, Measure, ParametricBody, Population, tape_measures, unposed,
};
use garnet_skin::Method;
use rayon::prelude::*;

use crate::Outcome;

const SHOWN: [Measure; 5] = [
    Measure::Chest,
    Measure::Waist,
    Measure::Hip,
    Measure::Thigh,
    Measure::Inseam,
];

/// No data set is of this seed.
const SEED: u64 = 91;

/// Whom to measure.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Bodies.
    #[arg(long, default_value_t = 20)]
    bodies: u64,
    /// Bend their skin by linear blending in place of dual quaternions.
    #[arg(long)]
    linear: bool,
}

/// What is found less what is right, in metres, of a body in a pose.
struct Found {
    pose: &'static str,
    body: usize,
    errors: [f64; SHOWN.len()],
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let method = if arguments.linear {
        Method::Linear
    } else {
        Method::DualQuaternion
    };
    let own = ParametricBody::build(&BodyParameters::new(0.5))?;
    let population = Population::new(SEED);
    let bodies =
        (0..arguments.bodies).map(|index| ParametricBody::build(&population.sample(index)));
    let bodies: Vec<ParametricBody> = bodies.collect::<Result<_, _>>()?;
    let cases: Vec<(usize, &KeyPose)> = (0..bodies.len())
        .flat_map(|body| key_poses().map(move |pose| (body, pose)))
        .collect();
    let found = |&(body, pose): &(usize, &'static KeyPose)| -> Result<Found, String> {
        let other = &bodies[body];
        let told = |error: &dyn std::fmt::Display| error.to_string();
        let poser = Poser::new(other.body().skeleton()).map_err(|error| told(&error))?;
        let skin = (other.body()).posed_positions(&poser.pose(&pose.angles), method);
        let skin = skin.map_err(|error| told(&error))?;
        let found = unposed(own.body(), &skin).map_err(|error| told(&error))?;
        let found = found.as_ref().and_then(tape_measures);
        let found = found.ok_or_else(|| format!("body {body} has the shape of the mean one"))?;
        Ok(Found {
            pose: pose.name,
            body,
            errors: SHOWN.map(|measure| found[measure] - other.measures()[measure]),
        })
    };
    let found: Vec<Found> = cases.par_iter().map(found).collect::<Result<_, _>>()?;
    println!("| off, mm | median | p90 | p98 | largest | of |\n|---|---|---|---|---|---|");
    for (at, measure) in SHOWN.iter().enumerate() {
        let mut errors: Vec<(f64, &Found)> = (found.iter())
            .map(|found| (1e3 * found.errors[at].abs(), found))
            .collect();
        errors.sort_by(|a, b| a.0.total_cmp(&b.0));
        let quantile = |share: f64| errors[((errors.len() - 1) as f64 * share) as usize];
        let [median, most, nearly_all, (largest, worst)] = [0.5, 0.9, 0.98, 1.0].map(quantile);
        println!(
            "| {} | {:.0} | {:.0} | {:.0} | {largest:.0} | `{}`, body {} |",
            measure.name(),
            median.0,
            most.0,
            nearly_all.0,
            worst.pose,
            worst.body
        );
    }
    Ok(())
}
