//! Measures the built-in bodies against their bars, over many random parameter sets.

use std::time::Instant;

use clap::{Args, ValueEnum};
use garnet_body::shape::{BodyParameters, Measure, ParametricBody, Population};
use garnet_mesh::{TriMesh, diagnose};

use crate::Outcome;

/// By how much a girth changes in mode `one`, relative; the other way where that is not possible.
const STEP: f64 = 0.03;
/// The gap between the thighs is taken this far below the crotch, in metres.
const BELOW_CROTCH: f64 = 0.03;
const SMALLEST_ANGLE: f32 = 10.0;
/// An inseam farther off than this is listed, in metres.
const NOTABLE_INSEAM: f64 = 0.005;

/// The worst of everything, and counts.
#[derive(Debug, Default)]
struct Worst {
    refused: usize,
    girth: f64,
    stature: f64,
    inseam: f64,
    mass: f64,
    seconds: Vec<f64>,
    gap: f64,
    unclean: usize,
    sharp_faces: usize,
    faces: usize,
    intersecting_bodies: usize,
    intersections: usize,
    joints_outside: usize,
}

/// What to measure.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Number of bodies.
    #[arg(default_value = "100")]
    count: u64,
    /// What is given of each body.
    #[arg(value_enum, default_value = "all")]
    given: Given,
    /// Seed of the bodies.
    #[arg(long, default_value = "11")]
    seed: u64,
    /// How often each body is built; the shortest time counts.
    #[arg(long, default_value = "1")]
    repeats: u32,
}

/// What is given of each body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Given {
    /// Every measure of a sample.
    All,
    /// Stature and body mass index alone.
    Bmi,
    /// Stature and a few girths.
    Some,
    /// Every measure, of which one girth after the other changes.
    One,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let &Arguments {
        count,
        given,
        seed,
        repeats,
    } = arguments;
    let population = Population::new(seed);
    if given == Given::One {
        return one_by_one(&population, count);
    }
    let mut worst = Worst {
        gap: f64::MAX,
        ..Worst::default()
    };
    // What is read and computed once is no part of the time of a body.
    ParametricBody::build(&BodyParameters::new(0.5))?;
    for index in 0..count {
        let parameters = chosen(&population.sample(index), given, index, count);
        let mut seconds = f64::MAX;
        let mut built = None;
        for _ in 0..repeats {
            let start = Instant::now();
            built = Some(ParametricBody::build(&parameters));
            seconds = seconds.min(start.elapsed().as_secs_f64());
        }
        match built {
            Some(Ok(built)) => {
                worst.seconds.push(seconds);
                worst.add(index, &parameters, &built);
            }
            Some(Err(error)) => {
                worst.refused += 1;
                println!("body {index}: {error}");
            }
            None => {}
        }
    }
    worst.print(count);
    Ok(())
}

/// Changes each girth of some bodies while all other measures are kept as they were, and tells how
/// far these move.
fn one_by_one(population: &Population, count: u64) -> Outcome {
    let mut moved = Vec::new();
    let mut refused = 0;
    for index in 0..count {
        let drawn = population.sample(index);
        let first = ParametricBody::build(&drawn)?;
        let kept = first.measures().iter().fold(
            BodyParameters::new(drawn.sex()),
            |known, (measure, value)| known.with(measure, value),
        );
        let before = ParametricBody::build(&kept)?;
        for girth in Measure::GIRTHS {
            let changed = [1.0 + STEP, 1.0 - STEP].into_iter().find_map(|factor| {
                let changed = kept.clone().with(girth, factor * first.measures()[girth]);
                ParametricBody::build(&changed).ok()
            });
            let Some(after) = changed else {
                refused += 1;
                continue;
            };
            for (other, old) in before
                .measures()
                .iter()
                .filter(|&(other, _)| other != girth)
            {
                let change = (after.measures()[other] / old - 1.0).abs();
                moved.push((change, other, girth, index));
            }
        }
    }
    println!("bodies {count}, changes that no body allows {refused}");
    for girth in Measure::GIRTHS {
        let of_girth = moved.iter().filter(|change| change.2 == girth);
        if let Some((change, other, _, index)) = of_girth.max_by(|a, b| a.0.total_cmp(&b.0)) {
            println!(
                "{girth} by {:.0} %: moves {other} the most, by {:.2} % (body {index})",
                100.0 * STEP,
                100.0 * change
            );
        }
    }
    Ok(())
}

/// What is kept of a random body's parameters.
fn chosen(full: &BodyParameters, given: Given, index: u64, count: u64) -> BodyParameters {
    let stature = full.measure(Measure::Stature).unwrap_or(1.7);
    match given {
        Given::Bmi => {
            let sex = (7.0 * index as f64 / count as f64).fract();
            let bmi = 17.0 + 19.0 * (0.618 * index as f64).fract();
            BodyParameters::new(sex)
                .with(Measure::Stature, stature)
                .with_bmi(bmi)
        }
        Given::Some => {
            let girths = full
                .given()
                .filter(|(measure, _)| measure.is_girth())
                .enumerate();
            let kept = girths.filter(|(place, _)| (index >> (place % 8)) & 1 == 1);
            kept.fold(
                BodyParameters::new(full.sex()).with(Measure::Stature, stature),
                |parameters, (_, (measure, value))| parameters.with(measure, value),
            )
        }
        Given::All | Given::One => full.clone(),
    }
}

impl Worst {
    fn add(&mut self, index: u64, parameters: &BodyParameters, built: &ParametricBody) {
        let measures = built.measures();
        for (measure, value) in parameters.given() {
            let error = (measures[measure] - value).abs();
            match measure {
                Measure::Stature => self.stature = self.stature.max(error),
                Measure::Inseam => {
                    if error > NOTABLE_INSEAM {
                        println!(
                            "body {index}: inseam {:+.1} mm",
                            1e3 * (measures[measure] - value)
                        );
                    }
                    self.inseam = self.inseam.max(error);
                }
                girth if girth.is_girth() => self.girth = self.girth.max(error / value),
                _ => {}
            }
        }
        let stature = measures[Measure::Stature];
        if let Some(bmi) = parameters.bmi().filter(|_| !parameters.has_girth()) {
            self.mass = self
                .mass
                .max((built.mass() / (bmi * stature.powi(2)) - 1.0).abs());
        }
        let mesh = built.body().rest();
        let skin = built.body().skin();
        self.unclean += usize::from(!diagnose(mesh).is_clean() || !skin.is_closed());
        self.faces += mesh.num_faces();
        self.sharp_faces += (0..mesh.num_faces())
            .filter(|&face| smallest_angle(mesh, face) < SMALLEST_ANGLE)
            .count();
        let pairs = skin.self_intersections().len();
        if pairs > 0 {
            println!("body {index}: {pairs} intersecting pairs, {parameters:?}");
        }
        self.intersections += pairs;
        self.intersecting_bodies += usize::from(pairs > 0);
        let joints = built.body().skeleton().joints().iter();
        self.joints_outside += joints
            .filter(|joint| !skin.contains(joint.rest_position))
            .count();
        let below = measures[Measure::Inseam] - BELOW_CROTCH;
        let legs = mesh
            .positions()
            .iter()
            .filter(|point| f64::from(point.y) < below);
        let gap = legs
            .map(|point| 2.0 * f64::from(point.x.abs()))
            .fold(f64::MAX, f64::min);
        self.gap = self.gap.min(gap);
    }

    fn print(&self, count: u64) {
        println!(
            "bodies                       {count}, refused {}",
            self.refused
        );
        println!("worst girth                  {:.3} %", 100.0 * self.girth);
        println!("worst stature                {:.2} mm", 1e3 * self.stature);
        println!("worst inseam                 {:.1} mm", 1e3 * self.inseam);
        println!("worst mass (no girth given)  {:.2} %", 100.0 * self.mass);
        println!("not closed or not manifold   {}", self.unclean);
        println!(
            "self-intersections           {} pairs in {} bodies",
            self.intersections, self.intersecting_bodies
        );
        println!(
            "angles below 10 degrees      {:.4} % of faces",
            100.0 * self.sharp_faces as f64 / self.faces as f64
        );
        println!("joints outside               {}", self.joints_outside);
        println!("smallest gap of the thighs   {:.1} mm", 1e3 * self.gap);
        let mut times = self.seconds.clone();
        times.sort_by(f64::total_cmp);
        let (Some(slowest), Some(middle)) = (times.last(), times.get(times.len() / 2)) else {
            return;
        };
        println!(
            "one body                     mean {:.0} ms, median {:.0} ms, p95 {:.0} ms, worst {:.0} ms (body {})",
            1e3 * times.iter().sum::<f64>() / times.len() as f64,
            1e3 * middle,
            1e3 * times[times.len() * 95 / 100],
            1e3 * slowest,
            self.seconds
                .iter()
                .position(|time| time >= slowest)
                .unwrap_or(0)
        );
    }
}

/// The smallest angle of a face, in degrees.
fn smallest_angle(mesh: &TriMesh, face: usize) -> f32 {
    let corners = mesh.corners(face);
    let angle = |i: usize| {
        let (u, v) = (
            corners[(i + 1) % 3] - corners[i],
            corners[(i + 2) % 3] - corners[i],
        );
        u.angle(&v).to_degrees()
    };
    angle(0).min(angle(1)).min(angle(2))
}
