//! The tape finds on a sewn and worn garment what its pattern was cut with.

use garnet::{
    Garment,
    body::shape::Tape,
    data::{usual_package, wearer_of},
    drape::{FitLines, Region},
    pattern::GarmentKind,
};

/// Girths on the worn cloth may differ by this from those of the pattern, relative: the line goes
/// straight round the body, and the cloth does not hang quite level.
const MAX_DIFFERENCE: f64 = 0.025;

#[test]
fn the_finished_girths_of_all_patterns_are_found_on_the_worn_garment() {
    for kind in GarmentKind::ALL {
        let package = usual_package(kind, 1500).unwrap();
        let body = &package.body;
        let tape = Tape::around(body).unwrap();
        let wearer = wearer_of(body).unwrap().unwrap();
        let expected = kind.parameters().fit(&wearer.measures, &wearer.measures);
        let garment = Garment::new(package.mesh.clone()).bind(body).unwrap();
        let lines = FitLines::new(&garment, Some(&package.rest)).unwrap();
        let found = lines.fit(&tape, garment.cloth().rest_nodes());
        let regions: Vec<Region> = found.iter().map(|fit| fit.region).collect();
        let all = match kind {
            GarmentKind::Jeans => vec![Region::Waist, Region::Hip, Region::Thigh],
            GarmentKind::Dress => vec![Region::Chest, Region::Waist, Region::Hip],
            _ => vec![Region::Chest, Region::Waist, Region::Hip, Region::UpperArm],
        };
        assert_eq!(regions, all, "{kind}");
        for fit in &found {
            println!(
                "{kind} {}: body {:.3}, garment {:.3}, ease {:+.3}, strain {:+.3}, {}",
                fit.region,
                fit.body,
                fit.garment,
                fit.ease(),
                fit.strain,
                fit.word()
            );
            // Where the tape of the body lies, under a waistband too.
            assert!(fit.body > 0.2 && fit.strain.abs() < 0.12, "{kind} {fit:?}");
            // Of hips and thighs a pattern gives the least ease alone.
            let is_exact = fit.region == Region::Chest;
            let Some(ease) = expected.ease(fit.region.name()).filter(|_| is_exact) else {
                continue;
            };
            let cut = (1.0 + ease) * wearer.measures.chest;
            let difference = fit.garment / cut - 1.0;
            assert!(difference.abs() < MAX_DIFFERENCE, "{kind} {fit:?} {cut}");
        }
    }
}
