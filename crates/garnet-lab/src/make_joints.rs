//! Fits the joints of the built-in body to vertices of its rest mesh, stores the weights in the
//! crate and tells how far they are off on 500 other bodies.

use std::{error::Error, path::PathBuf};

use clap::Args;
use garnet_body::shape::{
    BodyParameters, JOINT_NAMES, Measure, NUM_JOINTS, ParametricBody, Population,
};
use garnet_mesh::Point3;
use nalgebra::{DMatrix, DVector, Vector3};

use crate::Outcome;

/// Bodies that the weights are fitted to, and bodies that they are judged by.
const FITTED: u64 = 300;
const JUDGED: u64 = 500;
const SEEDS: [u64; 2] = [41, 42];

/// Vertices of a combination: so many near the joint, so many all over the half.
const NEAR: usize = 24;
const SPREAD: usize = 48;

/// Ridge, in squared metres a body.
const RIDGE: f64 = 1e-6;

/// A body: vertices and joints at rest.
struct Example {
    positions: Vec<Point3>,
    joints: Vec<Point3>,
}

/// What to make.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The file, `crates/garnet-body/src/shape/joints.bin`.
    path: PathBuf,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let fitted = examples(SEEDS[0], FITTED);
    let judged = examples(SEEDS[1], JUDGED);
    let mirror = mirror_vertices(&fitted[0].positions);
    let mut bytes = Vec::new();
    for (joint, name) in JOINT_NAMES.iter().enumerate() {
        if name.starts_with("right") {
            continue;
        }
        let is_middle = !name.starts_with("left");
        // What is in the middle is a mean of both sides.
        let at = |example: &Example, vertex: usize| -> Vector3<f64> {
            let left = example.positions[vertex].coords.cast();
            if is_middle {
                let right: Vector3<f64> = example.positions[mirror[vertex]].coords.cast();
                0.5 * (left + right)
            } else {
                left
            }
        };
        let vertices = chosen(&fitted[0], joint, mirror.len());
        let weights = solved(&fitted, joint, &vertices, &at)?;
        bytes.extend((vertices.len() as u16).to_le_bytes());
        for (&vertex, weight) in vertices.iter().zip(weights.iter()) {
            bytes.extend((vertex as u16).to_le_bytes());
            bytes.extend((*weight as f32).to_le_bytes());
        }
        let mut errors: Vec<f64> = judged
            .iter()
            .map(|example| {
                let parts = vertices.iter().zip(weights.iter());
                let found: Vector3<f64> = parts.map(|(&v, w)| *w * at(example, v)).sum();
                1e3 * (found - example.joints[joint].coords.cast()).norm()
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        println!(
            "{name:<14} median {:.1} mm, p95 {:.1} mm, worst {:.1} mm",
            errors[errors.len() / 2],
            errors[errors.len() * 95 / 100],
            errors[errors.len() - 1]
        );
    }
    assert_eq!(JOINT_NAMES.len(), NUM_JOINTS);
    std::fs::write(&arguments.path, bytes)?;
    Ok(())
}

/// Bodies of the population, and between them bodies of which little is known.
fn examples(seed: u64, count: u64) -> Vec<Example> {
    let population = Population::new(seed);
    let parameters = |index: u64| {
        let drawn = population.sample(index);
        if index % 3 == 2 {
            let sex = (0.37 * index as f64).fract();
            BodyParameters::new(sex)
                .with(
                    Measure::Stature,
                    drawn.measure(Measure::Stature).unwrap_or(1.7),
                )
                .with_bmi(17.0 + 19.0 * (0.618 * index as f64).fract())
        } else {
            drawn
        }
    };
    let built = (0..count).filter_map(|index| ParametricBody::build(&parameters(index)).ok());
    built
        .map(|built| {
            let body = built.into_body();
            let joints = body.skeleton().joints().iter();
            Example {
                joints: joints.map(|joint| joint.rest_position).collect(),
                positions: body.rest().positions().to_vec(),
            }
        })
        .collect()
}

/// The mirror image of each vertex of the left half, which comes first.
fn mirror_vertices(positions: &[Point3]) -> Vec<usize> {
    let num_middle = positions.iter().take_while(|point| point.x == 0.0).count();
    let num_half = num_middle + (positions.len() - num_middle) / 2;
    (0..num_half)
        .map(|vertex| {
            if vertex < num_middle {
                vertex
            } else {
                vertex + num_half - num_middle
            }
        })
        .collect()
}

/// Vertices near a joint and all over the half, each as far as can be from those before it.
fn chosen(example: &Example, joint: usize, num_half: usize) -> Vec<usize> {
    let center = example.joints[joint];
    let mut near: Vec<usize> = (0..num_half).collect();
    near.sort_by(|&a, &b| {
        let distance = |vertex: usize| (example.positions[vertex] - center).norm();
        distance(a).total_cmp(&distance(b))
    });
    let mut chosen = spread(example, &near[..8 * NEAR], NEAR);
    let all = spread(example, &(0..num_half).collect::<Vec<_>>(), SPREAD);
    chosen.extend(all);
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

fn spread(example: &Example, among: &[usize], count: usize) -> Vec<usize> {
    let mut chosen = vec![among[0]];
    let mut distances = vec![f32::MAX; among.len()];
    while chosen.len() < count {
        let last = example.positions[chosen[chosen.len() - 1]];
        for (distance, &vertex) in distances.iter_mut().zip(among) {
            *distance = distance.min((example.positions[vertex] - last).norm());
        }
        let farthest = (0..among.len()).max_by(|&a, &b| distances[a].total_cmp(&distances[b]));
        chosen.push(among[farthest.unwrap_or(0)]);
    }
    chosen
}

/// Weights that sum to one: those of the offsets from the mean of the vertices.
fn solved(
    examples: &[Example],
    joint: usize,
    vertices: &[usize],
    at: &dyn Fn(&Example, usize) -> Vector3<f64>,
) -> Result<DVector<f64>, Box<dyn Error>> {
    let count = vertices.len();
    let share = 1.0 / count as f64;
    let mut normal = DMatrix::<f64>::zeros(count, count);
    let mut right = DVector::<f64>::zeros(count);
    for example in examples {
        let points: Vec<Vector3<f64>> = vertices.iter().map(|&v| at(example, v)).collect();
        let mean: Vector3<f64> = share * points.iter().sum::<Vector3<f64>>();
        let offset = example.joints[joint].coords.cast::<f64>() - mean;
        let offsets: Vec<Vector3<f64>> = points.iter().map(|point| point - mean).collect();
        for a in 0..count {
            right[a] += offsets[a].dot(&offset);
            for b in 0..count {
                normal[(a, b)] += offsets[a].dot(&offsets[b]);
            }
        }
    }
    for a in 0..count {
        normal[(a, a)] += RIDGE * examples.len() as f64;
    }
    let weights = normal
        .cholesky()
        .ok_or("the examples do not determine the joint")?
        .solve(&right);
    // Σ w (v - mean) + mean as one combination.
    let rest = share * (1.0 - weights.sum());
    Ok(weights.map(|weight| weight + rest))
}
