//! Cloth that settles where something else has put it.

#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use std::sync::atomic::AtomicBool;

use garnet_body::poses::{Poser, key_pose};
use garnet_data::{BodyPath, DataError, GarmentPackage, Quality, SETTLE_FRAMES, Teacher};
use garnet_mesh::{Point3, Topology, edge_stretch};
use garnet_sim::Drape;
use garnet_skin::{Garment, PosedBody, Warp};

/// A package, its simulation, and a body that it is warped to.
struct Scene {
    package: GarmentPackage,
    teacher: Teacher,
    posed: PosedBody,
    warped: Vec<Point3>,
}

impl Scene {
    fn new(pose: &str) -> Self {
        let package = common::tshirt();
        let poser = Poser::new(package.body.skeleton()).unwrap();
        let pose = poser.pose(&key_pose(pose).unwrap().angles);
        let posed = package.body.posed(&pose).unwrap();
        let garment = Garment::new(package.mesh.clone())
            .bind(&package.body)
            .unwrap();
        let nodes = garment.warped(&posed, Warp::Shape).unwrap();
        Self {
            teacher: Teacher::new(&package).unwrap(),
            warped: garment.weld().scatter(&nodes),
            posed,
            package,
        }
    }

    fn settled(&self, from: &[Point3], frames: u32) -> Vec<Point3> {
        let stop = AtomicBool::new(false);
        let skin = self.posed.skin().positions();
        self.teacher.settled(skin, from, frames, &stop).unwrap()
    }

    fn simulated(&self, quality: Quality) -> Drape {
        let path = BodyPath::to_posed(&self.package.body, &self.posed);
        let stop = AtomicBool::new(false);
        let drape = self.teacher.drape(&path, quality, &stop, &mut |_| {});
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
fn a_warp_that_settles_is_less_strained_and_nearer_to_the_simulation() {
    let scene = Scene::new("reach_high");
    let simulated = scene.simulated(Quality::Teacher).positions;
    let settled = scene.settled(&scene.warped, 4 * SETTLE_FRAMES);
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
    let settled = scene.settled(&scene.warped, SETTLE_FRAMES);
    assert_ne!(settled, scene.warped);
    assert_eq!(settled, scene.settled(&scene.warped, SETTLE_FRAMES));
}

#[test]
fn settling_can_be_stopped_and_refuses_places_that_are_none() {
    let scene = Scene::new("wave");
    let skin = scene.posed.skin().positions();
    let settled = |from: &[Point3], is_stopped: bool| {
        let stop = AtomicBool::new(is_stopped);
        let settled = scene.teacher.settled(skin, from, SETTLE_FRAMES, &stop);
        settled.unwrap_err()
    };
    assert!(matches!(settled(&scene.warped, true), DataError::Stopped));
    let mut nowhere = scene.warped.clone();
    nowhere[0].x = f32::NAN;
    assert!(matches!(settled(&nowhere, false), DataError::Sim(_)));
}
