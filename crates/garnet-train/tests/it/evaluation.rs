//! Networks beside the warp.

use garnet_data::{Dataset, Split};
use garnet_drape::{DrapeOptions, GarmentPackage, Package};
use garnet_train::{Candidate, Finish, Stage, StagedScene, drape_scenes, evaluate};
use garnet_untangle::UntangleOptions;

use crate::invented::{Invented, run, tiny};

#[test]
fn a_network_is_measured_as_its_training_measured_it() {
    let invented = Invented::new();
    let trained = run(&invented.job("local", tiny(10))).unwrap();
    let package = GarmentPackage::read(&invented.package()).unwrap();
    let stage = Stage::new(package, Dataset::open(&invented.dataset()).unwrap()).unwrap();
    let candidates = [
        Candidate::Skinning,
        Candidate::Warp,
        Candidate::Model {
            name: "local".to_owned(),
            weights: trained.weights.clone(),
            settle: 0,
        },
    ];
    let mut told = Vec::new();
    let found = evaluate(
        &stage,
        Split::Test,
        &candidates,
        Finish::Untangle(UntangleOptions::default()),
        &mut |event| told.push(event),
    );
    let found = found.unwrap();
    assert_eq!((found.scenes, found.rows.len(), told.len()), (1, 3, 1));
    let [dqs, warp, local] = &found.rows[..] else {
        panic!("three rows");
    };
    // The arm keeps its shape, so both are one.
    assert_eq!(dqs.scores, warp.scores);
    assert_eq!(Some(local.scores), trained.test);
    assert!(local.flops > 0 && warp.flops == 0);
    assert!(local.seconds.network.median > 0.0);
    let teacher = &found.teacher;
    assert!(
        teacher.distance < 1e-12 && teacher.normal < 1e-3,
        "{teacher:?}"
    );
    assert!(teacher.stretch_p99 > 0.9, "{teacher:?}");
    for row in &found.rows {
        assert_eq!(row.untangled.unwrap().left.inside, 0);
        assert!(row.curves.distance.shares.is_sorted());
        // The mean distance is the area above the curve, if nothing is beyond it.
        let curve = &row.curves.distance;
        assert_eq!(curve.shares.last(), Some(&1.0));
        let step = curve.thresholds[1];
        let area: f64 = curve.shares.iter().map(|share| step * (1.0 - share)).sum();
        assert!((area - row.scores.distance).abs() < step, "{area}");
    }
    let error = evaluate(
        &stage,
        Split::Test,
        &[Candidate::Model {
            name: "none".to_owned(),
            weights: invented.path().join("none.safetensors"),
            settle: 0,
        }],
        Finish::None,
        &mut |_| {},
    );
    assert!(error.unwrap_err().to_string().contains("none.safetensors"));
}

#[test]
fn an_evaluation_drapes_as_a_package_does_to_the_bit() {
    const FRAMES: [u32; 2] = [0, 6];
    let invented = Invented::new();
    let trained = run(&invented.job("local", tiny(3))).unwrap();
    let package = GarmentPackage::read(&invented.package()).unwrap();
    let stage = Stage::new(package, Dataset::open(&invented.dataset()).unwrap()).unwrap();
    let candidates = FRAMES.map(|settle| Candidate::Model {
        name: "local".to_owned(),
        weights: trained.weights.clone(),
        settle,
    });
    let mut shown = Vec::new();
    drape_scenes(
        &stage,
        Split::Test,
        &candidates,
        &UntangleOptions::default(),
        |_| true,
        &mut |scene| shown.push(scene.drapes),
    )
    .unwrap();
    let mut bodies = Vec::new();
    let mut observer = |staged: StagedScene| {
        bodies.push(staged.posed);
        Ok(())
    };
    stage.for_each(Split::Test, Ok, &mut observer).unwrap();
    assert!(!bodies.is_empty() && bodies.len() == shown.len());

    let draper = Package::open(invented.package()).unwrap().draper("local");
    let draper = draper.unwrap();
    for (body, drapes) in bodies.iter().zip(&shown) {
        for (frames, drape) in FRAMES.into_iter().zip(drapes) {
            let options = DrapeOptions::default().with_relax_frames(frames);
            let own = draper.clone().with_options(options).drape(body).unwrap();
            assert_eq!(own.positions, *drape, "{frames} frames");
        }
    }
}
