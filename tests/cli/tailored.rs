//! Garments that are cut before they are draped: to the measures of whoever wears them, in a size,
//! or with other parameters.

use std::fs;

use garnet::Point3;
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
fn a_posed_wearer_is_measured_by_the_rig_beside() {
    let fixture = prepared();
    let body = "body --sex female --stature 150 --bmi 19 --pose sit -o woman.obj --json -q";
    let told = fixture.garnet(body);
    let told: Value = serde_json::from_slice(&told.stdout).unwrap();
    let mut measures = told["bodies"][0]["tape"]["measures"]
        .as_array()
        .unwrap()
        .iter();
    let inseam = measures
        .find(|measure| measure["name"] == "inseam")
        .unwrap();
    let inseam = inseam["m"].as_f64().unwrap();
    let drape = "drape jeans woman.obj --method warp -o worn.obj --report report.json";
    done(&fixture, drape);
    let cut = report(&fixture);
    let found = cut["cuts"][0]["inseam_m"].as_f64().unwrap();
    assert!((found - inseam).abs() < 1e-3, "{found} {inseam}");
    // No line of jeans goes round the chest.
    let regions = cut["drapes"][0]["fit"].as_array().unwrap().iter();
    let mut regions = regions.map(|fit| fit["region"].as_str().unwrap());
    assert!(regions.all(|region| region != "chest"));
    done(
        &fixture,
        "render worn.obj woman.obj --color-by fit=jeans -o fit.png -q",
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

/// A T-shirt without variants, a large man, and a thin woman who waves.
fn shirt_and_bodies() -> Fixture {
    let fixture = Fixture::new();
    done(&fixture, "garment tshirt --vertices 600 -o tee -q");
    done(&fixture, "body --sex male --bmi 34 -o big.obj -q");
    done(
        &fixture,
        "body --sex female --bmi 19 --pose wave -o thin.obj -q",
    );
    fixture
}

#[test]
fn a_body_that_lies_because_of_its_axes_is_told() {
    let fixture = shirt_and_bodies();
    fixture.moved("thin.obj", "z.obj", |p| Point3::new(p.x, -p.z, p.y));
    for (options, is_told) in [
        ("z.obj", true),
        ("thin.obj --up z", true),
        ("z.obj --up z", false),
        ("thin.obj", false),
        ("--pose wave", false),
    ] {
        let command = format!("drape tee {options} --method warp --no-untangle -o worn.obj");
        let output = fixture.garnet(&command);
        let told = stderr(&output);
        assert_eq!(output.status.code(), Some(0), "{options}: {told}");
        assert_eq!(told.contains("lies along z"), is_told, "{options}: {told}");
    }
}

/// The girth of the garment round the chest in the first drape of a report.
fn chest(report: &Value) -> f64 {
    let regions = report["drapes"][0]["fit"].as_array().unwrap().iter();
    let chest = regions.filter(|region| region["region"] == "chest");
    chest
        .map(|region| region["garment_m"].as_f64().unwrap())
        .sum()
}

#[test]
fn a_shirt_is_draped_in_the_size_that_is_named_or_fits() {
    let fixture = shirt_and_bodies();
    let draped = |options: &str| {
        let command =
            format!("drape tee big.obj {options} --method warp -o worn.obj --report report.json");
        let output = fixture.garnet(&command);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        (report(&fixture), stderr(&output))
    };
    let (own, _) = draped("");
    assert!(own.get("cuts").is_none());
    let (small, told) = draped("--size S");
    let misfit = "size s does not fit this body: its chest has an ease of";
    assert!(told.contains(misfit), "{told}");
    let (large, told) = draped("--size 2xl");
    assert!(!told.contains("does not fit"), "{told}");
    assert!(told.contains("cut in size 2xl for `big.obj`"), "{told}");
    assert_eq!(large["cuts"][0]["size"], "2xl");
    // A step of size is 8 cm round the body's chest, and a fifth more round the shirt's.
    let steps = (chest(&large) - chest(&small)) / (1.2 * 0.08);
    assert!((steps - 4.0).abs() < 0.35, "{steps} steps from S to 2XL");
    assert!(chest(&small) < chest(&own) && chest(&own) < chest(&large));

    let (chosen, told) = draped("--size auto");
    let sizes =
        ["size", "second_size"].map(|key| chosen["cuts"][0][key].as_str().unwrap().to_owned());
    let large_ones = ["l", "xl", "2xl", "3xl"];
    assert!(
        sizes.iter().all(|size| large_ones.contains(&size.as_str())),
        "{sizes:?}"
    );
    assert!(
        told.contains(&format!("size {} is taken", sizes[0])),
        "{told}"
    );
    assert_ne!(sizes[0], sizes[1]);

    let (both, _) = draped("--size l --ease 35 --length 70");
    let changed = &both["cuts"][0]["parameters"];
    assert_eq!(changed["chest-ease"].as_f64(), Some(0.35));
    assert_eq!(changed["length"].as_f64(), Some(0.7));
    let (plain, _) = draped("--size l");
    // 1.35 over 1.2, and a little more where the looser chest hangs lower.
    let ratio = chest(&both) / chest(&plain);
    assert!((1.08..1.25).contains(&ratio), "{ratio}");
}

#[test]
fn each_body_gets_the_size_that_fits_it() {
    let fixture = shirt_and_bodies();
    done(
        &fixture,
        "drape tee big.obj thin.obj --size auto --method warp -o worn/ --report report.json",
    );
    let report = report(&fixture);
    let sizes = report["cuts"].as_array().unwrap().iter();
    let sizes: Vec<&str> = sizes.map(|cut| cut["size"].as_str().unwrap()).collect();
    assert_eq!(sizes.len(), 2);
    assert_ne!(sizes[0], sizes[1]);
    assert!(["xs", "s"].contains(&sizes[1]), "{sizes:?}");
    // A size that is named is one garment for all, also in one file.
    done(
        &fixture,
        "drape tee big.obj thin.obj --size m --method warp -o all.npz",
    );
}

#[test]
fn a_size_on_a_body_of_another_topology_is_that_of_who_stands_in_for_it() {
    let fixture = shirt_and_bodies();
    done(
        &fixture,
        "body --sex male --bmi 34 --coarse -o coarse.obj -q",
    );
    done(
        &fixture,
        "drape tee --rest-body coarse.obj --pose stand --size auto --method warp -o worn.obj \
         --report report.json",
    );
    let of_coarse = report(&fixture)["cuts"][0]["size"].clone();
    done(
        &fixture,
        "drape tee big.obj --size auto --method warp -o worn.obj --report report.json",
    );
    assert_eq!(of_coarse, report(&fixture)["cuts"][0]["size"]);
}

#[test]
fn sizes_are_simulated_and_colored_as_they_are_cut() {
    let fixture = shirt_and_bodies();
    done(
        &fixture,
        "simulate tee big.obj --size 2xl --quality fast -o worn.obj --report report.json",
    );
    assert_eq!(report(&fixture)["cuts"][0]["size"], "2xl");
    let pixels = |package: &str| {
        let command = format!("render worn.obj big.obj --color-by fit={package} -o fit.png -q");
        done(&fixture, &command);
        fixture.read("fit.png")
    };
    assert_eq!(pixels("tee@2xl"), pixels("tee@2XL"));
    for (package, status, told) in [
        ("tee", 0, "in size 2xl: if it was draped in that"),
        ("tee@xl", 0, "in size 2xl: if it was draped in that"),
        ("tee@huge", 2, "no size `huge`"),
    ] {
        let command = format!("render worn.obj big.obj --color-by fit={package} -o fit.png");
        let output = fixture.garnet(&command);
        assert_eq!(output.status.code(), Some(status));
        assert!(stderr(&output).contains(told), "{}", stderr(&output));
    }
    let output = fixture.garnet("render worn.obj big.obj --color-by fit=tee@2xl -o fit.png");
    assert!(!stderr(&output).contains("note"), "{}", stderr(&output));
}

#[test]
fn cuts_that_there_are_not_are_refused() {
    let fixture = shirt_and_bodies();
    done(&fixture, "garment jeans --vertices 600 -o jeans -q");
    for (options, words) in [
        ("tee big.obj --size huge", "there is no size `huge`"),
        ("tee big.obj --size 32x34", "`32x34` is a size of trousers"),
        (
            "tee big.obj --sleeve 90",
            "it lies between 16.0 cm and 36.0 cm",
        ),
        ("tee big.obj --length=-3", "is not possible"),
        (
            "jeans big.obj --sleeve 30",
            "a jeans has no parameter `sleeve`",
        ),
        ("tee/template.obj big.obj --size m", "cannot be cut anew"),
    ] {
        let output = fixture.garnet(&format!("drape {options} --method warp -o worn.obj"));
        assert_eq!(output.status.code(), Some(2), "{options}");
        let told = stderr(&output);
        assert!(told.contains(words), "{options}: {told}");
        assert!(!fixture.path("worn.obj").exists(), "{options}");
    }
}

#[test]
fn what_networks_have_not_learned_is_told_and_far_from_it_simulated() {
    let fixture = shirt_and_bodies();
    let shirt = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/tshirt");
    let draped = |options: &str| {
        let command = format!("drape {shirt} big.obj {options} -o worn.obj --report report.json");
        let output = fixture.garnet(&command);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let report = report(&fixture);
        let warnings = report["warnings"].as_array().unwrap().iter();
        let is_told = warnings
            .clone()
            .any(|warning| warning["kind"] == "other_cut");
        let inside = report["drapes"][0]["untangle"]["inside"].as_u64();
        assert_eq!(inside, Some(0), "{options}");
        (report["method"].as_str().unwrap().to_owned(), is_told)
    };
    assert_eq!(draped(""), ("accurate".to_owned(), false));
    // Two variants have learned sizes, too; `fast` has not.
    assert_eq!(draped("--size l"), ("accurate".to_owned(), false));
    assert_eq!(
        draped("--size xs --method balanced"),
        ("balanced".to_owned(), false)
    );
    assert_eq!(draped("--size l --method fast"), ("fast".to_owned(), true));
    assert_eq!(
        draped("--size 3xl --method fast"),
        ("fast".to_owned(), true)
    );
    assert_eq!(draped("--size 3xl"), ("sim".to_owned(), false));
}

#[test]
fn scenes_of_a_size_are_of_the_package_in_that_size() {
    let fixture = shirt_and_bodies();
    let shirt = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/tshirt");
    let options = "--bodies 1/0/0 --poses 1 --keep-all -q";
    done(
        &fixture,
        &format!("dataset {shirt} --size l -o scenes {options}"),
    );
    let manifest: Value = serde_json::from_slice(&fixture.read("scenes/dataset.json")).unwrap();
    let own = fs::read_to_string(format!("{shirt}/garment.toml")).unwrap();
    let places = manifest["garment"]["positions"].as_str().unwrap();
    assert!(
        !own.contains(places),
        "size L lies elsewhere than the template"
    );
    // The package measures them in that size.
    let eval = "--split train --model balanced";
    done(
        &fixture,
        &format!("eval {shirt} scenes {eval} --report report.json -q"),
    );
    let methods = report(&fixture)["methods"].as_array().unwrap().clone();
    assert!(!methods.is_empty());

    done(&fixture, "garment jeans --vertices 600 -o jeans -q");
    for (arguments, words) in [
        (
            "jeans --size 32x34",
            "each body wears a garment cut to its measures",
        ),
        ("tee --size 32x34", "`32x34` is a size of trousers"),
        ("tee --size huge", "there is no size `huge`"),
    ] {
        let output = fixture.garnet(&format!("dataset {arguments} -o none"));
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        let told = stderr(&output);
        assert!(told.contains(words), "{arguments}: {told}");
        assert!(!fixture.path("none").exists(), "{arguments}");
    }
}

#[test]
fn whom_a_named_size_does_not_fit_is_told_for_each() {
    let fixture = shirt_and_bodies();
    let drape = |arguments: &str| {
        let command = format!("drape tee {arguments} --method warp --report report.json");
        let output = fixture.garnet(&command);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        (report(&fixture), stderr(&output))
    };
    let misfit = |body: &str| format!("; size 2xl fits best (`{body}`)");
    let (_, told) = drape("thin.obj big.obj -o worn/ --size s");
    assert!(told.contains(&misfit("big.obj")), "{told}");
    assert!(!told.contains("(`thin.obj`)"), "{told}");
    // The rest body is a wearer as any other.
    let (found, told) = drape("--rest-body big.obj big.obj -o worn.obj --size s");
    assert!(told.contains(&misfit("big.obj")), "{told}");
    let measured = found["cuts"][0]["chest_m"].as_f64().unwrap();
    let girth = |report: &Value| {
        let regions = report["drapes"][0]["fit"].as_array().unwrap();
        let chest = regions.iter().find(|region| region["region"] == "chest");
        chest.unwrap()["body_m"].as_f64().unwrap()
    };
    assert!((girth(&found) - measured).abs() < 2e-3);
    for size in ["xs", "3xl"] {
        let (found, _) = drape(&format!("big.obj -o worn.obj --size {size}"));
        assert!((girth(&found) - measured).abs() < 2e-3, "{size}");
        let regions = found["drapes"][0]["fit"].as_array().unwrap().len();
        assert!(regions >= 3, "{size}: {regions}");
    }
    // The ease is that of the package's body, not of this one.
    let (_, told) = drape("big.obj -o worn.obj --ease 25");
    assert!(
        told.contains("does not fit: its chest has an ease of -"),
        "{told}"
    );
}

#[test]
fn a_dress_without_sleeves_is_placed_as_it_is() {
    let fixture = Fixture::new();
    done(&fixture, "body --sex female --stature 168 -o woman.obj -q");
    done(
        &fixture,
        "garment dress --body woman.obj --vertices 1000 -o dress -q",
    );
    let larger = |point: &Point3| Point3::new(1.08 * point.x, 1.08 * point.y + 0.1, 1.08 * point.z);
    fixture.moved("dress/template.obj", "large.obj", larger);
    let drape = "drape large.obj --rig woman.rig.npz --pose stand -o worn.obj --report report.json";
    let output = fixture.garnet(&format!("{drape} --place"));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(!stderr(&output).contains("sleeves"), "{}", stderr(&output));
}
