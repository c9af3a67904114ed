//! Whether garments fit, and garments over each other.

use garnet::{io::ObjFile, mesh::primitives::tube};
use serde_json::Value;

use crate::fixtures::{Fixture, refused, stderr, stdout};
use crate::train::done;

/// A woman, jeans and a T-shirt.
fn wardrobe() -> Fixture {
    let fixture = Fixture::new();
    done(
        &fixture,
        "body --sex female --stature 168 --bmi 24 -o woman.obj -q",
    );
    done(&fixture, "garment jeans --vertices 1000 -o jeans -q");
    done(&fixture, "garment tshirt --vertices 1000 -o tee -q");
    fixture
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap()
}

#[test]
fn the_report_tells_ease_and_strain_of_each_region() {
    let fixture = wardrobe();
    let output = fixture.garnet("drape tee woman.obj -o out.obj --report -");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("\n  fit: chest "),
        "{}",
        stderr(&output)
    );
    let report = json(&stdout(&output));
    assert!(report["no_fit"].is_null());
    let fit = report["drapes"][0]["fit"].as_array().unwrap();
    let regions: Vec<&str> = fit
        .iter()
        .map(|found| found["region"].as_str().unwrap())
        .collect();
    assert_eq!(regions, ["chest", "waist", "hip", "upper arm"]);
    let measured = json(&stdout(
        &fixture.garnet("body --sex female --stature 168 --bmi 24 -o same.obj --json"),
    ));
    for found in fit {
        let [body, garment, ease] = ["body_m", "garment_m", "ease_m"].map(|key| number(found, key));
        assert!((garment - body - ease).abs() < 1e-9);
        assert!((ease / body - number(found, "ease")).abs() < 1e-9);
        assert!(number(found, "strain").abs() < 0.3);
    }
    // The wearer is the one that `body` measures, found on the body of the package.
    let measures = measured["bodies"][0]["tape"]["measures"]
        .as_array()
        .unwrap();
    let chest = measures.iter().find(|measure| measure["name"] == "chest");
    let chest = number(chest.unwrap(), "m");
    assert!((number(&fit[0], "body_m") / chest - 1.0).abs() < 0.015);
}

#[test]
fn a_garment_on_another_body_is_told_why_its_fit_is_not() {
    let fixture = Fixture::new();
    let output = fixture.garnet("drape sleeve.obj body.obj --pose bend.json -o out.obj --report -");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(!stderr(&output).contains("fit:"));
    let report = json(&stdout(&output));
    assert!(report["drapes"][0]["fit"].is_null());
    assert!(report["no_fit"].as_str().unwrap().contains("built-in body"));
}

#[test]
fn a_picture_of_the_fit_asks_for_package_and_body() {
    let fixture = wardrobe();
    done(&fixture, "drape tee woman.obj -o out.obj -q");
    done(
        &fixture,
        "render out.obj woman.obj --color-by fit=tee -o fit.png --size 300x120 -q",
    );
    let small = "-o no.png --size 300x120";
    for (arguments, words) in [
        (
            "render out.obj --color-by fit=tee",
            "the picture has no body",
        ),
        (
            "render out.obj woman.obj --color-by fit=out.obj",
            "is no garment package",
        ),
        (
            "render out.obj woman.obj --color-by fit=jeans",
            "the garment of `jeans` has",
        ),
        (
            "render out.obj body.obj --color-by fit=tee",
            "cannot tell whether `out.obj` fits",
        ),
    ] {
        refused(&fixture, &format!("{arguments} {small}"), &[words]);
    }
}

#[test]
fn an_outfit_is_an_obj_of_each_garment_with_nothing_through_the_other() {
    let fixture = wardrobe();
    let output = fixture.garnet("drape jeans tee woman.obj -o outfit --json");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report = json(&stdout(&output));
    assert_eq!(report["schema"], "garnet.outfit/1");
    let paths = [0, 1].map(|number| report["garments"][number]["drapes"][0]["output"].clone());
    assert_eq!(paths, ["outfit/jeans.obj", "outfit/tee.obj"]);
    let layer = &report["layers"][0];
    assert_eq!(
        (&layer["inner"], &layer["outer"]),
        (&"jeans".into(), &"tee".into())
    );
    assert!(number(layer, "crossing_share") < 0.01, "{layer}");
    for (name, template) in [("outfit/jeans.obj", "jeans"), ("outfit/tee.obj", "tee")] {
        let draped = ObjFile::read(fixture.path(name)).unwrap();
        let cut = ObjFile::read(fixture.path(template).join("template.obj")).unwrap();
        assert_eq!(draped.triangles(), cut.triangles());
    }
    // The same again, to the byte, on one thread.
    let first = fixture.read("outfit/tee.obj");
    done(
        &fixture,
        "drape jeans tee woman.obj -o again/ -q --threads 1",
    );
    assert!(first == fixture.read("again/tee.obj"));
}

#[test]
fn layers_of_obj_files_are_an_outfit() {
    let fixture = Fixture::new();
    fixture.mesh("coat.obj", &tube(0.135, 0.5, 36, 22));
    let inputs = "drape sleeve.obj body.obj --rig body.rig.npz --pose bend.json";
    let output = fixture.garnet(&format!("{inputs} --layer coat.obj -o outfit --json"));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report = json(&stdout(&output));
    assert_eq!(report["schema"], "garnet.outfit/1");
    let paths = [0, 1].map(|number| report["garments"][number]["drapes"][0]["output"].clone());
    assert_eq!(paths, ["outfit/sleeve.obj", "outfit/coat.obj"]);
    let layer = &report["layers"][0];
    let names = (&layer["inner"], &layer["outer"]);
    assert_eq!(names, (&"sleeve".into(), &"coat".into()));
    // One by one, they run through each other.
    assert!(number(layer, "crossing_share") < 0.02, "{layer}");
    for (arguments, words) in [
        (
            "--layer sleeve.obj -o no",
            "two garments lead to the output",
        ),
        ("--layer missing.obj -o no", "`missing.obj`"),
        ("--layer coat.obj -o no.glb", "an OBJ of its own"),
    ] {
        refused(&fixture, &format!("{inputs} {arguments}"), &[words]);
    }
    // Its name would be that of a file that is read.
    let before = fixture.read("coat.obj");
    refused(
        &fixture,
        &format!("{inputs} --layer coat.obj -o ."),
        &["one of the files that are read"],
    );
    assert!(before == fixture.read("coat.obj"));
}

#[test]
fn what_is_no_outfit_is_refused_with_what_to_do() {
    let fixture = wardrobe();
    for (arguments, words) in [
        (
            "drape jeans tee woman.obj bent.obj -o no",
            "one body in one pose",
        ),
        ("drape jeans tee woman.obj -o no.glb", "an OBJ of its own"),
        (
            "drape jeans tee woman.obj -o no --repeat 3",
            "`--repeat` is given for an outfit",
        ),
        (
            "drape jeans jeans woman.obj -o no",
            "two garments lead to the output",
        ),
        ("drape jeans woman.obj tee -o no", "the inner one first"),
        ("drape jeans tee -o no", "no body is given"),
    ] {
        refused(&fixture, arguments, &[words]);
    }
}

#[test]
fn an_outfit_is_shown_on_one_page() {
    let fixture = wardrobe();
    let output =
        fixture.garnet("drape tee woman.obj --layer jeans -o out --method warp --view out.html");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let page = String::from_utf8(fixture.read("out.html")).unwrap();
    for name in ["tee", "jeans", "body"] {
        assert!(page.contains(&format!("\"name\":\"{name}\"")), "{name}");
    }
}
