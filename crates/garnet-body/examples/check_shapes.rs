//! Measures the built-in bodies against their bars, over many random parameter sets.
//!
//! ```text
//! cargo run --release -p garnet-body --example check_shapes -- 500 all    every measure is given
//! cargo run --release -p garnet-body --example check_shapes -- 500 bmi    stature and body mass index alone
//! cargo run --release -p garnet-body --example check_shapes -- 500 some   stature and a few girths
//! ```
#![expect(clippy::print_stdout, reason = "the program prints what it measures")]

use std::time::Instant;

use garnet_body::shape::{BodyParameters, Measure, ParametricBody, Population};
use garnet_mesh::{TriMesh, diagnose};

const SEED: u64 = 11;
/// The gap between the thighs is taken this far below the crotch, in metres.
const BELOW_CROTCH: f64 = 0.03;
const SMALLEST_ANGLE: f32 = 10.0;

/// The worst of everything, and counts.
#[derive(Debug, Default)]
struct Worst {
    refused: usize,
    girth: f64,
    stature: f64,
    inseam: f64,
    mass: f64,
    seconds: f64,
    total_seconds: f64,
    gap: f64,
    unclean: usize,
    sharp_faces: usize,
    faces: usize,
    intersecting_bodies: usize,
    intersections: usize,
    joints_outside: usize,
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let count: u64 = arguments
        .next()
        .and_then(|word| word.parse().ok())
        .unwrap_or(100);
    let mode = arguments.next().unwrap_or_else(|| "all".to_owned());
    let population = Population::new(SEED);
    let mut worst = Worst {
        gap: f64::MAX,
        ..Worst::default()
    };
    for index in 0..count {
        if std::env::var("ONLY").is_ok_and(|o| !o.split(',').any(|n| n == index.to_string())) {
            continue;
        }
        let parameters = chosen(&population.sample(index), &mode, index, count);
        let start = Instant::now();
        match ParametricBody::build(&parameters) {
            Ok(built) => {
                let seconds = start.elapsed().as_secs_f64();
                worst.seconds = worst.seconds.max(seconds);
                worst.total_seconds += seconds;
                worst.add(index, &parameters, &built);
            }
            Err(error) => {
                worst.refused += 1;
                println!("body {index}: {error}");
            }
        }
    }
    worst.print(count);
}

/// What is kept of a random body's parameters.
fn chosen(full: &BodyParameters, mode: &str, index: u64, count: u64) -> BodyParameters {
    let stature = full.measure(Measure::Stature).unwrap_or(1.7);
    match mode {
        "bmi" => {
            let sex = (7.0 * index as f64 / count as f64).fract();
            let bmi = 17.0 + 19.0 * (0.618 * index as f64).fract();
            BodyParameters::new(sex)
                .with(Measure::Stature, stature)
                .with_bmi(bmi)
        }
        "some" => {
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
        _ => full.clone(),
    }
}

impl Worst {
    fn add(&mut self, index: u64, parameters: &BodyParameters, built: &ParametricBody) {
        let measures = built.measures();
        for (measure, value) in parameters.given() {
            let error = (measures[measure] - value).abs();
            match measure {
                Measure::Stature => self.stature = self.stature.max(error),
                Measure::Inseam => self.inseam = self.inseam.max(error),
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
        println!(
            "one body                     mean {:.0} ms, worst {:.0} ms",
            1e3 * self.total_seconds / count as f64,
            1e3 * self.seconds
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
