//! All trained garments that come with the repository: what each variant makes of them.

use std::{
    fs,
    path::{Path, PathBuf},
};

use garnet::{
    Fallback, Package,
    body::poses::{Poser, key_pose},
    body::shape::{BodyParameters, Measure, ParametricBody},
    mesh::{edge_stretch, vertex_distances},
};

/// Poses of the library: an arm up, a leg up.
const POSES: [&str; 2] = ["wave", "stairs_up"];

/// The variants that every garment has.
const VARIANTS: [&str; 3] = ["accurate", "balanced", "fast"];

/// No variant is farther from `accurate` than this in the mean, in metres.
const FARTHEST: f32 = 0.025;

fn packages() -> Vec<PathBuf> {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let folders = fs::read_dir(models)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut packages: Vec<PathBuf> = folders
        .filter(|folder| folder.join("garment.toml").is_file())
        .collect();
    packages.sort();
    packages
}

#[test]
fn every_variant_of_every_garment_drapes_and_is_free() {
    let packages = packages();
    assert!(!packages.is_empty());
    for path in packages {
        let package = Package::open(&path).unwrap();
        let poser = Poser::new(package.body().skeleton()).unwrap();
        for pose in POSES {
            let pose_of = poser.pose(&key_pose(pose).unwrap().angles);
            let target = package.body().posed(&pose_of).unwrap();
            let mut drapes = VARIANTS.map(|variant| {
                let drape = package.draper(variant).unwrap().drape(&target).unwrap();
                let what = format!("{} by {variant} in {pose}", path.display());
                let provenance = &drape.provenance;
                assert!(
                    provenance.fallback.is_none(),
                    "{what}: {:?}",
                    provenance.fallback
                );
                assert_eq!(drape.report.as_ref().unwrap().inside, 0, "{what}");
                (what, drape.positions)
            });
            let (_, accurate) = std::mem::take(&mut drapes[0]);
            for (what, positions) in &drapes[1..] {
                let distances = vertex_distances(&accurate, positions).unwrap();
                let mean = distances.iter().sum::<f32>() / distances.len() as f32;
                println!("{what}: {:.1} mm from accurate", 1e3 * mean);
                assert!(mean < FARTHEST, "{what}: {mean}");
            }
        }
    }
}

/// No edge of simulated cloth is so many times as long as at rest.
const TORN: f32 = 2.0;

#[test]
fn cuffs_that_are_caught_on_the_way_are_simulated_from_rest() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let package = Package::open(models.join("sweater")).unwrap();
    let tall = BodyParameters::new(1.0).with(Measure::Stature, 1.85);
    let tall = ParametricBody::build(&tall.with_bmi(24.0)).unwrap();
    let poser = Poser::new(tall.body().skeleton()).unwrap();
    let pose = poser.pose(&key_pose("upward_salute").unwrap().angles);
    let posed = tall.body().posed(&pose).unwrap();
    let target = package.body().fitted(posed.skin().positions()).unwrap();
    let drape = package.draper("accurate").unwrap().drape(&target).unwrap();
    // The network would do: then another pose is to be found.
    let fallback = drape.provenance.fallback.as_ref().unwrap();
    assert!(matches!(fallback, Fallback::Torn { .. }), "{fallback}");
    let rest = package.garment().mesh();
    let edges = rest.faces().iter();
    let edges: Vec<[u32; 2]> = edges
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .collect();
    let stretch = edge_stretch(rest.positions(), &drape.positions, &edges).unwrap();
    assert!(stretch.max < TORN, "{stretch:?}");
}

#[test]
fn the_default_of_every_garment_is_its_most_accurate_variant() {
    for path in packages() {
        let package = Package::open(&path).unwrap();
        let default = package.manifest().default_variant().unwrap();
        assert_eq!(default.name, "accurate", "{}", path.display());
    }
}

/// How far the vertices of a garment lie from the axis of the body in the mean, in metres.
fn mean_width(package: &Package) -> f32 {
    let places = package.garment().mesh().positions();
    let widths = places.iter().map(|place| place.x.hypot(place.z));
    widths.sum::<f32>() / places.len() as f32
}

#[test]
fn shirts_and_dress_come_in_sizes_that_drape_without_being_cut() {
    for name in ["tshirt", "sweater", "dress"] {
        let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
        let package = Package::open(models.join(name)).unwrap();
        let sizes = package.sizes().unwrap();
        assert_eq!(sizes, ["2xl", "3xl", "l", "m", "s", "xl", "xs"], "{name}");
        let widths = ["xs", "m", "3xl"].map(|size| mean_width(&package.in_size(size).unwrap()));
        assert!(
            widths[0] < widths[1] && widths[1] < widths[2],
            "{name}: {widths:?}"
        );
        let large = package.in_size("xl").unwrap();
        let poser = Poser::new(large.body().skeleton()).unwrap();
        let pose = poser.pose(&key_pose(POSES[0]).unwrap().angles);
        let target = large.body().posed(&pose).unwrap();
        let drape = large.draper("fast").unwrap().drape(&target).unwrap();
        assert_eq!(drape.report.unwrap().inside, 0, "{name}");
        let error = package.in_size("huge").unwrap_err().to_string();
        assert!(
            error.contains("no size `huge`") && error.contains("xl"),
            "{error}"
        );
    }
}
