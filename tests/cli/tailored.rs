//! Garments that are cut to the measures of whoever wears them.

use std::fs;

use serde_json::Value;

use crate::fixtures::{Fixture, stderr};
use crate::train::done;

/// Jeans whose variants know them made to measure, and two men of other girths who sit.
fn prepared() -> Fixture {
    let fixture = Fixture::new();
    done(&fixture, "garment jeans --vertices 600 -o jeans -q");
    let path = fixture.path("jeans/garment.toml");
    let text = fs::read_to_string(&path).unwrap();
    let told = text.replace(
        "vertices = 600\n",
        "vertices = 600\nmade_to_measure = true\n",
    );
    assert_ne!(told, text, "the pattern says how many vertices it has");
    fs::write(path, told).unwrap();
    for (name, waist) in [("man", 100), ("thin", 78)] {
        let body =
            format!("body --sex male --stature 180 --waist {waist} --pose sit -o {name}.obj -q");
        done(&fixture, &body);
    }
    fixture
}

fn report(fixture: &Fixture) -> Value {
    serde_json::from_slice(&fixture.read("report.json")).unwrap()
}

#[test]
fn jeans_are_cut_for_whoever_sits_in_them() {
    let fixture = prepared();
    let drape = "drape jeans man.obj --method warp --settle 12 -o worn.obj --report report.json";
    let output = fixture.garnet(drape);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("cut for `man.obj`"),
        "{}",
        stderr(&output)
    );
    let cut = report(&fixture);
    assert_eq!(cut["cuts"].as_array().unwrap().len(), 1);
    let waist = cut["cuts"][0]["waist_m"].as_f64().unwrap();
    assert!((waist - 1.0).abs() < 0.02, "{waist}");
    // The template is for a waist of less.
    let text = fs::read_to_string(fixture.path("jeans/garment.toml")).unwrap();
    let plain = text.replace("made_to_measure = true\n", "");
    fs::write(fixture.path("jeans/garment.toml"), plain).unwrap();
    done(&fixture, drape);
    let uncut = report(&fixture);
    assert!(uncut.get("cuts").is_none());
    let strain = |report: &Value| report["drapes"][0]["stretch"]["p99"].as_f64().unwrap();
    assert!(
        strain(&cut) + 0.02 < strain(&uncut),
        "{} {}",
        strain(&cut),
        strain(&uncut)
    );
}

#[test]
fn each_wearer_has_a_cut_of_their_own() {
    let fixture = prepared();
    done(
        &fixture,
        "drape jeans man.obj thin.obj --method warp -o worn/ --report report.json",
    );
    let report = report(&fixture);
    let waists = report["cuts"].as_array().unwrap().iter();
    let waists: Vec<f64> = waists.map(|cut| cut["waist_m"].as_f64().unwrap()).collect();
    assert_eq!(waists.len(), 2);
    assert!(
        (waists[0] - 1.0).abs() < 0.02 && (waists[1] - 0.78).abs() < 0.02,
        "{waists:?}"
    );
    assert_eq!(report["drapes"].as_array().unwrap().len(), 2);
    for name in ["worn/man.obj", "worn/thin.obj"] {
        assert!(fixture.path(name).is_file(), "{name}");
    }
    let output = fixture.garnet("drape jeans man.obj thin.obj --method warp -o all.pc2");
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("cut for each"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn the_body_of_the_package_wears_the_template() {
    let fixture = prepared();
    done(
        &fixture,
        "drape jeans --pose sit --method warp -o worn.obj --report report.json",
    );
    assert!(report(&fixture).get("cuts").is_none());
}
