//! The machinery learns: a small network comes to know a few scenes by heart.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use burn::optim::{AdamConfig, GradientsParams};
use burn::tensor::{Device, TensorData};
use garnet_mesh::primitives::{icosphere, tube};
use garnet_mesh::{Point3, TriMesh, Vector3, vertex_normals};
use garnet_net::losses::{LossBody, LossConfig, LossTarget, Losses};
use garnet_net::{
    BodySampling, Frame, GarNet, GarNetConfig, GarmentGraph, Predictor, Scene, SceneInput, Variant,
    surrogate,
};
use nalgebra::{Isometry3, UnitQuaternion};

/// A scene as the teacher would give it.
struct Example {
    warped: Vec<Point3>,
    draped: Vec<Point3>,
    body: TriMesh,
    rotations: Vec<UnitQuaternion<f32>>,
}

struct School {
    config: GarNetConfig,
    garment: GarmentGraph,
    sampling: BodySampling,
    losses: Losses,
    examples: Vec<Example>,
}

impl School {
    fn new(config: GarNetConfig, loss: &LossConfig, num_examples: usize) -> Self {
        let template = tube(0.2, 0.4, 12, 8);
        let garment = GarmentGraph::new(&template, &[]).unwrap();
        let config = garment.configured(config);
        let rest_body = icosphere(2, 0.18);
        Self {
            sampling: BodySampling::new(rest_body.positions(), None, &config.pooling).unwrap(),
            losses: Losses::new(&template, loss).unwrap(),
            examples: (0..num_examples)
                .map(|number| example(&template, number as f32))
                .collect(),
            garment,
            config,
        }
    }

    fn scene(&self, example: &Example) -> Scene {
        let normals = vertex_normals(example.body.positions(), example.body.faces());
        let input = input(example, &normals);
        Scene::new(&self.config, &self.garment, &self.sampling, &input).unwrap()
    }

    /// Trains for some rounds; gives the network and the loss of each round.
    fn train(&self, rounds: usize) -> (GarNet, Vec<f64>) {
        let device = Device::flex().autodiff();
        let mut net = self.config.init(11, &device).unwrap();
        let mut adam = AdamConfig::new().init();
        let prepared: Vec<(Scene, LossTarget, LossBody)> = (self.examples.iter())
            .map(|example| {
                let target = self.losses.target(&example.draped).unwrap();
                let body = LossBody::new(&example.body).unwrap();
                (self.scene(example), target, body)
            })
            .collect();
        let mut totals = Vec::new();
        for round in 0..rounds {
            let mut total = 0.0;
            for (scene, target, body) in &prepared {
                let output = net.forward(&self.garment, &self.sampling, scene, &device);
                let translations: Vec<f32> = output.to_data().try_into_vec().unwrap();
                let predicted = scene.moved(&translations).unwrap();
                let report = self.losses.evaluate(&predicted, target, body).unwrap();
                total += report.total();
                let gradient = scene.pulled_back(&report.gradient);
                let gradients = surrogate(output, gradient).backward();
                let gradients = GradientsParams::from_grads(gradients, &net);
                // Half a cosine: at a constant rate the last millimetres are noise of the steps.
                let progress = (round as f64 + 0.5) / rounds as f64;
                let rate = 7e-3 * f64::midpoint(1.0, (std::f64::consts::PI * progress).cos());
                net = adam.step(rate, net, gradients);
            }
            totals.push(total / prepared.len() as f64);
        }
        (net, totals)
    }

    /// Mean vertex distance over the examples, in metres: of the network and of the warp.
    fn errors(&self, net: GarNet) -> [f32; 2] {
        let sampling = self.sampling.clone();
        let predictor = Predictor::new(net, self.garment.clone(), sampling).unwrap();
        let mut sums = [0.0; 2];
        for example in &self.examples {
            let normals = vertex_normals(example.body.positions(), example.body.faces());
            let predicted = predictor.predict(&input(example, &normals)).unwrap();
            for (sum, places) in sums.iter_mut().zip([&predicted, &example.warped]) {
                let error = garnet_mesh::distance_error(&example.draped, places).unwrap();
                *sum += error.mean as f32 / self.examples.len() as f32;
            }
        }
        sums
    }
}

fn input<'a>(example: &'a Example, normals: &'a [Vector3]) -> SceneInput<'a> {
    SceneInput {
        warped: &example.warped,
        body: example.body.positions(),
        body_normals: normals,
        world_from_root: Isometry3::identity(),
        rotations: &example.rotations,
        parameters: &[],
    }
}

/// The garment is turned more and more with its height; the drape hangs off by folds that depend
/// on the size of the body.
fn example(template: &TriMesh, number: f32) -> Example {
    let size = 1.0 + 0.04 * number;
    let turn = |place: &Point3| {
        let angle = 0.3 * number * place.y;
        UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angle)
    };
    let rotations: Vec<_> = template.positions().iter().map(turn).collect();
    let placed = template.positions().iter().zip(&rotations);
    let warped: Vec<Point3> = placed
        .clone()
        .map(|(place, turn)| turn * place * size)
        .collect();
    let fold = |place: &Point3| {
        let outward = Vector3::new(place.x, 0.0, place.z) / 0.2;
        let depth = 0.01 * (12.0 * place.y + 3.0 * place.x / 0.2 + number).sin();
        outward * depth + Vector3::new(0.0, -0.01 * size, 0.0)
    };
    Example {
        draped: (placed.zip(&warped))
            .map(|((place, turn), warped)| warped + turn * fold(place))
            .collect(),
        warped,
        body: icosphere(2, 0.18 * size),
        rotations,
    }
}

#[test]
fn a_tiny_network_learns_eight_scenes_by_heart() {
    let mut config = GarNetConfig::preset("tiny").unwrap();
    config.fusion = vec![64, 64];
    let school = School::new(config, &LossConfig::paper(), 8);
    // The folds of a scene are told apart only after some thousand steps.
    let rounds = 600;
    let (net, totals) = school.train(rounds);
    let [error, of_warp] = school.errors(net);
    println!("loss {:.2e} to {:.2e}", totals[0], totals[rounds - 1]);
    println!(
        "error {:.2} mm, of the warp {:.2} mm",
        error * 1e3,
        of_warp * 1e3
    );
    assert!(error < 1e-3 && error < 0.1 * of_warp);
}

#[test]
fn every_variant_learns_something() {
    for variant in [Variant::Naive, Variant::Global, Variant::Local] {
        let mut config = GarNetConfig::preset("tiny")
            .unwrap()
            .with_variant(variant, 0);
        config.frame = Frame::Root;
        let loss = LossConfig::fine_tune_rq();
        let school = School::new(config, &loss, 2);
        let (net, totals) = school.train(25);
        assert!(totals[24] < 0.7 * totals[0], "{variant:?}: {totals:?}");
        let [error, of_warp] = school.errors(net);
        assert!(error < of_warp, "{variant:?}: {error} and {of_warp}");
    }
}

#[test]
fn two_trainings_from_one_seed_are_one() {
    let config = GarNetConfig::preset("tiny").unwrap();
    let school = School::new(config, &LossConfig::paper(), 2);
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(count)
            .build()
            .unwrap();
        pool.install(|| school.train(4).1)
    };
    let once = with_threads(1);
    assert_eq!(once, with_threads(1));
    assert_eq!(once, with_threads(2));
}

#[test]
fn derivatives_of_the_whole_network_agree_with_differences() {
    let mut config = GarNetConfig::preset("tiny").unwrap();
    config.garment.blocks = vec![16];
    let school = School::new(config, &LossConfig::paper(), 1);
    let (net, _) = school.train(3);
    let device = Device::flex().autodiff();
    let scene = school.scene(&school.examples[0]);
    let weights: Vec<f32> = (0..3 * scene.num_vertices())
        .map(|number| (number as f32 * 0.7).sin())
        .collect();
    let value = |net: &GarNet| -> f64 {
        let output = net.forward(&school.garment, &school.sampling, &scene, &device);
        let output: Vec<f32> = output.to_data().try_into_vec().unwrap();
        output
            .iter()
            .zip(&weights)
            .map(|(a, b)| f64::from(a * b))
            .sum()
    };
    let output = net.forward(&school.garment, &school.sampling, &scene, &device);
    let gradients = surrogate(output, weights.clone()).backward();
    let mut gradients = GradientsParams::from_grads(gradients, &net);
    // A step along the derivative changes the value by the squared length of the derivative.
    let mut squared = 0.0;
    let mut walker = Walker {
        gradients: &mut gradients,
        squared: &mut squared,
        step: 0.0,
        device: &device,
    };
    let _ = walk(net.clone(), &mut walker);
    let step = 1e-3 / squared.sqrt();
    let moved = |sign: f64| {
        let output = net.forward(&school.garment, &school.sampling, &scene, &device);
        let gradients = surrogate(output, weights.clone()).backward();
        let mut gradients = GradientsParams::from_grads(gradients, &net);
        let mut unused = 0.0;
        let mut walker = Walker {
            gradients: &mut gradients,
            squared: &mut unused,
            step: sign * step,
            device: &device,
        };
        value(&walk(net.clone(), &mut walker))
    };
    let slope = (moved(1.0) - moved(-1.0)) / (2.0 * step);
    assert!(
        (slope / squared - 1.0).abs() < 2e-2,
        "{slope} and {squared}"
    );
}

/// Moves all weights along their derivatives.
struct Walker<'a> {
    gradients: &'a mut GradientsParams,
    squared: &'a mut f64,
    step: f64,
    device: &'a Device,
}

fn walk(net: GarNet, walker: &mut Walker<'_>) -> GarNet {
    use burn::module::Module;
    net.map(walker)
}

impl burn::module::ModuleMapper for Walker<'_> {
    fn map_float<const D: usize>(
        &mut self,
        param: burn::module::Param<burn::tensor::Tensor<D>>,
    ) -> burn::module::Param<burn::tensor::Tensor<D>> {
        let Some(gradient) = self.gradients.remove::<D>(param.id) else {
            return param;
        };
        let shape = gradient.dims();
        let gradient: Vec<f32> = gradient.into_data().try_into_vec().unwrap();
        *self.squared += gradient
            .iter()
            .map(|value| f64::from(value * value))
            .sum::<f64>();
        let (step, device) = (self.step as f32, self.device);
        param.map(|tensor| {
            let numbers: Vec<f32> = tensor.into_data().try_into_vec().unwrap();
            let moved = numbers.iter().zip(&gradient).map(|(a, b)| a + step * b);
            let data = TensorData::new(moved.collect::<Vec<f32>>(), shape);
            burn::tensor::Tensor::from_data(data, device).require_grad()
        })
    }
}
