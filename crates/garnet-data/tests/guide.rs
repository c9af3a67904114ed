//! Coarse simulations that guide networks.

#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use std::sync::atomic::AtomicBool;

use garnet_body::poses::{Poser, key_pose};
use garnet_data::{BodyPath, DataError, GarmentPackage, Guide, Quality, Teacher};
use garnet_mesh::{Fingerprint, Point3};
use garnet_skin::{Garment, Warp, WarpedGarment};

#[test]
fn a_coarse_garment_tells_about_where_a_finer_one_arrives() {
    let package = common::tshirt_of(1500);
    let guide = Guide::cut(&package, 600).unwrap();
    assert!(guide.num_simulated() < 700, "{}", guide.num_simulated());
    let poser = Poser::new(package.body.skeleton()).unwrap();
    let pose = poser.pose(&key_pose("reach_high").unwrap().angles);
    let posed = package.body.posed(&pose).unwrap();
    let stop = AtomicBool::new(false);
    let path = BodyPath::to_posed(&package.body, &posed);
    let teacher = Teacher::new(&package).unwrap();
    let arrived = teacher.arrived(&path, Quality::Teacher, &stop).unwrap();

    let garment = Garment::new(package.mesh.clone())
        .bind(&package.body)
        .unwrap();
    let warped = WarpedGarment::new(&garment, &package.body, &posed, Warp::Shape).unwrap();
    let offsets = guide.offsets(&posed, &stop).unwrap();
    let places = warped.positions.iter().zip(&warped.rotations).zip(&offsets);
    let guided: Vec<Point3> = places
        .map(|((place, turn), offset)| place + turn * offset)
        .collect();
    let missed = |places: &[Point3]| {
        let distances = places.iter().zip(&arrived.arrived);
        distances.map(|(a, b)| (a - b).norm()).sum::<f32>() / places.len() as f32
    };
    let [warp, guided] = [&warped.positions, &guided].map(|places| missed(places));
    println!(
        "the warp misses it by {:.1} mm, the guide by {:.1} mm",
        1e3 * warp,
        1e3 * guided
    );
    assert!(guided < 0.5 * warp, "{guided} {warp}");

    // The same once it was written, and on any number of threads.
    let folder = tempfile::tempdir().unwrap();
    package.write(folder.path()).unwrap();
    guide.write(folder.path()).unwrap();
    let read = Guide::read(folder.path(), &package.mesh, &package.body).unwrap();
    assert_eq!(read.fingerprint(), guide.fingerprint());
    let alone = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    let again = alone.install(|| read.offsets(&posed, &stop)).unwrap();
    for (one, other) in offsets.iter().zip(&again) {
        assert!((one - other).norm() < 1e-3, "{one} {other}");
    }
    read.check(folder.path(), guide.fingerprint()).unwrap();
    let other = read.check(folder.path(), Fingerprint::of_bytes(b"another"));
    assert!(matches!(other, Err(DataError::Foreign { .. })));
    stop.store(true, std::sync::atomic::Ordering::Relaxed);
    let stopped = guide.offsets(&posed, &stop);
    assert!(matches!(stopped, Err(DataError::Stopped)));
    std::fs::remove_file(folder.path().join("guide.obj")).unwrap();
    assert!(Guide::read(folder.path(), &package.mesh, &package.body).is_err());
}

#[test]
fn garments_without_a_pattern_are_not_cut_again() {
    let mut package: GarmentPackage = common::tshirt();
    package.manifest.pattern = None;
    let refused = Guide::cut(&package, 300);
    assert!(matches!(refused, Err(DataError::Unguided { .. })));
}
