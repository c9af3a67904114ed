//! The tape finds on a sewn and worn garment what its pattern was cut with.

use std::sync::atomic::AtomicBool;

use garnet::{
    Garment,
    body::shape::{BodyParameters, ParametricBody, Tape},
    data::{CutOptions, body_of_size, finished_girths, recut, usual_package, wearer_of},
    drape::{FitLines, Region, RegionFit},
    pattern::GarmentKind,
};
use garnet_data::{Tailor, usual_fabric};

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
        let lines = FitLines::new(&garment, Some(&package.rest), Vec::new()).unwrap();
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
                fit.strain.unwrap(),
                fit.word()
            );
            // Where the tape of the body lies, under a waistband too.
            assert!(
                fit.body > 0.2 && fit.strain.unwrap().abs() < 0.12,
                "{kind} {fit:?}"
            );
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

/// What a chest may measure more, relative: near deep armholes cloth is wider than where patterns
/// are measured.
const MAX_AT_ARMHOLE: f64 = 0.08;

/// A waistband may lie this far from where it was cut for, in metres.
const MAX_SLIP: f64 = 0.03;

fn tailor_of(kind: GarmentKind) -> Tailor {
    Tailor::new(kind.parameters(), 1000, usual_fabric(kind)).unwrap()
}

#[test]
fn sleeves_beside_a_broad_chest_are_not_measured_with_it() {
    let tailor = tailor_of(GarmentKind::Tshirt);
    let ease = tailor.parameters().get("chest-ease").unwrap();
    for (sex, bmi) in [(0.0, 34.0), (1.0, 34.0), (0.5, 23.0)] {
        let built = ParametricBody::build(&BodyParameters::new(sex).with_bmi(bmi)).unwrap();
        let tape = Tape::around(built.body()).unwrap();
        let wearer = wearer_of(built.body()).unwrap().unwrap();
        let worn = tailor.dress(built.body(), &wearer, &AtomicBool::new(false));
        let package = tailor.package("tee".to_owned(), &worn.unwrap(), built.into_body(), None);
        let package = package.unwrap();
        let garment = Garment::new(package.mesh.clone())
            .bind(&package.body)
            .unwrap();
        let lines = FitLines::new(&garment, Some(&package.rest), Vec::new()).unwrap();
        let found = lines.fit(&tape, garment.cloth().rest_nodes());
        let chest = found
            .iter()
            .find(|fit| fit.region == Region::Chest)
            .unwrap();
        let more = chest.garment / ((1.0 + ease) * wearer.measures.chest) - 1.0;
        assert!(
            (-MAX_DIFFERENCE..MAX_AT_ARMHOLE).contains(&more),
            "{sex} {bmi}: {more:.3}"
        );
    }
}

#[test]
fn jeans_are_worn_where_they_were_cut_to_be() {
    let tailor = tailor_of(GarmentKind::Jeans);
    for (sex, bmi) in [(0.0, 21.0), (1.0, 21.0), (0.0, 30.0), (1.0, 30.0)] {
        let built = ParametricBody::build(&BodyParameters::new(sex).with_bmi(bmi)).unwrap();
        let wearer = wearer_of(built.body()).unwrap().unwrap();
        let worn = tailor
            .dress(built.body(), &wearer, &AtomicBool::new(false))
            .unwrap();
        let heights = worn.positions.iter().map(|position| f64::from(position.y));
        let top = heights.clone().fold(f64::NEG_INFINITY, f64::max);
        let hem = heights.fold(f64::INFINITY, f64::min);
        let scale = wearer.measures.stature / 1.72;
        let wanted = wearer.measures.inseam + scale * tailor.parameters().get("rise").unwrap();
        assert!(
            (top - wanted).abs() < MAX_SLIP,
            "{sex} {bmi}: {top:.3} for {wanted:.3}"
        );
        assert!(hem > 0.05, "{sex} {bmi}: {hem:.3} above the floor");
    }
}

#[test]
fn sizes_that_are_too_large_have_the_girths_of_their_pattern() {
    for (kind, sizes) in [
        (GarmentKind::Sweater, ["m", "3xl"]),
        (GarmentKind::Jeans, ["32x32", "40x32"]),
    ] {
        let package = usual_package(kind, 1000).unwrap();
        let wearer = wearer_of(&package.body).unwrap().unwrap().measures;
        let tape = Tape::around(&package.body).unwrap();
        let mut before: Option<Vec<RegionFit>> = None;
        for size in sizes {
            let options = CutOptions {
                size: Some(size.parse().unwrap()),
                parameters: None,
            };
            let body = ParametricBody::build(&body_of_size(&package, options.size.unwrap()));
            let stop = AtomicBool::new(false);
            let cut = recut(&package, body.unwrap().into_body(), &options, &stop);
            let cut = cut.unwrap().unwrap();
            let pattern = cut.manifest.pattern.clone().unwrap();
            assert_eq!(pattern.size.as_deref(), Some(size));
            let garment = Garment::new(cut.mesh.clone()).bind(&cut.body).unwrap();
            let finished = finished_girths(&pattern, &cut.body).unwrap();
            let lines = FitLines::new(&garment, Some(&cut.rest), finished).unwrap();
            let found = lines.fit(&tape, garment.cloth().rest_nodes());
            let told = tailor_of(kind).with_size(options.size);
            let told = told
                .parameters()
                .fit(&options.size.unwrap().measures(), &wearer);
            for fit in &found {
                // What is warned of and what is reported are one number.
                let is_exact = matches!(fit.region, Region::Chest | Region::Waist | Region::Hip);
                if let Some(ease) = told.ease(fit.region.name()).filter(|_| is_exact) {
                    let differs = (fit.ease_share() - ease).abs();
                    assert!(differs < 0.03, "{kind} {size} {fit:?}: {ease:.3}");
                }
            }
            let before = before.replace(found.clone()).unwrap_or_default();
            for (small, large) in before.iter().zip(&found) {
                assert_eq!(small.region, large.region);
                assert!(small.garment < large.garment, "{kind} {small:?} {large:?}");
                // The tape lies where it lay.
                let differs = (small.body - large.body).abs();
                assert!(differs < 0.02, "{kind} {small:?} {large:?}");
            }
        }
    }
}
