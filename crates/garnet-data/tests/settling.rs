//! Cloth that settles where something else has put it.

#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use std::sync::atomic::AtomicBool;

use garnet_body::poses::{Poser, key_pose};
use garnet_drape::{BodyPath, GarmentPackage, Moment, PackageError, Quality, Settling, Simulator};
use garnet_mesh::{Point3, Topology, edge_stretch};
use garnet_sim::{Drape, Event};
use garnet_skin::{Garment, PosedBody, Warp};

const FRAMES: u32 = Moment::Rest.settle_frames();

/// A package, its simulation, and a body that it is warped to.
struct Scene {
    package: GarmentPackage,
    simulator: Simulator,
    posed: PosedBody,
    warped: Vec<Point3>,
}

impl Scene {
    fn new(pose: &str) -> Self {
        Self::of(common::tshirt(), pose)
    }

    fn of(package: GarmentPackage, pose: &str) -> Self {
        let poser = Poser::new(package.body.skeleton()).unwrap();
        let pose = poser.pose(&key_pose(pose).unwrap().angles);
        let posed = package.body.posed(&pose).unwrap();
        let garment = Garment::new(package.mesh.clone())
            .bind(&package.body)
            .unwrap();
        let nodes = garment.warped_nodes(&posed, Warp::Shape).unwrap();
        Self {
            simulator: Simulator::new(&package).unwrap(),
            warped: garment.weld().scatter(&nodes),
            posed,
            package,
        }
    }

    fn settled(&self, from: &[Point3], frames: u32) -> Vec<Point3> {
        self.settled_from(from, Moment::Rest, frames)
    }

    fn settled_from(&self, from: &[Point3], moment: Moment, frames: u32) -> Vec<Point3> {
        let stop = AtomicBool::new(false);
        let body = &self.package.body;
        let settling = Settling {
            frames,
            ..Settling::of(moment)
        };
        self.simulator
            .settled(body, &self.posed, from, settling, &stop)
            .unwrap()
    }

    fn simulated(&self, quality: Quality) -> Drape {
        let path = BodyPath::to_posed(&self.package.body, &self.posed);
        let stop = AtomicBool::new(false);
        let drape = self.simulator.drape(&path, quality, &stop, &mut |_| {});
        drape.unwrap()
    }

    /// The 99th percentile of edge lengths over those at rest.
    fn stretch(&self, places: &[Point3]) -> f32 {
        let mesh = &self.package.mesh;
        let topology = Topology::new(mesh.num_vertices(), mesh.faces());
        let stretch = edge_stretch(mesh.positions(), places, topology.edges()).unwrap();
        stretch.p99
    }
}

fn mean_distance(a: &[Point3], b: &[Point3]) -> f32 {
    let distances = a.iter().zip(b).map(|(a, b)| (a - b).norm());
    distances.sum::<f32>() / a.len() as f32
}

#[test]
fn the_fast_quality_ends_near_the_teachers() {
    // Coarser T-shirts find other folds for any change.
    let scene = Scene::of(common::tshirt_of(2000), "wave");
    let [teacher, fast] = [Quality::Teacher, Quality::Fast].map(|quality| scene.simulated(quality));
    let moved = mean_distance(&scene.warped, &teacher.positions);
    let missed = mean_distance(&fast.positions, &teacher.positions);
    println!("{:.1} mm, the warp {:.1} mm", 1e3 * missed, 1e3 * moved);
    assert!(missed < 0.005 && missed < 0.25 * moved, "{missed} {moved}");
    assert_eq!(fast.report.penetration.num_inside, 0);
    let [taught, hurried] = [teacher, fast].map(|drape| drape.report.strain.p99);
    assert!(hurried < 1.2 * taught, "{hurried} {taught}");
}

#[test]
fn a_warp_that_settles_is_less_strained_and_nearer_to_the_simulation() {
    let scene = Scene::new("reach_high");
    let simulated = scene.simulated(Quality::Teacher).positions;
    let settled = scene.settled(&scene.warped, 4 * FRAMES);
    let [before, after] = [&scene.warped, &settled].map(|places| scene.stretch(places));
    assert!(after - 1.0 < 0.5 * (before - 1.0), "{before} {after}");
    let [before, after] = [&scene.warped, &settled].map(|drape| mean_distance(drape, &simulated));
    assert!(after < 0.8 * before, "{before} {after}");
}

#[test]
fn the_teacher_ends_near_the_balance_that_the_reference_solver_finds() {
    for pose in ["wave", "reach_front"] {
        let scene = Scene::new(pose);
        let taught = scene.simulated(Quality::Teacher);
        let balanced = scene.simulated(Quality::Reference);
        let balance = balanced.report.balance.unwrap();
        assert!(balance.settled.is_settled, "{pose}: {balance:?}");
        assert!(balance.settled.residual <= 0.01, "{pose}: {balance:?}");
        assert_eq!(balanced.report.penetration.num_inside, 0, "{pose}");
        let distance = mean_distance(&taught.positions, &balanced.positions);
        assert!(distance < 8e-3, "{pose}: {distance}");
    }
}

#[test]
fn no_frames_leave_cloth_where_it_is_and_the_same_frames_give_the_same_bits() {
    let scene = Scene::new("wave");
    assert_eq!(scene.settled(&scene.warped, 0), scene.warped);
    let settled = scene.settled(&scene.warped, FRAMES);
    assert_ne!(settled, scene.warped);
    assert_eq!(settled, scene.settled(&scene.warped, FRAMES));
}

#[test]
fn cloth_put_where_it_arrives_finds_the_folds_of_the_teacher() {
    let scene = Scene::new("reach_high");
    let path = BodyPath::to_posed(&scene.package.body, &scene.posed);
    let stop = AtomicBool::new(false);
    let mut frames: Vec<Vec<Point3>> = Vec::new();
    let mut watch = |event: Event<'_>| {
        if let Event::Frame { positions, .. } = event {
            frames.push(scene.simulator.vertices(positions));
        }
    };
    let simulated = (scene.simulator)
        .drape(&path, Quality::Teacher, &stop, &mut watch)
        .unwrap();
    // The end of the motion, but for vertices that were inside.
    let same = |frame: &Vec<Point3>| {
        let pairs = frame.iter().zip(&simulated.arrived);
        pairs.filter(|(a, b)| a == b).count() as f64 / frame.len() as f64
    };
    assert!(same(&frames[59]) > 0.95, "{}", same(&frames[59]));
    assert!(same(&frames[61]) < 0.5, "{}", same(&frames[61]));

    let moment = Moment::Arrival;
    let settled = scene.settled_from(&simulated.arrived, moment, moment.settle_frames());
    let before = mean_distance(&simulated.arrived, &simulated.positions);
    let after = mean_distance(&settled, &simulated.positions);
    assert!(after < 0.5 * before, "{before} {after}");
    let briefly = scene.settled(&simulated.arrived, FRAMES);
    let briefly = mean_distance(&briefly, &simulated.positions);
    assert!(after < 0.7 * briefly, "{briefly} {after}");
}

#[test]
fn cloth_put_where_it_is_midway_goes_on_with_the_body_into_the_folds_of_the_teacher() {
    // Coarser T-shirts find other folds for any change.
    let scene = Scene::of(common::tshirt_of(2000), "wave");
    let simulated = scene.simulated(Quality::Teacher);
    let frames = Moment::Midway.settle_frames();
    let resumed = |frames: u32| scene.settled_from(&simulated.midway, Moment::Midway, frames);
    let end = resumed(frames);
    assert_eq!(end, resumed(frames));
    let midway = mean_distance(&simulated.midway, &simulated.positions);
    let missed = mean_distance(&end, &simulated.positions);
    assert!(missed < 0.006 && missed < 0.1 * midway, "{missed} {midway}");
    let stopped = scene.simulator.settled(
        &scene.package.body,
        &scene.posed,
        &end,
        Settling::of(Moment::Midway),
        &AtomicBool::new(true),
    );
    assert!(matches!(stopped, Err(PackageError::Stopped)));
    assert_ne!(resumed(0), end);
}

#[test]
fn settling_can_be_stopped_and_refuses_places_that_are_none() {
    let scene = Scene::new("wave");
    let settled = |from: &[Point3], is_stopped: bool| {
        let stop = AtomicBool::new(is_stopped);
        let (body, settling) = (&scene.package.body, Settling::of(Moment::Rest));
        let simulator = &scene.simulator;
        let settled = simulator.settled(body, &scene.posed, from, settling, &stop);
        settled.unwrap_err()
    };
    assert!(matches!(
        settled(&scene.warped, true),
        PackageError::Stopped
    ));
    let mut nowhere = scene.warped.clone();
    nowhere[0].x = f32::NAN;
    assert!(matches!(settled(&nowhere, false), PackageError::Sim(_)));
}
