//! The trained garment that comes with the repository, by the library, as the README says.

use std::path::{Path, PathBuf};

use garnet::{
    DrapeOptions, Draper, Package, Point3, Pose, PosedBody, UnitQuaternion, Vector3, io,
    mesh::edge_stretch,
    net::Unfamiliar,
    package::{Limit, Moment},
};

/// What one edge in a hundred may be, over its length at rest, before a drape is given up.
const TORN: f32 = 1.25 * garnet_knn::TORN_STRETCH;

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models")
}

fn shirt() -> Package {
    Package::open(models().join("tshirt")).unwrap()
}

fn reach(shirt: &Package) -> PosedBody {
    let reach = io::ObjFile::read(models().join("demo/reach.obj")).unwrap();
    shirt.body().fitted(reach.positions()).unwrap()
}

/// What 1 % of the edges exceed, over their length at rest.
fn stretch(shirt: &Package, positions: &[Point3]) -> f32 {
    let mesh = shirt.garment().mesh();
    let edges = garnet_mesh::Topology::new(mesh.num_vertices(), mesh.faces());
    let found = edge_stretch(mesh.positions(), positions, edges.edges());
    found.unwrap().p99
}

#[test]
fn the_shirt_settles_from_where_it_arrives_and_is_free() {
    let shirt = shirt();
    let target = reach(&shirt);
    let draper = shirt.draper("arrival").unwrap();
    let rested = draper.drape(&target).unwrap();
    assert_eq!(rested.provenance.predicted, Some(Moment::Arrival));
    assert_eq!(rested.provenance.relaxed_from, Some(Moment::Arrival));
    assert_eq!(rested.report.as_ref().unwrap().inside, 0);
    let options = DrapeOptions::default().with_relax_frames(0);
    let arrived = draper.with_options(options).drape(&target).unwrap();
    assert_eq!(arrived.provenance.relaxed_from, None);
    let [arrived, rested] = [arrived, rested].map(|drape| stretch(&shirt, &drape.positions));
    println!("stretch p99 {arrived:.3}, settled {rested:.3}");
    assert!(rested < 1.08 && rested < arrived, "{arrived} {rested}");
}

#[test]
fn the_shirt_goes_on_from_where_it_is_midway() {
    let shirt = shirt();
    let target = reach(&shirt);
    let drape = shirt.draper("midway").unwrap().drape(&target).unwrap();
    let provenance = &drape.provenance;
    assert_eq!(provenance.predicted, Some(Moment::Midway));
    assert!(provenance.fallback.is_none() && provenance.unrelaxed.is_none());
    assert_eq!(drape.report.as_ref().unwrap().inside, 0);
    let found = stretch(&shirt, &drape.positions);
    assert!(found < 1.08, "{found}");
    let same = shirt.default_draper().unwrap().drape(&target).unwrap();
    assert_eq!(same.positions, drape.positions, "it is the default");
}

#[test]
fn threads_share_a_draper_and_drape_as_one_does() {
    let shirt = shirt();
    let target = reach(&shirt);
    for variant in ["fast", "local"] {
        let draper = shirt.draper(variant).unwrap();
        let alone = draper.drape(&target).unwrap().positions;
        let together = std::thread::scope(|scope| {
            let threads = [(); 2].map(|()| scope.spawn(|| draper.drape(&target).unwrap()));
            threads.map(|thread| thread.join().unwrap().positions)
        });
        assert!(together.iter().all(|found| *found == alone), "{variant}");
    }
}

#[test]
fn a_packaged_shirt_takes_what_its_network_knows_of_the_nearest_body_where_it_knows_no_better() {
    let shirt = shirt();
    let skeleton = shirt.body().skeleton();
    let mut pose = Pose::rest(skeleton.num_joints());
    // Bent backwards as nobody can.
    for (joint, rotation) in skeleton.joints().iter().zip(&mut pose.rotations) {
        if joint.name.starts_with("spine") {
            *rotation = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -1.2);
        }
    }
    let target = shirt.body().posed(&pose).unwrap();
    let mut found = Vec::new();
    for variant in ["falling", "midway"] {
        let drape = shirt.draper(variant).unwrap().drape(&target).unwrap();
        let provenance = &drape.provenance;
        let unrelaxed = &provenance.unrelaxed;
        assert!(unrelaxed.is_none(), "{unrelaxed:?}");
        assert!(provenance.fallback.is_none(), "{variant}: {provenance:?}");
        let beyond = provenance.beyond.as_ref();
        assert!(
            matches!(beyond, Some(Unfamiliar::Pose { joint, .. }) if joint.starts_with("spine")),
            "{variant}: {beyond:?}"
        );
        assert_eq!(drape.report.as_ref().unwrap().inside, 0);
        found.push(stretch(&shirt, &drape.positions));
    }
    let warped = Draper::new(shirt.garment().clone()).drape(&target).unwrap();
    let warped = stretch(&shirt, &warped.positions);
    println!("stretch p99 warped {warped:.2}, by networks {found:.2?}");
    // What is not settled keeps the strain of the warp, and what the network adds to it: less than
    // what counts as torn.
    assert!(found[1] < 0.9 * warped && found[0] < TORN, "{found:?}");

    let error = shirt.draper("best").unwrap_err();
    assert!(error.to_string().contains("`best`"), "{error}");
}

#[test]
fn variants_have_the_names_that_people_choose_by_and_their_old_ones() {
    let shirt = shirt();
    for (name, old) in [
        ("fast", "falling"),
        ("balanced", "arrival"),
        ("accurate", "midway"),
    ] {
        let variant = shirt.manifest().variant(name).unwrap();
        assert_eq!(Some(variant), shirt.manifest().variant(old));
        assert_eq!(variant.name, name);
    }
    let within = |limit| {
        let (_, choice) = shirt.draper_within(limit).unwrap();
        let chosen = choice.candidate().map(|found| found.variant.clone());
        (choice.is_met, chosen)
    };
    let accurate = Some("accurate".to_owned());
    assert_eq!(within(Limit::Seconds(3600.0)), (true, accurate));
    assert_eq!(within(Limit::Seconds(1e-9)), (false, None));
    let fast = Some("fast".to_owned());
    assert_eq!(within(Limit::Distance(0.0055)), (true, fast));
}

#[test]
fn a_drape_is_written_with_all_but_the_positions_of_the_template() {
    let shirt = shirt();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("draped.obj");
    let moved: Vec<Point3> = (shirt.garment().mesh().positions().iter())
        .map(|place| place + Vector3::new(0.0, 0.5, 0.0))
        .collect();
    shirt.write(&path, &moved).unwrap();
    let rest_of = |text: &str| {
        let is_kept = |line: &&str| !line.starts_with("v ") && !line.starts_with("vn ");
        let lines = text.lines().filter(is_kept).map(str::to_owned);
        lines.collect::<Vec<_>>()
    };
    let written = std::fs::read_to_string(&path).unwrap();
    let template = std::fs::read_to_string(models().join("tshirt/template.obj")).unwrap();
    assert!(template.lines().any(|line| line.starts_with("vt ")));
    assert_eq!(rest_of(&written), rest_of(&template));
    let first = |text: &str| {
        text.lines()
            .find(|line| line.starts_with("v "))
            .map(str::to_owned)
    };
    assert_ne!(first(&written), first(&template));
}
