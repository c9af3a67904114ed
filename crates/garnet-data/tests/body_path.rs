//! The way of a body to its target.

#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use garnet_body::{
    poses::{Poser, key_pose},
    shape::{BodyParameters, Measure, ParametricBody},
};
use garnet_drape::BodyPath;
use garnet_mesh::Point3;
use garnet_skin::Method;

/// Rounding of a chain of rotations in `f32`, in metres.
const ROUNDING: f32 = 2e-5;

fn largest_distance(a: &[Point3], b: &[Point3]) -> f32 {
    let distances = a.iter().zip(b).map(|(a, b)| (a - b).norm());
    distances.fold(0.0, f32::max)
}

#[test]
fn a_path_begins_at_rest_and_ends_at_the_pose() {
    let built = common::body();
    let body = built.body();
    let poser = Poser::new(body.skeleton()).unwrap();
    for name in ["reach_high", "squat", "first_arabesque"] {
        let pose = poser.pose(&key_pose(name).unwrap().angles);
        let posed = body.posed(&pose).unwrap();
        let path = BodyPath::to_posed(body, &posed);
        let start = largest_distance(&path.positions(0.0), body.rest().positions());
        assert!(start < ROUNDING, "{name}: {start}");
        let end = largest_distance(&path.positions(1.0), posed.skin().positions());
        assert!(end < ROUNDING, "{name}: {end}");
    }
}

#[test]
fn a_path_to_another_shape_ends_at_that_body_in_its_pose() {
    let built = common::body();
    let tall = BodyParameters::new(0.0)
        .with(Measure::Stature, 1.88)
        .with_bmi(29.0);
    let tall = ParametricBody::build(&tall).unwrap();
    let poser = Poser::new(tall.body().skeleton()).unwrap();
    let pose = poser.pose(&key_pose("warrior_two").unwrap().angles);
    let path = BodyPath::to_shape(built.body(), tall.body(), &pose).unwrap();
    let expected = tall.body().posed_positions(&pose, Method::DualQuaternion);
    let end = largest_distance(&path.positions(1.0), &expected.unwrap());
    assert!(end < ROUNDING, "{end}");
}

const NUM_STEPS: usize = 100;

#[test]
fn a_path_has_no_jumps() {
    let built = common::body();
    let body = built.body();
    let poser = Poser::new(body.skeleton()).unwrap();
    let pose = poser.pose(&key_pose("reach_high").unwrap().angles);
    let path = BodyPath::to_posed(body, &body.posed(&pose).unwrap());
    let mut before = path.positions(0.0);
    for step in 1..=NUM_STEPS {
        let after = path.positions(step as f32 / NUM_STEPS as f32);
        // The hands go 1.4 m in all.
        assert!(largest_distance(&before, &after) < 0.04, "step {step}");
        before = after;
    }
}
