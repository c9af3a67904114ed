//! The trained garment that comes with the repository, by the library, as the README says.

use std::{path::Path, sync::atomic::AtomicBool};

use garnet::{
    Draper, Garment, Moment, Network, PackagedGarment, Pose, UnitQuaternion, Vector3, Warped,
    edge_stretch, io,
    package::{BodyPath, GarmentPackage, Settling, Teacher},
};

#[test]
fn the_shirt_settles_from_where_it_arrives_and_is_free() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let folder = models.join("tshirt");
    let package = GarmentPackage::read(&folder).unwrap();
    let variant = package.manifest.variant("arrival").unwrap();
    let weights = package.manifest.weights_of(&folder, "arrival").unwrap();
    let garment = Garment::new(package.mesh.clone())
        .bind(&package.body)
        .unwrap();
    let mut network = Network::load(weights, &garment, &package.body, &[]).unwrap();
    let moment = network.moment();
    assert_eq!(
        (moment, variant.settle_frames),
        (Moment::Arrival, Some(moment.settle_frames()))
    );

    let reach = io::ObjFile::read(models.join("demo/reach.obj")).unwrap();
    let target = package.body.fitted(reach.positions()).unwrap();
    let warped = network.warped(&garment, &target).unwrap();
    let moved = network.moved(&garment, &target, &warped).unwrap();
    assert!(moved.fallback.is_none());
    let from = moved.garment.positions(&garment);
    let teacher = Teacher::new(&package).unwrap();
    let (settling, stop) = (Settling::of(moment), AtomicBool::new(false));
    let settled = teacher
        .settled(&package.body, &target, &from, settling, &stop)
        .unwrap();
    let draper = Draper::new();
    let arrived = Warped::at(&garment, &from);
    let rested = Warped::settled(&garment, &settled, settling);
    let [arrived, rested] =
        [arrived, rested].map(|put| draper.finish(&garment, &target, &put).unwrap());
    let report = rested.report.as_ref().unwrap();
    assert_eq!(report.inside, 0);

    let edges = garnet_mesh::Topology::new(package.mesh.num_vertices(), package.mesh.faces());
    let stretch = |places: &[garnet::Point3]| {
        let rest = package.mesh.positions();
        edge_stretch(rest, places, edges.edges()).unwrap().p99
    };
    let [arrived, rested] = [arrived, rested].map(|drape| stretch(&drape.positions));
    println!("stretch p99 {arrived:.3}, settled {rested:.3}");
    assert!(rested < 1.08 && rested < arrived, "{arrived} {rested}");
}

#[test]
fn the_shirt_goes_on_from_where_it_is_midway() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let folder = models.join("tshirt");
    let package = GarmentPackage::read(&folder).unwrap();
    let weights = package.manifest.weights_of(&folder, "midway").unwrap();
    let garment = Garment::new(package.mesh.clone())
        .bind(&package.body)
        .unwrap();
    let mut network = Network::load(weights, &garment, &package.body, &[]).unwrap();
    let moment = network.moment();
    assert_eq!(moment, Moment::Midway);

    let reach = io::ObjFile::read(models.join("demo/reach.obj")).unwrap();
    let target = package.body.fitted(reach.positions()).unwrap();
    let path = BodyPath::to_posed(&package.body, &target);
    let halfway = path.posed(&package.body, moment.motion_share()).unwrap();
    let warped = network.warped(&garment, &halfway).unwrap();
    let moved = network.moved(&garment, &halfway, &warped).unwrap();
    assert!(moved.fallback.is_none());
    let from = moved.garment.positions(&garment);
    let (teacher, stop) = (Teacher::new(&package).unwrap(), AtomicBool::new(false));
    let settled = teacher
        .settled(&package.body, &target, &from, Settling::of(moment), &stop)
        .unwrap();
    let put = Warped::settled(&garment, &settled, Settling::of(moment));
    let drape = Draper::new().finish(&garment, &target, &put).unwrap();
    assert_eq!(drape.report.as_ref().unwrap().inside, 0);
    let edges = garnet_mesh::Topology::new(package.mesh.num_vertices(), package.mesh.faces());
    let rest = package.mesh.positions();
    let stretch = edge_stretch(rest, &drape.positions, edges.edges()).unwrap();
    assert!(stretch.p99 < 1.08, "{}", stretch.p99);

    let mut packaged = PackagedGarment::open(&folder, None).unwrap();
    let same = packaged.drape(&target).unwrap();
    assert!(same.fallback.is_none() && same.unsettled.is_none());
    assert_eq!(same.drape.positions, drape.positions, "it is the default");
}

#[test]
fn a_packaged_shirt_does_without_its_network_where_that_knows_no_better() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/tshirt");
    let package = GarmentPackage::read(&folder).unwrap();
    let skeleton = package.body.skeleton();
    let mut pose = Pose::rest(skeleton.num_joints());
    // Bent backwards as nobody can.
    for (joint, rotation) in skeleton.joints().iter().zip(&mut pose.rotations) {
        if joint.name.starts_with("spine") {
            *rotation = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -1.2);
        }
    }
    let target = package.body.posed(&pose).unwrap();
    let edges = garnet_mesh::Topology::new(package.mesh.num_vertices(), package.mesh.faces());
    let mut stretch = Vec::new();
    for variant in ["pose-space", "midway"] {
        let mut shirt = PackagedGarment::open(&folder, Some(variant)).unwrap();
        let draped = shirt.drape(&target).unwrap();
        assert!(draped.unsettled.is_none(), "{:?}", draped.unsettled);
        assert!(draped.fallback.is_some(), "{variant}");
        let drape = draped.drape;
        assert_eq!(drape.report.as_ref().unwrap().inside, 0);
        let rest = package.mesh.positions();
        let found = edge_stretch(rest, &drape.positions, edges.edges()).unwrap();
        stretch.push(found.p99);
        if variant == "pose-space" {
            let warped = Draper::new().drape(shirt.garment(), &target).unwrap();
            assert_eq!(drape.positions, warped.positions);
        }
    }
    println!(
        "stretch p99 warped {:.2}, simulated {:.2}",
        stretch[0], stretch[1]
    );
    assert!(stretch[1] < 0.9 * stretch[0], "{stretch:?}");

    let error = PackagedGarment::open(&folder, Some("best")).unwrap_err();
    assert!(error.to_string().contains("`best`"), "{error}");
}

#[test]
fn a_shirt_beside_the_body_is_refused() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/tshirt");
    let package = GarmentPackage::read(&folder).unwrap();
    let shifted = |shift: Vector3| {
        let moved = package.mesh.positions().iter().map(|point| point + shift);
        let mesh = package.mesh.with_positions(moved.collect()).unwrap();
        Garment::new(mesh).bind(&package.body)
    };
    assert!(shifted(Vector3::zeros()).is_ok());
    for way in [
        Vector3::x(),
        -Vector3::x(),
        Vector3::y(),
        Vector3::z(),
        -Vector3::z(),
    ] {
        let found = shifted(way * 0.7);
        assert!(
            matches!(found, Err(garnet::Error::Misplaced(_))),
            "{way} is accepted"
        );
    }
}
