//! Joints go along with a change of shape.

#![allow(clippy::unwrap_used, reason = "tests")]

use garnet_body::shape::{BodyParameters, Measure, ParametricBody};
use garnet_mesh::{Kinship, kinship};
use garnet_skin::{Body, Joint, Point3};

/// Joints that went along are so near to those of the other body in the mean, and at most, in
/// metres.
const MEAN_OFF: f32 = 0.012;
const MOST_OFF: f32 = 0.035;

fn body(sex: f64, stature: f64, bmi: f64) -> Body {
    let parameters = BodyParameters::new(sex).with(Measure::Stature, stature);
    let built = ParametricBody::build(&parameters.with_bmi(bmi)).unwrap();
    built.body().clone()
}

fn distances(a: &Body, b: &Body) -> Vec<f32> {
    let joints = [a, b].map(|body| body.skeleton().joints().iter());
    let [a, b] = joints;
    let apart = |(a, b): (&Joint, &Joint)| (a.rest_position - b.rest_position).norm();
    a.zip(b).map(apart).collect()
}

#[test]
fn joints_go_along_with_another_shape() {
    let rig = body(1.0, 1.60, 21.0);
    for other in [
        body(1.0, 1.75, 21.0),
        body(1.0, 1.60, 34.0),
        body(0.0, 1.92, 29.0),
    ] {
        let reshaped = rig.reshaped(other.rest().positions()).unwrap();
        let off = distances(&reshaped, &other);
        let mean = off.iter().sum::<f32>() / off.len() as f32;
        let most = off.iter().copied().fold(0.0, f32::max);
        assert!(mean < MEAN_OFF && most < MOST_OFF, "{mean} {most} {off:?}");
        assert_eq!(reshaped.rest().positions(), other.rest().positions());
        let before = distances(&rig, &other).into_iter().fold(0.0, f32::max);
        assert!(most < before, "{most} of {before}");
    }
    let same = rig.reshaped(rig.rest().positions()).unwrap();
    assert!(distances(&same, &rig).iter().all(|&off| off < 1e-5));
}

#[test]
fn a_body_with_its_vertices_in_another_order_is_a_stranger() {
    let body = body(1.0, 1.60, 21.0);
    let mesh = body.rest();
    let count = mesh.num_vertices();
    let mixed: Vec<Point3> = (0..count)
        .map(|vertex| mesh.positions()[vertex * 2477 % count])
        .collect();
    let kinships = [
        kinship(mesh.positions(), &mixed, mesh.faces()),
        kinship(&mixed, mesh.positions(), mesh.faces()),
    ];
    assert_eq!(kinships, [Kinship::Stranger; 2]);
}
