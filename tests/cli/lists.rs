//! What there is to choose from, and what shells and manuals need.

use serde_json::Value;

use crate::fixtures::{Fixture, refused_with_hint, stderr, stdout};
use crate::train::{done, prepared};

#[test]
fn poses_are_listed_by_group_with_what_is_bent() {
    let fixture = Fixture::new();
    let listed: Value = serde_json::from_str(&done(&fixture, "poses --json")).unwrap();
    assert_eq!(listed["schema"], "garnet.poses/1");
    let listed = listed["poses"].as_array().unwrap();
    assert_eq!(listed.len(), garnet::body::poses::key_poses().count());
    let warrior = listed
        .iter()
        .find(|pose| pose["name"] == "warrior_two")
        .unwrap();
    assert_eq!(warrior["group"], "yoga");
    assert!(warrior["note"].as_str().unwrap().contains("arms raised"));
    let text = done(&fixture, "poses");
    assert!(
        text.starts_with("everyday\n  stand") && text.contains("\ndance\n"),
        "{text}"
    );
    // Each can be asked for.
    for pose in listed.iter().step_by(20) {
        done(
            &fixture,
            &format!(
                "body --pose {} -o one.obj -q",
                pose["name"].as_str().unwrap()
            ),
        );
    }
}

#[test]
fn variants_are_listed_with_their_errors() {
    let fixture = prepared();
    assert_eq!(done(&fixture, "variants net"), "");
    done(&fixture, "train net scenes --preset tiny --epochs 1 -q");
    let text = done(&fixture, "variants net");
    let (head, listed) = text.split_once('\n').unwrap();
    assert!(
        head.starts_with("variant ") && head.ends_with(" time"),
        "{text}"
    );
    assert!(
        listed.starts_with("local ") && listed.contains(" mm"),
        "{text}"
    );
    assert!(listed.contains("the default"), "{text}");
    let listed: Value = serde_json::from_str(&done(&fixture, "variants net --json")).unwrap();
    assert_eq!(listed["schema"], "garnet.variants/1");
    let listed = &listed["variants"];
    assert_eq!(listed[0]["name"], "local");
    assert!(listed[0]["error_m"].as_f64().unwrap() > 0.0);
    refused_with_hint(&fixture, "variants sleeve.obj", &["is no garment package"]);
}

#[test]
fn shells_and_manuals_know_every_subcommand() {
    let fixture = Fixture::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = done(&fixture, &format!("completions {shell}"));
        assert!(
            script.contains("drape") && script.contains("stress"),
            "{shell}"
        );
    }
    done(&fixture, "man -o pages -q");
    let page = String::from_utf8(fixture.read("pages/garnet-drape.1")).unwrap();
    assert!(page.contains(".TH GARNET-DRAPE 1") && page.contains("clearance"));
    for name in ["garnet.1", "garnet-stress.1", "garnet-garment-tshirt.1"] {
        assert!(!fixture.read(&format!("pages/{name}")).is_empty());
    }
}

#[test]
fn versions_tell_commit_and_features() {
    let fixture = Fixture::new();
    let short = format!("garnet {}", env!("CARGO_PKG_VERSION"));
    assert_eq!(done(&fixture, "-V").trim_end(), short);
    let long = done(&fixture, "--version");
    let mut lines = long.lines();
    assert_eq!(lines.next(), Some(short.as_str()));
    let commit = lines.next().and_then(|line| line.strip_prefix("commit "));
    let commit = commit.unwrap();
    assert_eq!(lines.next(), Some("features package, network, train"));
    assert_eq!(lines.next(), None);
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let head = std::process::Command::new("git")
        .args(["rev-parse", "--short=9", "HEAD"])
        .current_dir(root)
        .output();
    let is_checkout = std::path::Path::new(root).join(".git").exists();
    match head {
        Ok(head) if is_checkout && option_env!("GARNET_COMMIT").is_none() => {
            assert_eq!(commit, String::from_utf8_lossy(&head.stdout).trim());
        }
        _ => assert!(!commit.is_empty()),
    }
    done(&fixture, "man -o pages -q");
    let page = String::from_utf8(fixture.read("pages/garnet.1")).unwrap();
    assert!(!page.contains("commit "), "{page}");
}

#[test]
fn what_is_done_is_told_where_it_is_asked_for() {
    let fixture = Fixture::new();
    let drape = "drape sleeve.obj bent.obj --rest-body body.obj";
    let run = |options: &str| {
        let output = fixture.garnet(&format!("{drape} {options}"));
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        (stdout(&output), stderr(&output))
    };
    let (_, usual) = run("-o usual.obj");
    assert!(!usual.contains("INFO"), "{usual}");
    let (data, told) = run("-o told.obj -v");
    assert_eq!(data, "");
    let lines = |text: &str, level: &str| {
        let begin = format!("{level} ");
        let lines = text.lines().map(str::trim_start);
        let lines = lines.filter(|line| line.starts_with(&begin));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    let info = lines(&told, "INFO");
    for expected in [
        "garnet version=",
        "instruction_set=",
        "the garment path=sleeve.obj vertices=",
        "the rest body path=body.obj rig=body.rig.npz",
        "the posed body path=bent.obj targets=1",
        "the method method=\"warp\"",
        "why=\"the garment is no package, and has no variants\"",
        "bound seconds=",
        "draped and written seconds=",
    ] {
        let is_told = info.iter().any(|line| line.contains(expected));
        assert!(is_told, "{expected}: {told}");
    }
    assert!(lines(&told, "DEBUG").is_empty(), "{told}");
    let (_, all) = run("-o all.obj -vv");
    let debug = lines(&all, "DEBUG").join("\n");
    assert!(
        debug.contains("warped seconds=") && debug.contains("untangled seconds="),
        "{all}"
    );
    // Nothing else differs.
    for name in ["told.obj", "all.obj"] {
        assert_eq!(fixture.read(name), fixture.read("usual.obj"));
    }
    let (data, told) = run("-o told.obj -v --json");
    serde_json::from_str::<Value>(&data).unwrap();
    assert!(told.contains("INFO"), "{told}");
}

#[test]
fn packages_are_found_by_their_name() {
    let fixture = Fixture::new();
    std::fs::create_dir(fixture.path("shop")).unwrap();
    done(&fixture, "garment tshirt --vertices 600 -o shop/tee -q");
    let unknown = fixture.garnet("info tee");
    assert_eq!(unknown.status.code(), Some(2));
    let found = std::process::Command::new(env!("CARGO_BIN_EXE_garnet"))
        .args(["info", "tee"])
        .current_dir(fixture.folder())
        .env("GARNET_MODELS", fixture.path("shop"))
        .output()
        .unwrap();
    assert_eq!(found.status.code(), Some(0), "{}", stderr(&found));
    assert!(
        stdout(&found).contains("garment package"),
        "{}",
        stdout(&found)
    );
}
