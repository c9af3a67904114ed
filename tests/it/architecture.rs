//! The rules of ARCHITECTURE.md that a machine can hold.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// Each crate and the crates of this workspace that it may use.
const ARROWS: [(&str, &[&str]); 17] = [
    ("garnet-mesh", &[]),
    ("garnet-knn", &["mesh"]),
    ("garnet-skin", &["mesh", "knn"]),
    ("garnet-untangle", &["mesh", "knn", "skin"]),
    ("garnet-body", &["mesh", "knn", "skin"]),
    ("garnet-io", &["mesh", "knn", "skin", "body"]),
    ("garnet-pattern", &["mesh"]),
    ("garnet-sim", &["mesh", "knn"]),
    (
        "garnet-drape",
        &[
            "mesh", "knn", "skin", "untangle", "body", "io", "sim", "net",
        ],
    ),
    (
        "garnet-data",
        &[
            "mesh", "knn", "skin", "body", "io", "pattern", "sim", "drape",
        ],
    ),
    ("garnet-kernel", &[]),
    ("garnet-net", &["mesh", "knn", "skin", "sim", "kernel"]),
    (
        "garnet-train",
        &[
            "drape", "net", "data", "untangle", "mesh", "knn", "skin", "body", "io", "pattern",
            "sim", "kernel",
        ],
    ),
    (
        "garnet-stress",
        &["mesh", "knn", "skin", "body", "drape", "data"],
    ),
    ("garnet-view", &["mesh"]),
    (
        "garnet",
        &[
            "mesh", "knn", "skin", "untangle", "body", "io", "pattern", "sim", "drape", "data",
            "kernel", "net", "train", "stress",
        ],
    ),
    ("garnet-cli", &["garnet", "view"]),
];

/// Third parties that only some crates may name.
const OWNERS: [(&str, &[&str]); 15] = [
    ("tobj", &["garnet-io"]),
    ("gltf", &["garnet-io"]),
    // Tests of data sets write archives to import.
    ("zip", &["garnet-io", "garnet-data"]),
    ("kiddo", &["garnet-knn"]),
    ("burn", &["garnet-net", "garnet-train"]),
    ("clap", &["garnet-cli", "garnet-lab"]),
    ("anyhow", &["garnet-cli"]),
    ("csv", &["garnet-cli"]),
    ("tracing", &["garnet-drape", "garnet-cli"]),
    ("tracing-subscriber", &["garnet-cli"]),
    ("indicatif", &["garnet-cli"]),
    (
        "faer",
        &[
            "garnet-skin",
            "garnet-sim",
            "garnet-train",
            "garnet-benches",
        ],
    ),
    ("pulp", &["garnet-sim"]),
    ("image", &["garnet-view"]),
    ("plotters", &["garnet-view"]),
];

/// Packages that may use any crate: they are used by none.
const OUTERMOST: [&str; 3] = ["garnet-lab", "garnet-tests", "garnet-benches"];

/// Lines of a source file, its tests included: a longer one has more than one idea.
const MAX_LINES: usize = 800;

/// Columns of a comment at most; code fences, tables and addresses may be wider.
const MAX_COLUMNS: usize = 100;

/// Crates whose public items users of the facade see.
const SHOWN: [&str; 13] = [
    "garnet-mesh",
    "garnet-knn",
    "garnet-skin",
    "garnet-untangle",
    "garnet-body",
    "garnet-io",
    "garnet-pattern",
    "garnet-sim",
    "garnet-drape",
    "garnet-data",
    "garnet-net",
    "garnet-train",
    "garnet-stress",
];

/// How public items other than fields begin.
const ITEMS: [&str; 7] = [
    "pub fn ",
    "pub const ",
    "pub struct ",
    "pub enum ",
    "pub trait ",
    "pub type ",
    "pub mod ",
];

/// A list of documentation shows a summary beside the name alone; fewer words say too little there.
const LEAST_WORDS: usize = 4;

/// The packages of the workspace, each with its manifest and the names of all that it depends on.
fn packages() -> BTreeMap<String, (PathBuf, Vec<String>)> {
    let package = |package: &Value| {
        let dependencies = package["dependencies"].as_array().unwrap();
        let names = dependencies
            .iter()
            .map(|dependency| text(&dependency["name"]));
        let manifest = PathBuf::from(text(&package["manifest_path"]));
        (text(&package["name"]), (manifest, names.collect()))
    };
    metadata().iter().map(package).collect()
}

fn text(value: &Value) -> String {
    value.as_str().unwrap().to_owned()
}

/// What Cargo knows of each package of the workspace.
fn metadata() -> Vec<Value> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args([
            "metadata",
            "--format-version",
            "1",
            "--no-deps",
            "--offline",
        ])
        .current_dir(root())
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{stderr}");
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The name of a crate from its short form in the table.
fn full_name(short: &str) -> String {
    match short {
        "garnet" => short.to_owned(),
        _ => format!("garnet-{short}"),
    }
}

#[test]
fn crates_use_only_the_crates_that_they_may_use() {
    for (name, (_, dependencies)) in packages() {
        if OUTERMOST.contains(&name.as_str()) {
            continue;
        }
        let row = ARROWS.iter().find(|(row, _)| *row == name);
        let (_, allowed) = row.unwrap_or_else(|| panic!("`{name}` is not in the table of crates"));
        let allowed: Vec<String> = allowed.iter().map(|short| full_name(short)).collect();
        for dependency in dependencies.iter().filter(|d| d.starts_with("garnet")) {
            assert!(
                allowed.contains(dependency),
                "`{name}` must not use `{dependency}`"
            );
        }
    }
}

#[test]
fn third_parties_stay_behind_the_crates_that_own_them() {
    for (name, (_, dependencies)) in packages() {
        for (third_party, owners) in OWNERS {
            let is_used = dependencies
                .iter()
                .any(|dependency| dependency == third_party);
            assert!(
                !is_used || owners.contains(&name.as_str()),
                "`{name}` names `{third_party}`"
            );
        }
    }
}

#[test]
fn all_packages_share_the_lints_of_the_workspace() {
    for (name, (manifest, _)) in packages() {
        let manifest = fs::read_to_string(manifest).unwrap().replace('\r', "");
        assert!(
            manifest.contains("[lints]\nworkspace = true"),
            "`{name}` has other lints"
        );
    }
}

#[test]
fn crates_that_command_and_library_need_can_be_published() {
    let packages = metadata();
    let is_published = |package: &&Value| package["publish"].is_null();
    let published: Vec<&Value> = packages.iter().filter(is_published).collect();
    let names: Vec<String> = (published.iter().map(|package| text(&package["name"]))).collect();
    let expected = ARROWS.map(|(name, _)| name.to_owned());
    assert_eq!(
        names.iter().collect::<BTreeSet<_>>(),
        expected.iter().collect::<BTreeSet<_>>()
    );
    for package in published {
        let name = text(&package["name"]);
        for key in ["description", "license", "readme"] {
            let is_given = package[key].as_str().is_some_and(|text| !text.is_empty());
            assert!(is_given, "`{name}` has no {key}");
        }
        for key in ["categories", "keywords"] {
            // No more than five are taken.
            let count = package[key].as_array().unwrap().len();
            assert!((1..=5).contains(&count), "`{name}` has {count} {key}");
        }
        for dependency in package["dependencies"].as_array().unwrap() {
            let other = text(&dependency["name"]);
            if dependency["path"].is_null() {
                continue;
            }
            assert!(names.contains(&other), "`{name}` needs `{other}`");
            assert_ne!(
                dependency["req"], "*",
                "`{name}` needs any version of `{other}`"
            );
        }
    }
}

#[test]
fn no_source_file_is_longer_than_a_reader_can_hold() {
    for (path, text) in sources() {
        let lines = text.lines().count();
        assert!(lines <= MAX_LINES, "{} has {lines} lines", path.display());
    }
}

#[test]
fn comments_are_no_wider_than_code() {
    let mut wide = Vec::new();
    for (path, text) in sources() {
        let mut is_fenced = false;
        for (number, line) in text.lines().enumerate() {
            let Some(comment) = line.trim_start().strip_prefix("//") else {
                is_fenced = false;
                continue;
            };
            let words = comment.trim_start_matches(['/', '!']).trim_start();
            if words.starts_with("```") {
                is_fenced = !is_fenced;
            }
            let is_exempt = is_fenced || words.starts_with('|') || words.contains("://");
            if !is_exempt && line.chars().count() > MAX_COLUMNS {
                wide.push(format!("{}:{}", path.display(), number + 1));
            }
        }
    }
    assert!(
        wide.is_empty(),
        "wider than {MAX_COLUMNS} columns: {wide:#?}"
    );
}

#[test]
fn summaries_of_public_items_stand_alone() {
    let mut short = Vec::new();
    for (path, text) in sources() {
        let is_shown = |name: &&str| path.starts_with(root().join("crates").join(name).join("src"));
        if !SHOWN.iter().any(is_shown) {
            continue;
        }
        let mut summary: Option<(usize, Vec<&str>)> = None;
        let mut is_over = false;
        for (number, line) in text.lines().enumerate() {
            let line = line.trim_start();
            if let Some(words) = line.strip_prefix("///") {
                let (_, known) = summary.get_or_insert((number + 1, Vec::new()));
                is_over |= words.trim().is_empty();
                if !is_over {
                    known.extend(words.split_whitespace());
                }
            } else if !line.starts_with('#') {
                let found = summary.take();
                let is_item = ITEMS.iter().any(|item| line.starts_with(item));
                let is_short = |(_, words): &(usize, Vec<&str>)| words.len() < LEAST_WORDS;
                if let Some((at, words)) = found.filter(|found| is_item && is_short(found)) {
                    short.push(format!("{}:{at}: {}", path.display(), words.join(" ")));
                }
                is_over = false;
            }
        }
    }
    assert!(
        short.is_empty(),
        "summaries of fewer than {LEAST_WORDS} words: {short:#?}"
    );
}

/// The Rust files of crates, tests and benches, with their text.
fn sources() -> Vec<(PathBuf, String)> {
    let mut folders = ["crates", "tests", "benches"]
        .map(|folder| root().join(folder))
        .to_vec();
    let mut sources = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = fs::read_to_string(&path).unwrap();
                sources.push((path, text));
            }
        }
    }
    assert!(!sources.is_empty());
    sources
}
