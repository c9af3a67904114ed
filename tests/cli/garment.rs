//! Packages: what is refused before anything is written, what is warned of, and files in other
//! units.

use std::fs;

use garnet::{Point3, io::ObjFile, package::GarmentPackage};

use crate::fixtures::{Fixture, refused_with_hint as refused, stderr, stdout};

/// Runs a command that must do its work, and returns what it says.
fn done(fixture: &Fixture, arguments: &str) -> String {
    let output = fixture.garnet(arguments);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{arguments}: {text}");
    text
}

const FROM_SLEEVE: &str = "garment from-obj sleeve.obj --rest-body body.obj -o sleeve";

#[test]
fn trained_networks_keep_their_garment() {
    let fixture = Fixture::new();
    done(&fixture, FROM_SLEEVE);
    // Without networks a package may be made anew.
    done(&fixture, &format!("{FROM_SLEEVE} --fabric silk"));
    let manifest = "sleeve/garment.toml";
    let text = String::from_utf8(fixture.read(manifest)).unwrap();
    assert!(text.contains("silk"), "{text}");
    let variant = "\n[[variant]]\nname = \"naive\"\nweights = \"naive.safetensors\"\n";
    fixture.text(manifest, &(text + variant));
    let before = fixture.read(manifest);
    refused(
        &fixture,
        FROM_SLEEVE,
        &["`sleeve` holds a garment with trained networks", "lists 1"],
    );
    refused(
        &fixture,
        "garment tshirt --vertices 500 -o sleeve",
        &["trained networks"],
    );
    assert_eq!(fixture.read(manifest), before);
    fixture.text(manifest, "schema = 3");
    refused(
        &fixture,
        FROM_SLEEVE,
        &["`sleeve/garment.toml`", "another folder"],
    );
}

#[test]
fn a_garment_that_no_command_would_take_is_refused() {
    let fixture = Fixture::new();
    let from = |name: &str| format!("garment from-obj {name}.obj --rest-body body.obj -o no");
    fixture.moved("sleeve.obj", "mm.obj", |p| p * 1000.0);
    refused(
        &fixture,
        &from("mm"),
        &["`mm.obj`", "millimetres", "`--units mm,m`"],
    );
    fixture.moved("sleeve.obj", "away.obj", |p| p + garnet::Vector3::x() * 5.0);
    refused(&fixture, &from("away"), &["`away.obj`", "m apart"]);
    fixture.moved("sleeve.obj", "inside.obj", |p| {
        Point3::new(0.3 * p.x, p.y, 0.3 * p.z)
    });
    refused(
        &fixture,
        &from("inside"),
        &["`inside.obj`", "deep in the body"],
    );
    fixture.moved("sleeve.obj", "flat.obj", |p| Point3::new(0.15, p.y, 0.0));
    refused(
        &fixture,
        &from("flat"),
        &["`flat.obj`", "no triangle of it has an area"],
    );
    let text = String::from_utf8(fixture.read("sleeve.obj")).unwrap();
    let face = text.lines().find(|line| line.starts_with("f ")).unwrap();
    fixture.text("doubled.obj", &format!("{text}{face}\n{face}\n"));
    refused(
        &fixture,
        &from("doubled"),
        &["`doubled.obj`", "counted from 1", "doubled"],
    );
    refused(
        &fixture,
        "garment from-obj sleeve.obj -o no",
        &["`--rest-body`", "`--rig`"],
    );
}

#[test]
fn errors_name_vertices_as_the_file_does() {
    let fixture = Fixture::new();
    // Each triangle has vertices of its own, which lie at the places of those of its neighbors; the
    // edge from place to place of `v 2` and `v 3` has three of them.
    let text = "v 0.13 0 0\nv 0.13 0.1 0\nv 0.13 0 0.1\nv 0.13 0 0.1\nv 0.13 0.1 0\nv 0.13 0.1 0.1\n\
                v 0.13 0 0.1\nv 0.13 0.1 0\nv 0.19 0.1 0.1\nf 1 2 3\nf 4 5 6\nf 7 8 9\n";
    fixture.text("fan.obj", text);
    refused(
        &fixture,
        "garment from-obj fan.obj --rest-body body.obj -o no",
        &[
            "`fan.obj`",
            "the edge between the vertices 2 and 3 of the garment",
            "3 faces",
        ],
    );
}

#[test]
fn a_garment_in_millimetres_with_z_up_becomes_metres_with_y_up() {
    let fixture = Fixture::new();
    let blender = |p: &Point3| Point3::new(p.x, -p.z, p.y) * 1000.0;
    fixture.moved("sleeve.obj", "mm.obj", blender);
    fixture.moved("body.obj", "body_mm.obj", blender);
    let text = String::from_utf8(fixture.read("mm.obj")).unwrap();
    fixture.text("mm.obj", &format!("g cloth\nvt 0.5 0.5\n{text}"));
    done(
        &fixture,
        "garment from-obj mm.obj --rest-body body_mm.obj --rig body.rig.npz -o found",
    );
    done(
        &fixture,
        "garment from-obj mm.obj --rest-body body_mm.obj --rig body.rig.npz --units mm --up z -o told",
    );
    let there = ObjFile::read(fixture.path("sleeve.obj")).unwrap();
    for name in ["found", "told"] {
        let package = GarmentPackage::read(&fixture.path(name)).unwrap();
        let pairs = package.mesh.positions().iter().zip(there.positions());
        assert!(pairs.into_iter().all(|(a, b)| (a - b).norm() < 1e-5));
        let text = String::from_utf8(package.template.source().to_vec()).unwrap();
        assert!(text.starts_with("g cloth\nvt 0.5 0.5\nv "));
        let arguments = format!("simulate {name} bent.obj --quality fast -o {name}.obj");
        done(&fixture, &arguments);
    }
}

#[test]
fn a_template_that_was_changed_is_refused() {
    let fixture = Fixture::new();
    done(&fixture, FROM_SLEEVE);
    let drape = "drape sleeve bent.obj -o no.obj";
    let template = fixture.read("sleeve/template.obj");
    fixture.moved("sleeve.obj", "sleeve/template.obj", |p| p * 1.01);
    refused(
        &fixture,
        drape,
        &[
            "`sleeve/template.obj`",
            "its vertices are not those",
            "garment.toml",
        ],
    );
    refused(
        &fixture,
        &drape.replace("drape", "simulate"),
        &["its vertices are not those"],
    );
    fixture.bytes("sleeve/template.obj", &template);
    let manifest = String::from_utf8(fixture.read("sleeve/garment.toml")).unwrap();
    let line = |key: &str| {
        let mut lines = manifest.lines();
        lines.find(|line| line.starts_with(key)).unwrap().to_owned()
    };
    let other = manifest.replace(&line("positions = "), "positions = \"00\"");
    fixture.text("sleeve/garment.toml", &other);
    refused(&fixture, drape, &["its vertices are not those"]);
    // A fabric that is none is that of the manifest.
    let other = manifest.replace(&line("density = "), "density = -5.0");
    fixture.text("sleeve/garment.toml", &other);
    refused(
        &fixture,
        &drape.replace("drape", "simulate"),
        &["`sleeve/garment.toml`", "the density of the fabric is `-5`"],
    );
    fixture.text("sleeve/garment.toml", &manifest);
    done(&fixture, &drape.replace("no.obj", "yes.obj"));
}

#[test]
fn a_manifest_that_does_not_parse_is_told_with_line_and_column() {
    let fixture = Fixture::new();
    done(&fixture, FROM_SLEEVE);
    let manifest = String::from_utf8(fixture.read("sleeve/garment.toml")).unwrap();
    fixture.text(
        "sleeve/garment.toml",
        &format!("color = \"red\"\n{manifest}"),
    );
    refused(
        &fixture,
        "drape sleeve bent.obj -o no.obj",
        &["`sleeve/garment.toml`: line 1, column 1: unknown field `color`"],
    );
}

#[test]
fn skin_that_looks_out_between_the_vertices_is_warned_of() {
    let fixture = Fixture::new();
    // The middles of its sides are inside the body, which is round.
    fixture.mesh(
        "square.obj",
        &garnet::mesh::primitives::tube(0.13, 0.8, 4, 8),
    );
    let output = fixture.garnet("garment from-obj square.obj --rest-body body.obj -o no --json");
    let report: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(report["inside"], 0, "{report}");
    assert_eq!(
        report["warnings"][0]["kind"], "crossing_at_rest",
        "{report}"
    );
    let text = done(&fixture, FROM_SLEEVE);
    assert!(!text.contains("warning"), "{text}");
}

#[test]
fn what_is_in_a_package_is_told() {
    let fixture = Fixture::new();
    done(&fixture, FROM_SLEEVE);
    let output = fixture.garnet("info sleeve --json");
    let report: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    let file = &report["files"][0];
    assert_eq!(file["kind"], "package", "{report}");
    assert_eq!(file["template"], "sleeve/template.obj", "{report}");
    assert_eq!(file["vertices"], 1240, "{report}");
}

#[test]
fn a_package_that_cannot_be_written_leaves_nothing() {
    let fixture = Fixture::new();
    fs::create_dir_all(fixture.path("sleeve/body.rig.npz")).unwrap();
    refused(&fixture, FROM_SLEEVE, &["`sleeve/body.rig.npz`"]);
    let left = fs::read_dir(fixture.path("sleeve")).unwrap().count();
    assert_eq!(left, 1);
}

#[test]
fn arguments_that_make_no_sense_are_told_with_their_reasons() {
    let fixture = Fixture::new();
    refused(
        &fixture,
        "garment jeans -o body.obj",
        &["it is a file, and a folder is needed"],
    );
    for name in ["../../x", "a/b", "a\\b"] {
        let arguments = format!("garment jeans --name {name} -o no");
        let output = fixture.garnet(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        assert!(
            stderr(&output).contains("expected a name"),
            "{}",
            stderr(&output)
        );
    }
    let output = fixture.garnet("garment tshirt --sleeve 300 -o no");
    let text = stderr(&output);
    assert!(!text.contains("Usage: garnet [OPTIONS]"), "{text}");
    assert!(
        text.contains("--sleeve <CM>") && text.contains("it lies between"),
        "{text}"
    );
    let output = fixture.garnet("garment tshirt --vertices 100 -o no --json");
    let document: serde_json::Value = serde_json::from_str(&stderr(&output)).unwrap();
    assert_eq!(document["hint"], "the default is 5000", "{document}");
    assert!(
        !document["error"].as_str().unwrap().contains("hint"),
        "{document}"
    );
    // The parameters that fold the pattern together are all named.
    let corner = "garment tshirt --vertices 1000 --length 90 --chest-ease=-5 --waist-shape=-12 --hem-flare=-10 \
                  --sleeve 36 --sleeve-ease 70 --cuff-ease 0 --neck-width 16.5 --neck-depth 5 --shoulder 5 \
                  --armhole 1 -o no";
    refused(
        &fixture,
        corner,
        &["these together fold it", "cuff-ease", "armhole"],
    );
    assert!(!fixture.path("no").exists());
}

#[test]
fn a_posed_body_is_told_from_one_at_rest() {
    let fixture = Fixture::new();
    done(&fixture, "body --sex male --pose stand -o man.obj");
    let arguments = "garment tshirt --vertices 700 --body man.obj -o no";
    refused(
        &fixture,
        arguments,
        &["`man.obj`", "not at rest", "`--body man.rig.npz`"],
    );
    fs::rename(fixture.path("man.rig.npz"), fixture.path("rest.npz")).unwrap();
    refused(
        &fixture,
        arguments,
        &["`man.obj`", "in a pose", "`garnet body`"],
    );
    refused(
        &fixture,
        "garment tshirt --vertices 700 --body sleeve.obj -o no",
        &["`sleeve.obj`", "it is not the built-in body"],
    );
    done(
        &fixture,
        "garment tshirt --vertices 700 --body rest.npz -o tee",
    );
    done(&fixture, "body --sex male --coarse -o coarse.obj");
    refused(
        &fixture,
        "garment tshirt --vertices 700 --body coarse.obj -o no",
        &["`coarse.obj`", "the coarse level", "without `--coarse`"],
    );
}

#[test]
fn the_size_of_a_wearer_is_found_and_the_next_one_told() {
    let fixture = Fixture::new();
    let text = done(&fixture, "garment tshirt --vertices 700 --size auto -o tee");
    assert!(text.starts_with("note: size m is taken: "), "{text}");
    assert!(text.contains("fits, too"), "{text}");
    let manifest = String::from_utf8(fixture.read("tee/garment.toml")).unwrap();
    assert!(manifest.contains("size = \"m\""), "{manifest}");
    done(
        &fixture,
        "body --sex male --stature 190 --bmi 39 -o large.obj -q",
    );
    let output = fixture.garnet("garment tshirt --vertices 700 --size auto -o again --json");
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["size"], "m");
    assert!(report["second_size"].is_string(), "{report}");
    let text = done(
        &fixture,
        "garment jeans --vertices 700 --size auto --body large.obj -o wide",
    );
    assert!(text.starts_with("note: "), "{text}");
    done(
        &fixture,
        "garment jeans --vertices 700 --size 34X30 -o sized",
    );
    let manifest = String::from_utf8(fixture.read("sized/garment.toml")).unwrap();
    assert!(manifest.contains("size = \"34x30\""), "{manifest}");
    for (arguments, told) in [
        ("tshirt --size 34x30", "is a size of trousers"),
        ("jeans --size 34x99", "there is no size"),
        ("dress --size huge", "there is no size"),
    ] {
        let output = fixture.garnet(&format!("garment {arguments} -o no"));
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        assert!(stderr(&output).contains(told), "{arguments}");
        assert!(!fixture.path("no").exists());
    }
}

#[test]
fn a_size_that_does_not_fit_is_warned_of() {
    let fixture = Fixture::new();
    done(&fixture, "body --stature 140 --bmi 15 -o tiny.obj");
    let arguments = "garment jeans --vertices 700 --size 3xl --body tiny.obj -o wide";
    let text = done(&fixture, arguments);
    assert!(
        text.contains("warning: size 3xl does not fit this body: its waist has an ease of"),
        "{text}"
    );
    let text = done(&fixture, "garment tshirt --vertices 700 --size m -o m");
    assert!(!text.contains("warning"), "{text}");
    let text = done(
        &fixture,
        "garment tshirt --vertices 700 --body tiny.obj -o made",
    );
    assert!(!text.contains("warning"), "{text}");
    done(&fixture, "body --stature 170 --waist 130 -o stout.obj");
    let output =
        fixture.garnet("garment jeans --vertices 700 --size xs --body stout.obj -o tight --json");
    let report: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    let warnings = report["warnings"].as_array().unwrap();
    let kinds: Vec<&str> = warnings
        .iter()
        .filter_map(|warning| warning["kind"].as_str())
        .collect();
    assert!(
        kinds.contains(&"misfit") && kinds.contains(&"strain"),
        "{report}"
    );
}

#[test]
fn files_of_a_folder_that_is_no_package_are_not_written_over() {
    let fixture = Fixture::new();
    fs::create_dir(fixture.path("mine")).unwrap();
    fs::write(fixture.path("mine/template.obj"), "v 0 0 0\n").unwrap();
    refused(
        &fixture,
        "garment tshirt --vertices 600 -o mine",
        &["`mine` has a file `template.obj`", "name another folder"],
    );
    assert_eq!(fixture.read("mine/template.obj"), b"v 0 0 0\n");
}

#[test]
fn garments_are_cut_alike_wherever_their_body_stands_and_faces() {
    let fixture = Fixture::new();
    done(&fixture, "body --sex female --bmi 27 -o here.obj -q");
    let (sine, cosine) = 0.8_f32.sin_cos();
    let away = |p: &Point3| {
        let [x, z] = [cosine * p.x + sine * p.z, cosine * p.z - sine * p.x];
        Point3::new(x + 0.5, p.y + 0.1, z - 2.0)
    };
    fixture.moved("here.obj", "away.obj", away);
    for (name, kind) in [("here", "tshirt"), ("away", "tshirt")] {
        let made = format!("garment {kind} --vertices 800 --body {name}.obj -o {name} -q");
        done(&fixture, &made);
    }
    let template = |name: &str| {
        let file = ObjFile::read(fixture.path(&format!("{name}/template.obj"))).unwrap();
        file.positions().to_vec()
    };
    let [here, found] = [template("here"), template("away")];
    let apart: Vec<f32> = here
        .iter()
        .zip(&found)
        .map(|(here, found)| (away(here) - found).norm())
        .collect();
    let mean = apart.iter().sum::<f32>() / apart.len() as f32;
    // Rounding alone lets folds differ.
    assert!(mean < 1e-2, "{mean}");
}

#[test]
fn bodies_are_measured_in_any_unit_and_place() {
    let fixture = Fixture::new();
    done(&fixture, "body --sex female --bmi 27 -o here.obj -q");
    fixture.moved("here.obj", "inches.obj", |p| p / 0.0254);
    fixture.moved("here.obj", "feet.obj", |p| p / 0.3048);
    fixture.moved("here.obj", "away.obj", |p| {
        Point3::new(p.x - 0.5, p.y - 0.9, p.z + 30.0)
    });
    let measures = |name: &str| {
        let output = fixture.garnet(&format!("info {name}.obj"));
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let told = stdout(&output);
        let of = |measure: &str| {
            let line = told
                .lines()
                .find(|line| line.trim_start().starts_with(measure));
            let line = line.unwrap_or_else(|| panic!("{name}: no {measure} in {told}"));
            let number = line
                .trim()
                .trim_end_matches("cm")
                .split_whitespace()
                .last()
                .unwrap();
            number.parse::<f64>().unwrap()
        };
        ["stature", "chest", "inseam"].map(of)
    };
    let here = measures("here");
    for name in ["inches", "feet", "away"] {
        for (found, here) in measures(name).into_iter().zip(here) {
            assert!((found - here).abs() < 0.15, "{name}: {found} {here}");
        }
    }
}

#[test]
fn what_measures_leave_no_room_for_is_told() {
    let fixture = Fixture::new();
    let told = done(&fixture, "body --sex male --bmi 35 --waist 85 -o heavy.obj");
    assert!(told.contains("not 35.0 as asked for"), "{told}");
}
