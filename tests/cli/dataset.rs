//! Data sets: what is refused before anything is written, and what is told of scenes that were
//! rejected.

use std::fs;

use garnet::{Point3, Vector3};

use crate::fixtures::{Fixture, refused, stderr, stdout};
use crate::train::{done, prepared};

#[test]
fn a_garment_on_another_body_is_refused_with_the_way_out() {
    let fixture = Fixture::new();
    done(
        &fixture,
        "garment from-obj sleeve.obj --rest-body body.obj -o net -q",
    );
    refused(
        &fixture,
        "dataset net -o out --bodies 2/0/0 --poses 2",
        &[
            "vertices that is not the built-in one",
            "hint: bring the garment to the built-in body: `garnet body -o rest.obj`",
        ],
    );
}

#[test]
fn what_the_hint_says_brings_a_garment_to_the_built_in_body() {
    let fixture = Fixture::new();
    done(&fixture, "body --stature 170 -o own.obj -q");
    done(&fixture, "garment tshirt --vertices 600 -o cut -q");
    done(&fixture, "drape cut own.obj -o worn.obj -q");
    done(
        &fixture,
        "garment from-obj worn.obj --rest-body own.obj -o package -q",
    );
    let report = done(
        &fixture,
        "dataset package -o out --bodies 1/0/0 --poses 1 --until midway --json",
    );
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["splits"]["train"]["scenes"], 1);
}

#[test]
fn a_data_set_goes_on_after_its_garment_was_trained() {
    let fixture = Fixture::new();
    done(&fixture, "garment tshirt --vertices 600 -o cut -q");
    let command = "dataset cut -o out --bodies 1/0/0 --poses 1 --until midway -q";
    done(&fixture, command);
    let before = fixture.read("out/shards/train_0000.safetensors");
    // As a training on wearers with garments of their own leaves it.
    let manifest = String::from_utf8(fixture.read("cut/garment.toml")).unwrap();
    let trained = manifest.replace("[pattern]\n", "[pattern]\nmade_to_measure = true\n");
    assert_ne!(trained, manifest);
    fixture.text("cut/garment.toml", &trained);
    done(&fixture, command);
    assert_eq!(fixture.read("out/shards/train_0000.safetensors"), before);
    // One that is begun now keeps it.
    done(&fixture, &command.replace("out", "new"));
    fixture.text("cut/garment.toml", &manifest);
    done(&fixture, &command.replace("out", "new"));
}

#[test]
fn scenes_that_are_mostly_rejected_are_told() {
    let fixture = Fixture::new();
    done(&fixture, "garment tshirt --vertices 1500 -o tee -q");
    let output = fixture.garnet("dataset tee -o out --bodies 1/0/0 --poses 8 --quality fast");
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    let expected = "warning: [..] of 8 scenes were rejected, [..] of them for unsettled: ";
    for part in expected.split("[..]") {
        assert!(text.contains(part), "{text}");
    }
    assert!(
        text.contains("; `--quality teacher` settles for longer; other arguments"),
        "{text}"
    );
    assert!(!fixture.path("out/unfinished").exists());
}

#[test]
fn a_data_set_without_scenes_is_an_error() {
    let fixture = Fixture::new();
    done(&fixture, "garment tshirt --vertices 700 -o tee -q");
    let arguments = "dataset tee -o out --bodies 1/0/0 --poses 2 --quality fast --json";
    let output = fixture.garnet(arguments);
    assert_eq!(output.status.code(), Some(2));
    let report: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(report["mostly_rejected"]["kind"], "unsettled");
    let error: serde_json::Value = serde_json::from_str(&stderr(&output)).unwrap();
    assert_eq!(error["error"], "the data set has no scenes");
}

#[test]
fn hints_fit_what_is_wrong_with_the_files_of_a_data_set() {
    let fixture = Fixture::new();
    done(&fixture, "garment tshirt --vertices 600 -o tee -q");
    let asked = "dataset tee -o out --bodies 1/0/1 --poses 1 --until midway";
    done(&fixture, &format!("{asked} -q"));
    refused(
        &fixture,
        "dataset tee -o out --bodies 1/0/1 --poses 1",
        &[
            "with end midway, asked for is rest",
            "hint: give the arguments that it was begun with",
        ],
    );
    refused(
        &fixture,
        &format!("{asked} --mixed"),
        &["with poses mixed false, asked for is true"],
    );
    refused(
        &fixture,
        &format!("{asked} --sizing made-to-measure"),
        &["with sizing one-size, asked for is made-to-measure"],
    );
    refused(
        &fixture,
        &format!("{asked} --keep-all"),
        &["with limits of 0 vertices inside"],
    );

    let shard = "out/shards/train_0000.safetensors";
    let whole = fixture.read(shard);
    fixture.half(shard, shard);
    let delete = format!("hint: delete `{shard}`");
    refused(&fixture, asked, &["no sound safetensors file", &delete]);
    fixture.bytes(shard, &fixture.read("out/shards/test_0000.safetensors"));
    refused(
        &fixture,
        asked,
        &["is the shard `test_0000.safetensors`", &delete],
    );
    fs::remove_file(fixture.path(shard)).unwrap();
    done(&fixture, &format!("{asked} -q"));
    assert_eq!(fixture.read(shard), whole);

    let manifest = String::from_utf8(fixture.read("out/dataset.json")).unwrap();
    let other = manifest.replace("garnet.dataset/1", "garnet.dataset/9");
    fixture.text("out/dataset.json", &other);
    let of_version = "its schema is `garnet.dataset/9`";
    let other_folder = "hint: name another folder with `-o`";
    refused(&fixture, asked, &[of_version, other_folder]);
    let anew = "hint: make the data set anew with `garnet dataset`";
    refused(&fixture, "eval tee out", &[of_version, anew]);

    fixture.half("out/dataset.json", "out/dataset.json");
    refused(
        &fixture,
        asked,
        &["dataset.json`: EOF", "hint: copy it again"],
    );
}

#[test]
fn arguments_that_contradict_each_other_are_refused() {
    let fixture = prepared();
    for option in [
        "--bodies 1/0/0",
        "--poses 3",
        "--seed 1",
        "--quality fast",
        "--until rest",
        "--sizing one-size",
        "--vary sleeve=1:2",
        "--keep-all",
        "--shard 1/2",
    ] {
        refused(
            &fixture,
            &format!("dataset net --import scenes.json -o out {option}"),
            &["cannot be used with"],
        );
    }
    refused(
        &fixture,
        "dataset net --import scenes.json -o out --units cm",
        &["`--units` and `--body-file` are for such a folder"],
    );
    refused(
        &fixture,
        "dataset net -o out --body-file body.obj",
        &["--import <JSON|DIR>"],
    );
    refused(
        &fixture,
        "dataset net -o out --vary sleeve=20:20 --vary sleeve=22:24",
        &["`--vary` names `sleeve` twice"],
    );
    refused(&fixture, "dataset net -o net", &["it is a garment package"]);
    refused(
        &fixture,
        "dataset net -o out --bodies 0/0/0",
        &["expected at least one body"],
    );
}

#[test]
fn imports_that_are_wrong_leave_everything_as_it_was() {
    let fixture = prepared();
    let manifest = String::from_utf8(fixture.read("scenes.json")).unwrap();
    let wrong = |from: &str, to: &str, expected: &[&str]| {
        fixture.text("wrong.json", &manifest.replace(from, to));
        refused(&fixture, "dataset net --import wrong.json -o out", expected);
    };
    for (from, to, cause) in [
        ("\"units\": \"m\",", "", "missing field `units`"),
        ("\"units\"", "\"unit\"", "unknown field `unit`"),
        ("\"valid\"", "\"value\"", "unknown variant `value`"),
    ] {
        let form = "hint: `garnet dataset --help` shows the form of a manifest";
        wrong(from, to, &["`wrong.json`: ", cause, "line ", form]);
    }
    wrong(
        "\"body\": \"c\"",
        "\"body\": \"a\"",
        &[
            "`wrong.json`: the body `a` is in `train` by scene 1 and in `test` by scene 4",
            "hint: put all its scenes into one split",
        ],
    );
    wrong(
        "\"walk\"",
        "\"bend\"",
        &["the sequence `bend` is in `train` by scene 1 and in `test` by scene 4"],
    );
    wrong(
        "md_most.obj",
        "nowhere.obj",
        &[
            "cannot take scene 4, of body `c`, of `wrong.json`",
            "nowhere.obj",
            "hint: check the path: paths in a manifest are relative to it",
        ],
    );
    wrong(
        "md_most.obj",
        "body.rig.npz",
        &[
            "body.rig.npz",
            "the template of the package has",
            "hint: meshes have the vertices of the package",
        ],
    );
    fixture.bytes("cut.npz", b"PK");
    wrong(
        "md_most.obj",
        "cut.npz",
        &["cut.npz", "hint: the file may be cut off"],
    );

    let before = fixture.read("scenes/shards/train_0000.safetensors");
    fixture.text("wrong.json", &manifest.replace("\"valid\"", "\"train\""));
    refused(
        &fixture,
        "dataset net --import wrong.json -o scenes",
        &["with bodies 1/1/1, asked for is 2/0/1"],
    );
    assert_eq!(fixture.read("scenes/shards/train_0000.safetensors"), before);
}

#[test]
fn imported_meshes_are_those_of_the_package_and_lie_on_each_other() {
    let fixture = prepared();
    let manifest = String::from_utf8(fixture.read("scenes.json")).unwrap();
    let wrong = |from: &str, to: &str, expected: &[&str]| {
        fixture.text("wrong.json", &manifest.replace(from, to));
        refused(&fixture, "dataset net --import wrong.json -o out", expected);
    };
    fixture.moved("md_most.obj", "away.obj", |p| p + Vector3::x() * 5.0);
    wrong(
        "md_most.obj",
        "away.obj",
        &[
            "`away.obj` is ",
            " m away from its body `most.obj`",
            "hint: export garment and body of a scene from one place",
        ],
    );
    fixture.moved("most.obj", "mirrored.obj", |p| Point3::new(-p.x, p.y, p.z));
    wrong(
        "\"most.obj\"",
        "\"mirrored.obj\"",
        &[
            "`mirrored.obj` does not belong here: it is the mirror image of the rest body",
            "hint: export it again without a mirrored axis",
        ],
    );
    wrong(
        "garnet.import/1",
        "garnet.import/2",
        &[
            "its schema is `garnet.import/2`",
            "hint: `garnet dataset --help` shows the form of a manifest",
        ],
    );
    fs::create_dir(fixture.path("shirts")).unwrap();
    refused(
        &fixture,
        "dataset net --import shirts --body-file body.obj -o out",
        &[
            "no folder in it has a `shirt_mesh_r_tmp.obj`",
            "hint: name the folder that has a folder for each shirt",
        ],
    );
}

#[test]
fn an_import_of_other_drapes_does_not_replace_those_that_are_there() {
    let fixture = prepared();
    let import = "dataset net --import scenes.json -o scenes";
    let files = ["dataset.json", "shards/test_0000.safetensors"];
    let read = || files.map(|name| fixture.read(&format!("scenes/{name}")));
    let before = read();
    done(&fixture, &format!("{import} -q"));
    assert!(read() == before, "a second import shows");

    fixture.moved("md_most.obj", "md_most.obj", |p| p + Vector3::x() * 1e-3);
    refused(
        &fixture,
        import,
        &[
            "`scenes/dataset.json` holds a data set with imported content ",
            "hint: name another folder with `-o`",
        ],
    );
    assert!(read() == before);
}
