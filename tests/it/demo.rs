//! The demo files are those that `make-demo` writes, and drape well.

use garnet::io::{ObjFile, empty_sleeves, read_body};
use garnet::{Garment, Point3};
use garnet_tests::Judge;
use garnet_tests::demo::Demo;

use crate::held::{Bars, held};

/// The body is made with functions that other machines round otherwise, in metres.
const ROUNDING: f32 = 1e-4;

#[test]
fn committed_files_are_those_that_the_generator_writes() {
    let demo = Demo::new().unwrap();
    let folder = Demo::folder();
    for (name, text) in [("reach", &demo.reach_obj), ("tunic", &demo.tunic_obj)] {
        let committed = ObjFile::read(folder.join(format!("{name}.obj"))).unwrap();
        let generated = ObjFile::parse(text.clone().into_bytes(), name).unwrap();
        assert_eq!(committed.triangles(), generated.triangles(), "{name}");
        for (a, b) in committed.positions().iter().zip(generated.positions()) {
            let is_same = (a - b).norm() < ROUNDING;
            assert!(
                is_same,
                "{name} is old: cargo run -p garnet-lab -- make-demo"
            );
        }
    }
    let rig = read_body(folder.join("body.rig.npz")).unwrap();
    assert_eq!(rig.rest().faces(), demo.body.rest().faces());
    for (a, b) in rig
        .rest()
        .positions()
        .iter()
        .zip(demo.body.rest().positions())
    {
        assert!((a - b).norm() < ROUNDING, "body.rig.npz is old");
    }
}

#[test]
fn the_demo_drapes_well() {
    let folder = Demo::folder();
    let file = ObjFile::read(folder.join("tunic.obj")).unwrap();
    let body = read_body(folder.join("body.rig.npz")).unwrap();
    let mesh = file.mesh().unwrap();
    let judge = Judge::new(&mesh).with_edges(file.polygon_edges());
    let bound = Garment::new(mesh).bind(&body).unwrap();
    for (name, places) in Demo::new().unwrap().posed().unwrap() {
        let posed = body.fitted(&places).unwrap();
        held(name, &judge, &bound, &posed, Bars::default());
    }
}

#[test]
fn a_sleeve_that_stands_off_beside_its_arm_is_named() {
    let folder = Demo::folder();
    let mesh = ObjFile::read(folder.join("tunic.obj"))
        .unwrap()
        .mesh()
        .unwrap();
    let body = read_body(folder.join("body.rig.npz")).unwrap();
    assert_eq!(empty_sleeves(&mesh, &body), []);
    let joints = body.skeleton().joints();
    let shoulder = joints[body.skeleton().find("left_shoulder").unwrap()].rest_position;
    // The left sleeve is raised, beyond the shoulder.
    let raised = mesh.positions().iter().map(|place| {
        let angle = ((place.x - shoulder.x - 0.04) / 0.06).clamp(0.0, 1.0);
        let (sine, cosine) = (1.1 * angle).sin_cos();
        let [x, y] = [place.x - shoulder.x, place.y - shoulder.y];
        let [x, y] = [cosine * x - sine * y, sine * x + cosine * y];
        Point3::new(shoulder.x + x, shoulder.y + y, place.z)
    });
    let raised = mesh.with_positions(raised.collect()).unwrap();
    let found = empty_sleeves(&raised, &body);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].center.x > shoulder.x + 0.1, "{found:?}");
    assert!(joints[found[0].joint].name.starts_with("left_"));
}
