//! Networks that are told where a coarse simulation has come to.

use std::fs;
use std::path::Path;

use garnet_data::{
    Counts, DatasetOptions, GarmentPackage, Guide, Limits, Quality, Sizing, Tailor, Until,
    Variations, default_rest_body, generate, usual_fabric, wearer_of,
};
use garnet_net::{GUIDED, GarmentGraph, Model, PoseSpace};
use garnet_pattern::GarmentKind;
use garnet_train::{Begin, PoseSpaceConfig, Recipe, ToldBy, TrainConfig, TrainError, TrainJob};

use crate::invented::{Invented, run};

/// Networks of a few passes.
fn config(told_by: ToldBy) -> TrainConfig {
    let pose_space = PoseSpaceConfig {
        told_by: Some(told_by),
        region_shapes: 8,
        hidden: 16,
        rounds: 2,
        passes: 400,
        guide: 300,
        ..PoseSpaceConfig::default()
    };
    TrainConfig {
        pose_space,
        ..TrainConfig::default()
    }
}

/// A T-shirt of few vertices, and scenes until bodies arrive.
fn job(folder: &Path) -> TrainJob {
    let (package, dataset) = (folder.join("tshirt"), folder.join("dataset"));
    let body = garnet_body::shape::ParametricBody::build(&default_rest_body()).unwrap();
    let body = body.into_body();
    let kind = GarmentKind::Tshirt;
    let tailor = Tailor::new(kind.parameters(), 500, usual_fabric(kind)).unwrap();
    let wearer = wearer_of(&body).unwrap().unwrap();
    let worn = tailor.dress(&body, &wearer, &false.into()).unwrap();
    let tshirt = tailor
        .package("tshirt".to_owned(), &worn, body, None)
        .unwrap();
    fs::create_dir(&package).unwrap();
    tshirt.write(&package).unwrap();
    let options = DatasetOptions {
        seed: 4,
        bodies: Counts {
            train: 3,
            valid: 1,
            test: 1,
        },
        poses: 3,
        quality: Quality::Fast,
        until: Until::Arrival,
        sizing: Sizing::OneSize,
        vary: Variations::default(),
        limits: Limits {
            inside: 50,
            strain_p99: 1.0,
            moving: 1.0,
            self_intersections: 10_000,
            trapped_intersections: 10_000,
        },
        part: (0, 1),
        threads: 2,
    };
    generate(&tshirt, &dataset, &options, &|_| {}, &false.into()).unwrap();
    TrainJob {
        package,
        dataset,
        more: Vec::new(),
        recipe: Recipe::of_name(GUIDED).unwrap(),
        config: config(ToldBy::Networks),
        base: None,
        begin: Begin::Anew,
    }
}

#[test]
fn a_guide_is_cut_told_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let job = job(folder.path());
    let fitted = run(&job).unwrap();
    let space = PoseSpace::load(&fitted.weights).unwrap();
    assert!(space.regions().unwrap().is_guided());
    let package = GarmentPackage::read(&job.package).unwrap();
    let guide = Guide::read(&job.package, &package.mesh, &package.body).unwrap();
    assert_eq!(space.guide, Some(guide.fingerprint()));
    // Nine scenes are few: the warp is about as far off as the arms have moved the cloth.
    let valid = fitted.best.valid.distance;
    println!("{:.2} mm", 1e3 * valid);
    assert!(valid < 0.03, "{valid}");

    let graph = GarmentGraph::new(&package.mesh, &[]).unwrap();
    let rest = package.body.rest().positions();
    let model = Model::load(&fitted.weights, graph, package.mesh.positions(), rest).unwrap();
    assert_eq!(model.guide(), Some(guide.fingerprint()));

    let by_scenes = TrainJob {
        config: config(ToldBy::Scenes),
        ..job
    };
    let error = run(&by_scenes).unwrap_err();
    assert!(matches!(error, TrainError::NoGuide { .. }), "{error}");
}

#[test]
fn a_garment_without_pattern_has_no_guide() {
    let invented = Invented::new();
    let error = run(&invented.job(GUIDED, config(ToldBy::Networks))).unwrap_err();
    assert!(error.to_string().contains("sewing pattern"), "{error}");
}
