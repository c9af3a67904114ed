//! The demo files are those that `make-demo` writes, and drape well.

use garnet::Garment;
use garnet::io::{ObjFile, read_body, read_pose};
use garnet_tests::Judge;
use garnet_tests::demo::Demo;

use crate::held::{Bars, held};

#[test]
fn committed_files_are_those_that_the_generator_writes() {
    let demo = Demo::new();
    let folder = Demo::folder();
    for (name, text) in [
        ("body.obj", &demo.body_obj),
        ("tunic.obj", &demo.tunic_obj),
        ("reach.json", &demo.reach_json),
    ] {
        let committed = std::fs::read_to_string(folder.join(name)).unwrap();
        assert!(
            &committed == text,
            "{name} is old: cargo run -p garnet-tests --bin make-demo"
        );
    }
    // The archive may be packed in other ways; what is in it may not differ.
    let rig = read_body(folder.join("body.rig.npz")).unwrap();
    assert_eq!(rig.rest(), demo.body.rest());
    assert_eq!(rig.skeleton(), demo.body.skeleton());
    // Weights are scaled to sum 1 once more when they are read.
    let weights = [rig.weights(), demo.body.weights()].map(garnet::SkinWeights::to_dense);
    assert_eq!(weights[0].len(), weights[1].len());
    for (read, generated) in weights[0].iter().zip(&weights[1]) {
        assert!(
            (read - generated).abs() <= crate::held::ROUNDING,
            "{read} {generated}"
        );
    }
}

#[test]
fn the_demo_drapes_well() {
    let folder = Demo::folder();
    let file = ObjFile::read(folder.join("tunic.obj")).unwrap();
    let body = read_body(folder.join("body.rig.npz")).unwrap();
    let pose = read_pose(folder.join("reach.json"), None, body.skeleton()).unwrap();
    let mesh = file.mesh().unwrap();
    let judge = Judge::new(&mesh).with_edges(file.polygon_edges());
    let bound = Garment::new(mesh).bind(&body).unwrap();
    held(
        "demo",
        &judge,
        &bound,
        &body.posed(&pose).unwrap(),
        Bars::default(),
    );
}
