//! Where outputs go: never over what is read, never under the name of another format, into folders
//! that are named as such.

use crate::fixtures::{Fixture, refused_with_hint};
use crate::train::{done, prepared};
use garnet::package::FileLock;

/// Runs a command that must be refused with all of `expected`, and change nothing.
fn refused(fixture: &Fixture, arguments: &str, expected: &[&str]) {
    let garment = fixture.read("sleeve.obj");
    refused_with_hint(fixture, arguments, expected);
    assert!(fixture.read("sleeve.obj") == garment, "{arguments}");
}

const DRAPE: &str = "drape sleeve.obj body.obj --pose bend.json";
const SIMULATE: &str = "simulate sleeve.obj bent.obj --rig body.rig.npz --quality fast";

#[test]
fn names_of_other_formats_are_refused() {
    let fixture = Fixture::new();
    let drapes = "drapes are written as OBJ, GLB, PC2, MDD or npz, not";
    let meshes = "meshes are written as OBJ, not";
    for name in ["x.fbx", "x.usd", "x.PLY", "x.obj.gz"] {
        let kind = name.rsplit('.').next().unwrap();
        for (arguments, what) in [
            (format!("{DRAPE} -o {name}"), drapes),
            (format!("{DRAPE} -o out.obj --body-out {name}"), drapes),
            (format!("{SIMULATE} -o {name}"), drapes),
            (format!("body -o {name}"), meshes),
        ] {
            refused(
                &fixture,
                &arguments,
                &[
                    &format!("cannot write `{name}`"),
                    &format!("{what} {kind}"),
                    "ends with .obj",
                ],
            );
        }
        refused(
            &fixture,
            &format!("render body.obj -o {name}"),
            &["pictures are PNG", "ends with .png"],
        );
    }
    for arguments in [
        "garment tshirt -o x.glb",
        "drape sleeve.obj body.obj bent.obj --rig body.rig.npz -o x.fbx",
        "body --sample 2 -o x.obj",
    ] {
        let expected = ["the name of a file", "a folder is needed"];
        refused(&fixture, arguments, &expected);
    }
    done(&fixture, &format!("{DRAPE} -o upper.OBJ -q"));
    done(&fixture, &format!("{DRAPE} -o bare -q"));
    assert!(fixture.read("upper.OBJ") == fixture.read("bare"));
}

#[test]
fn what_is_read_is_not_written_over() {
    let fixture = Fixture::new();
    done(
        &fixture,
        "garment from-obj sleeve.obj --rest-body body.obj -o net -q",
    );
    let read = ["one of the files that are read", "write into another file"];
    for arguments in [
        format!("{DRAPE} -o sleeve.obj"),
        format!("{DRAPE} -o net/../sleeve.obj"),
        format!("{DRAPE} -o body.obj"),
        format!("{DRAPE} -o out.obj --body-out sleeve.obj"),
        format!("{DRAPE} -o out.obj --body-out body.obj"),
        format!("{SIMULATE} -o sleeve.obj"),
        format!("{SIMULATE} -o bent.obj"),
        "drape net body.obj -o net/template.obj".to_owned(),
        "drape sleeve.obj bent.obj --rest-body body.obj -o ./body.obj".to_owned(),
        "body body.obj -o body.obj".to_owned(),
    ] {
        refused(&fixture, &arguments, &read);
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(fixture.path("sleeve.obj"), fixture.path("link.obj")).unwrap();
        refused(&fixture, &format!("{DRAPE} -o link.obj"), &read);
    }
}

#[test]
fn a_separator_at_the_end_means_a_folder() {
    let fixture = Fixture::new();
    done(&fixture, &format!("{DRAPE} -o one.obj -q"));
    done(
        &fixture,
        &format!("{DRAPE} -o draped/ --body-out posed/ -q"),
    );
    assert!(fixture.read("draped/body.obj") == fixture.read("one.obj"));
    assert!(fixture.path("posed/body.obj").is_file());
    done(
        &fixture,
        "drape sleeve.obj bent.obj --rest-body body.obj -o draped/ -q",
    );
    assert!(fixture.path("draped/bent.obj").is_file());
    done(&fixture, "body --pose wave -o bodies/ -q");
    assert!(fixture.path("bodies/wave.obj").is_file());
    assert!(fixture.path("bodies/body.rig.npz").is_file());
    refused(
        &fixture,
        &format!("{DRAPE} -o sleeve.obj/"),
        &["it is a file, and a folder is needed"],
    );
    refused(
        &fixture,
        &format!("{DRAPE} -o missing/out/"),
        &["the folder `missing` does not exist"],
    );
}

#[test]
fn reports_are_json_and_replace_reports_alone() {
    let fixture = prepared();
    let eval = "eval net scenes";
    let other = ["reports are written as JSON, not", "ends with .json"];
    for name in ["x.obj", "x.glb", "net/template.obj", "net/README.md"] {
        for command in [
            format!("{DRAPE} -o out.obj"),
            format!("{SIMULATE} -o out.obj"),
            "eval net scenes".to_owned(),
        ] {
            refused(&fixture, &format!("{command} --report {name}"), &other);
        }
    }
    let lost = ["a file is there that is no report", "remove this one first"];
    let dataset = fixture.read("scenes/dataset.json");
    fixture.text("jobs", "[]");
    for name in [
        "scenes/dataset.json",
        "./scenes/../scenes/dataset.json",
        "bend.json",
        "jobs",
    ] {
        for command in [format!("{DRAPE} -o out.obj"), eval.to_owned()] {
            refused(&fixture, &format!("{command} --report {name}"), &lost);
        }
    }
    assert!(fixture.read("scenes/dataset.json") == dataset);
    // What another run has reported is written over, and so is what is empty.
    fixture.text("report.json", "");
    for _ in 0..2 {
        done(
            &fixture,
            &format!("{DRAPE} -o out.obj --report report.json -q"),
        );
        done(&fixture, "eval net scenes --report report.json -q");
    }
    done(&fixture, "eval net scenes --report net/eval.json -q");
    done(&fixture, "eval net scenes --report net/eval.json -q");
}

#[test]
fn packages_and_data_sets_that_are_read_stay_as_they_are() {
    let fixture = prepared();
    done(
        &fixture,
        "train net scenes --preset tiny --epochs 1 --kind local --variant mine -q",
    );
    let weights = fixture.read("net/mine.safetensors");
    let read = ["one of the files that are read"];
    refused(
        &fixture,
        "train net scenes --from net/../net/mine.safetensors --kind local --variant mine",
        &[read[0], "another name with `--variant`"],
    );
    assert!(fixture.read("net/mine.safetensors") == weights);
    // A package whose weights have the name of a chart's file.
    let manifest = String::from_utf8(fixture.read("net/garment.toml")).unwrap();
    let renamed = manifest.replace("mine.safetensors", "samples.json");
    fixture.text("net/garment.toml", &renamed);
    fixture.bytes("net/samples.json", &weights);
    refused(
        &fixture,
        "chart net scenes -o net --teacher-scenes 0",
        &read,
    );
    assert!(fixture.read("net/samples.json") == weights);
    let fit = "simulate sleeve.obj way/frame_0009.obj --rig body.rig.npz --quality fast -o out.obj";
    fixture.folder_with("way", "bent.obj", "frame_0009.obj");
    refused(
        &fixture,
        &format!("{fit} --frames way"),
        &["`way/frame_0009.obj` is read, and has the name of a frame"],
    );
}

#[test]
fn folders_that_are_gone_on_with_are_written_by_one_run_at_a_time() {
    let fixture = prepared();
    std::fs::create_dir(fixture.path("out")).unwrap();
    let lock = FileLock::take(&fixture.path("out/garnet.lock"), &fixture.path("out")).unwrap();
    let commands = [
        "chart net scenes -o out --teacher-scenes 0 --repeat 1",
        "body --sample 1 -o out",
        "stress net -o out --quick --axis joints --method none",
    ];
    for command in commands {
        refused(&fixture, command, &["is being written by another run"]);
    }
    drop(lock);
    done(&fixture, "body --sample 1 -o out -q");
    assert!(!fixture.path("out/garnet.lock").exists());
}

#[test]
fn a_rig_beside_a_body_and_foreign_files_are_kept() {
    let fixture = Fixture::new();
    refused(
        &fixture,
        &format!("{DRAPE} -o body.rig.npz"),
        &["`body.rig.npz`", "one of the files that are read"],
    );
    fixture.text("mine.json", "{\"my\": \"work\"}");
    fixture.text("mine.txt", "my work\n");
    for name in ["mine.json", "mine.txt"] {
        let before = fixture.read(name);
        refused(
            &fixture,
            &format!("{DRAPE} -o out.obj --hide {name}"),
            &[&format!("cannot write `{name}`"), "it would be lost"],
        );
        assert!(fixture.read(name) == before);
    }
    // What an earlier run has written is written anew.
    for name in ["hidden.json", "hidden.txt"] {
        for _ in 0..2 {
            done(&fixture, &format!("{DRAPE} -o out.obj --hide {name}"));
        }
    }
}
