//! Garments of a package on bodies of other topologies.

use std::{fs, path::Path};

use garnet::{
    Point3, Rig, SkinWeights, TriMesh,
    io::{ObjFile, read_rig, write_rig_npz},
};

use crate::fixtures::{Fixture, stderr};
use crate::train::done;

/// A package `net` of the tunic of the demo, and its body `own.obj` with its rig.
fn package() -> (Fixture, Rig) {
    let fixture = Fixture::new();
    let demo = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/demo"));
    for (name, copy) in [("tunic.obj", "tunic.obj"), ("body.rig.npz", "own.rig.npz")] {
        fs::copy(demo.join(name), fixture.path(copy)).unwrap();
    }
    let own = read_rig(fixture.path("own.rig.npz")).unwrap();
    fixture.mesh("own.obj", own.rest.as_ref().unwrap());
    done(
        &fixture,
        "garment from-obj tunic.obj --rest-body own.obj -o net -q",
    );
    (fixture, own)
}

/// [`package`], its body with its vertices in another order as
/// `stranger.obj`, and the same in centimetres as `cm.obj`; each with its rig.
fn prepared() -> Fixture {
    let (fixture, own) = package();
    let stranger = reversed(&own);
    fixture.mesh("stranger.obj", stranger.rest.as_ref().unwrap());
    fixture.moved("stranger.obj", "cm.obj", |point| point * 100.0);
    for name in ["stranger.rig.npz", "cm.rig.npz"] {
        write_rig_npz(fixture.path(name), &stranger).unwrap();
    }
    fixture
}

/// The same body with its last vertex first.
fn reversed(rig: &Rig) -> Rig {
    let mesh = rig.rest.as_ref().unwrap();
    let last = mesh.num_vertices() as u32 - 1;
    let places = mesh.positions().iter().rev().copied().collect();
    let faces = mesh
        .faces()
        .iter()
        .map(|face| face.map(|vertex| last - vertex));
    let joints = rig.skeleton.num_joints();
    let rows = (0..mesh.num_vertices())
        .rev()
        .map(|vertex| rig.weights.vertex(vertex));
    Rig {
        rest: Some(TriMesh::new(places, faces.collect()).unwrap()),
        skeleton: rig.skeleton.clone(),
        weights: SkinWeights::from_influences(joints, rows).unwrap(),
        rest_pose: None,
    }
}

fn distance(a: &[Point3], b: &[Point3]) -> f32 {
    let pairs = a.iter().zip(b);
    pairs.map(|(a, b)| (a - b).norm()).sum::<f32>() / a.len() as f32
}

fn report(fixture: &Fixture, arguments: &str) -> serde_json::Value {
    serde_json::from_str(&done(fixture, arguments)).unwrap()
}

fn places(fixture: &Fixture, name: &str) -> Vec<Point3> {
    let file = ObjFile::read(fixture.path(name)).unwrap();
    file.positions().to_vec()
}

#[test]
fn a_garment_made_for_one_body_is_worn_by_another() {
    let fixture = prepared();
    let own = "drape net --pose warrior_two -o own_drape.obj --report -";
    let stranger = "drape net --rest-body stranger.obj --pose warrior_two -o drape.obj --report -";
    for arguments in [own, stranger] {
        let found = report(&fixture, arguments);
        assert_eq!(found["drapes"][0]["untangle"]["inside"], 0, "{arguments}");
    }
    // The same body is there, but nothing tells so: its points have to be found.
    let found = distance(
        &places(&fixture, "own_drape.obj"),
        &places(&fixture, "drape.obj"),
    );
    println!("{:.2} mm", 1e3 * found);
    assert!(found < 5e-3, "{found}");
}

#[test]
fn a_drape_is_in_the_unit_of_the_body() {
    let fixture = prepared();
    // The rigs are beside the bodies.
    done(&fixture, "drape net stranger.obj -o m.obj -q");
    done(&fixture, "drape net cm.obj -o cm_drape.obj -q");
    let scaled: Vec<Point3> = (places(&fixture, "m.obj").iter())
        .map(|place| place * 100.0)
        .collect();
    assert!(distance(&scaled, &places(&fixture, "cm_drape.obj")) < 0.1);
    // A package is in metres, whatever its own body comes in.
    fixture.moved("own.obj", "own_cm.obj", |point| point * 100.0);
    done(&fixture, "drape net own_cm.obj -o own_drape.obj -q");
    assert!(distance(&scaled, &places(&fixture, "own_drape.obj")) < 0.5);
}

#[test]
fn a_body_that_is_no_figure_is_refused() {
    let (fixture, _) = package();
    let output = fixture.garnet("drape net --rest-body body.obj body.obj -o out.obj");
    assert_eq!(output.status.code(), Some(2));
    let told = stderr(&output);
    assert!(told.contains("cannot bring"), "{told}");
    assert!(!fixture.path("out.obj").exists());
}
